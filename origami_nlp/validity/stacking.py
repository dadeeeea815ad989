"""Faces that lie on each other: is the order that a file states one of paper, is it whole, and is there one at all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.folding import MOST_NODES, TRANSITIVE, Rule
from origami_nlp.numerics import INSIDE
from origami_nlp.pattern_problem import Layers, PatternProblem, Stack, Unclear, conflict, pose_stack
from origami_nlp.validity.closing import face_words
from origami_nlp.validity.counting import UNCLEAR
from origami_nlp.validity.faults import MILLI, Findings

STATED = "faceOrders agree with each other"
FOLLOWS = f"{STATED}, with what follows"
CREASES = "faceOrders agree with creases"
WHOLE = "faceOrders are whole"
RULES = "faceOrders are those of paper"
EXISTS = "layers have an order"
Order = tuple[int, int, int]


@dataclass
class _Said:
    """What is said of pairs of pieces: values, and which statement says each."""

    value: dict[int, bool]
    by: dict[int, int]
    disputed: set[int]


def check_layers(f: Findings, problem: PatternProblem, phi: np.ndarray) -> None:
    """Check the order of layers of a state in which no faces pass through each other."""
    pattern = problem.pattern
    near = max(INSIDE, min(2 * f.lengths() / problem.crossings.size, MILLI))
    stack = Stack(problem.crossings, phi, near=near)
    if not len(stack.pairs):
        f.settle(EXISTS, "no faces lie on each other")
        return
    try:
        rules = list(stack.rules())
    except Unclear:
        f.skip(EXISTS, UNCLEAR, undecided=True)
        return
    stated = pattern.orders
    if stated:
        given = _stated(f, stack, stated)
        good = _check_rules(f, stack, rules, given)
        if not good:
            f.skip(WHOLE, "the orders that are stated are not those of paper")
            f.skip(EXISTS, "the orders that are stated are not those of paper")
            return
        _check_whole(f, stack, stated)
    else:
        f.skip(WHOLE, f"the file states none; {len(stack.pairs):,} pairs of layers")
    _check_exists(f, stack, stated)


def _stated(f: Findings, stack: Stack, stated: Sequence[Order]) -> _Said:
    """Read what the file states of each pair, against itself and against the creases."""
    shown = f.frame.face_orders
    given = _Said({}, {}, set())
    for k, order in enumerate(stated):
        for unknown, value in stack.states(order):
            if given.value.setdefault(unknown, value) != value and unknown not in given.disputed:
                given.disputed.add(unknown)
                f.fault(
                    STATED,
                    f"{_written(shown, given.by[unknown])} and {_written(shown, k)} say the opposite of each other",
                    faces=shown[k][:2],
                    place=_place(stack, unknown),
                )
            given.by.setdefault(unknown, k)
    f.settle(STATED, f"{len(stated)} stated")
    for unknown, value, crease in stack.known():
        if given.value.get(unknown, value) == value or unknown in given.disputed:
            given.value[unknown] = value
            continue
        given.disputed.add(unknown)
        edge = int(stack.crossings.pattern.numbers[crease])
        kind = "valley" if stack.phi[crease] > 0 else "mountain"
        says = "mountain" if kind == "valley" else "valley"
        f.fault(
            CREASES,
            f"edge {edge} is folded as a {kind}, but {_written(shown, given.by[unknown])} says {says}",
            edges=[edge],
            faces=shown[given.by[unknown]][:2],
            place=_place(stack, unknown),
        )
    f.settle(CREASES, f"{sum(1 for _ in stack.known())} creases folded flat")
    return given


def _check_rules(
    f: Findings, stack: Stack, rules: list[tuple[Rule, tuple[int, ...]]], given: _Said
) -> bool:
    """Check every rule with what is said of its pairs; whether all are obeyed."""
    seen, common = set(), None
    for (unknowns, allowed), pieces in rules:
        known = [None if u in given.disputed else given.value.get(u) for u in unknowns]
        if any(all(k in (None, v) for k, v in zip(known, fit, strict=True)) for fit in allowed):
            continue
        named = {u for u in unknowns if given.value.get(u) is not None}
        common = named if common is None else common & named
        kind, text = _broken(f, stack, allowed is TRANSITIVE or allowed == TRANSITIVE, pieces)
        which = stack.crossings.polygon[list(dict.fromkeys(pieces))]
        key = (kind, text)
        if key not in seen:
            seen.add(key)
            place = _place(stack, unknowns[0]) if unknowns else stack.x[pieces[0]].mean(axis=0)
            faces = sorted({int(p) for p in which}) if f.frame.faces else []
            f.fault(RULES, text, faces=faces, place=place)
    culprits = sorted({given.by[u] for u in common or () if u in given.by})
    blamed = [_written(f.frame.face_orders, k) for k in culprits]
    all_name = (
        f", all of them with {' or '.join(blamed)}" if blamed and len(f.of(RULES)) > 1 else ""
    )
    f.settle(RULES, f"{len(rules):,} rules{all_name}")
    return not (f.of(RULES) or given.disputed)


def _broken(
    f: Findings, stack: Stack, transitive: bool, pieces: tuple[int, ...]
) -> tuple[str, str]:
    """Name the kind of a rule that is not obeyed, and say what is wrong."""
    pattern, number = stack.crossings.pattern, stack.crossings.polygon
    faces = [int(number[p]) for p in pieces]
    if transitive:
        words = face_words(f, pattern, *sorted(faces))
        return "transitivity", f"{words} lie on each other in a circle (transitivity)"
    a, b, c, d = pieces
    one = _edge(stack, a, b)
    if c == d:
        kind = "taco-tortilla" if _is_taco(stack, a, b) else "tortilla-tortilla"
        return kind, (
            f"{face_words(f, pattern, faces[2])} passes through {one} between "
            f"{face_words(f, pattern, faces[0], faces[1])} ({kind})"
        )
    tacos = _is_taco(stack, a, b) + _is_taco(stack, c, d)
    kind = ("tortilla-tortilla", "taco-tortilla", "taco-taco")[tacos]
    return kind, (
        f"{one} between {face_words(f, pattern, faces[0], faces[1])} and {_edge(stack, c, d)} between "
        f"{face_words(f, pattern, faces[2], faces[3])} pass through each other ({kind})"
    )


def _edge(stack: Stack, a: int, b: int) -> str:
    """Name the edge over which two pieces hang together."""
    bends = stack.bends
    at = np.flatnonzero(
        ((bends.left == a) & (bends.right == b)) | ((bends.left == b) & (bends.right == a))
    )
    creases = [int(c) for c in bends.crease[at] if c >= 0]
    return (
        f"edge {stack.crossings.pattern.numbers[creases[0]]}" if creases else "the edge (no crease)"
    )


def _is_taco(stack: Stack, a: int, b: int) -> bool:
    return (min(a, b), max(a, b)) in stack.unknown


def _check_whole(f: Findings, stack: Stack, stated: Sequence[Order]) -> None:
    """Check that of all faces that overlap an order is stated, or follows from what is."""
    posed = pose_stack(stack)
    if isinstance(posed, Layers):
        f.fault(WHOLE, posed.reason)
        f.settle(WHOLE)
        return
    orders, _ = posed
    core, _ = conflict(stack, orders, stated)
    if core:
        shown = {
            o: s for o, s in zip(stack.crossings.pattern.orders, f.frame.face_orders, strict=True)
        }
        words = ", ".join(str([*shown[o]]) for o in core)
        faces = sorted({face for o in core for face in shown[o][:2]})
        text = f"{words} contradict each other, by what follows from them"
        f.fault(FOLLOWS, text, faces=faces)
        f.settle(FOLLOWS)
        return
    number = stack.crossings.polygon
    seen = set()
    for k in np.flatnonzero(np.array(orders.values) < 0).tolist():
        a, b = sorted(int(p) for p in number[stack.pairs[k]])
        if (a, b) in seen:
            continue
        seen.add((a, b))
        f.fault(
            WHOLE,
            f"{face_words(f, stack.crossings.pattern, a, b)} overlap, and no order of them is stated or follows",
            faces=[a, b] if f.frame.faces else [],
            place=_place(stack, k),
        )
    f.settle(WHOLE, f"of {len(stack.pairs):,} pairs of layers")


def _check_exists(f: Findings, stack: Stack, stated: Sequence[Order]) -> None:
    """Check that the layers have an order (with what is stated)."""
    try:
        posed = pose_stack(stack, most=4 * MOST_NODES)
        if isinstance(posed, Layers):
            f.fault(EXISTS, posed.reason)
            f.settle(EXISTS)
            return
        orders, _ = posed
        if stated:
            conflict(stack, orders, stated)
        counts = orders.counts()
    except TimeoutError:
        f.skip(EXISTS, "the search for one was given up", undecided=True)
        return
    none = [part for part, many, whole in counts if whole and not many]
    for part in none:
        f.fault(
            EXISTS,
            f"{_faces_of(f, stack, part)} have no order in which they do not pass through each other",
            faces=_numbers(stack, part) if f.frame.faces else [],
            place=_place(stack, part[0]) if part else None,
        )
    doubt = "" if all(many for _, many, _ in counts) else "the search for one was given up"
    total = math.prod(many for _, many, _ in counts)
    whole = all(w for _, _, w in counts)
    one = total == 1 and whole
    said = f"{'' if whole else 'at least '}{total:,} order{'' if one else 's'}"
    said += " with what is stated" if stated else ""
    f.settle(EXISTS, "" if none else said, doubt)


def _numbers(stack: Stack, part: Sequence[int]) -> list[int]:
    return sorted({int(p) for p in stack.crossings.polygon[stack.pairs[list(part)]].ravel()})


def _faces_of(f: Findings, stack: Stack, part: Sequence[int]) -> str:
    if not part:
        return "the faces"
    which = _numbers(stack, part)
    few = which[:6]
    more = f", ... ({len(which)})" if len(which) > len(few) else ""
    return face_words(f, stack.crossings.pattern, *few) + more


def _place(stack: Stack, unknown: int) -> np.ndarray:
    """Return the middle of what a pair has in common."""
    x: np.ndarray = stack.middles(np.array([unknown]))[0]
    return x


def _written(orders: Sequence[Order], k: int) -> str:
    return str([*orders[k]])
