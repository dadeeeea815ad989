"""A load path: legs of stable states, snaps between them, branches and events around them.

Angles in radians, torques in N m, energies in J (the units of springs).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.display import Section
from origami_nlp.minima import Part
from origami_nlp.numerics import INPUT_TOL
from origami_nlp.paths import records as r
from origami_nlp.paths.driver import Driver
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import Path, Plot, Track, listed
from origami_nlp.pattern_problem import state_parts


@dataclass(frozen=True, eq=False, repr=False)
class LoadPath(Path):
    """A state of a vertex or of a pattern under a load that grows, through contacts and snaps.

    Attributes
    ----------
    parameter
        The parameter, or the load, and its range.
    branches, events
        All equilibria that were followed, unstable ones included, and where they change, in order of their numbers.
    alarms
        What does not fit together, in words; empty where everything does.
    steps
        Of the continuation, that were accepted.
    interrupted
        Whether the time was over, or the user (Ctrl-C) ended it, before all was followed and judged.
    driver
        What the load is: its `name`, its `unit`, and the `coordinate` that it works on.
    state
        Number (1-based) of the unloaded minimum that is loaded; 0 where it was given itself.
    legs, snaps
        What the state does, in order.
    plastic_work
        What hinges that yield have taken [J].

    Examples
    --------
    >>> import origami_nlp as o
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=-0.15)
    >>> [round(snap.t, 6) for snap in path.snaps], [leg.why for leg in path.legs]
    ([-0.13815], ['snap', 'range'])
    >>> sheet = o.examples.pattern("miura", 2, 3).with_springs(0.01, 1.2)
    >>> path = o.load_path(sheet, 2, to=0.02)
    >>> [leg.why for leg in path.legs], len(path.snaps)
    (['range'], 0)
    """

    driver: Driver
    state: int
    legs: tuple[r.Leg, ...]
    snaps: tuple[r.Snap, ...]
    plastic_work: float = 0.0

    ALSO = ("dissipated", "start_stiffness", "stiffness_unit")

    def origami_at(self, t: float) -> Any:
        """Return what is loaded, without the load.

        Parameters
        ----------
        t
            The value.

        Returns
        -------
        Scene or Pattern
            Whose states those at t are.
        """
        return self.driver.unloaded

    @property
    def dissipated(self) -> float:
        """Energy lost in all snaps and to yielding [J]; over a closed cycle the area of the hysteresis loop."""
        return sum(snap.released for snap in self.snaps) + self.plastic_work

    @property
    def start_stiffness(self) -> float:
        """Stiffness of the state that is loaded, against the load, see `Leg`."""
        return self.legs[0].stiffness if self.legs else math.nan

    @property
    def stiffness_unit(self) -> str:
        """The unit of `start_stiffness`, of the load over what it works on."""
        return f"{self.driver.unit or 1}/{self.place.unit}"

    @property
    def place(self) -> ParameterRange:
        """What the load works on, as it is shown."""
        name, _, unit = self.driver.coordinate[:-1].rpartition(" [")
        return ParameterRange(name, -math.inf, math.inf, unit, False)

    @property
    def curves(self) -> list[Track]:
        """The legs: stable states."""
        each = [leg.points for leg in self.legs]
        return [Track("leg", k, p, "minimum") for k, p in enumerate(each, start=1)]

    def point_at(self, t: float, fold_angles: Sequence[float]) -> r.PathPoint:
        """Return a state as a point.

        Parameters
        ----------
        t
            The load.
        fold_angles
            All N [rad].

        Returns
        -------
        r.PathPoint
            With its energy and what the load works on.
        """
        phi = np.array(fold_angles)
        energy, angle = float(self.driver.unloaded.energy(phi)), float(self.driver.conjugate(phi))
        return r.PathPoint(t, tuple(fold_angles), energy, (), math.nan, angle)

    @property
    def panels(self) -> list[Plot]:
        """Load and energy over what the load works on, energy over the load."""
        load, energy, place = self.parameter.axis, "energy without the load [J]", self.place
        return [
            Plot(place.axis, load, lambda p: (place.drawn(p.angle), p.t)),
            Plot(place.axis, energy, lambda p: (place.drawn(p.angle), p.energy)),
            Plot(load, energy, lambda p: (p.t, p.energy)),
        ]

    @property
    def span(self) -> tuple[float, float]:
        """The loads of the path, not far beyond its last event."""
        loads = [t for leg in self.legs for t in leg.t] or [0.0]
        low, high = min(loads), max(loads)
        events = [0.0, *(e.t for e in self.events if low <= e.t <= high)]
        more = 0.3 * (max(events) - min(events)) or high - low
        low, high = max(low, min(events) - more), min(high, max(events) + more)
        room = 0.08 * (high - low) or 1.0
        return low - room, high + room

    def report_sections(self) -> Iterator[Section]:
        """Return what the state does: legs, snaps, events; and what is not known."""
        place, unit = self.place.stated, self.stiffness_unit
        yield listed(self.legs, f"{self.verdict}\nLegs over {place}, stiffness [{unit}]")
        if self.snaps:
            yield listed(self.snaps, f"Snaps, over {place}")
        angles = [p.angle for leg in self.legs for p in leg.points]
        if len(angles) > 1 and np.ptp(angles) <= INPUT_TOL * self.driver.work.arm:
            yield "the load does no work"
        if self.plastic_work:
            yield f"plastic work {self.plastic_work:.6g} J"
        if self.driver.scene is None:
            yield "crossing of facets is checked at the states of the path and of descents, not between them"
        yield from self.known_sections()

    @property
    def verdict(self) -> str:
        """What the state does under the load, in a sentence."""
        unit, title = f" {self.driver.unit}".rstrip(), self.driver.origami.title
        state = f"state #{self.state}" if self.state else "a state"
        does, at = "does not snap, loaded to", [leg.t[1] for leg in self.legs if leg.why == "range"]
        if self.legs and self.legs[-1].why == r.COLLAPSE:
            does, at = "collapses, as hinges yield, at", [self.legs[-1].t[1]]
        elif self.snaps:
            does, at = "snaps at", [snap.t for snap in self.snaps]
        loads = " and ".join(f"{t:.6g}" for t in at) or "0"
        lost = f", losing {self.dissipated:.6g} J" * bool(self.snaps)
        return f"{title}: {state} under {self.driver.name} {does} {loads}{unit}{lost}"

    def mesh_parts(self) -> list[Part]:
        """Return the states at which each leg begins and ends, side by side as triangles."""
        ends = dict.fromkeys(leg.points[k].fold_angles for leg in self.legs for k in (0, -1))
        return state_parts(self.driver.origami, [np.array(phi) for phi in ends])
