"""The tree of boxes behind a proof: what was cut where, what was contracted, and why each leaf is one."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np


class NodeKind(IntEnum):
    """What a node is; `Tree.data` holds the number in brackets."""

    SPLIT = 0
    """Two children, [lower, middle] and [middle, upper] of angle [axis], middle = 0.5 * (lower + upper) in doubles."""
    CONTRACT = 1
    """One child, a box inside this one; the rest holds no solution of the closure rows.  [position in `lower`]"""
    NARROW = 2
    """One child, a box inside this one; the rest holds no solution of closure, minors and twin rows.  [position]"""
    CLOSED = 3
    """Leaf: closure row [row] differs from zero."""
    EMPTY = 4
    """Leaf: the closure rows together have no solution, though each by itself may be zero."""
    NONE = 5
    """Leaf: closure, minors and twin rows together have no solution."""
    MINOR = 6
    """Leaf: the minor of the free creases `Tree.minors[number]` differs from zero."""
    TWIN = 7
    """Leaf: the twin row of `Tree.twins[number]` differs from zero."""
    FLAT = 8
    """Leaf: within the radius of the flat state's lemma."""
    ROOT = 9
    """Leaf: within the uniqueness box of critical point [number]."""
    SINGULAR = 10
    """Leaf: within singular cluster [number]."""
    UNDECIDED = 11
    """Leaf: within undecided cluster [number]."""


@dataclass(frozen=True, eq=False)
class Tree:
    """All nodes in preorder, stratum after stratum in the order of itertools.product((0, 1, -1), repeat=n).

    The box of a stratum is [-up(pi), up(pi)] in free angles, up(pi) the double above pi, and +-pi in pinned ones (the
    double stands for pi itself).

    Attributes
    ----------
    kind
        `NodeKind` of each node, uint8 [M].
    data
        Its number, int32 [M]; 0 where there is none.
    lower, upper
        Boxes of the nodes CONTRACT and NARROW, in preorder, shape [B, n].
    minors, twins
        Creases or variables (0-based) of the rows.
    """

    kind: np.ndarray
    data: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    minors: tuple[tuple[int, ...], ...]
    twins: tuple[tuple[int, ...], ...]


class Recorder:
    """Collects nodes in the order in which boxes are treated.

    Parameters
    ----------
    strata
        How many boxes there are at the start: nodes 0, 1, ...
    """

    def __init__(self, strata: int) -> None:
        self.strata = self.count = strata
        self._events: list[
            tuple[np.ndarray, NodeKind | np.ndarray, np.ndarray | int, np.ndarray]
        ] = []
        self._boxes: list[tuple[np.ndarray, np.ndarray]] = []
        self._stored = 0

    def _new(self, many: int) -> np.ndarray:
        self.count += many
        return np.arange(self.count - many, self.count)

    def leaves(self, nodes: np.ndarray, kind: NodeKind, data: np.ndarray | int = 0) -> None:
        """Record leaves of one kind."""
        self._events.append((nodes, kind, data, np.full(len(nodes), -1)))

    def split(self, nodes: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Record boxes that are cut; return the numbers of the first and the second children."""
        first, second = self._new(len(nodes)), self._new(len(nodes))
        self._events.append((nodes, NodeKind.SPLIT, axis, np.stack([first, second])))
        return first, second

    def contract(
        self, nodes: np.ndarray, critical: np.ndarray, lower: np.ndarray, upper: np.ndarray
    ) -> np.ndarray:
        """Record boxes that are contracted, with the critical rows or without; return the numbers of the children."""
        child = self._new(len(nodes))
        kind = np.where(critical, NodeKind.NARROW, NodeKind.CONTRACT)
        place = self._stored + np.arange(len(nodes))
        self._stored += len(nodes)
        self._boxes.append((lower.T, upper.T))
        self._events.append((nodes, kind, place, child))
        return child

    def tree(
        self, size: int, minors: tuple[tuple[int, ...], ...], twins: tuple[tuple[int, ...], ...]
    ) -> Tree:
        """Return all nodes in preorder.

        Parameters
        ----------
        size
            Variables n.
        minors, twins
            What the numbers of rows mean.

        Returns
        -------
        Tree
        """
        kind = np.full(self.count, NodeKind.UNDECIDED, dtype=np.uint8)
        data = np.zeros(self.count, dtype=np.int32)
        first, second = np.full((2, self.count), -1)
        for nodes, what, number, child in self._events:
            kind[nodes], data[nodes] = what, number
            if child.ndim == 2:
                first[nodes], second[nodes] = child
            else:
                first[nodes] = child
        # recorded in the order of treatment, stored so that a reader needs one stack
        order = _preorder(self.strata, first.tolist(), second.tolist())
        kind, data = kind[order], data[order]
        none = np.zeros((0, size))
        lower = np.concatenate([none, *(b[0] for b in self._boxes)])
        upper = np.concatenate([none, *(b[1] for b in self._boxes)])
        contracted = (kind == NodeKind.CONTRACT) | (kind == NodeKind.NARROW)
        place = data[contracted]
        data[contracted] = np.arange(len(place))
        return Tree(kind, data, lower[place], upper[place], minors, twins)


def _preorder(strata: int, first: list[int], second: list[int]) -> np.ndarray:
    out, stack = [], list(range(strata - 1, -1, -1))
    while stack:
        node = stack.pop()
        out.append(node)
        # pushed first, popped last: the whole first child comes before the second
        if second[node] >= 0:
            stack.append(second[node])
        if first[node] >= 0:
            stack.append(first[node])
    return np.array(out, dtype=int)
