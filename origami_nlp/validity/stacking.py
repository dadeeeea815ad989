"""Faces that lie on each other: is the order that a file states one of paper, is it whole, and is there one at all."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import INSIDE
from origami_nlp.pattern_problem import Orders, PatternProblem, Stack, conflict
from origami_nlp.validity.closing import face_words
from origami_nlp.validity.counting import Counted, count_posed, posed_orders
from origami_nlp.validity.faults import MILLI, Findings

CREASES = "faceOrders agree with creases"
WHOLE = "faceOrders are whole"
RULES = "faceOrders are those of paper"
EXISTS = "layers have an order"
Order = tuple[int, int, int]


def check_layers(f: Findings, problem: PatternProblem, phi: np.ndarray) -> None:
    """Check the order of layers of a closed state [n] without crossings, stated or not."""
    stated = problem.pattern.orders
    near = max(INSIDE, min(2 * f.lengths() / problem.crossings.size, MILLI))
    stack, orders = posed_orders(problem, phi, near)
    if stack is None or (isinstance(orders, Counted) and not orders.decided):
        f.skip(EXISTS, count_posed(orders).reason, undecided=True)
        return
    if not len(stack.pairs):
        f.settle(EXISTS, "no faces lie on each other")
        return
    if not stated:
        f.skip(WHOLE, f"the file states none; {len(stack.pairs):,} pairs of layers")
    elif not _check_stated(f, stack, orders, stated):
        for name in (WHOLE, EXISTS):
            f.skip(name, "the orders that are stated are not those of paper")
        return
    elif isinstance(orders, Orders):
        _check_whole(f, stack, orders)
    _check_exists(f, stack, count_posed(orders), bool(stated))


def _check_stated(
    f: Findings, stack: Stack, orders: Orders | Counted, stated: Sequence[Order]
) -> bool:
    """Check faceOrders with the creases, and with each other by the rules of paper; whether they are right."""
    shown = {one: [*as_read] for one, as_read in zip(stated, f.frame.face_orders, strict=True)}
    said = {unknown: (value, one) for one in stated for unknown, value in stack.states(one)}
    known = [*stack.known()]
    for unknown, value, crease in known:
        if unknown in said and said[unknown][0] != value:
            by = said[unknown][1]
            edge = int(stack.crossings.pattern.numbers[crease])
            kinds = ("valley", "mountain")[:: 1 if stack.phi[crease] > 0 else -1]
            text = f"edge {edge} is folded as a {kinds[0]}, but {shown[by]} says {kinds[1]}"
            at = _place(stack, unknown)
            f.fault(CREASES, text, edges=[edge], faces=shown[by][:2], place=at)
    f.settle(CREASES, f"{len(known)} creases folded flat")
    # what contradicts each other, or what is known besides, is left out and the others looked at again
    left = [*stated]
    while isinstance(orders, Orders) and (core := conflict(stack, orders, left)[0]):
        left = [one for one in left if one not in core]
        words = " and ".join(str(shown[one]) for one in core)
        faces = sorted({face for one in core for face in shown[one][:2]})
        why = "each other" if len(core) > 1 else "how paper can lie"
        place = _place(stack, next(iter(stack.states(core[0])))[0])
        text = f"{words} contradict {why}, by what follows from them"
        f.fault(RULES, text, faces=faces, place=place)
    f.settle(RULES, f"{len(stated)} stated, {len(stack.ruled[1]):,} rules")
    return not (f.of(CREASES) or f.of(RULES))


def _check_whole(f: Findings, stack: Stack, orders: Orders) -> None:
    """Check that of all faces that overlap an order is stated, or follows from what is."""
    open_: dict[tuple[int, ...], int] = {}
    for k in np.flatnonzero(np.array(orders.values) < 0).tolist():
        pair = stack.crossings.polygon[stack.pairs[k]].tolist()
        open_.setdefault(tuple(sorted(pair)), k)
    for pair, k in open_.items():
        words = face_words(f, stack.crossings.pattern, *pair)
        text = f"{words} overlap, and no order of them is stated or follows"
        f.fault(WHOLE, text, faces=pair if f.frame.faces else [], place=_place(stack, k))
    f.settle(WHOLE, f"of {len(stack.pairs):,} pairs of layers")


def _check_exists(f: Findings, stack: Stack, found: Counted, stated: bool) -> None:
    """Check that the layers have an order (with what is stated)."""
    pattern, polygon = stack.crossings.pattern, stack.crossings.polygon
    for part in (part for part, many, whole in found.parts if whole and not many):
        which = np.unique(polygon[stack.pairs[list(part)]]).tolist()
        words = face_words(f, pattern, *which[:6]) if part else "the faces"
        more = f", ... ({len(which)})" if len(which) > 6 else ""
        text = f"{words}{more} have no order in which they do not pass through each other"
        place = _place(stack, part[0]) if part else None
        f.fault(EXISTS, text, faces=which if f.frame.faces else [], place=place)
    if found.reason and found.decided and not f.of(EXISTS):
        f.fault(EXISTS, found.reason)
    total, whole = math.prod(many for _, many, _ in found.parts), all(w for *_, w in found.parts)
    said = f"{'' if whole else 'at least '}{total:,} order{'' if total == 1 and whole else 's'}"
    said = "" if f.of(EXISTS) else said + " with what is stated" * stated
    f.settle(EXISTS, said, "" if found.decided else found.reason)


def _place(stack: Stack, unknown: int) -> np.ndarray:
    """Return the middle of what a pair has in common."""
    x: np.ndarray = stack.middles(np.array([unknown]))[0]
    return x
