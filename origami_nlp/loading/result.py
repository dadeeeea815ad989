"""A load path: legs of stable states, snaps between them, branches and events around them.

Angles in radians, torques in N m, energies in J (the units of springs).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.bifurcation import PathBranch, PathEvent
from origami_nlp.display import Content, Report, Section, Table, Viewable, Words, angle_columns
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.loading.driver import VertexDriver
from origami_nlp.loading.pattern_driver import PatternDriver
from origami_nlp.loading.records import Leg, Snap
from origami_nlp.minima import Part, state_parts
from origami_nlp.numerics import INPUT_TOL
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.pattern_problem import state_frame, states_to_fold

WHY = {
    "range": "stable to the end of the range",
    "breaks-symmetry": "beyond, the state is stable only while its symmetry is kept",
}
"""Why a leg ends, in words, where the name alone does not say it."""


MOST_ANGLES = 12
"""Fold angles that are printed of one state."""


@dataclass(frozen=True, repr=False)
class LoadPath(Report, Viewable):
    """A state of a vertex or of a pattern under a load that grows, through contacts and snaps.

    Attributes
    ----------
    driver
        What the load is: its `name`, its `unit`, and the `coordinate` that it works on.
    state
        Number (1-based) of the unloaded minimum that is loaded; 0 where it was given itself.
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
    >>> sheet = o.examples.pattern("miura", 2, 3).with_springs(0.01, 1.2)
    >>> path = o.load_path(sheet, 2, to=0.02)
    >>> [leg.why for leg in path.legs], len(path.snaps)
    (['range'], 0)
    """

    driver: VertexDriver | PatternDriver
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

    PICTURE, TURNED, SCHEMA = "draw_load", "view_path", "origami-nlp/load/2"
    ALSO = ("dissipated", "interrupted")

    @property
    def interrupted(self) -> bool:
        """Whether the time was over before the path came to its end, or its snaps were confirmed; an alarm says so."""
        return any(line.startswith(OUT_OF_TIME) for line in self.alarms)

    @property
    def label(self) -> str:
        """What is loaded."""
        return self.driver.label

    @property
    def scene(self) -> Scene | None:
        """The scene, as stated; None of a pattern."""
        return getattr(self.driver, "scene", None)

    @property
    def pattern(self) -> Pattern | None:
        """The pattern, as stated; None of a scene."""
        return getattr(self.driver, "pattern", None)

    @property
    def dissipated(self) -> float:
        """Energy lost in all snaps [J]; over a closed cycle the area of the hysteresis loop."""
        return sum(snap.released for snap in self.snaps)

    def view_content(self) -> Content:
        """Return legs and snaps as plain data, see `view`."""
        content: Content = self._from_room(self.TURNED)(self)  # bodies in space are slow to import
        return content

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
        what = "angle [rad]" if self.driver.coordinate.endswith("[rad]") else "position [m]"
        heads = ["event", "type", f"load{unit}", "contact", what, ""]
        if all(e.located for e in self.events):
            heads, rows = heads[:-1], [row[:-1] for row in rows]
        title = (
            f"{self.label}: {f'state #{self.state}' if self.state else 'a state'} under {self.driver.name}, "
            f"{self.low:.6g} to {self.high:.6g} {self.driver.unit}".rstrip()
        )
        return Table(heads, rows, title, "rlrlrl"[: len(heads)])

    def report_sections(self) -> Iterator[Section]:
        """Return events, what the state does, and what confirms it."""
        table = self.table()
        yield table if self.events else table.title
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
        if self.driver.WAY:
            yield self.driver.WAY
        yield from self._more()
        yield Words(f"{self.steps} steps", "dim")
        yield from (Words(line, "bold") for line in self.alarms)

    def _more(self) -> Iterator[str]:
        if self.scene is not None and not self.scene.group.is_trivial:
            name = self.scene.group.name
            yield f"states keep the symmetry {name}; --symmetry none follows those that break it as well"
        for number, leg in enumerate(self.legs, start=1):
            at = [p.angle for p in leg.points]
            if len(at) > 1 and max(at) - min(at) <= INPUT_TOL * self.driver.arm:
                yield (
                    f"leg {number}: the load does no work, what it works on stays as it is ({self.driver.coordinate}: "
                    f"{at[0]:.6g}); no motion that is free there changes it to first order"
                )

    def _snap_lines(self, number: int) -> Iterator[str]:
        snap, unit = self.snaps[number - 1], f" {self.driver.unit}" if self.driver.unit else ""
        after = " ".join(f"{math.degrees(a) + 0.0:.2f}" for a in snap.after[:MOST_ANGLES])
        after += f" ... of {len(snap.after)}" if len(snap.after) > MOST_ANGLES else ""
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

    def states(self) -> Iterator[tuple[str, tuple[float, ...], dict[str, Any]]]:
        """Yield the stable states of all legs in order.

        Yields
        ------
        tuple
            Title, fold angles, and what else is known of each, for a frame of a FOLD file.
        """
        for number, leg in enumerate(self.legs, start=1):
            for p in leg.points:
                title = f"leg {number}, {self.driver.name} = {p.t:.9g} {self.driver.unit}".rstrip()
                yield title, p.fold_angles, {"leg": number, "parameter": p.t, "energy": p.energy}

    def to_fold(self) -> dict[str, Any]:
        """Return the stable states of all legs as FOLD data (spec 1.1), one frame each, in order."""
        stated = self._stated
        frames = [state_frame(stated, phi, title, **more) for title, phi, more in self.states()]
        return states_to_fold(stated, frames)

    @property
    def _stated(self) -> Scene | Pattern:
        driver = self.driver
        return driver.scene if isinstance(driver, VertexDriver) else driver.pattern

    def mesh_parts(self) -> list[Part]:
        """Return the states at which each leg begins and ends, side by side as triangles."""
        ends = [leg.points[k].fold_angles for leg in self.legs for k in (0, -1)]
        states = [np.array(phi) for phi in dict.fromkeys(map(tuple, ends))]
        return state_parts(self._stated, states)

    def _rows(self) -> Iterator[dict[str, object]]:
        load = "_".join(["t", *self.driver.unit.split()])
        place = "angle_rad" if self.driver.coordinate.endswith("[rad]") else "position_m"
        for number, leg in enumerate(self.legs, start=1):
            for p in leg.points:
                row: dict[str, object] = {"leg": number, load: p.t, place: p.angle}
                row |= {"energy_J": p.energy, "eigenvalue_N_m_per_rad": p.eigenvalue}
                yield row | angle_columns(p.fold_angles)
