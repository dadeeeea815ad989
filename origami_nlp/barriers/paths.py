"""Passes over explicit ways: paths between minima, and from states that paths must pass down to them, as one graph.

Ways, and traced curves where there are some, meet at minima and at states from which several go down; the merge tree of
this graph has the lowest pass that they show between every two minima.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.barriers.passes import PassKind
from origami_nlp.barriers.result import Barriers
from origami_nlp.barriers.traced import passes_over
from origami_nlp.minima import MinimaResult, TracedPasses
from origami_nlp.numerics import merge_tree


class PathDown(NamedTuple):
    """Closed admissible states [S, n] that end at a minimum.

    to: its number (from 0).  start: number of the minimum that it begins at; -1 for another state, from which other
    ways may begin.  energy: what it does not climb above [the problem's units]; nan where its highest state is exact.
    """

    states: np.ndarray
    to: int
    start: int = -1
    energy: float = math.nan


def passes_over_paths(
    problem: Any,
    result: MinimaResult,
    minima: np.ndarray,
    ways: Sequence[PathDown],
    traced: TracedPasses | None,
    why: str,
    otherwise: PassKind = "corner",
) -> Barriers:
    """Return the lowest passes over ways, and over curves where some are traced.

    Parameters
    ----------
    problem, result
        Whose states they are.
    minima
        In the problem's variables, [M, n].
    ways
        Paths to them.
    traced
        Curves; their minima are these.
    why
        What bounds the passes from below.
    otherwise
        What a regular highest state is that is no saddle.
    """
    many, tops = len(minima), list[np.ndarray]()
    first = 0 if traced is None else len(traced.states) - many
    at = []
    for way in ways:
        if way.start >= 0:
            at.append(-1)
            continue
        same = (k for k, x in enumerate(tops) if np.abs(x - way.states[0]).max() == 0)
        at.append(next(same, len(tops)))
        if at[-1] == len(tops):
            tops.append(way.states[0])
    shift = len(tops) + sum(len(way.states) - 2 for way in ways)
    states = [np.zeros((0, problem.size)), np.array(tops).reshape(-1, problem.size)]
    edges: list[np.ndarray] = []
    if traced is not None:
        states[0] = traced.states[:first]
        # minima are last
        edges.append(np.where(traced.edges >= first, traced.edges + shift, traced.edges))
    begin, known = first + len(tops), list[tuple[int, float]]()
    for top, way in zip(at, ways, strict=True):
        inner = way.states[1:-1]
        numbers = [
            first + top if way.start < 0 else first + shift + way.start,
            *range(begin, begin + len(inner)),
            first + shift + way.to,
        ]
        edges.append(np.column_stack([numbers[:-1], numbers[1:]]))
        if not math.isnan(way.energy):
            highest = int(problem.energies(way.states).argmax())
            known.append((numbers[highest], way.energy / problem.scale))
        states.append(inner)
        begin += len(inner)
    nodes = np.concatenate([*states, minima])
    energies = problem.energies(nodes) / problem.scale
    joined = np.concatenate(edges).astype(int) if edges else np.zeros((0, 2), int)
    heights = energies[joined].max(axis=1) if len(joined) else np.zeros(0)
    for node, height in known:
        over = (joined == node).any(axis=1)
        heights[over] = np.maximum(heights[over], height)
    leaves = list(range(len(nodes) - many, len(nodes)))
    tree = merge_tree(energies, joined, heights, leaves)
    found = TracedPasses(tree, nodes, energies, joined, np.isin(leaves, joined))
    return passes_over(problem, result, found, problem.scale, lambda i, j, height: why, otherwise)
