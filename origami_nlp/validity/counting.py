"""How many layer orders a state of a pattern has: counted part by part, and listed up to a cap."""

from __future__ import annotations

import itertools
import math
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.arguments import check_angles, check_whole
from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CLOSURE_TOL, INSIDE, NOISE
from origami_nlp.pattern import Pattern, as_pattern
from origami_nlp.pattern_problem import (
    Layers,
    Orders,
    PatternProblem,
    Stack,
    Unclear,
    pose_stack,
    state_frame,
    states_to_fold,
)

GUESSES = 20_000
"""Of the search in each part."""
WIDENED = 4.0
"""Over how far facets miss each other, the distance up to which they lie on each other."""
MOST_LAYERS = 50_000
"""Facets, and pairs of layers, whose order is asked: 30 kB a pair."""
UNCLEAR = "facets are closer than can be resolved, but not on each other"


@dataclass(frozen=True)
class LayerComponent:
    """Pairs of layers whose order hangs together: it is chosen freely beside that of other components.

    Attributes
    ----------
    pairs
        Number of pairs of overlapping pieces.
    orders
        Number of orders.
    whole
        Whether that is the number, or one that is no larger since the search was given up.
    """

    pairs: int = field(metadata=shown("pairs"))
    orders: int = field(metadata=shown("orders"))
    whole: bool = field(default=True, metadata=shown("all"))


@dataclass(frozen=True, eq=False, repr=False)
class LayerOrders(Report):
    """The layer orders of a state of a pattern.

    Attributes
    ----------
    pattern
        The pattern.
    fold_angles
        The state [rad], [n].
    pairs
        Number of pairs of convex pieces of facets that lie on each other.
    components
        What is left open by the creases and by what follows from them, part by part.
    orders
        Orders, each as FOLD's faceOrders: (f, g, s), polygons from 0; as many as were asked for.
    reason
        Why there is none, or why it is not known; "" otherwise.
    decided
        Whether that is known.
    unassigned
        Number of creases that may be mountain or valley.
    misses
        How far facets miss each other where loops do not close, over the sheet's size: the noise of a drawing.

    Examples
    --------
    >>> import math, origami_nlp as o
    >>> strip = o.examples.pattern("miura", 1, 4)
    >>> found = o.layer_orders(strip, [math.pi] * 3)
    >>> found.count, len(found.orders), found.count_words
    (3, 3, '3')
    """

    SCHEMA, ROWS = "origami-nlp/layers/1", "components"
    ALSO = ("count", "whole")
    pattern: Pattern
    fold_angles: np.ndarray
    pairs: int
    components: tuple[LayerComponent, ...]
    orders: tuple[tuple[tuple[int, int, int], ...], ...] = field(repr=False)
    reason: str = ""
    decided: bool = True
    unassigned: int = 0
    misses: float = 0.0

    @property
    def whole(self) -> bool:
        """Whether `count` is the number of orders, not only one that is no larger."""
        return self.decided and all(c.whole for c in self.components)

    @property
    def count(self) -> int:
        """Number of layer orders: the product of those of the components."""
        return 0 if self.reason else math.prod(c.orders for c in self.components)

    @property
    def count_words(self) -> str:
        """The number, or that it is one that is no larger."""
        return f"{'' if self.whole else 'at least '}{self.count:,}"

    @property
    def verdict(self) -> str:
        """How many layer orders there are, in a sentence."""
        if self.reason:
            doubt = "no layer order: " if self.decided else "layer orders not counted: "
            return f"{self.pattern.title}: {doubt}{self.reason}"
        which = "folded flat" if (np.abs(self.fold_angles) == math.pi).all() else "folded"
        one = self.count == 1 and self.whole
        return f"{self.pattern.title}: {which}, {self.count_words} layer order{'' if one else 's'}"

    def report_sections(self) -> Iterator[Section]:
        """Return the verdict over a table of the components."""
        yield record_table(self.components, self.verdict) if self.components else self.verdict
        if not self.reason:
            left = self.pairs - sum(c.pairs for c in self.components)
            same = f"{self.pairs:,} pairs of layers, {left:,} of them in the same order in all"
            yield f"{same}; listed: {len(self.orders):,} (JSON, FOLD)"
        if self.unassigned:
            yield f"{self.unassigned} creases are unassigned: mountain or valley, as the layers have it"
        if self.misses:
            near = f"what is nearer than {WIDENED:g} times that lies on each other"
            yield f"as drawn, facets miss each other by up to {self.misses:.1e} of the sheet: {near}"

    def to_fold(self) -> dict[str, Any]:
        """Return FOLD: the crease pattern, and a frame with faceOrders for each order that is listed."""
        if not self.orders:
            raise OptionError(f"-o: {self.reason or 'no order is listed: ask for some, most=100'}")
        frame = state_frame(self.pattern, self.fold_angles, "layer order 1")
        frames = [
            {**frame, "frame_title": f"layer order {k}", "faceOrders": [list(o) for o in order]}
            for k, order in enumerate(self.orders, start=1)
        ]
        return states_to_fold(self.pattern, frames)


def flat_folded(pattern: Pattern) -> tuple[np.ndarray, set[int]]:
    """Return a pattern folded flat by its letters, [n] [rad], and the creases that may be mountain or valley."""
    free = set(np.flatnonzero(pattern.signs == 0).tolist())
    return np.where(pattern.signs == 0, math.pi, math.pi * pattern.signs), free


