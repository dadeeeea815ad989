"""A graph of admissible states that covers the feasible set evenly, whatever charts do.

The set of closed states is grown outwards from known states: steps along its tangent space, pulled back
onto loop closure, at most one state to a lattice cell of the fold-angle space; a step that
leaves the admissible set is cut back to the boundary, so that contact boundaries carry states of their own.
Two states are joined where the state half-way between them closes nearby and is admissible.  States on
phi = +pi and -pi are far apart here, and families that share one chart point are spread out.

With full contact two pieces that meet in the flat state only are never joined past it
(`side_of_flat` gives the reason).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, NONZERO
from origami_nlp.problem import Model, Problem

STRAY = 0.3
"""The state half-way along an edge lies within this share of its length of the straight middle."""
MOST_STATES = 400_000
"""At which growth is cut."""
STUCK = 0.05
"""Share of the escape path below which a state is not moved to the border."""
BISECTIONS = 20
ASIDE = 0.15
"""How far an edge may go aside to pass a bent boundary, as a share of its length."""


@dataclass(frozen=True)
class StateGraph:
    """States [V, n] (model variables) and the edges between neighbours.

    energy: of the states [V], in the scene's units.  edges: [E, 2].  middle: [E, n], the admissible state half-way on
    each edge.  height: [E], the largest energy along it, from the parabola through the ends and the middle.
    spacing: lattice cell [rad].  complete: whether growth ended by itself (not at the cap on states).
    """

    states: np.ndarray = field(repr=False)
    energy: np.ndarray = field(repr=False)
    edges: np.ndarray = field(repr=False)
    middle: np.ndarray = field(repr=False)
    height: np.ndarray = field(repr=False)
    spacing: float
    complete: bool

    def __repr__(self) -> str:
        done = "" if self.complete else ", cut at its cap"
        return (
            f"StateGraph({len(self.states)} states, {len(self.edges)} edges, "
            f"spacing {self.spacing:.3g} rad{done})"
        )


def side_of_flat(fold_angles: np.ndarray) -> np.ndarray:
    """Return on which side of the flat state admissible states [..., N] lie: the sign of the sum of all fold angles.

    Up (+1) and down (-1) are joined by admissible states only through the flat state (0), symmetric or not: round
    every other one |sum phi| >= 2 pi - area(K) > 0, with K the convex hull of the spherical polygon of the vertex,
    facets that touch included (proved in docs/validation/landscapes.md).
    """
    phi = np.asarray(fold_angles, dtype=float)
    flat = np.abs(phi).max(axis=-1) <= DUPLICATE_TOL
    return np.where(flat, 0, np.sign(phi.sum(axis=-1))).astype(int)


def grow(
    model: Model,
    seeds: Iterable[np.ndarray],
    spacing: float,
    *,
    chains: Iterable[np.ndarray] = (),
    alone: Collection[int] = (),
) -> StateGraph:
    """Cover the part of the feasible set that is connected to `seeds` by a graph.

    Parameters
    ----------
    seeds
        Closed, admissible states [n]; they become the first vertices, exactly as given.
    spacing
        Size of the lattice cells [rad].
    chains
        Polylines [m, n] of admissible states, each joined to the next: thin sets, and descents.
    alone
        Seeds on thin sets, that chains join to the rest and nothing else does.  Chains are alone but for their ends.
    """
    first = [np.asarray(s, dtype=float) for s in seeds]
    joined: list[tuple[int, int]] = []
    apart = set(alone)
    for chain in chains:
        start = len(first)
        first += list(np.asarray(chain, dtype=float))
        joined += [(k, k + 1) for k in range(start, len(first) - 1)]
        apart.update(range(start, len(first)))
    states = [np.array(first)]
    occupied = set(_cells(states[0], spacing))
    frontier = np.array([s for k, s in enumerate(first) if k not in apart])
    count, complete = len(first), True
    while len(frontier):
        if count >= MOST_STATES:
            complete = False
            break
        # breadth first: the frontier are the states of the last round, and no cell holds two
        new = _step_out(model, frontier, spacing, occupied)
        if not len(new):
            break
        states.append(new)
        count += len(new)
        frontier = new
    x = np.vstack(states)
    free = np.array([k for k in range(len(x)) if k not in apart])
    edges, middle, height = _join(model, x[free], spacing)
    edges = free[edges]
    energy = model.energies(x)
    if joined:
        link = np.array(joined)
        edges, middle = np.vstack([edges, link]), np.vstack([middle, x[link[:, 1]]])
        height = np.concatenate([height, energy[link].max(axis=1)])
    return StateGraph(x, energy, edges, middle, height, spacing, complete)


def close(model: Problem, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pull states [K, n] onto loop closure; return them and which of them close."""
    x, residual = project(model, x, steps=12)
    limits = model.fold_limits
    x = limits.hold(x, limits.near(x, CLOSURE_TOL))
    return x, residual <= CLOSURE_TOL


