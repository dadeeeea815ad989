"""Facets that lie on each other: can their layers be ordered, and do they have the order that a file states."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np

from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import CLOSURE_TOL, NOISE
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.equations import PatternEquations
from origami_nlp.pattern_problem.orders import MOST_NODES, Orders
from origami_nlp.pattern_problem.stacks import Stack, Unclear

ALONG = "intersect along a crease"
Posed: TypeAlias = tuple[Orders, list[tuple[int, ...]]]
"""Of pairs of a stack, whether the first piece is above, and the pieces that each rule is about."""
MOST_PAIRS = 10_000
"""Overlapping pairs of pieces that are ordered: a millisecond each."""


@dataclass(frozen=True)
class Layers:
    """What is known of the order of layers.

    Attributes
    ----------
    verdict
        Whether an order exists.
    reason
        Why not, or why it is not known; empty where it exists.
    pairs
        Number of pairs of facets that lie on each other.
    orders
        One order that is free of crossings, as in FOLD: (f, g, s), polygon f on the side of polygon g's normal where
        s = 1, on the other where s = -1; empty where none is known.
    stated
        Whether it is one that the file states, completed where that is not whole.
    """

    verdict: Literal["ordered", "crosses", "not decided"]
    reason: str = ""
    pairs: int = 0
    orders: tuple[tuple[int, int, int], ...] = field(default=(), metadata={"plain": False})
    stated: bool = False

    def words(self) -> str:
        """Return whether facets that lie on each other as a file describes them have an order."""
        if self.verdict != "ordered":
            return f"as in the file: {self.reason}"
        return (
            f"as in the file, {'in the order that it states' if self.stated else 'an order exists'}"
        )


def order_layers(problem: PatternEquations, phi: np.ndarray) -> Layers:
    """Return whether the layers of a state that closes, and whose facets do not pierce each other, have an order.

    In the state that the pattern's file describes, the order that the file states is kept.

    Parameters
    ----------
    problem
        The problem.
    phi
        Fold angles [rad], [n].

    Returns
    -------
    Layers
        The answer.
    """
    pattern = problem.pattern
    if pattern.is_flat and not phi.any():
        return Layers("ordered")
    stack = problem.stack(phi)
    many = len(stack.pairs)
    if many > MOST_PAIRS:
        why = f"{many:,} pairs of facets lie on each other, at most {MOST_PAIRS:,} are ordered"
        return Layers("not decided", f"layer order not decided: {why}", many)
    stated = pattern.orders if _is_stated(pattern, problem.expand(phi)) else ()
    try:
        found = _ordered(problem, phi, stack, stated)
        if pattern.cell and found.verdict == "crosses" and not found.reason.endswith(ALONG):
            # orders that do not repeat are not looked for
            why = "layer order not decided: none that repeats with the cell was found"
            return Layers("not decided", why, found.pairs)
        return found
    except Unclear:
        why = (
            "layer order not decided: facets are closer than can be resolved, but not on each other"
        )
    except TimeoutError:
        why = "layer order not decided: the search for one was given up"
    return Layers("not decided", why, len(stack.facets))


def check_orders(problem: PatternEquations) -> Layers | None:
    """Order the layers of the state that the pattern's file describes.

    Parameters
    ----------
    problem
        The problem.

    Returns
    -------
    Layers or None
        None where the file describes no folded state, or one that does not close or in which facets cross.

    Raises
    ------
    FoldFileError
        If faceOrders of the file contradict how the facets lie.
    """
    pattern = problem.pattern
    phi = pattern.stated
    if phi is None:
        return None
    limits = problem.fold_limits
    phi, residual = problem.project(phi, limits.room(phi) == 0)
    if residual > CLOSURE_TOL or not limits.inside(phi).all() or problem.crossings.find(phi):
        return None
    found = order_layers(problem, phi)
    if found.verdict == "crosses" and found.stated:
        raise FoldFileError(found.reason)
    return found


def _is_stated(pattern: Pattern, phi: np.ndarray) -> bool:
    at = pattern.stated
    return at is not None and bool(np.abs(at - phi).max(initial=0.0) <= NOISE)


def pose_layers(problem: PatternEquations, phi: np.ndarray, stack: Stack) -> Orders | Layers:
    """Pose which of the pieces that lie on each other at a state are above, with what creases and the file say of it.

    Parameters
    ----------
    problem, phi
        The problem and a closed state whose facets do not pierce each other, [n] [rad].
    stack
        Its pieces.

    Returns
    -------
    Orders or Layers
        Of pairs of the stack, whether the first piece is above; or why they have no order.

    Raises
    ------
    Unclear
        If two pieces are too close to each other.
    """
    posed = _posed(problem, phi, stack)
    if not isinstance(posed, Layers) and _is_stated(problem.pattern, problem.expand(phi)):
        bare = list(posed[0].values)
        if conflict(stack, posed[0], problem.pattern.orders)[0]:
            posed[0].values = bare
    return posed if isinstance(posed, Layers) else posed[0].copied()


def pose_stack(
    stack: Stack, unassigned: Container[int] = (), most: float = MOST_NODES
) -> Posed | Layers:
    """Pose the orders of a stack, and the pieces that each rule is about.

    Parameters
    ----------
    stack
        The pieces.
    unassigned
        Creases that are folded either way: they do not say which of their facets is above.
    most
        Guesses of a search in each part.

    Returns
    -------
    tuple or Layers
        Of pairs of the stack, whether the first piece is above, all that is forced being settled, and the pieces that
        each rule is about; or why they have no order.

    Raises
    ------
    Unclear
        If two pieces are too close to each other.
    """
    many = len(stack.facets)
    rules, about = stack.ruled
    if rules.rules and not rules.rules[-1][0]:
        return Layers("crosses", f"{_facets(stack, about[-1])} {ALONG}", many)
    orders = Orders(rules, most)
    for unknown, value, crease in stack.known():
        if crease in unassigned:
            continue
        # -1: nothing speaks against it; -2: it was forced otherwise before; else the rule that cannot be obeyed
        bad = orders.assume({unknown: value})
        if bad != -1:
            both = stack.pairs[unknown].tolist() if bad == -2 else about[bad]
            why = (
                f"{_facets(stack, both)} have no order with the crease {crease + 1} folded as it is"
            )
            return Layers("crosses", f"layers have no order: {why}", many)
    return orders, about


def _posed(problem: PatternEquations, phi: np.ndarray, stack: Stack) -> Posed | Layers:
    """Pose the orders of a state once for all who ask."""

    def made() -> tuple[Posed | Layers | None, list[int]]:
        try:
            posed = pose_stack(stack)
        except Unclear:
            return None, []
        return posed, [] if isinstance(posed, Layers) else list(posed[0].values)

    posed, forced = problem.kept("orders", phi, made)
    if posed is None:
        raise Unclear
    if not isinstance(posed, Layers):
        posed[0].values = list(forced)
    known: Posed | Layers = posed
    return known


def _ordered(
    problem: PatternEquations,
    phi: np.ndarray,
    stack: Stack,
    stated: Sequence[tuple[int, int, int]],
) -> Layers:
    """Find an order, the one that is stated where it is."""
    posed, many = _posed(problem, phi, stack), len(stack.facets)
    if isinstance(posed, Layers):
        return posed
    orders, about = posed
    if not stated:
        found = orders.solve()
        if found is None:
            return Layers("crosses", "layers have no order in which they do not cross", many)
        return Layers("ordered", "", many, stack.polygons(found))
    bare = list(orders.values)
    core, refused = conflict(stack, orders, stated)
    if not core:
        found = orders.solve()
        if found is not None:
            return Layers("ordered", "", many, stack.polygons(found), stated=True)
    orders.values = bare
    if orders.solve() is None:
        return Layers("crosses", "layers have no order in which they do not cross", many)
    lies = [f"[{f}, {g}, {s}]" for f, g, s in core]
    reported = ", ".join(lies[:4]) + (f", ... ({len(lies)})" if len(lies) > 4 else "")
    what = "contradicts how the facets lie" if len(core) == 1 else "contradict each other"
    if refused >= 0:
        what += f", by {_facets(stack, about[refused])}"
    what = f"{reported} {what}" if core else "no order of all layers has those that are stated"
    why = f"faceOrders: {what}: correct them, or leave faceOrders out"
    return Layers("crosses", why, many, stated=True)


def conflict(
    stack: Stack, orders: Orders, stated: Sequence[tuple[int, int, int]]
) -> tuple[list[tuple[int, int, int]], int]:
    """Let polygons lie as stated; or return a few statements that contradict each other, and what refuses them.

    Parameters
    ----------
    stack, orders
        The pieces, and their orders, which are settled further.
    stated
        Polygons f, g and s as in `Layers.orders`.

    Returns
    -------
    list of tuple
        Statements that contradict each other, or what is known besides; none where there are none.
    int
        As of `Orders.assume`.
    """
    bare, bad = list(orders.values), -1
    core: list[tuple[int, int, int]] = []
    while True:
        # core first, then the others: what fails is added to the core, until a statement of the core fails by itself
        orders.values = list(bare)
        for one in (*core, *stated):
            bad = _assume(stack, orders, one)
            if bad != -1:
                break
        else:
            return [], -1
        if one in core:
            return core, bad
        core.append(one)


def _assume(stack: Stack, orders: Orders, order: tuple[int, int, int]) -> int:
    """Let two polygons lie as stated, wherever they overlap: -1, or what speaks against it as `Orders.assume`."""
    return orders.assume(dict(stack.states(order)))


def _facets(stack: Stack, pieces: Sequence[int] | np.ndarray) -> str:
    """Name facets, 1-based."""
    which = sorted({int(stack.crossings.facet[p]) + 1 for p in pieces})
    return "facets " + ", ".join(map(str, which[:-1])) + f" and {which[-1]}"
