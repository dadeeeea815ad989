"""The map of events over two parameters: curves between which the number and kind of states do not change."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.arguments import check_until, check_whole
from origami_nlp.continuation import EventPoint, EventTracer, Line, SpecialPoint
from origami_nlp.display import Report, Section, Words, shown
from origami_nlp.errors import OUT_OF_TIME, OptionError, unless_stopped
from origami_nlp.numerics import NEAR_SINGULAR_TOL, NONZERO, SAMPLED, STATIONARY
from origami_nlp.paths.family import SAMPLES, Family, family_of, with_generic_symmetry
from origami_nlp.paths.parameter_range import ParameterRange, parse_parameter_range
from origami_nlp.paths.records import Interval
from origami_nlp.paths.result import listed
from origami_nlp.paths.survey import follow_family
from origami_nlp.pattern import Scene, as_scene
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Contact

FOLLOWED = ("fold", "nonsmooth-fold", "closes", "leaves")
"""Events that are followed over two parameters, besides those at the flat state."""
FLAT = "flat"
"""Type of a curve along which states come out of the flat one."""


@dataclass(frozen=True)
class CurvePoint:
    """An event at one pair of parameters.

    Attributes
    ----------
    t
        Both parameters in their units.
    fold_angles
        All N [rad].
    kkt, event
        Residuals of the KKT system and of the event's own function.
    """

    t: tuple[float, float]
    fold_angles: tuple[float, ...]
    kkt: float
    event: float


@dataclass(frozen=True)
class EventCurve:
    """A curve of events.

    Attributes
    ----------
    id
        From 1.
    type
        Of the event from which it was followed.
    contact
        That closes or leaves, in words; "" for folds.
    points
        In order.
    ends
        Why it ends, first and last: ``range``, ``closed curve``, or what it meets.
    """

    id: int = field(metadata=shown("curve"))
    type: str = field(metadata=shown("type"))
    contact: str = field(metadata=shown("contact"))
    points: tuple[CurvePoint, ...]
    ends: tuple[str, str] = field(metadata=shown("ends"))


@dataclass(frozen=True)
class CountedLine:
    """What was followed over one parameter at one value of the other.

    Attributes
    ----------
    parameter
        Name of the parameter that was followed over: the first, or across it the second.
    t
        Value of the other one.
    intervals
        Number and kinds of minima over it.
    events
        Values of it at which events were located, and the number of the curve of each; 0 for one that is not
        followed over two parameters.
    """

    parameter: str = field(metadata=shown("over"))
    t: float = field(metadata=shown("the other at", spec=".6g"))
    intervals: tuple[Interval, ...] = field(metadata=shown("minima", missing="not counted"))
    events: tuple[tuple[float, int], ...]


@dataclass(frozen=True, eq=False, repr=False)
class BifurcationSet(Report):
    """Curves of events over two parameters, and the counts between them.

    Attributes
    ----------
    scene
        The scene that the others differ from.
    parameters
        Both parameters with their ranges.
    curves
        In order of their numbers.
    lines
        What was followed over one parameter: each event there lies on a curve.
    interrupted
        Whether the time was over before all was followed: curves are those until then, and minima are not counted on
        lines that were not followed whole.
    stopped
        Whether the user (Ctrl-C) ended it, in place of the time.

    Examples
    --------
    >>> import origami_nlp as o
    >>> few = {"lines": 1, "across": 0, "effort": "quick"}
    >>> found = o.find_bifurcation_set(o.examples.degree6("pi/4"), "ratio=1:1.1", "alpha=44deg:45deg", **few)
    >>> len(found.curves), [interval.minima for interval in found.lines[0].intervals]
    (0, [2])
    """

    scene: Scene
    parameters: tuple[ParameterRange, ParameterRange]
    curves: tuple[EventCurve, ...]
    lines: tuple[CountedLine, ...]
    interrupted: bool = False
    stopped: bool = field(default=False, metadata={"plain": False})

    PICTURE, SCHEMA, ROWS = "draw_boundaries", "origami-nlp/path/2", "curves"

    def report_sections(self) -> Iterator[Section]:
        """Return the curves, and the counts along each line."""
        over = " and ".join(p.stated for p in self.parameters)
        yield listed(self.curves, f"{len(self.curves)} curves of events over {over}")
        yield listed(self.lines, "Minima; events that no line meets are not here")
        if self.interrupted:
            ended = "interrupted" if self.stopped else OUT_OF_TIME
            left = "on lines that were not followed whole minima are not counted"
            yield Words(f"{ended}: curves are those until then; {left}", "bold")


def find_bifurcation_set(
    scene: Scene,
    event: str | ParameterRange,
    parameter: str | ParameterRange,
    *,
    lines: int = 3,
    across: int = 1,
    seed: int = 0,
    effort: str = "normal",
    seconds: float | None = None,
) -> BifurcationSet:
    """Follow the events over one parameter through a second one.

    Parameters
    ----------
    scene
        One vertex; or a pattern that equals one.
    event
        The first parameter and its range, in which events are looked for, such as ``"ratio=0.01:100"``.
    parameter
        The second parameter and its range.
    lines
        Values of the second at which the first is followed: both ends, then between them.
    across
        Values of the first, evenly inside its range, at which the second is followed: for curves along which the second
        stays as it is, which no line meets.
    seed, effort
        Of the searches.
    seconds
        Wall time; what was followed by then is returned, see `BifurcationSet.interrupted`.  None: no limit.

    Returns
    -------
    BifurcationSet
        Curves and counts.

    Raises
    ------
    OptionError
        If the scene has no such parameters, or an argument is not what it must be.
    Interrupted
        If the user interrupts it: a `KeyboardInterrupt` whose ``result`` holds what was followed.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scene, few = o.examples.degree6("pi/3"), {"lines": 1, "across": 0, "effort": "quick"}
    >>> o.find_bifurcation_set(scene, "ratio=0.3:0.4", "alpha=59deg:60deg", **few)
    BifurcationSet(1 curves of events over ratio and alpha [rad])
    """
    scene = as_scene(scene, "a search for boundaries", "follow takes a pattern, over one parameter")
    check_whole("lines", lines, 1)
    check_whole("across", across, 0)
    until = check_until(seconds)
    stated = (parse_parameter_range(p) if isinstance(p, str) else p for p in (event, parameter))
    a, b = stated
    if a.name == b.name:
        raise OptionError(f"event and parameter are both {a.name!r}: name two parameters")
    scene = with_generic_symmetry(scene, (a, b))
    found, stopped = _Map(Plane(scene, (a, b)), until), False
    try:
        found.follow_lines(lines, across, seed=seed, effort=effort)
    except KeyboardInterrupt:
        if not found.lines:
            raise
        stopped = True
    late = stopped or time.monotonic() > until or not all(line.intervals for line in found.lines)
    what = tuple(found.curves), tuple(found.lines), late, stopped
    return unless_stopped(BifurcationSet(scene, (a, b), *what), stopped)


@dataclass(frozen=True, eq=False)
class Plane:
    """Scenes that differ from one in two parameters."""

    scene: Scene
    parameters: tuple[ParameterRange, ParameterRange]

    @cached_property
    def _like(self) -> PatternProblem:
        """Whose scale and numbers of contacts all problems of the plane take."""
        return pose(self.scene)

    def family(self, value: float, axis: int = 0, samples: int = SAMPLES) -> Family:
        """Return the scenes over the first parameter (axis 0) or the second at one value of the other."""
        along, other = self.parameters[axis], self.parameters[1 - axis]
        made = family_of(self.scene, along, other, at=[value])
        return replace(made, like=self._like, samples=samples)

    def line(self, axis: int, share: float) -> tuple[Line, float, float]:
        """Return the line over one parameter at a share of the other, where its range begins and how long it is."""
        low, high = self.parameters[axis].ends
        other = self.parameters[1 - axis].at_share(share)
        return self.family(other, axis, 2).line, low, high - low


class _Map:
    """Curves and counted lines in a plane, as far as they are known."""

    def __init__(self, plane: Plane, until: float) -> None:
        self.plane, self.until = plane, until
        self.curves: list[EventCurve] = []
        self.lines: list[CountedLine] = []
        # of each curve its points: shares of the ranges, and states
        self._traced: list[np.ndarray] = []

    def follow_lines(self, lines: int, across: int, **search: object) -> None:
        """Follow each parameter at some values of the other one, and the events that are met."""
        plane = self.plane
        where = np.linspace(0.0, 1.0, lines) if lines > 1 else [0.5]
        inside = np.linspace(0.0, 1.0, across + 2)[1:-1]
        for axis, share in [*((0, u) for u in where), *((1, u) for u in inside)]:
            if time.monotonic() > self.until:
                return
            t = plane.parameters[1 - axis].at_share(share)
            family = plane.family(t, axis)
            atlas = follow_family(family, full=False, until=self.until, **search)  # type: ignore[arg-type]
            if atlas.stopped:
                raise KeyboardInterrupt
            met = sorted(self._events(atlas.web, axis, share))
            counts = () if atlas.interrupted else atlas.intervals
            self.lines.append(CountedLine(plane.parameters[axis].name, t, counts, tuple(met)))

    def _events(self, web: Any, axis: int, other: float) -> Iterator[tuple[float, int]]:
        """Follow the events of a line that lie on no curve yet; yield where events are, and on which curves."""
        plane = self.plane
        for number, node in enumerate(web.nodes):
            flat = node.type == "singular" and not node.point[:-1].any()
            if not (flat or node.type in FOLLOWED) or not node.located:
                continue
            share, state, known = np.full(2, other), node.point[:-1], 0
            share[axis] = plane.parameters[axis].share_of(node.s)
            systems: Any = [(None, None)] if flat else _systems(web, number, node)
            # several systems can have the node as a solution: the first in which Newton comes back to it is followed
            for hold, contact in systems:
                tracer = EventTracer(plane.line, hold, contact, len(state), axis)
                first = tracer.at(share, state)
                if first is None or abs(first.x[axis] - share[axis]) > NEAR_SINGULAR_TOL:
                    continue
                words = first.frame.problem.words(contact, state).text if contact else ""
                kind = FLAT if flat else node.type
                known = self._known(first, words) or self._traced_from(tracer, first, kind, words)
                break
            yield plane.parameters[axis].t_of(node.s), known

    def _known(self, first: EventPoint, contact: str) -> int:
        """Return the number of the curve on which an event lies, between two of its points; 0 of none.

        One curve meets a line more than once, and every other line as well.
        """
        for curve, x in zip(self.curves, self._traced, strict=True):
            # rays that lie on each other close with either of their openings
            if contact.split(" (")[0] == curve.contact.split(" (")[0]:
                step, apart = np.diff(x, axis=0), first.x - x[:-1]
                along = (step * apart).sum(axis=1) / np.maximum((step * step).sum(axis=1), NONZERO)
                nearest = x[:-1] + along.clip(0.0, 1.0)[:, None] * step
                if np.linalg.norm(nearest - first.x, axis=1).min(initial=np.inf) <= SAMPLED:
                    return curve.id
        return 0

    def _traced_from(self, tracer: EventTracer, first: EventPoint, kind: str, contact: str) -> int:
        """Trace a new curve, and return its number."""
        points, ends = tracer.follow(first, self.until)
        good = [p for p in points if max(p.kkt, abs(p.event)) <= STATIONARY]
        a, b = self.plane.parameters
        at = [(a.at_share(float(p.x[0])), b.at_share(float(p.x[1]))) for p in good]
        found = [
            CurvePoint(t, p.frame.fold_angles, p.kkt, p.event)
            for t, p in zip(at, good, strict=True)
        ]
        self._traced.append(np.array([p.x for p in good]))
        self.curves.append(EventCurve(len(self.curves) + 1, kind, contact, tuple(found), ends))
        return len(self.curves)


Held = tuple[tuple[Contact, ...], Contact | None]


def _systems(web: Any, number: int, node: SpecialPoint) -> Iterator[Held]:
    """Yield what is held at an event on the side that holds less, and a contact that closes there.

    Several contacts may close together, and not all of them to first order.
    """
    arcs = [arc for arc in web.arcs if number in (arc.start, arc.end)]
    holds = [arc.frames[len(arc.frames) // 2].hold for arc in arcs]
    # one system serves both sides: without the contact, where its opening vanishes
    least = min(holds, key=len)
    if node.contact is None:
        yield least, None
        return
    rest = tuple(c for c in least if c != node.contact)
    more = (c for hold in holds for c in hold if c not in rest)
    for contact in dict.fromkeys((node.contact, *more)):
        yield rest, contact
