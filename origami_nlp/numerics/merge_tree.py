"""Merge trees of an energy on a graph: where sublevel sets of different minima first meet.

Edges are added in order of their height; a union-find structure keeps the components of the sublevel
set, and when an edge joins two of them, the one with the higher minimum ends there (the elder rule of persistent
homology).  The edges that join form a minimum spanning forest, on which every path is a lowest one: its largest
height is the min-max barrier between its ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Merge:
    """Two branches of the tree meet.

    height: of the edge.  edge: its number.  first, second: the leaves (positions in the list given to
    `merge_tree`) on either side, the lowest leaf first.
    """

    height: float
    edge: int
    first: tuple[int, ...]
    second: tuple[int, ...]


@dataclass(frozen=True)
class MergeTree:
    """The merge tree of chosen leaves.

    merges: in order of height; fewer than leaves - 1 where components stay apart.
    forest: for each vertex its neighbours (vertex, edge) in the minimum spanning forest.
    others: persistence (height of death less energy of birth) of components without a chosen leaf, as
    (persistence, vertex of birth), largest first.
    """

    merges: tuple[Merge, ...]
    forest: dict[int, list[tuple[int, int]]] = field(repr=False)
    others: tuple[tuple[float, int], ...] = field(repr=False)

    def barrier(self, a: int, b: int) -> Merge | None:
        """Return the merge at which leaves a and b first share a component; None if they never do."""
        for merge in self.merges:
            sides = (merge.first, merge.second)
            if any(a in one and b in two for one, two in (sides, sides[::-1])):
                return merge
        return None

    def path(self, start: int, end: int) -> tuple[list[int], list[int]] | None:
        """Return vertices and edges of the lowest path between two vertices of the graph, or None."""
        came: dict[int, tuple[int, int]] = {start: (-1, -1)}
        stack = [start]
        while stack and end not in came:
            v = stack.pop()
            for w, edge in self.forest.get(v, ()):
                if w not in came:
                    came[w] = (v, edge)
                    stack.append(w)
        if end not in came:
            return None
        vertices, edges = [end], []
        while vertices[-1] != start:
            v, edge = came[vertices[-1]]
            vertices.append(v)
            edges.append(edge)
        return vertices[::-1], edges[::-1]


def merge_tree(
    energy: np.ndarray, edges: np.ndarray, height: np.ndarray, leaves: Sequence[int]
) -> MergeTree:
    """Build the merge tree of the vertices `leaves`.

    Parameters
    ----------
    energy
        Of the vertices, [V].
    edges, height
        [E, 2] and [E]; a height below the energy of an end counts as that energy.
    leaves
        Vertices whose merges are wanted, each once.
    """
    height = np.maximum(height, energy[edges].max(axis=1)) if len(edges) else height
    parent = list(range(len(energy)))

    def find(v: int) -> int:
        while parent[v] != v:
            # path halving
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    lowest = list(range(len(energy)))  # of each root: its lowest vertex
    members: dict[int, tuple[int, ...]] = {v: (k,) for k, v in enumerate(leaves)}
    forest: dict[int, list[tuple[int, int]]] = {}
    merges, others = [], []
    for edge in np.argsort(height, kind="stable").tolist():
        a, b = (int(v) for v in edges[edge])
        one, two = find(a), find(b)
        if one == two:
            continue
        forest.setdefault(a, []).append((b, edge))
        forest.setdefault(b, []).append((a, edge))
        # elder rule
        if energy[lowest[one]] > energy[lowest[two]]:
            one, two = two, one  # the elder, lower one lives on
        mine, yours = members.get(one, ()), members.pop(two, ())
        if mine and yours:
            low = min((*mine, *yours), key=lambda k: energy[leaves[k]])
            pair = (mine, yours) if low in mine else (yours, mine)
            merges.append(Merge(float(height[edge]), edge, *pair))
        elif not yours or not mine:
            gone = lowest[two] if not yours else lowest[one]
            life = float(height[edge] - energy[gone])
            if life > 0:
                others.append((life, gone))
        parent[two] = one
        if mine or yours:
            members[one] = tuple(sorted((*mine, *yours)))
    others.sort(reverse=True)
    return MergeTree(tuple(merges), forest, tuple(others))
