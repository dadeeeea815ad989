"""Arcs of a bifurcation diagram joined to branches, and its nodes made events."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from origami_nlp.continuation import AGAIN, LATE, BifurcationDiagram, Equilibrium, SpecialPoint
from origami_nlp.kkt import State
from origami_nlp.numerics import CONTACT_TOL
from origami_nlp.paths.judging import JudgedSegment
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.records import (
    BranchEnd,
    KindRange,
    Multiplier,
    PathBranch,
    PathEvent,
    PathPoint,
    Residuals,
)
from origami_nlp.problem import Contact

QUIET = ("start", "range", "corner", AGAIN, LATE)
"""Nodes at which nothing happens."""
Chain = list[tuple[int, bool]]
"""Arcs in order, each with whether it is run from its start to its end."""


def chains_of(web: BifurcationDiagram) -> list[Chain]:
    """Join arcs at nodes where just two of them meet; others end there."""
    meeting: dict[int, list[int]] = {}
    for k, arc in enumerate(web.arcs):
        meeting.setdefault(arc.start, []).append(k)
        meeting.setdefault(arc.end, []).append(k)
    left = set(range(len(web.arcs)))
    out: list[Chain] = []

    def walk(arc: int, node: int) -> Chain:
        chain: Chain = []
        while arc in left:
            left.discard(arc)
            forward = web.arcs[arc].start == node
            chain.append((arc, forward))
            node = web.arcs[arc].end if forward else web.arcs[arc].start
            onward = [k for k in meeting[node] if k != arc]
            if len(meeting[node]) != 2 or not onward:
                break
            arc = onward[0]
        return chain

    for node, arcs in sorted(meeting.items()):
        # ends of branches: where one arc ends, or three and more meet
        if len(arcs) != 2:
            out += [walk(k, node) for k in arcs if k in left]
    for k in range(len(web.arcs)):
        if k in left:
            out.append(walk(k, web.arcs[k].start))
    return out


def branches_of(
    web: BifurcationDiagram,
    parameter: ParameterRange,
    chains: list[Chain],
    parts: dict[int, list[JudgedSegment]],
    across: Callable[[Equilibrium], float],
) -> tuple[tuple[PathBranch, ...], tuple[PathEvent, ...]]:
    """Return branches and events, with their numbers.

    parts: of each arc, see `parts_of`.  across: eigenvalue across the symmetry.
    """
    meets: dict[int, set[int]] = {}
    for number, chain in enumerate(chains, start=1):
        for k, _ in chain:
            meets.setdefault(web.arcs[k].start, set()).add(number)
            meets.setdefault(web.arcs[k].end, set()).add(number)
    shown = [k for k, node in enumerate(web.nodes) if node.type not in QUIET]
    shown.sort(key=lambda k: web.nodes[k].s)
    ids = {k: i for i, k in enumerate(shown, start=1)}
    events = tuple(
        _event(web, ids[k], web.nodes[k], parameter, tuple(sorted(meets.get(k, ())))) for k in shown
    )
    branches = tuple(
        _branch(web, parameter, number, chain, parts, across, ids)
        for number, chain in enumerate(chains, start=1)
    )
    return branches, events


def joined(
    diagrams: Sequence[tuple[Sequence[PathBranch], Sequence[PathEvent]]],
    one: Callable[[PathEvent, PathEvent], bool],
    order: Callable[[PathEvent], tuple[float, ...]],
) -> tuple[list[PathBranch], list[PathEvent]]:
    """Return the branches and events of several diagrams of one system as those of one, numbered anew.

    one: whether two events are one, of which the first is kept.  order: of events that are.
    """
    if len(diagrams) == 1:
        return list(diagrams[0][0]), list(diagrams[0][1])
    shifts = np.cumsum([0, *(len(branches) for branches, _ in diagrams)]).tolist()
    found = [(which, e) for which, (_, events) in enumerate(diagrams) for e in events]
    found.sort(key=lambda pair: (not pair[1].located, order(pair[1])))
    groups: list[list[tuple[int, PathEvent]]] = []
    for which, e in found:
        same = next((g for g in groups if one(g[0][1], e)), None)
        if same is None:
            groups.append([(which, e)])
        else:
            same.append((which, e))
    groups.sort(key=lambda group: group[0][1].t)
    ids = {(which, e.id): k for k, g in enumerate(groups, start=1) for which, e in g}
    events = []
    for k, g in enumerate(groups, start=1):
        own = sorted({b + shifts[which] for which, e in g for b in e.branches})
        events.append(replace(g[0][1], id=k, branches=tuple(own)))
    branches = []
    for which, (several, _) in enumerate(diagrams):
        for b in several:
            a, c = (
                replace(end, event=None if end.event is None else ids[which, end.event])
                for end in b.ends
            )
            branches.append(replace(b, id=b.id + shifts[which], ends=(a, c)))
    return branches, events


def _event(
    web: BifurcationDiagram,
    number: int,
    node: SpecialPoint,
    parameter: ParameterRange,
    meets: tuple[int, ...],
) -> PathEvent:
    problem, note = web.line.at(node.s), node.why
    if node.between is not None:
        low, high = (parameter.shown(parameter.t_of(s), 12) for s in node.between)
        note = f"between {low} and {high}: {note}"
    return PathEvent(
        number,
        _type(web, node),
        parameter.t_of(node.s),
        tuple((problem.expand(node.point[:-1]) + 0.0).tolist()),
        "" if node.contact is None else problem.words(node.contact, node.point[:-1]).text,
        Residuals(node.residual, node.value),
        node.located,
        note,
        meets,
    )


def _type(web: BifurcationDiagram, node: SpecialPoint) -> str:
    """Return the type of an event, contacts as they close and leave while the parameter grows."""
    if node.type == "refused":
        return "singular"
    if node.type not in ("closes", "leaves"):
        return node.type
    number = web.nodes.index(node)
    held = [
        (arc.frames[1].hold.contacts, arc.high > node.s + (node.s - arc.low))
        for arc in web.arcs
        if number in (arc.start, arc.end)
    ]
    # of contacts that close together another one may be held: then more of them are on that side
    most = max((len(contacts) for contacts, _ in held), default=0)
    named = [after for contacts, after in held if node.contact in contacts][:1]
    named = named or [after for contacts, after in held if len(contacts) == most]
    if len(set(named)) != 1:
        return node.type
    return "closes" if named[0] else "leaves"


def _branch(
    web: BifurcationDiagram,
    parameter: ParameterRange,
    number: int,
    chain: Chain,
    parts: dict[int, list[JudgedSegment]],
    across: Callable[[Equilibrium], float],
    ids: dict[int, int],
) -> PathBranch:
    points: list[PathPoint] = []
    ranges: list[KindRange] = []
    for k, forward in chain:
        arc = web.arcs[k]
        frames = arc.frames if forward else arc.frames[::-1]
        last = len(frames) - 1
        # positions in the whole branch
        begin = len(points) - bool(points)  # arcs share the point at which they meet
        dependent = _dependent(arc.frames[last // 2])
        points += [point_of(f, parameter, across, dependent) for f in frames[bool(points) :]]
        for part in parts[k] if forward else reversed(parts[k]):
            a, b = (part.first, part.last) if forward else (last - part.last, last - part.first)
            t = parameter.t_of(frames[a].s), parameter.t_of(frames[b].s)
            new = KindRange(t, part.kind, arc.index, part.certificate, (begin + a, begin + b))
            ranges = _joined(ranges, new)
    (a, forward), (b, onward) = chain[0], chain[-1]
    first = web.arcs[a].start if forward else web.arcs[a].end
    final = web.arcs[b].end if onward else web.arcs[b].start
    ends = (_end(web, first, ids), _end(web, final, ids))
    if first == final and len(chain) > 1:
        ends = (BranchEnd("closed curve", None),) * 2
    return PathBranch(number, tuple(ranges), tuple(points), ends)


def _joined(ranges: list[KindRange], new: KindRange) -> list[KindRange]:
    """Add a range; one that goes on in the same kind and direction is made longer."""
    if ranges and (old := ranges[-1]).kind == new.kind and old.index == new.index:
        if (old.t[1] - old.t[0]) * (new.t[1] - new.t[0]) > 0:
            t, points = (old.t[0], new.t[1]), (old.points[0], new.points[1])
            return [*ranges[:-1], replace(old, t=t, points=points)]
    return [*ranges, new]


def _end(web: BifurcationDiagram, node: int, ids: dict[int, int]) -> BranchEnd:
    found = web.nodes[node]
    why = found.type + (f": {found.why}" if found.why else "")
    return BranchEnd(why, ids.get(node))


Pieces = tuple[tuple[Contact, ...], ...]


def point_of(
    frame: Equilibrium,
    parameter: ParameterRange,
    across: Callable[[Equilibrium], float],
    dependent: Pieces,
) -> PathPoint:
    """Return a state of a branch in the scene's units; dependent: see `_dependent`."""
    p = frame.problem
    forces = []
    if frame.hold.contacts:
        held = zip(frame.hold.contacts, frame.forces.tolist(), strict=True)
        spread = _spread(frame.seen, dependent) if dependent else {}
        for contact, value in held:
            # moment at each single contact, in the scene's units
            unit, words = p.scale / p.weight(contact), p.words(contact, frame.state).text
            low, high = spread.get(contact, (value, value))
            forces.append(Multiplier(words, value * unit, (low * unit, high * unit)))
    eigenvalue = p.scale * float(frame.eigenvalues[0]) if len(frame.eigenvalues) else math.nan
    return PathPoint(
        parameter.t_of(frame.s),
        tuple((p.expand(frame.state) + 0.0).tolist()),
        p.energy(frame.state),
        tuple(forces),
        eigenvalue,
        across(frame),
    )


