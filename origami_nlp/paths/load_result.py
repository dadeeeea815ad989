"""A load path: legs of stable states, snaps between them, branches and events around them.

Angles in radians, torques in N m, energies in J (the units of springs).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.display import Cell, Details, Section, Words
from origami_nlp.minima import Part
from origami_nlp.numerics import INPUT_TOL, SETTLED
from origami_nlp.paths import records as r
from origami_nlp.paths.driver import Driver
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import Path, Plot, Station, Track, bold, degrees_listed, listed
from origami_nlp.pattern_problem import state_parts

WHY = {"range": "stable; end of the range", r.PITCHFORK: "pitchfork: stable states branch off"}
"""Why a leg ends, in words, where the name alone does not say it."""
GOES_ON = (r.YIELDS, r.HOLDS)
"""Ends of legs at which another one begins."""


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
        return [Track("leg", k, p, ["minimum"] * len(p)) for k, p in enumerate(each, start=1)]

    @property
    def stations(self) -> list[Station]:
        """The events, and where snaps lead."""
        found = super().stations
        for k, s in enumerate(self.snaps, start=1):
            found.append(Station(f"after snap {k}", self.point_at(s.t, s.after), s.certificate))
        return found

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
            Plot(place.axis, load, lambda p: (place.drawn(p.angle), p.t)),
            Plot(place.axis, energy, lambda p: (place.drawn(p.angle), p.energy)),
            Plot(load, energy, lambda p: (p.t, p.energy)),
        ]

    def report_sections(self) -> Iterator[Section]:
        """Return what the state does, a line each of what happens on the path, what is not known, and the details."""
        yield listed(self.verdict, [*self._happenings()])
        if math.isfinite(self.start_stiffness):
            yield f"stiffness at the start: {self.start_stiffness:.5g} {self.stiffness_unit}"
        for number, snap in enumerate(self.snaps, start=1):
            yield f"after snap {number}, {snap.kind} [deg]: {degrees_listed(snap.after)}"
        if self.plastic_work:
            yield f"plastic work {self.plastic_work:.6g} J"
        yield from bold(self.alarms)
        if self.driver.scene is None:
            yield "crossing of facets is checked at the states of the path and of descents, not between them"
        sure = [f"snap {k}: {snap.certificate}" for k, snap in enumerate(self.snaps, start=1)]
        pieces = [self.events_table()] * bool(self.events)
        yield Details([*pieces, *sure, Words(f"{self.steps} steps", "dim")], "Events, certificates")

    def _happenings(self) -> Iterator[dict[str, Cell]]:
        """Return a row for each start, event, snap and end on the path, in its order."""
        place = replace(self.place, name=self.place.name.partition(" of ")[0])
        load = replace(self.parameter, name="load").axis
        form = "z.2f" if place.unit == "rad" else ".6g"
        at = {(e.t, e.fold_angles): e for e in self.events}

        def row(t: float, said: Cell, *angles: float) -> dict[str, Cell]:
            where = " to ".join(f"{place.drawn(v):{form}}" for v in angles)
            return {load: f"{t:.6g}", "what happens": said, place.axis: where}

        for number, leg in enumerate(self.legs):
            first, last = leg.points[0], leg.points[-1]
            if first.t == 0.0:
                said = f"state #{self.state}" if self.state else "the state that was given"
                yield row(0.0, said + " again, loaded the other way" * bool(number), first.angle)
            # the event at the end of a leg that snaps or branches is told by its end
            told = self.snaps[leg.snap - 1].event if leg.snap else None
            for p in leg.points[1 : -1 if leg.why == r.PITCHFORK else None]:
                event = at.get((p.t, p.fold_angles))
                if event and event.id != told:
                    yield row(p.t, event.words(growing=last.t >= first.t), p.angle)
            if leg.snap is not None:
                snap = self.snaps[leg.snap - 1]
                said = f"snap {leg.snap}: {r.EVENT_WORDS.get(snap.type, snap.type)}"
                lost = {"energy\nlost [J]": f"{snap.released:.6g}"}
                yield row(snap.t, Words(said, "bold"), *snap.angle) | lost | _kept(leg)
            elif leg.why not in GOES_ON:
                angles = [p.angle for p in leg.points]
                idle = len(angles) > 1 and np.ptp(angles) <= INPUT_TOL * self.driver.work.arm
                said = WHY.get(leg.why, leg.why) + "; the load does no work" * bool(idle)
                yield row(last.t, said, last.angle) | _kept(leg)

    @property
    def verdict(self) -> str:
        """What the state does under the load, in a sentence."""
        unit = f" {self.driver.unit}".rstrip()
        state = f"state #{self.state}" if self.state else "a state"
        words = f"{self.driver.origami.title}: {state} under {self.driver.name}"
        if self.legs and self.legs[-1].why == r.COLLAPSE:
            return f"{words} collapses at {self.legs[-1].points[-1].t:.6g}{unit}: hinges yield"
        if self.snaps:
            at = " and ".join(f"{snap.t:.6g}" for snap in self.snaps)
            whole = " in all" * (len(self.snaps) > 1)
            return f"{words} snaps at {at}{unit}, losing {self.dissipated:.6g} J{whole}"
        last = [leg for leg in self.legs if leg.why not in GOES_ON]
        ends = " and to ".join(f"{leg.points[-1].t:.6g}" for leg in last) or "0"
        left = ", where it is left" * any(leg.why != "range" for leg in last)
        return f"{words} does not snap, loaded to {ends}{unit}{left}"

    def mesh_parts(self) -> list[Part]:
        """Return the states at which each leg begins and ends, side by side as triangles."""
        ends = dict.fromkeys(leg.points[k].fold_angles for leg in self.legs for k in (0, -1))
        return state_parts(self.driver.origami, [np.array(phi) for phi in ends])


def _kept(leg: r.Leg) -> dict[str, Cell]:
    """Return by how much the rest angles have moved that a leg leaves behind."""
    moved = ((i, math.degrees(m)) for i, m in enumerate(leg.moved, start=1) if abs(m) > SETTLED)
    return {"rest angles\nmoved [deg]": ", ".join(f"{i}: {m:+.4g}" for i, m in moved)}