def _cells(x: np.ndarray, spacing: float) -> list[tuple[int, ...]]:
    return [tuple(c) for c in np.floor(x / spacing).astype(int).tolist()]


def _directions(dof: int) -> np.ndarray:
    """Unit vectors towards the neighbours of a lattice point in `dof` dimensions."""
    d = np.array([v for v in itertools.product((-1, 0, 1), repeat=dof) if any(v)], dtype=float)
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def _tangents(model: Problem, x: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the tangent space at each state, [K, n, dof]; more than that where singular
    states have a larger kernel is left out."""
    _, jac = model.closure(x)
    return np.linalg.svd(jac)[2][:, model.equation_count :].transpose(0, 2, 1)


def _step_out(
    model: Model, frontier: np.ndarray, spacing: float, occupied: set[tuple[int, ...]]
) -> np.ndarray:
    """Return new states one step away from `frontier`, in cells that were empty (and now are not)."""
    directions = _directions(model.dof)
    tangents = _tangents(model, frontier)
    ahead = frontier[:, None] + spacing * np.einsum("kni,di->kdn", tangents, directions)
    origin = np.repeat(frontier, len(directions), axis=0)
    ahead = ahead.reshape(-1, model.size)
    if model.scene.contact == "full" and (np.abs(frontier).max(axis=1) <= DUPLICATE_TOL).any():
        # around the flat state: its tangent cone is no space
        extra = spacing * _directions(model.size)
        origin = np.vstack([origin, np.zeros_like(extra)])
        ahead = np.vstack([ahead, extra])
    keep = np.array([c not in occupied for c in _cells(ahead, spacing)])
    origin, ahead = origin[keep], ahead[keep]
    y, good = close(model, ahead)
    good &= np.abs(y).max(axis=1, initial=0) >= 0.1 * spacing
    good &= np.linalg.norm(y - ahead, axis=1) <= 0.6 * spacing
    good[good] = model.admissible(y[good])
    cut = _cut_back(model, origin[~good], ahead[~good])
    cut = cut[
        np.abs(cut).max(axis=1, initial=0) >= 0.1 * spacing
    ]  # closure says little next to the flat state
    out = []
    # states on boundaries have a lattice of their own, or those beside them would leave gaps in it
    for found, on_boundary in ((y[good], ()), (cut, (1,))):
        for state, cell in zip(found, _cells(found, spacing), strict=True):
            if cell + on_boundary not in occupied:
                occupied.add(cell + on_boundary)
                out.append(state)
    return np.array(out).reshape(-1, model.size)


def _cut_back(model: Problem, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """Return admissible states on the way from `inside` to `outside`, as far as that goes."""
    low, high = np.zeros(len(inside)), np.ones(len(inside))
    best = np.array(inside)
    step = np.linalg.norm(outside - inside, axis=1)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        want = inside + middle[:, None] * (outside - inside)
        y, good = close(model, want)
        good &= np.linalg.norm(y - want, axis=1) <= 0.6 * step
        good[good] = model.admissible(y[good])
        best[good] = y[good]
        # bisection for all at once; it ends at one boundary of the admissible set, not always the nearest
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    return best[low > STUCK]


def _join(model: Model, x: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the edges [E, 2] between neighbours, the state half-way [E, n], and the height [E] of each."""
    edges = _near(x, spacing)
    side = side_of_flat(model.expand(x)) if model.scene.contact == "full" else np.zeros(len(x))
    # an edge from above the flat state to below it would skip the only state that joins them
    edges = edges[side[edges[:, 0]] * side[edges[:, 1]] >= 0]
    a, b = x[edges[:, 0]], x[edges[:, 1]]
    length = np.linalg.norm(a - b, axis=1)
    middle, good = _reach(model, 0.5 * (a + b), STRAY * length)
    # an estimate of the energy along the edge: refinement makes the passes that matter exact
    height = parabola_top(model.energies(a), model.energies(middle), model.energies(b))
    # along a bent boundary the middle is outside: go round it on either side, by two shorter legs
    for sign in (1.0, -1.0):
        todo = np.flatnonzero(~good)
        u, v = a[todo], b[todo]
        want = 0.5 * (u + v) + sign * ASIDE * _across(model, u, v)
        via, ok = _reach(model, want, STRAY * length[todo])
        tops = []
        for end in (u, v):
            leg = np.linalg.norm(via - end, axis=1)
            quarter, fine = _reach(model, 0.5 * (via + end), STRAY * leg, ok)
            ok &= fine
            tops.append(
                parabola_top(model.energies(end), model.energies(quarter), model.energies(via))
            )
        done = todo[ok]
        good[done], middle[done] = True, via[ok]
        height[done] = np.maximum(*tops)[ok]
    return edges[good], middle[good], height[good]


def _near(x: np.ndarray, spacing: float) -> np.ndarray:
    """Return the pairs of states closer than 1.8 cells, in cells that touch, [E, 2]."""
    from scipy.spatial import cKDTree

    edges = cKDTree(x).query_pairs(1.8 * spacing, output_type="ndarray")
    cells = np.floor(x / spacing)
    touch = np.abs(cells[edges[:, 0]] - cells[edges[:, 1]]).max(axis=1, initial=0.0) <= 1
    return np.unique(edges[touch], axis=0)


def _across(model: Problem, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return tangent vectors of length |b - a| across the edge from a to b, [K, n]."""
    if not len(a):
        return np.zeros_like(a)
    along = b - a
    length = np.linalg.norm(along, axis=1, keepdims=True)
    unit = along / np.maximum(length, NONZERO)
    t = _tangents(model, 0.5 * (a + b))
    flat = np.einsum("kni,kn->ki", t, unit)
    # the tangent direction most nearly square to the edge
    pick = t[np.arange(len(a)), :, np.abs(flat).argmin(axis=1)]
    pick = pick - np.sum(pick * unit, axis=1, keepdims=True) * unit
    return length * pick / np.maximum(np.linalg.norm(pick, axis=1, keepdims=True), NONZERO)


def _reach(
    model: Problem, want: np.ndarray, stray: np.ndarray, only: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Close the states `want` [K, n]; return which are admissible and within `stray` [K] of them."""
    y, good = close(model, want)
    good &= np.linalg.norm(y - want, axis=1) <= stray + CLOSURE_TOL
    if only is not None:
        good &= only
    good[good] = model.admissible(y[good])
    return y, good


def parabola_top(a: np.ndarray, m: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the largest value on [0, 1] of the parabola with values a, m, b at 0, 1/2, 1."""
    bend = 2.0 * (a - 2.0 * m + b)  # a + slope t + bend t^2
    slope = b - a - bend
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(bend < 0, -slope / (2 * bend), -1.0)
        top = np.where((t > 0) & (t < 1), a - slope * (slope / (4 * bend)), -math.inf)
    return np.maximum(np.maximum(np.maximum(a, b), m), top)
