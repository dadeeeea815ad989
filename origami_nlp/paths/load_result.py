"""A load path: legs of stable states, snaps between them, branches and events around them.

Angles in radians, torques in N m, energies in J (the units of springs).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.display import Cell, Section, Table, Words
from origami_nlp.minima import Part
from origami_nlp.numerics import INPUT_TOL, SETTLED
from origami_nlp.paths import records as r
from origami_nlp.paths.driver import Driver
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import (
    Path,
    Plot,
    Station,
    Track,
    bold,
    degrees_listed,
    details,
    listed,
)
from origami_nlp.pattern_problem import state_parts

WHY = {"range": "stable; end of the range", r.PITCHFORK: "pitchfork: stable states branch off"}
"""Why a leg ends, in words, where the name alone does not say it."""
GOES_ON = (r.YIELDS, r.HOLDS)
"""Ends of legs at which another one begins."""
SHIFT = 0.01
"""Share of the range by which the load of a state differs that is loaded anew; after a snap it is far less."""
MOST_NAMED = 3
"""Snaps whose loads the verdict names."""


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
    cost
        What it took.
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
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=-0.15, confirm=False)
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
    def curves(self) -> list[Track]:
        """The legs: stable states."""
        numbered = enumerate(self.legs, start=1)
        return [Track("leg", k, leg.points, ["minimum"] * len(leg.points)) for k, leg in numbered]

    @property
    def stations(self) -> list[Station]:
        """The events, and where snaps lead."""
        landed = [(f"after snap {k}", s) for k, s in enumerate(self.snaps, start=1)]
        after = [Station(title, self.point_at(s.t, s.after), s.certificate) for title, s in landed]
        return super().stations + after

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
        return r.PathPoint(t, tuple(fold_angles), energy, (), math.nan, math.nan, angle)

    @property
    def panels(self) -> list[Plot]:
        """Load and energy over what the load works on, energy over the load."""
        load, energy, place = self.parameter.axis, "energy without the load [J]", self.place
        return [
            Plot(place.axis, load, lambda p: place.drawn(p.angle), lambda p: p.t),
            Plot(place.axis, energy, lambda p: place.drawn(p.angle), lambda p: p.energy),
            Plot(load, energy, lambda p: p.t, lambda p: p.energy),
        ]

    def table(self) -> Table:
        """Return one row an event, in order of the load; with a star those on the path."""
        on = {s.event for s in self.snaps} | {e.id for leg in self.legs for _, e in self._on(leg)}
        return self.events_table("all events, * on the path", frozenset(on))

    def _beside(self, event: r.PathEvent) -> dict[str, str]:
        return {
            self.place.axis: self._place(float(self.driver.conjugate(np.array(event.fold_angles))))
        }

    def report_sections(self) -> Iterator[Section]:
        """Return what the state does, a line each of what happens on the path, what is not known, and the details."""
        yield listed(self.verdict, [*self._happenings()])
        if math.isfinite(self.start_stiffness):
            yield f"stiffness at the start: {self.start_stiffness:.5g} {self.stiffness_unit}"
        for number, snap in enumerate(self.snaps, start=1):
            yield f"after snap {number}, {snap.kind} [deg]: {degrees_listed(snap.after)}"
            if snap.confirmed is not None and not all(snap.confirmed.found):
                yield from bold([f"snap {number}: {snap.confirmed.words()}"])
        if self.plastic_work:
            yield f"plastic work {self.plastic_work:.6g} J"
        yield from bold(self.alarms)
        if self.driver.scene is None:
            yield "crossing of facets is checked at the states of the path and of descents, not between them"
        yield details(self._details(), "Events, certificates, searches")

    def _happenings(self) -> Iterator[dict[str, Cell]]:
        """Return a row for each start, contact, snap and end on the path, in its order."""
        place = replace(self.place, name=self.place.name.partition(" of ")[0]).axis
        load, arrived = replace(self.parameter, name="load").axis, math.nan

        def row(t: float, said: Cell, *angles: float) -> dict[str, Cell]:
            return {load: f"{t:.6g}", "what happens": said, place: self._place(*angles)}

        for leg in self.legs:
            first, last = leg.points[0], leg.points[-1]
            if not abs(first.t - arrived) <= SHIFT * (self.parameter.high - self.parameter.low):
                said = f"state #{self.state}" if self.state else "the state that was given"
                again = " again, loaded the other way" * math.isfinite(arrived)
                yield row(first.t, said + again, first.angle)
            for p, event in self._on(leg):
                if leg.why != r.PITCHFORK or p is not last:
                    yield row(event.t, event.words(growing=last.t >= first.t), p.angle)
            arrived = last.t
            if leg.snap is not None:
                snap = self.snaps[leg.snap - 1]
                words = f"snap {leg.snap}: {r.EVENT_WORDS.get(snap.type, snap.type)}"
                yield row(snap.t, Words(words, "bold"), *snap.angle) | self._more(leg)
            elif leg.why not in GOES_ON:
                at = [p.angle for p in leg.points]
                idle = len(at) > 1 and max(at) - min(at) <= INPUT_TOL * self.driver.work.arm
                said = WHY.get(leg.why, leg.why) + "; the load does no work" * idle
                yield row(last.t, said, last.angle) | self._more(leg)

    def _more(self, leg: r.Leg) -> dict[str, Cell]:
        """Return what else is known of a leg: energy lost, symmetry, rest angles that have moved."""
        lost = "" if leg.snap is None else f"{self.snaps[leg.snap - 1].released:.6g}"
        kept = "" if leg.symmetry == "none" else leg.symmetry
        since = "" if leg.full_space_from is None else f" from {leg.full_space_from:.6g}"
        row: dict[str, Cell] = {"energy\nlost [J]": lost, "symmetry": kept}
        shown = leg.full_space + since if kept else ""
        row["without it"] = shown if leg.full_space in ("", "stable") else Words(shown, "bold")
        moved = ((i, m) for i, m in enumerate(leg.moved, start=1) if abs(m) > SETTLED)
        row["rest angles\nmoved [deg]"] = ", ".join(
            f"{i}: {math.degrees(m):+.4g}" for i, m in moved
        )
        return row

    def _on(self, leg: r.Leg) -> Iterator[tuple[r.PathPoint, r.PathEvent]]:
        """Return the events that a leg passes, in its order, without that at its end."""
        left = {e.fold_angles: e for e in self.events}
        if leg.snap:
            event = self.snaps[leg.snap - 1].event
            left = {phi: e for phi, e in left.items() if e.id != event}
        for point in leg.points:
            passed = left.pop(point.fold_angles, None)
            # a leg that begins where a hinge yields does not pass that
            if passed and (passed.type not in GOES_ON or point is not leg.points[0]):
                yield point, passed

    @property
    def verdict(self) -> str:
        """What the state does under the load, in a sentence."""
        unit = f" {self.driver.unit}".rstrip()
        state = f"state #{self.state}" if self.state else "a state"
        words = f"{self.driver.origami.title}: {state} under {self.driver.name}"
        for leg in self.legs:
            if leg.why == r.COLLAPSE:
                return f"{words} collapses at {leg.points[-1].t:.6g}{unit}: hinges yield"
        if not self.snaps:
            last = [leg for leg in self.legs if leg.why not in GOES_ON]
            ends = " and to ".join(f"{leg.points[-1].t:.6g}" for leg in last) or "0"
            left = ", where it is left" * any(leg.why != "range" for leg in last)
            return f"{words} does not snap, loaded to {ends}{unit}{left}"
        at = " and ".join(f"{snap.t:.6g}" for snap in self.snaps[:MOST_NAMED])
        more, all_ = len(self.snaps) - MOST_NAMED, " in all" * (len(self.snaps) > 1)
        at += f" and {more} more loads" if more > 0 else ""
        return f"{words} snaps at {at}{unit}, losing {self.dissipated:.6g} J{all_}"

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

    def _place(self, *values: float) -> str:
        form = "z.2f" if self.place.unit == "rad" else ".6g"
        return " to ".join(f"{self.place.drawn(v):{form}}" for v in values)

    def _details(self) -> Iterator[Table | Cell]:
        """Return all events, those of unstable equilibria too, what certifies each snap, and what following cost."""
        yield self.table()
        for number, snap in enumerate(self.snaps, start=1):
            again, sure = snap.restabilises, snap.confirmed
            said = f"snap {number}, event {snap.event}: lands on {snap.kind}: {snap.certificate}"
            said += "" if again is None else f"; unstable states are stable again at {again:.12g}"
            yield said + ("" if sure is None else f"; {sure.words()}")
        yield Words(f"{self.cost.steps} steps", "dim")

    def mesh_parts(self) -> list[Part]:
        """Return the states at which each leg begins and ends, side by side as triangles."""
        ends = dict.fromkeys(leg.points[k].fold_angles for leg in self.legs for k in (0, -1))
        return state_parts(self.driver.origami, [np.array(phi) for phi in ends])
