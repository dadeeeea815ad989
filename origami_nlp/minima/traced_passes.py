"""Passes between the minima of a scene with one degree of freedom: exact, from all curves of its states.

Each branch of a curve is cut where the energy is stationary, where fold limits and gaps close, and where another branch
begins or ends on it: between two cuts the energy is monotone and all states are admissible, or none is.  Cuts that are
one state join branches, at crossings as well; the merge tree of this graph holds every pass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.minima.curve import NODES, TO_SERIES, Branches, ConfigurationCurves
from origami_nlp.minima.law_sections import slope_sections
from origami_nlp.minima.one_dof import gaps_of, lifts, roots
from origami_nlp.numerics import ANSWERED, SETTLED, MergeTree, merge_tree, pairs_within
from origami_nlp.problem import Model

HALVINGS = 45
"""Of the range of a driver, to find a state on a branch."""
CHUNK = 2_000_000
"""Numbers compared at once."""


@dataclass(frozen=True, eq=False)
class TracedPasses:
    """The merge tree of a scene's curves.

    tree: over the minima.  states, energies: of the vertices, [V, n], [V].  edges: [E, 2].
    on_curves: minima that are states of the curves.
    """

    tree: MergeTree
    states: np.ndarray
    energies: np.ndarray
    edges: np.ndarray
    on_curves: np.ndarray

    def heights(self) -> np.ndarray:
        """Energy of the lowest pass between two minima, [M, M]; inf where no curve leads from one to the other."""
        many = len(self.on_curves)
        out = np.full((many, many), math.inf)
        for merge in self.tree.merges:
            for i in merge.first:
                out[i, list(merge.second)] = merge.height
        return np.minimum(out, out.T)

    def top(self, i: int, j: int) -> np.ndarray:
        """Return the pass between two minima that are joined, [n]."""
        merge = self.tree.barrier(i, j)
        assert merge is not None
        ends = self.edges[merge.edge]
        top: np.ndarray = self.states[ends[self.energies[ends].argmax()]]
        return top


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Branches with the turns that make states of the model of them: series [B, NODES, n] of the fold angles."""

    series: np.ndarray
    x: np.ndarray
    tangents: np.ndarray
    pinned: np.ndarray
    driver: np.ndarray

    def at(self, which: np.ndarray, where: np.ndarray) -> np.ndarray:
        """States of some pieces at positions in [-1, 1], [K, n]."""
        basis = np.cos(np.outer(np.arccos(np.clip(where, -1, 1)), np.arange(NODES)))
        x: np.ndarray = np.einsum("bk,bkn->bn", basis, self.series[which])
        return np.where(self.pinned[which], np.copysign(math.pi, x), x)


def traced_passes(
    model: Model,
    curves: ConfigurationCurves,
    branches: Branches,
    minima: np.ndarray,
    energies: np.ndarray,
) -> TracedPasses | None:
    """Build the merge tree of the curves.

    Parameters
    ----------
    model
        With one degree of freedom and fold limits.
    curves, branches
        Of it, resolved.
    minima, energies
        States [M, n] and their energies, the scene's units.

    Returns
    -------
    TracedPasses
        None where an end of a branch could not be joined to anything: then passes may be missing.
    """
    p = _pieces(curves, branches)
    if not len(p.series):
        return None
    which, where = _cuts(model, p)
    more = _ends_on(p)
    which, where = np.concatenate([which, more[0]]), np.concatenate([where, more[1]])
    order = np.lexsort((where, which))
    which, where = which[order], where[order]
    states = p.at(which, where)
    inside = model.fold_limits.inside(states, SETTLED).all(axis=1)
    step = np.flatnonzero((which[1:] == which[:-1]) & (where[1:] > where[:-1]))
    # between two cuts all states are admissible or none is: the middle one stands for them
    good = step[_admissible(model, p, which[step], (where[step] + where[step + 1]) / 2)]
    again = np.flatnonzero((which[1:] == which[:-1]) & (where[1:] == where[:-1]))
    nodes = np.concatenate([states, minima])
    value = np.concatenate([[model.energy(x) for x in states], energies])
    # cuts that are one state, on several pieces
    pairs = pairs_within(nodes, SETTLED)
    edges = np.concatenate(
        [np.column_stack([good, good + 1]), np.column_stack([again, again + 1]), pairs]
    )
    if _dangling(model, p, (which, where, states, inside), good, pairs):
        return None
    leaves = list(range(len(states), len(nodes)))
    joined = np.isin(leaves, pairs[:, 1])
    tree = merge_tree(value, edges, value[edges].max(axis=1), leaves)
    return TracedPasses(tree, nodes, value, edges, joined)


