"""Strips folded by multiples of a right angle, seen from the side: chains on the square lattice, every order tried.

Of each edge of the lattice all orders of the strands on it are gone through; at no node may two passages interleave.
Shares no code with the package.
"""

from __future__ import annotations

import itertools
import math
from collections import defaultdict

STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))
MOST = 20_000
"""Orders that are tried."""


def is_paper(lengths: list[int], turns: list[int]) -> bool | None:
    """Return whether a chain can be laid without crossing itself; None where there are too many orders.

    lengths: of the strips, whole; turns: between them, in right angles, to the left > 0.
    """
    here, way, strand = (0, 0), 0, 0
    walk, passages = [], []
    for k, length in enumerate(lengths):
        for unit in range(length):
            there = (here[0] + STEPS[way][0], here[1] + STEPS[way][1])
            walk.append((here, there))
            if strand:
                passages.append((here, strand - 1, strand, turns[k - 1] if unit == 0 else 0))
            here, strand = there, strand + 1
        if k < len(turns):
            way = (way + turns[k]) % 4
    edges = defaultdict(list)
    for s, (a, b) in enumerate(walk):
        edges[min(a, b), max(a, b)].append(s)
    if math.prod(math.factorial(len(on)) for on in edges.values()) > MOST:
        return None
    for orders in itertools.product(*(itertools.permutations(on) for on in edges.values())):
        left = {s: n for order in orders for n, s in enumerate(order)}
        if _crosses_nowhere(walk, passages, left):
            return True
    return False


def _crosses_nowhere(walk, passages, left) -> bool:
    at = defaultdict(list)
    for node, s, t, turn in passages:
        ends = []
        for q in (s, t):
            far = next(x for x in walk[q] if x != node)
            way = STEPS.index((far[0] - node[0], far[1] - node[1]))
            # counter-clockwise about the node, what is left of its edge comes later where the edge leaves the node
            ends.append((way, left[q] if node < far else -left[q]))
        if abs(turn) == 2 and (ends[1] < ends[0]) != (turn > 0):
            return False
        at[node].append(ends)
    for here in at.values():
        for one, two in itertools.combinations(here, 2):
            low, high = sorted(one)
            if sum(low < place < high for place in two) == 1:
                return False
    return True
