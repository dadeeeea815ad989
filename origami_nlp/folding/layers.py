"""Order of touching layers: is a degenerate closed spherical polygon the limit of simple ones?

Arcs that lie on top of each other run through common segments between nodes (polygon vertices,
merged where they coincide).  The polygon is weakly simple exactly when the strands in each segment
can be ordered from left to right such that at every node no two passages interleave (Chang,
Erickson and Xu, "Detecting weakly simple polygons").  A crease folded to phi = +pi turns to the
left seen from outside, to -pi to the right, which fixes the order of its two strands.  The unknowns
are booleans "strand a is left of strand b"; each pair of passages at a node, and each three strands
of a segment (an order is transitive), allow a table of values.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from origami_nlp.folding.compiled_layers import Around, Arranged, Paths, arranged_in_c, library
from origami_nlp.folding.orders import TRANSITIVE, Allowed, Orders, Rules, not_interleaved
from origami_nlp.numerics import cross

Strand = tuple[int, int]
"""(arc, piece): the piece-th part of facet `arc`, cut at the nodes that lie on it."""
Step = tuple[Strand, int, int]
"""A strand of the walk around the polygon, and the nodes that it leads from and to."""
Passage = tuple[tuple[Strand, int], tuple[Strand, int]]
"""A walk through a node: incoming and outgoing strand, each with the node at its far end."""
Pair = tuple[Strand, Strand]
"""Two strands of one segment, smaller first: the boolean 'the first is left of the second'."""

Table = tuple[tuple[Pair, ...], Allowed]
"""Pairs, and the truth values that they may take together."""


@dataclass
class LayerProblem:
    """The layer orders that a touching polygon allows.

    Attributes
    ----------
    segments
        For each segment (u, v), u < v, its strands with their direction (+1: from u to v).
    tables
        Constraints, each a tuple of pairs and the set of truth values that they may take.
    fixed
        Pairs whose order the folds decide.
    feasible
        False where no order exists whatever the pairs.
    ready
        The number of each pair, and the tables as rules, where that was done before.
    """

    segments: dict[tuple[int, int], list[tuple[Strand, int]]]
    tables: list[Table] = field(default_factory=list)
    fixed: dict[Pair, bool] = field(default_factory=dict)
    feasible: bool = True
    ready: tuple[dict[Pair, int], Rules] | None = None

    @cached_property
    def numbered(self) -> tuple[dict[Pair, int], Rules]:
        """The number of each pair that tables name, and the tables as rules; asked for when they are complete."""
        if self.ready is not None:
            return self.ready
        number: dict[Pair, int] = {}
        rules = [
            (tuple(number.setdefault(pair, len(number)) for pair in pairs), allowed)
            for pairs, allowed in self.tables
        ]
        return number, Rules(len(number), rules)

    @cached_property
    def _orders(self) -> Orders | None:
        """What rules and folds leave open; None where they contradict each other."""
        number, rules = self.numbered
        orders = Orders(rules)
        given = {number[pair]: v for pair, v in self.fixed.items() if pair in number}
        good = self.feasible and orders.settle() < 0 and orders.assume(given) == -1
        return orders if good else None

    @cached_property
    def _symmetric(self) -> dict[object, LayerProblem]:
        return {}

    def solvable(self, assume: dict[Pair, bool] | None = None) -> bool:
        """Return whether some layer order exists (that also has the orders in `assume`)."""
        asked = assume or {}
        if self._orders is None or any(self.fixed.get(pair, v) != v for pair, v in asked.items()):
            return False
        number, _ = self.numbered
        return self._orders.possible({number[p]: v for p, v in asked.items() if p in number})

    def order(self) -> dict[Pair, bool] | None:
        """Return one layer order, 'the first is left of the second' for each pair, or None if there is none."""
        values = None if self._orders is None else self._orders.solve()
        if values is None:
            return None
        found = {pair: values[k] for pair, k in self.numbered[0].items()} | self.fixed
        for strands in self.segments.values():  # two strands alone in a segment may be in no table
            for (a, _), (b, _) in itertools.combinations(strands, 2):
                found.setdefault(ordered(a, b)[0], True)
        return found

    def with_symmetry(self, elements: tuple[tuple[int, bool], ...], degree: int) -> LayerProblem:
        """Ask the layers to have a symmetry: elements (s, mirrored) of the group of a `degree`-crease vertex.

        Seen along its own direction, a strand has another on its left exactly when their images do: a
        mirror swaps left and right, and turns the direction of the walk round.
        """
        asked = (elements, degree)
        if asked not in self._symmetric:
            self._symmetric[asked] = self._with_symmetry(elements, degree)
        return self._symmetric[asked]

    def _with_symmetry(self, elements: tuple[tuple[int, bool], ...], degree: int) -> LayerProblem:
        pieces: dict[int, int] = {}
        run: dict[Strand, int] = {}
        for strands in self.segments.values():
            for (arc, piece), direction in strands:
                pieces[arc] = max(pieces.get(arc, 0), piece + 1)
                run[arc, piece] = direction
        tables = list(self.tables)
        feasible = self.feasible
        for shift, mirrored in elements:
            for strands in self.segments.values():
                for (a, _), (b, _) in itertools.combinations(strands, 2):
                    a2, b2 = (_image(c, shift, mirrored, degree, pieces) for c in (a, b))
                    one, flip_one = ordered(a, b)
                    two, flip_two = ordered(a2, b2)
                    # the first of a pair is left of the second, along the direction of a: v != odd
                    odd_one, odd_two = flip_one != (run[a] < 0), flip_two != (run[a2] < 0)
                    if one == two:
                        feasible = feasible and odd_one == odd_two
                        continue
                    equal = odd_one == odd_two
                    allowed = {(v, v == equal) for v in (False, True)}
                    tables.append(((one, two), frozenset(allowed)))
        return LayerProblem(self.segments, tables, self.fixed, feasible)


def _image(
    strand: Strand, shift: int, mirrored: bool, degree: int, pieces: dict[int, int]
) -> Strand:
    """Return the strand that an element of the group sends a strand to."""
    arc, piece = strand
    if not mirrored:
        return (arc + shift) % degree, piece
    # facet i lies between creases i and i + 1, which go to shift - i and shift - i - 1; its pieces are met backwards
    target = (shift - arc - 1) % degree
    return target, pieces[target] - 1 - piece


def ordered(a: Strand, b: Strand) -> tuple[Pair, bool]:
    """Return two strands with the smaller first.

    Parameters
    ----------
    a, b
        The strands.

    Returns
    -------
    pair
        The smaller, then the larger.
    swapped : bool
        Whether that swapped them.
    """
    return ((a, b), False) if a < b else ((b, a), True)


def layer_problem(
    creases: np.ndarray, fold_angles: np.ndarray, tolerance: float
) -> LayerProblem | None:
    """Pose the layer problem of a polygon: which of the facets that lie on each other is on which side.

    Parameters
    ----------
    creases
        Polygon vertices c_i, shape [N, 3]; facets must not cross properly.
    fold_angles
        Needed for the side to which closed creases turn, shape [N] [rad].
    tolerance
        Distance below which features touch [rad].

    Returns
    -------
    LayerProblem or None
        None where nothing touches.
    """
    found = (_arranged_in_numpy if library() is None else arranged_in_c)(creases, tolerance)
    return None if found is None else _folded(*found, tuple((fold_angles > 0).tolist()))


def _arranged_in_numpy(creases: np.ndarray, tolerance: float) -> Arranged | None:
    """Return what `arranged_in_c` does, to rounding."""
    n = len(creases)
    node = np.arange(n)
    if n > 1:
        # nodes are classes of creases that coincide, also through a third one
        gram = np.linalg.norm(creases[:, None] - creases[None], axis=-1)
        for i, j in zip(*np.nonzero(np.triu(gram <= tolerance, 1)), strict=True):
            node[node == node[j]] = node[i]
    nodes = sorted(set(node.tolist()))
    paths = _nodes_on_arcs(creases, node, nodes, tolerance)
    # creases apart, and none on a facet in which it does not end: nothing lies on anything
    if len(nodes) == n and all(len(path) == 2 for path in paths):
        return None
    far: dict[int, set[int]] = {w: set() for w in nodes}
    for u, v in itertools.chain.from_iterable(map(itertools.pairwise, paths)):
        far[u].add(v)
        far[v].add(u)
    around = tuple((w, _turning(creases, w, far[w])) for w in nodes)
    return tuple(map(tuple, paths)), around


@lru_cache(maxsize=4096)
def _folded(paths: Paths, around: Around, left: tuple[bool, ...]) -> LayerProblem:
    """Let closed creases turn to their side; `left`: whether crease i turns left.

    States of one combinatorial kind ask the same question, and share its answers.
    """
    posed, walk = _posed(paths, around)
    fixed: dict[Pair, bool] = {}
    feasible = posed.feasible
    for (s, u, w), (t, _, v) in zip(walk, walk[1:] + walk[:1], strict=True):
        if u != v:
            continue
        pair, flip = ordered(t, s)  # a closed crease: the facet of the outgoing strand starts at it
        canonical = u < w  # the incoming strand runs along the direction of its segment
        value = (left[t[0]] == canonical) != flip
        feasible = fixed.setdefault(pair, value) == value and feasible
    return LayerProblem(posed.segments, posed.tables, fixed, feasible, posed.ready)


@lru_cache(maxsize=1024)
def _posed(paths: Paths, around: Around) -> tuple[LayerProblem, tuple[Step, ...]]:
    """Pose the problem of a walk, whatever the sides to which closed creases turn; and return the walk."""
    walk = tuple(
        ((i, piece), u, v)
        for i, path in enumerate(paths)
        for piece, (u, v) in enumerate(itertools.pairwise(path))
    )
    segments: dict[tuple[int, int], list[tuple[Strand, int]]] = {}
    for strand, u, v in walk:
        segments.setdefault((min(u, v), max(u, v)), []).append((strand, 1 if u < v else -1))
    problem = LayerProblem(segments)
    for strands in problem.segments.values():
        for a, b, c in itertools.combinations(sorted(s for s, _ in strands), 3):
            problem.tables.append((((a, b), (b, c), (a, c)), TRANSITIVE))
    _add_passages(problem, walk, dict(around))
    problem.ready = problem.numbered
    return problem, walk


def _nodes_on_arcs(
    creases: np.ndarray, node: np.ndarray, nodes: list[int], tolerance: float
) -> list[list[int]]:
    """Return the nodes along each arc in order, its two ends included."""
    a, b, c = creases, np.roll(creases, -1, axis=0), creases[nodes]
    across = cross(a, b)
    sine = np.linalg.norm(across, axis=1)
    normal = across / sine[:, None]
    start, end = node.tolist(), [*node[1:].tolist(), int(node[0])]
    near = np.abs(normal @ c.T) <= tolerance
    place = {w: k for k, w in enumerate(nodes)}
    arcs, ends = np.arange(len(a)), [[place[w] for w in side] for side in (start, end)]
    near[arcs, ends] = False
    paths = [[u, v] for u, v in zip(start, end, strict=True)]
    some = np.flatnonzero(near.any(axis=1))
    a, b, normal = a[some], b[some], normal[some]
    length = np.arctan2(sine[some], np.einsum("ij,ij->i", a, b))
    # azimuth of each node along the arc from its first end; only those in the plane of the arc count
    along = np.arctan2(cross(normal, a) @ c.T, a @ c.T)
    inside = near[some] & (along > 0) & (along < length[:, None])
    for i, on, at in zip(some.tolist(), inside, along, strict=True):
        between = [nodes[k] for k in np.flatnonzero(on)[np.argsort(at[on], kind="stable")]]
        paths[i][1:1] = between
    return paths


def _add_passages(
    problem: LayerProblem, walk: tuple[Step, ...], around: dict[int, tuple[int, ...]]
) -> None:
    """Let no two passages interleave at a node."""
    passages: dict[int, list[Passage]] = {}
    for (s, u, w), (t, w2, v) in zip(walk, walk[1:] + walk[:1], strict=True):
        assert w == w2
        # each end: strand, node at its far side
        passages.setdefault(w, []).append(((s, u), (t, v)))
    for w, here in passages.items():
        place = {v: k for k, v in enumerate(around[w])}
        for one, two in itertools.combinations(here, 2):
            table = _interleaving_table(w, place, one, two)
            if table is None:
                continue
            if not table[1]:
                problem.feasible = False
            problem.tables.append(table)


def _turning(creases: np.ndarray, w: int, far: set[int]) -> tuple[int, ...]:
    """Return the far nodes in the order of their segments at w, counter-clockwise seen from outside."""
    ends = sorted(far)
    if len(ends) < 3:
        return tuple(ends)
    c = creases[w]
    # any frame of the tangent plane: only the cyclic order is used
    x = cross(c, [1.0, 0.0, 0.0] if abs(c[0]) < 0.9 else [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    y = cross(c, x)
    turned = [ends[k] for k in np.argsort(np.arctan2(creases[ends] @ y, creases[ends] @ x))]
    first = turned.index(ends[0])  # where it begins says nothing
    return tuple(turned[first:] + turned[:first])


def _interleaving_table(w: int, place: dict[int, int], one: Passage, two: Passage) -> Table | None:
    """Return the pairs that two passages compare at node w, and the values that keep them apart."""
    ends = [*one, *two]
    rank = {v: k for k, v in enumerate(sorted({v for _, v in ends}, key=place.__getitem__))}
    pairs: dict[Pair, int] = {}
    level = []
    for k, m in itertools.combinations(range(4), 2):
        (a, far), (b, other) = ends[k], ends[m]
        if far == other and a != b:
            pair, swapped = ordered(a, b)
            # left of the segment's direction is counter-clockwise, so later, where it starts; earlier at its end
            level.append((k, m, pairs.setdefault(pair, len(pairs)), (w < far) == swapped))
    allowed = not_interleaved(tuple(rank[v] for _, v in ends), tuple(level))
    return (tuple(pairs), allowed) if pairs or not allowed else None