def _dependent(frame: Equilibrium) -> Pieces:
    """Return the contacts that are closed at a state, piece by piece, where they do not determine their multipliers."""
    if not frame.hold.contacts or frame.problem.sparse:
        return ()
    state = frame.seen
    unique = all(state.on(piece).multiplier_set.unique for piece in state.pieces)
    return () if unique else tuple(state.pieces)


def _spread(state: State, pieces: Pieces) -> dict[Contact, tuple[float, float]]:
    """Return the smallest and largest multiplier of each contact over the set of them, scaled energy.

    pieces: of another state of the same arc; they are looked for again where they are not closed here.
    """
    rows = tuple(dict.fromkeys(c for piece in pieces for c in piece))
    try:
        open_ = np.abs(state.local.openings(rows)[0]).max(initial=0.0) > CONTACT_TOL
    except ArithmeticError:  # sides that run along each other have no gap here
        open_ = True
    if open_:
        pieces = tuple(state.pieces)
    out: dict[Contact, tuple[float, float]] = {}
    for piece in pieces:
        found = state.on(piece).multiplier_set
        if not found.unique:
            for contact, low, high in zip(piece, found.lower, found.upper, strict=True):
                out.setdefault(contact, (float(low), float(high)))
    return out


def widest_gap(web: BifurcationDiagram, taken: list[float]) -> float | None:
    """Return the middle of the widest interval of s between events and checks; None where all are narrow."""
    cuts = np.unique([web.low, web.high, *(n.s for n in web.nodes), *taken])
    if len(cuts) < 2:
        return None
    k = int(np.diff(cuts).argmax())
    return float(0.5 * (cuts[k] + cuts[k + 1]))
