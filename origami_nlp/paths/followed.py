"""A bifurcation diagram as branches and events: arcs judged and joined, nodes made events, states at one value."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.continuation import (
    AGAIN,
    LATE,
    BifurcationDiagram,
    BranchSegment,
    Equilibrium,
    Line,
)
from origami_nlp.errors import OptionError
from origami_nlp.kkt import contact_forces
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import rank
from origami_nlp.paths import records as r
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.pattern_states import judge

QUIET = ("start", "range", "corner", AGAIN, LATE)
"""Nodes at which nothing happens."""


class FollowedDiagram(BifurcationDiagram):
    """Equilibria over a parameter or under a load, and what they are as records.

    Where the user (Ctrl-C) ends judging, arcs that are left are undecided.

    Parameters
    ----------
    line
        The problems.
    parameter
        The parameter, or load, and its range.
    options
        As of `BifurcationDiagram`.
    """

    def __init__(self, line: Line, parameter: ParameterRange, **options: Any) -> None:
        if line.problem.sparse:
            many = f"a pattern of {line.problem.size} creases"
            raise OptionError(f"states of {many} are not followed: its closure has sparse factors")
        super().__init__(line, *parameter.ends, **options)
        self.parameter, self.cut = parameter, False
        self._kinds, self._points = dict[int, tuple[str, str]](), dict[Equilibrium, r.PathPoint]()

    def across(self, frame: Equilibrium) -> float:
        """Return the smallest stiffness of a state across its symmetry; nan where it keeps none that is imposed."""
        return math.nan

    def seen_as(self, frame: Equilibrium, phi: np.ndarray) -> dict[str, Any]:
        """Return the energy of a state at all fold angles, and what else its point has."""
        raise NotImplementedError

    def pack(self) -> Any:
        """Judge what was followed, and return the result."""
        raise NotImplementedError

    def result(self) -> Any:
        """Return what `pack` makes; once the user (Ctrl-C) ends judging, what is left is undecided."""
        try:
            return self.pack()
        except KeyboardInterrupt:
            self.stop()
            self.cut = True
            return self.pack()

    def records(self) -> tuple[tuple[r.PathBranch, ...], tuple[r.PathEvent, ...]]:
        """Return branches and events with their numbers."""
        for k, arc in enumerate(self.arcs):
            if k not in self._kinds:
                self._kinds[k] = kind_of(arc, judged=not self.cut)
        shown = [k for k, node in enumerate(self.nodes) if node.type not in QUIET]
        shown.sort(key=lambda k: self.nodes[k].s)
        events = tuple(self._event(*numbered) for numbered in enumerate(shown, start=1))
        return tuple(map(self._branch, range(len(self.arcs)))), events

    def point(self, frame: Equilibrium) -> r.PathPoint:
        """Return a state in the scene's units."""
        if frame in self._points:
            return self._points[frame]
        phi = frame.problem.expand(frame.state) + 0.0
        found = r.PathPoint(
            self.parameter.t_of(frame.s),
            tuple(phi.tolist()),
            multipliers=contact_forces(frame.seen, frame.hold) if frame.hold else (),
            eigenvalue=self.line.problem.scale * float(min(frame.eigenvalues, default=math.nan)),
            full_space_eigenvalue=math.nan if self.cut else self.across(frame),
            **self.seen_as(frame, phi),
        )
        return self._points.setdefault(frame, found)

    def listed_at(self, value: float) -> tuple[JudgedState, ...]:
        """Return the states of all branches at one value of the parameter, judged there."""
        out = []
        for frame in self.frames_at(self.parameter.s_of(value)):
            posed: Any = frame.problem
            energy = self.seen_as(frame, frame.seen.fold_angles)["energy"]
            out.append(replace(judge(posed, frame.state), energy=energy))
        # ties (mirror images of one another) in a fixed order
        scale = self.line.problem.scale
        return tuple(sorted(out, key=lambda one: rank(one.energy / scale, one.fold_angles)))

    def _event(self, number: int, at: int) -> r.PathEvent:
        node, arcs = self.nodes[at], enumerate(self.arcs, start=1)
        meets = tuple(k for k, arc in arcs if at in (arc.start, arc.end))
        problem, note = self.line.at(node.s), node.why
        if node.between is not None:
            low, high = (self.parameter.shown(self.parameter.t_of(s), 12) for s in node.between)
            note = f"between {low} and {high}: {note}"
        phi, t = (problem.expand(node.point[:-1]) + 0.0).tolist(), self.parameter.t_of(node.s)
        who = node.contact and problem.words(node.contact, node.point[:-1]).text
        how = r.Residuals(node.residual, node.value), node.located, note, meets
        return r.PathEvent(number, self._type(at), t, tuple(phi), who or "", *how)

    def _type(self, at: int) -> str:
        """Return the type of an event, contacts as they close and leave while the parameter grows."""
        node = self.nodes[at]
        if node.type not in ("closes", "leaves"):
            return "singular" if node.type == "refused" else node.type
        arcs = [arc for arc in self.arcs if at in (arc.start, arc.end)]
        held = [(a.frames[1].hold, a.high > node.s + (node.s - a.low)) for a in arcs]
        # of contacts that close together another one may be held: then more of them are on that side
        most = max((len(contacts) for contacts, _ in held), default=0)
        named = [after for contacts, after in held if node.contact in contacts][:1]
        named = named or [after for contacts, after in held if len(contacts) == most]
        return node.type if len(set(named)) != 1 else "closes" if named[0] else "leaves"

    def _branch(self, k: int) -> r.PathBranch:
        arc, (kind, why) = self.arcs[k], self._kinds[k]
        points = tuple(map(self.point, arc.frames))
        both = (self.nodes[node] for node in (arc.start, arc.end))
        begins, ends = (": ".join(filter(None, (node.type, node.why))) for node in both)
        t = points[0].t, points[-1].t
        return r.PathBranch(k + 1, t, kind, arc.index, why, points, (begins, ends))


def kind_of(arc: BranchSegment, judged: bool = True) -> tuple[str, str]:
    """Return what the states of an arc are, and why: judged in the middle and beside its ends.

    If one of these is no minimum that is said of all.
    """
    last = len(arc.frames) - 1
    if arc.index:
        return "saddle", ""
    if not judged:
        return "undecided", "interrupted before it was judged"
    inner = [last // 2, 1, last - 1] if last > 1 else [arc.middle]
    found = [arc.frames[k].judged for k in dict.fromkeys(inner)]
    worst = next((what for what in found if what.kind not in r.COUNTED), found[0])
    return worst.kind or worst.verdict, worst.reason
