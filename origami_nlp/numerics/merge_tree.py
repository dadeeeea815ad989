"""Merge trees of an energy on a graph: where sublevel sets of different minima first meet.

Edges are added in order of their height (Kruskal); those that join two components form a minimum spanning forest, on
which every path is a lowest one: its largest height is the min-max barrier between its ends.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Merge:
    """Two branches of the tree meet.

    height: of the edge.  edge: its number.  first, second: the leaves on either side, the lowest leaf first.
    """

    height: float
    edge: int
    first: tuple[int, ...]
    second: tuple[int, ...]


@dataclass(frozen=True)
class MergeTree:
    """The merge tree of the first vertices of a graph, its leaves.

    merges: in order of height; fewer than leaves - 1 where components stay apart.
    forest: for each vertex its neighbours (vertex, edge) in the minimum spanning forest.
    """

    merges: tuple[Merge, ...]
    forest: dict[int, list[tuple[int, int]]] = field(repr=False)

    def barrier(self, a: int, b: int) -> Merge | None:
        """Return the merge at which leaves a and b first share a component; None if they never do."""
        for merge in self.merges:
            sides = (merge.first, merge.second)
            if any(a in one and b in two for one, two in (sides, sides[::-1])):
                return merge
        return None

    def path(self, start: int, end: int) -> list[int]:
        """Return the vertices of the lowest path between two vertices of the graph that hang together."""
        came, stack = {start: start}, [start]
        while end not in came:
            v = stack.pop()
            for w, _ in self.forest[v]:
                if w not in came:
                    came[w] = v
                    stack.append(w)
        vertices = [end]
        while vertices[-1] != start:
            vertices.append(came[vertices[-1]])
        return vertices[::-1]


def merge_tree(energy: np.ndarray, edges: np.ndarray, height: np.ndarray, leaves: int) -> MergeTree:
    """Build the merge tree of the first vertices.

    Parameters
    ----------
    energy
        Of the vertices, [V].
    edges, height
        [E, 2] and [E]; a height below the energy of an end counts as that energy.
    leaves
        How many vertices are leaves, the first ones.
    """
    height = np.maximum(height, energy[edges].max(axis=1)) if len(edges) else height
    parent = list(range(len(energy)))

    def find(v: int) -> int:
        while parent[v] != v:
            # path halving
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    members: dict[int, tuple[int, ...]] = {v: (v,) for v in range(leaves)}
    forest: dict[int, list[tuple[int, int]]] = {}
    merges = []
    for edge in np.argsort(height, kind="stable").tolist():
        a, b = (int(v) for v in edges[edge])
        one, two = find(a), find(b)
        if one == two:
            continue
        forest.setdefault(a, []).append((b, edge))
        forest.setdefault(b, []).append((a, edge))
        sides = [s for v in (one, two) if (s := members.pop(v, ()))]
        if len(sides) == 2:
            first, second = sorted(sides, key=lambda s: min(energy[k] for k in s))
            merges.append(Merge(float(height[edge]), edge, first, second))
        parent[two] = one
        if sides:
            members[one] = tuple(sorted(k for side in sides for k in side))
    return MergeTree(tuple(merges), forest)
