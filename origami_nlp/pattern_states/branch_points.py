"""States on a curve at which closure loses rank, where other curves may leave: found, with the escape paths from them.

Along a curve of states with one degree of freedom the smallest singular value of closure that is not zero falls to
zero, in proportion to the distance, where curves meet.  Between two samples that is a sharp dip.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from origami_nlp.kkt import TangentCone
from origami_nlp.numerics import CLOSURE_TOL, NONZERO, RESOLVED, SETTLED, dense
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states.flat_folded import list_branches
from origami_nlp.pattern_states.interpolant import Interpolant
from origami_nlp.problem import FoldLimits

MOST_CREASES = 60
"""Up to which singular values are computed along curves; beyond, vertices are asked whether they are flat."""
PARTS = np.linspace(-1.0, 1.0, 9)
FORMS = 1e-4
"""Second-order forms on unit directions below this are zero."""


def dips(problem: PatternProblem, curve: Interpolant) -> list[np.ndarray]:
    """Find the states of a curve, its ends among them, at which closure loses rank.

    Parameters
    ----------
    problem
        The problem.
    curve
        Of states with one degree of freedom.

    Returns
    -------
    list of numpy.ndarray
        Closed states, [n] [rad].
    """
    size = _smallest(problem, curve.states)
    padded = np.concatenate([[np.inf], size, [np.inf]])
    low = np.flatnonzero((size <= padded[:-2]) & (size <= padded[2:]))
    found: list[np.ndarray] = []
    last = len(curve.control)
    for i in low:
        at, width, best = float(i), 1.0, float(size[i])
        for zoom in range(12):
            if best <= 0.1 * SETTLED:
                break
            places = np.clip(at + width * PARTS, 0.0, last)
            states = np.array(
                [curve.at(min(int(p), last - 1), p - min(int(p), last - 1)) for p in places]
            )
            values = _smallest(problem, states)
            at, width = float(places[values.argmin()]), 0.3 * width
            # where curves meet the dip is sharp: a smooth minimum does not fall any further
            if zoom == 3 and values.min() > 0.1 * size[i]:
                break
            best = min(best, float(values.min()))
        if best > SETTLED:
            continue
        step = min(int(at), last - 1)
        state = _snapped(problem, curve.at(step, at - step))
        if state is not None and not any(np.abs(state - x).max() < 10 * SETTLED for x in found):
            found.append(state)
    return found


def _smallest(problem: PatternProblem, states: np.ndarray) -> np.ndarray:
    """Return how far each state [S, n] of a curve is from others that meet it: 0 where they do, [S]."""
    n = problem.size
    if n > MOST_CREASES:
        open_ = np.abs(np.sin(states))
        loops = problem.pattern.vertices
        most = np.array([open_[:, list(loop.creases)].max(axis=1) for loop in loops])
        return most.min(axis=0)
    problem.check_time()
    # with one degree of freedom the rank is n - 1: the singular value of that number, from the largest on
    j = np.array([dense(problem.closure.jacobian(x)) for x in states])
    values = np.linalg.svd(j, compute_uv=False)
    # one crease alone is held by nothing, and meets no other curve
    return values[:, n - 2] if 0 <= n - 2 < values.shape[1] else np.full(len(states), np.inf)


def _snapped(problem: PatternProblem, phi: np.ndarray) -> np.ndarray | None:
    """Close a state, with creases that are all but open or fully folded made so where that closes too."""
    whole = np.round(phi / math.pi) * math.pi
    held = np.abs(phi - whole) < SETTLED
    new, residual = problem.project(np.where(held, whole, phi), held)
    if residual > CLOSURE_TOL or np.abs(new - phi).max() > 100 * SETTLED:
        new, residual = problem.project(phi)
    return problem.fold_limits.clip(new) if residual <= CLOSURE_TOL else None


def branch_directions(problem: PatternProblem, phi: np.ndarray) -> TangentCone:
    """Enumerate the branch directions of a closed state, planes cut down by what closure says to second order.

    Parameters
    ----------
    problem
        The problem.
    phi
        The state, [n] [rad].

    Returns
    -------
    TangentCone
        Candidates: whether states follow is seen when they are walked.
    """
    return split(problem, phi, list_branches(problem, phi))


def split(problem: PatternProblem, phi: np.ndarray, ways: TangentCone) -> TangentCone:
    """Cut families of two degrees of freedom down to lines where closure is not met to second order.

    Self-stresses s, s J = 0, of the whole sheet ask for s . c''(d, d) = 0, where vertices by themselves do not.

    Parameters
    ----------
    problem, phi
        The problem and a closed state, [n].
    ways
        Its branch directions.

    Returns
    -------
    TangentCone
        With lines instead of families that are not real.
    """
    if not ways.families:
        return ways
    j = dense(problem.closure.jacobian(phi))
    u, values, _ = np.linalg.svd(j)
    stress = u[:, int((values > SETTLED).sum()) :]
    lines, families = list(ways.lines), []
    for basis in ways.families:
        if basis.shape[1] != 2:
            families.append(basis)
            continue
        bent = problem.closure.second(phi, basis)  # by xx, xy, yy
        forms = bent[:, [0, 0, 1], [0, 1, 1]].T @ stress
        if np.abs(forms).max(initial=0.0) < FORMS:
            families.append(basis)
            continue
        a, b, c = forms[:, np.abs(forms).max(axis=0).argmax()]
        # a t^2 + 2 b t s + c s^2 = 0
        # from the larger of a and c, so that nothing small divides
        root = b * b - a * c
        if root < 0:
            continue
        r = math.sqrt(root)
        for s, t in ((a, -b + r), (a, -b - r)) if abs(a) > abs(c) else ((-b + r, c), (-b - r, c)):
            d = np.array([t, s]) / math.hypot(t, s)
            if np.abs(np.array([d[0] ** 2, 2 * d[0] * d[1], d[1] ** 2]) @ forms).max() < FORMS:
                line = basis @ d
                if not any(
                    min(np.abs(line - k).max(), np.abs(line + k).max()) < FORMS for k in lines
                ):
                    lines.append(line)
    return TangentCone(np.array(lines).reshape(-1, problem.size), tuple(families), ways.reason)


def into_family(
    phi: np.ndarray, basis: np.ndarray, side: np.ndarray, limits: FoldLimits
) -> Iterator[np.ndarray]:
    """Yield directions [n] from a state into a family of closed states with a basis [n, t], away from limits."""
    inward = basis @ (basis.T @ -limits.near(phi, RESOLVED))
    for k in range(4):
        d = basis @ (basis.T @ ((-1.0) ** k * np.roll(side, k // 2)))
        yield inward / max(np.abs(inward).max(), NONZERO) + 0.2 * d / np.abs(d).max()
