"""Can the layers of a touching spherical polygon be stacked?  By inserting strands one after another.

The polygon is cut at its nodes.  Walking along it, each strand is put at every place of the stack of
its segment in turn; at each node the new passage is a chord of a small circle, and must not cross
the chords already there.  Inserting later strands never changes the order of earlier ones, so the
search is exhaustive.  A crease at phi = +pi turns left (seen from outside), at -pi right.
"""

from __future__ import annotations

import itertools
from functools import lru_cache

import numpy as np

Walk = tuple[tuple[int, int], ...]
"""Strands (from node, to node) in order along the polygon, closed."""
Map = tuple[tuple[int, ...], bool]
"""A symmetry: where each crease goes, and whether it is a reflection."""


def combinatorics(
    creases: np.ndarray, phi: np.ndarray, tolerance: float
) -> tuple[Walk, tuple[int, ...], tuple[tuple[int, ...], ...]]:
    """Return strands, the turn at the start of each (+1 left, -1 right, 0 none), and rotation system.

    The rotation system lists, for each node, its neighbouring nodes counter-clockwise.
    """
    n = len(creases)
    label = list(range(n))
    for k in range(n):
        for m in range(k):
            if np.linalg.norm(creases[k] - creases[m]) <= tolerance:
                label[k] = label[m]
                break
    nodes = sorted(set(label))
    walk, turns = [], []
    for i in range(n):
        a, b = creases[i], creases[(i + 1) % n]
        tangent = b - (a @ b) * a
        tangent /= np.linalg.norm(tangent)
        normal = np.cross(a, tangent)
        length = np.arccos(np.clip(a @ b, -1, 1))
        stops = [(0.0, label[i]), (length, label[(i + 1) % n])]
        for w in nodes:
            if w in (label[i], label[(i + 1) % n]) or abs(creases[w] @ normal) > tolerance:
                continue
            s = np.arctan2(creases[w] @ tangent, creases[w] @ a)
            if 0 < s < length:
                stops.append((s, w))
        stops.sort()
        walk += [(u[1], v[1]) for u, v in itertools.pairwise(stops)]
        turns += [i] + [-1] * (len(stops) - 2)
    sides = []
    for s, (start, crease) in enumerate(zip(walk, turns, strict=True)):
        back = walk[s - 1][0] == start[1]
        sides.append(int(np.sign(phi[crease])) if back and crease >= 0 else 0)
    around = []
    for w in range(n):
        near = sorted({v for u, v in walk if u == w} | {u for u, v in walk if v == w})
        c = creases[w]
        e = np.linalg.svd(c[None])[2][1]
        f = np.cross(c, e)
        near.sort(key=lambda v: np.arctan2(creases[v] @ f, creases[v] @ e))
        if near:  # start the cyclic list at its smallest entry, so that equal systems compare equal
            k = near.index(min(near))
            near = near[k:] + near[:k]
        around.append(tuple(near))
    return tuple(walk), tuple(sides), tuple(around)


@lru_cache(maxsize=100_000)
def stackable(walk: Walk, sides: tuple[int, ...], around: tuple[tuple[int, ...], ...]) -> bool:
    """Return whether some stacking of all strands has no crossing passages."""
    return next(iter(stackings(walk, sides, around)), None) is not None


@lru_cache(maxsize=100_000)
def stackable_with(
    walk: Walk,
    sides: tuple[int, ...],
    around: tuple[tuple[int, ...], ...],
    label: tuple[int, ...],
    maps: tuple[Map, ...],
) -> bool:
    """Return whether some stacking without crossings is mapped to itself by all symmetries.

    label: the node at which each crease is (the first crease there).
    """
    n = len(label)
    strands: list[list[int]] = []
    s = 0
    for i in range(n):  # facet i starts at crease i and ends where crease i + 1 is
        strands.append([s])
        while walk[s][1] != label[(i + 1) % n]:
            s += 1
            strands[-1].append(s)
        s += 1
    moves = []
    for to, reflected in maps:
        strand_to = [0] * len(walk)
        for i in range(n):
            image = strands[to[(i + 1) % n] if reflected else to[i]]
            for a, b in zip(strands[i], image[::-1] if reflected else image, strict=True):
                strand_to[a] = b
        moves.append((strand_to, [label[to[w]] for w in range(n)], reflected))
    return any(
        all(_keeps(stacking, *one) for one in moves) for stacking in stackings(walk, sides, around)
    )


def _keeps(
    stacking: dict[tuple[int, int], tuple[int, ...]],
    strand_to: list[int],
    node_to: list[int],
    reflected: bool,
) -> bool:
    for (u, v), stack in stacking.items():
        image = tuple(strand_to[s] for s in stack)
        start, end = node_to[u], node_to[v]
        if reflected != (start > end):
            image = image[::-1]
        if stacking[min(start, end), max(start, end)] != image:
            return False
    return True


def stackings(walk: Walk, sides: tuple[int, ...], around: tuple[tuple[int, ...], ...]):
    """Yield every stacking: for each segment (u < v) its strands from left to right."""
    total = len(walk)
    stacks: dict[tuple[int, int], list[int]] = {}
    chords: dict[int, list[tuple[int, int]]] = {}

    def place(w: int, strand: int) -> tuple[int, int]:
        """Position of a strand's end on the circle around node w, counter-clockwise."""
        u, v = walk[strand]
        far = v if u == w else u
        key = (min(u, v), max(u, v))
        rank = stacks[key].index(strand)
        # from left to right is clockwise where the segment starts, counter-clockwise where it ends
        return (around[w].index(far), -rank if w == key[0] else rank)

    def clear(w: int, come: int, go: int) -> bool:
        """Whether the passage come -> go at node w crosses no other passage and turns to its side."""
        if sides[go]:
            u, v = walk[come]
            stack = stacks[(min(u, v), max(u, v))]
            left = stack.index(go) < stack.index(come)
            if (left == (u < v)) != (sides[go] > 0):
                return False
        one = sorted((place(w, come), place(w, go)))
        for c, g in chords.get(w, ()):
            inside = (one[0] < place(w, c) < one[1]) + (one[0] < place(w, g) < one[1])
            if inside == 1:
                return False
        return True

    def put(s: int):
        if s == total:
            if clear(walk[0][0], total - 1, 0):
                yield {key: tuple(stack) for key, stack in stacks.items()}
            return
        u, v = walk[s]
        stack = stacks.setdefault((min(u, v), max(u, v)), [])
        for position in range(len(stack) + 1):
            stack.insert(position, s)
            if s == 0:
                yield from put(1)
            elif clear(u, s - 1, s):
                chords.setdefault(u, []).append((s - 1, s))
                yield from put(s + 1)
                chords[u].pop()
            stack.pop(position)

    yield from put(0)