def layer_orders(
    pattern: Pattern | str | Path,
    fold_angles: Sequence[float] | np.ndarray | None = None,
    *,
    most: int = 100,
) -> LayerOrders:
    """Count the layer orders of a folded state, and list some.

    Parameters
    ----------
    pattern
        Of `read_pattern` or `make_pattern`, the name of an example such as ``"miura:4x4"``, or a FOLD file.
    fold_angles
        Of a state that closes [rad], [n]; by default the one that the file describes, and where it describes none that
        closes the pattern folded flat, unassigned creases as mountains or valleys.
    most
        Orders that are listed.

    Returns
    -------
    LayerOrders
        How many orders there are, by components, and some of them.

    Raises
    ------
    OptionError
        If an argument is not what it must be.
    AngleError
        If `fold_angles` are not n finite numbers.

    Notes
    -----
    Components and their numbers are those of Akitaya, Demaine and Ku, Computing flat-folded states (8OSME, 2024), whose
    program Flat-Folder counts flat-folded states; here layers may lie in several planes.

    Examples
    --------
    >>> import origami_nlp as o
    >>> o.layer_orders("miura:3x3").count
    1
    """
    sheet = as_pattern(pattern)
    sheet.check_alone("counting layer orders")
    check_whole("most", most, 0)
    problem, free = PatternProblem(sheet), set[int]()
    if fold_angles is not None:
        phi = check_angles("fold_angles", fold_angles, sheet.creases, one=True)
    else:
        phi, residual = np.zeros(0), math.inf
        # fold angles that do not close are targets of springs
        if (stated := sheet.stated) is not None and problem.residual(stated) <= 10 * NOISE:
            phi, residual = problem.project(stated, np.abs(stated) == math.pi)
        if residual > CLOSURE_TOL:
            phi, free = flat_folded(sheet)
    return count_orders(problem, phi, free, most)


def count_orders(
    problem: PatternProblem,
    phi: np.ndarray,
    unassigned: set[int],
    most: int,
) -> LayerOrders:
    """Count the layer orders of a state; a drawing may miss closure by its noise."""
    misses = problem.crossings.poses.apart(phi) / problem.crossings.size
    # what rounding leaves is no noise
    misses = misses if misses > 10 * CLOSURE_TOL else 0.0
    found, pairs, written = Counted(), 0, list[Any]()
    if max(misses, problem.residual(phi)) > 10 * NOISE:
        why = f"the state does not close: facets miss each other by {misses:.1e} of the sheet"
        found = Counted(reason=why, decided=False)
    elif pierced := problem.crossings.find(phi):
        f, g = pierced[0]
        found = Counted(reason=f"facets {f + 1} and {g + 1} pass through each other")
    else:
        near = max(INSIDE, WIDENED * misses)
        stack, orders = posed_orders(problem, phi, near, unassigned)
        found, pairs = count_posed(orders), len(stack.pairs) if stack else 0
        if stack and found.orders is not None and not found.reason:
            written = [*itertools.islice(_listed(stack, found, most), most)]
    parts = tuple(LayerComponent(len(part), many, whole) for part, many, whole in found.parts)
    told = (tuple(written), found.reason, found.decided, len(unassigned), misses)
    return LayerOrders(problem.pattern, phi, pairs, parts, *told)


def _listed(stack: Stack, found: Counted, most: int) -> Iterator[tuple[tuple[int, int, int], ...]]:
    """Go through the orders of a stack; of each part no more than are listed, the product begins with those."""
    each = [list(itertools.islice(found.orders.answers(p), most)) for p, _, _ in found.parts]
    unknowns = [u for part, _, _ in found.parts for u in part]
    values = [v == 1 for v in found.orders.values]
    for answer in itertools.product(*each):
        for u, v in zip(unknowns, itertools.chain(*answer), strict=True):
            values[u] = v
        yield stack.polygons(values)


class Counted(NamedTuple):
    """Orders of a stack: its parts with the number of orders of each and whether that is all, and why there is none."""

    parts: Sequence[tuple[Sequence[int], int, bool]] = ()
    reason: str = ""
    decided: bool = True
    orders: Any = None


def posed_orders(
    problem: PatternProblem,
    phi: np.ndarray,
    near: float,
    unassigned: Container[int] = (),
) -> tuple[Stack | None, Orders | Counted]:
    """Pose the layers of a state; the stack, and its orders or why there is none; no stack where there are too many."""
    if (facets := len(problem.crossings.facet)) > MOST_LAYERS / 10:
        return None, Counted(reason=f"layers of {facets:,} facets are not ordered", decided=False)
    stack = Stack(problem.crossings, phi, near=near)
    if (many := len(stack.pairs)) > MOST_LAYERS:
        why = f"{many:,} pairs of layers: more than {MOST_LAYERS:,} are not ordered"
        return stack, Counted(reason=why, decided=False)
    try:
        posed = pose_stack(stack, unassigned, GUESSES)
    except Unclear:
        return stack, Counted(reason=UNCLEAR, decided=False)
    return stack, Counted(reason=posed.reason) if isinstance(posed, Layers) else posed[0]


def count_posed(orders: Orders | Counted) -> Counted:
    """Count the orders that are left open, part by part."""
    if isinstance(orders, Counted):
        return orders
    try:
        parts = orders.counts()
    except TimeoutError:
        return Counted(reason="the search for one was given up", decided=False)
    none = [whole for _, many, whole in parts if not many]
    if any(none):
        return Counted(parts, "layers have no order in which they do not cross", True, orders)
    why = f"no order was found with {GUESSES:,} guesses in each component" if none else ""
    return Counted(parts, why, not none, orders)