def _pieces(curves: ConfigurationCurves, branches: Branches) -> _Pieces:
    parts = []
    for b, turns in lifts(curves.model, curves, branches):
        for turn in turns:
            x = b.x + turn
            near = (np.abs(x) <= math.pi + SETTLED).all(axis=2).any(axis=1)
            c = b.take(np.flatnonzero(near))
            x = x[near]
            series = np.einsum("kj,bjn->bkn", TO_SERIES, x)
            parts.append((series, x, c.tangents, c.pinned, c.sections.driver))
    if not parts:
        return _Pieces(*(np.zeros((0,)),) * 5)
    return _Pieces(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _cuts(model: Model, p: _Pieces) -> tuple[np.ndarray, np.ndarray]:
    """Ends of all pieces, stationary states, and where fold limits and gaps close: pieces and positions."""
    many = np.arange(len(p.series))
    which, where = [many, many], [np.full(len(many), -1.0), np.full(len(many), 1.0)]

    def add(values: np.ndarray, pieces: np.ndarray) -> None:
        k, at, _ = roots(values)
        which.append(pieces[k])
        where.append(at)

    # dE/ds along the tangent
    if model.parameters.laws is None:
        torque = model.parameters.torque(p.x) * p.tangents
        add(np.einsum("kj,bj->bk", TO_SERIES, torque.sum(axis=2)), many)
    else:
        sections = slope_sections(model, p.x, p.tangents)
        k, at, _ = roots(sections.series)
        piece, at = sections.on_branch(k, at)
        which.append(piece)
        where.append(at)
    for v in range(model.size):
        turns = np.flatnonzero(~p.pinned[:, v])
        for limit in (model.fold_limits.low[v], model.fold_limits.high[v]):
            values = p.series[turns, :, v].copy()
            values[:, 0] -= limit
            may = np.abs(values[:, 0]) <= np.abs(values[:, 1:]).sum(axis=1) + SETTLED
            add(values[may], turns[may])
    if model.gaps:
        gaps = gaps_of(model, p.x.reshape(-1, model.size)).reshape(*p.x.shape[:2], -1)
        for contact in model.gaps:
            values = np.einsum("kj,bj->bk", TO_SERIES, gaps[..., contact.index])
            size = np.abs(values).sum(axis=1)
            may = (2 * np.abs(values[:, 0]) <= size + SETTLED) & (size > SETTLED)
            add(values[may], many[may])
    return np.concatenate(which), np.concatenate(where)


def _ends_on(p: _Pieces) -> tuple[np.ndarray, np.ndarray]:
    """Where ends of pieces lie on others: pieces and positions."""
    many = np.arange(len(p.series))
    ends = np.concatenate([p.at(many, np.full(len(many), s)) for s in (-1.0, 1.0)])
    middle, reach = p.series[:, 0], np.abs(p.series[:, 1:]).sum(axis=1) + SETTLED
    found = []
    for k in np.array_split(many, max(1, -(-many.size * ends.size // CHUNK))):
        # series stay within the sum of their coefficients about the mean: a box about each piece
        on = (np.abs(ends[None] - middle[k][:, None]) <= reach[k][:, None]).all(axis=2)
        piece, end = np.nonzero(on)
        found.append(np.stack([k[piece], end]))
    piece, end = np.concatenate(found, axis=1)
    driver = p.driver[piece]
    goal = ends[end, driver]
    low, high = np.full(len(piece), -1.0), np.full(len(piece), 1.0)
    rows = np.arange(len(piece))
    # the driver's fold angle rises with the position
    for _ in range(HALVINGS):
        mid = (low + high) / 2
        below = p.at(piece, mid)[rows, driver] < goal
        low, high = np.where(below, mid, low), np.where(below, high, mid)
    at = (low + high) / 2
    near = np.abs(p.at(piece, at) - ends[end]).max(axis=1) <= SETTLED
    return piece[near], at[near]


def _admissible(model: Model, p: _Pieces, which: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return which states of pieces are admissible, taken to rounding first."""
    x = p.at(which, where)
    if not len(x):
        return np.zeros(0, dtype=bool)
    x, _ = project(model, x, frozen=p.pinned[which])
    good = model.admissible(x, ANSWERED**2)
    for k in np.flatnonzero(good & p.pinned[which].any(axis=1)):
        good[k] = not model.refuses(x[k])  # facets that lie on each other
    return good


def _dangling(
    model: Model,
    p: _Pieces,
    cuts: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    good: np.ndarray,
    pairs: np.ndarray,
) -> bool:
    """Return whether an end of a piece, beside admissible states and within the limits, is joined to no other piece."""
    which, where, states, inside = cuts
    count = len(which)
    beside = np.zeros(count, dtype=bool)
    beside[good], beside[good + 1] = True, True
    end = (np.abs(where) == 1) & inside & beside
    end &= (np.abs(states) < math.pi - SETTLED).any(axis=1)
    end &= ~((np.abs(np.abs(states) - math.pi) <= SETTLED) & ~p.pinned[which]).any(axis=1)
    two = pairs[(pairs < count).all(axis=1)]
    two = two[which[two[:, 0]] != which[two[:, 1]]]
    return bool(np.setdiff1d(np.flatnonzero(end), two).size)
