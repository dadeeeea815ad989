"""A load path: legs of stable states, snaps between them, branches and events around them.

JSON schema ``origami-nlp/load/1``: angles in radians, torques in N m, energies in J (the scene's units).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.atlas import PathBranch, PathEvent
from origami_nlp.loading.driver import Driver
from origami_nlp.loading.records import Leg, Snap
from origami_nlp.pattern import Scene, scene_to_dict
from origami_nlp.show import Content, Piece, Table, Told, Turnable, Words, to_plain

SCHEMA = "origami-nlp/load/1"
WHY = {
    "range": "stable to the end of the range",
    "breaks-symmetry": "stopped: beyond, the state is stable only while its symmetry is kept",
}
"""Why a leg ends, in words, where the name alone does not say it."""


@dataclass(frozen=True, repr=False)
class LoadPath(Told, Turnable):
    """A state under a load that grows, through contacts and snaps.

    Attributes
    ----------
    scene
        As stated.
    driver
        What the load is.
    state
        Number (1-based) of the minimum of the unloaded scene that is loaded.
    low, high
        Range of the load.
    legs, snaps
        What the state does, in order.
    branches, events
        All equilibria that were followed, unstable ones included, and where they change.
    alarms
        What does not fit together, in words; empty where everything does.
    steps, evaluations
        What following cost.

    Examples
    --------
    >>> import origami_nlp as o
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=-0.15, confirm=False)
    >>> [round(snap.t, 6) for snap in path.snaps], [leg.why for leg in path.legs]
    ([-0.13815], ['snap', 'range'])
    """

    scene: Scene
    driver: Driver
    state: int
    low: float
    high: float
    legs: tuple[Leg, ...]
    snaps: tuple[Snap, ...]
    branches: tuple[PathBranch, ...]
    events: tuple[PathEvent, ...]
    alarms: tuple[str, ...]
    steps: int
    evaluations: int

    PICTURE = "draw_load"

    @property
    def dissipated(self) -> float:
        """Energy lost in all snaps [J]; over a closed cycle the area of the hysteresis loop."""
        return sum(snap.released for snap in self.snaps)

    def table(self) -> Table:
        """Return one row an event, in order of the load."""
        on = {e for s in self.snaps for e in [s.event]}
        unit = f" [{self.driver.unit}]" if self.driver.unit else ""
        rows = [
            [
                str(e.id) + ("*" if e.id in on else ""),
                e.type,
                f"{e.t:.12g}",
                e.contact or "-",
                f"{float(self.driver.conjugate(np.array(e.fold_angles))):.6g}",
                "" if e.located else "not located",
            ]
            for e in self.events
        ]
        head = "angle [rad]" if self.driver.crease else "position [m]"
        title = (
            f"{self.scene.label or self.scene.vertex!r}: state #{self.state} under {self.driver.name}, "
            f"{self.low:.6g} to {self.high:.6g} {self.driver.unit}".rstrip()
        )
        return Table(["event", "type", f"load{unit}", "contact", head, ""], rows, title, "rlrlrl")

    def told(self) -> Iterator[Piece]:
        """Return events, what the state does, and what confirms it."""
        yield self.table()
        unit = f" {self.driver.unit}" if self.driver.unit else ""
        for leg in self.legs:
            a, b = leg.points[0].t, leg.points[-1].t
            full = f"; in the full space {leg.full_space}" if leg.full_space else ""
            if leg.full_space_from is not None:
                full += f" from {leg.full_space_from:.6g}{unit} on"
            yield f"from {a:.9g} to {b:.9g}{unit}: {WHY.get(leg.why, leg.why)}{full}"
            if leg.snap is not None:
                yield from self._snap_lines(leg.snap)
        if self.snaps:
            yield f"energy lost in snaps: {self.dissipated:.6g} J"
        else:
            yield "no snap"
        if not self.scene.group.is_trivial:
            yield f"states keep the symmetry {self.scene.group.name}; where they would break it the path stops"
        yield Words(f"{self.steps} steps, {self.evaluations} evaluations of the KKT system", "dim")
        yield from (Words(line, "bold") for line in self.alarms)

    def _snap_lines(self, number: int) -> Iterator[str]:
        snap, unit = self.snaps[number - 1], f" {self.driver.unit}" if self.driver.unit else ""
        after = " ".join(f"{math.degrees(a) + 0.0:.2f}" for a in snap.after)
        yield (
            f"   snap {number}, {snap.type} (event {snap.event}) at {snap.t:.12g}{unit}: loses {snap.released:.6g} J, "
            f"lands on {snap.kind} ({after}) deg: {snap.certificate}"
        )
        if snap.restabilises is not None:
            yield f"   the unstable states beyond become stable again at {snap.restabilises:.12g}{unit}"
        if (c := snap.confirmed) is not None:
            words = ["is among them" if f else "is NOT among them" for f in c.found]
            yield (
                f"   searches: {c.minima[0]} minima at {c.t[0]:.6g}{unit}, the state before the snap {words[0]}; "
                f"{c.minima[1]} at {c.t[1]:.6g}{unit}, the one after {words[1]}"
            )

    def turned(self) -> Content:
        """Return legs and snaps as plain data, see `view`."""
        from origami_nlp.loading.turned import turn_path  # bodies in space are slow to import

        return turn_path(self.driver, self.legs, self.snaps, self.told())

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data."""
        return {
            "schema": SCHEMA,
            "scene": scene_to_dict(self.scene),
            "parameter": {
                "name": self.driver.name,
                "unit": self.driver.unit,
                "from": self.low,
                "to": self.high,
                "scale": "linear",
                "creases": list(self.driver.creases),
                "coordinate": self.driver.coordinate,
            },
            "state": self.state,
            "legs": to_plain(self.legs),
            "snaps": to_plain(self.snaps),
            "dissipated": self.dissipated,
            "branches": to_plain(self.branches),
            "events": to_plain(self.events),
            "alarms": list(self.alarms),
            "cost": {"steps": self.steps, "evaluations": self.evaluations},
        }
