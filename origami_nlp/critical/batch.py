"""Many states of one model at once: closure, contacts, projection, and Newton on the KKT system.

Every function takes states x of shape [K, n] (the model's variables) and the compiled functions of the model, mapped
over K.  Rows are contacts with a side (`solve.active.Row`), the same for the whole batch.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.folding import crossing_depth
from origami_nlp.programme import Model, Row, Structure, compile_structure

OUTSIDE = 1e-12
"""Fold angles beyond pi by more than this [rad], and gaps below minus this, are not admissible."""
LONGEST_STEP = 0.3
"""Newton steps are cut to this length [rad]: a start belongs to the critical points near it."""
MOST_STEPS = 25
REACHED = 1e-10
"""A KKT point is reached when the last step [rad] and the residuals are below this."""


@lru_cache(maxsize=256)
def _mapped(structure: Structure, name: str, count: int) -> Any:
    """Compile one function of `structure` for `count` states at once."""
    return getattr(compile_structure(structure), name).map(count)


def _columns(values: Any, count: int) -> np.ndarray:
    """Repeat one column `count` times."""
    return np.tile(np.asarray(values, dtype=float).reshape(-1, 1), (1, count))


def _unpack(out: ca.DM, count: int) -> np.ndarray:
    """Turn a mapped result [r, K c] into [K, r, c]."""
    full = out.full()
    return full.reshape(full.shape[0], count, -1).transpose(1, 0, 2)


def closure(model: Model, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Loop closure [K, m] and its Jacobian [K, m, n]."""
    k = len(x)
    g, jac = _mapped(model.structure, "closure", k)(x.T, _columns(model.parameters, k))
    return g.full().T, _unpack(jac, k)


def gaps(model: Model, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values [K, c] and gradients [K, c, n] of the model's gaps (facet pairs without side)."""
    k = len(x)
    if not model.structure.gaps:
        return np.zeros((k, 0)), np.zeros((k, 0, model.size))
    *_, value, jac = _mapped(model.structure, "local", k)(x.T, _columns(model.parameters, k))
    return value.full().T, _unpack(jac, k)


def row_values(model: Model, x: np.ndarray, rows: tuple[Row, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Openings [K, r] of `rows` (>= 0 where open) and their gradients [K, r, n]."""
    values = np.zeros((len(x), len(rows)))
    gradients = np.zeros((len(x), len(rows), model.size))
    need = any(row.kind == "gap" for row in rows)
    all_values, all_gradients = gaps(model, x) if need else (None, None)
    for r, row in enumerate(rows):
        if row.kind == "limit":
            values[:, r] = math.pi - row.side * x[:, row.index]
            gradients[:, r, row.index] = -row.side
        else:
            assert all_values is not None and all_gradients is not None
            values[:, r] = row.side * all_values[:, row.index]
            gradients[:, r] = row.side * all_gradients[:, row.index]
    return values, gradients


def held_constraints(
    model: Model, x: np.ndarray, rows: tuple[Row, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Closure and `rows` together: values [K, m + r], Jacobian [K, m + r, n]."""
    g, jac = closure(model, x)
    values, gradients = row_values(model, x, rows)
    return np.concatenate([g, values], axis=1), np.concatenate([jac, gradients], axis=1)


def hold_limits(x: np.ndarray, rows: tuple[Row, ...]) -> np.ndarray:
    """Set fold angles at closed limits to +-pi exactly (in place)."""
    for row in rows:
        if row.kind == "limit":
            x[:, row.index] = row.side * math.pi
    return x


def project(
    model: Model, x: np.ndarray, rows: tuple[Row, ...] = (), steps: int = 25, cutoff: float = 1e-8
) -> tuple[np.ndarray, np.ndarray]:
    """Close states onto closure with `rows` held, by Gauss-Newton; returns them and residuals [K].

    Steps are of smallest norm, cut to one radian; singular values below `cutoff` of the largest are left out.
    """
    x = hold_limits(np.array(x, dtype=float), rows)
    residual = np.full(len(x), np.inf)
    todo = np.arange(len(x))
    for _ in range(steps):
        f, jac = held_constraints(model, x[todo], rows)
        residual[todo] = np.abs(f).max(axis=1, initial=0.0)
        far = residual[todo] > 1e-14
        todo, f, jac = todo[far], f[far], jac[far]
        if not len(todo):
            break
        step = -np.einsum("kij,kj->ki", np.linalg.pinv(jac, rcond=cutoff), f)
        length = np.linalg.norm(step, axis=1, keepdims=True)
        x[todo] += step * np.minimum(1.0, 1.0 / np.maximum(length, 1e-300))
        hold_limits(x, rows)
    return x, residual


def is_admissible(model: Model, x: np.ndarray) -> np.ndarray:
    """Tell which closed states keep the scene's contact, [K]; layers of touching facets are not ordered.

    Fold limits, mirror and axis gaps, and crossing of the modelled facet pairs, to 1e-12.  Where nothing but
    the boundary of a two-dimensional set touches, this is all of admissibility; on thin sets use
    `nearby.is_admissible`.
    """
    good = np.isfinite(x).all(axis=1)
    if model.structure.limits:
        good &= (np.abs(x) <= math.pi + OUTSIDE).all(axis=1)
    where = np.flatnonzero(good)
    walls = [i for i, gap in enumerate(model.structure.gaps) if gap.type != "facet-pair"]
    if walls and len(where):
        value, _ = gaps(model, x[where])
        where = where[(value[:, walls] >= -OUTSIDE).all(axis=1)]
    if len(where) and model.structure.pairs:
        where = where[_depth(model, x[where]) <= OUTSIDE]
    good[:] = False
    good[where] = True
    return good


def _depth(model: Model, x: np.ndarray) -> np.ndarray:
    """How deep the modelled facet pairs cross, [K]: sine of an angle, 0 where none crosses.

    Finer than `model.chart.admissible`: next to a state where a crease lies on another the depth is of third order in
    the distance.
    """
    out = _mapped(model.structure, "rays", len(x))(x.T, _columns(model.parameters, len(x)))
    rays = _unpack(out, len(x)).transpose(0, 2, 1)
    depth = np.zeros(len(x))
    for i, j in model.structure.pairs:
        first, second = (rays[:, [f, (f + 1) % rays.shape[1]]] for f in (i, j))
        depth = np.maximum(depth, crossing_depth(first, second))
    return depth


@dataclass(frozen=True)
class KktPoints:
    """KKT points that Newton reached, not yet told apart.

    x: [P, n].  multipliers: of the rows, [P, r] (scaled energy; > 0 where the contact pushes).
    residual: largest entry of stationarity (relative), closure and rows, [P].
    """

    x: np.ndarray
    multipliers: np.ndarray
    residual: np.ndarray


def kkt_newton(model: Model, start: np.ndarray, rows: tuple[Row, ...] = ()) -> KktPoints:
    """Run Newton on stationarity, closure and `rows` = 0 from every start [K, n].

    Finds minima, saddles and maxima along the stratum alike.  Starts whose Newton does not settle are dropped; a
    caller gives enough of them.
    """
    n, m, r = model.size, model.equation_count, len(rows)
    k, rest = model.parameters[-2 * n : -n], model.parameters[-n:]
    x = hold_limits(np.array(start, dtype=float), rows)
    todo = np.arange(len(x))
    residual = np.full(len(x), np.inf)
    multipliers = np.zeros((len(x), r))
    reached = np.zeros(len(x), dtype=bool)
    for _ in range(MOST_STEPS):
        y = x[todo]
        pull = k * (y - rest)
        f, jac = held_constraints(model, y, rows)
        gram = jac @ jac.transpose(0, 2, 1)
        weights = _solve(gram, np.einsum("kij,kj->ki", jac, pull))
        stationarity = pull - np.einsum("kij,ki->kj", jac, weights)
        size = 1.0 + np.abs(pull).max(axis=1)
        residual[todo] = np.maximum(
            np.abs(stationarity).max(axis=1) / size, np.abs(f).max(axis=1, initial=0.0)
        )
        multipliers[todo] = weights[:, m:]
        system = np.zeros((len(todo), n + m + r, n + m + r))
        system[:, :n, :n] = lagrangian_hessian(model, y, weights, rows)
        system[:, :n, n:] = -jac.transpose(0, 2, 1)
        system[:, n:, :n] = jac
        step = _solve(system, -np.concatenate([stationarity, f], axis=1))[:, :n]
        length = np.linalg.norm(step, axis=1)
        good = np.isfinite(length)
        step[~good] = 0.0
        x[todo] += step * np.minimum(1.0, LONGEST_STEP / np.maximum(length, 1e-300))[:, None]
        hold_limits(x, rows)
        settled = good & (length <= REACHED) & (residual[todo] <= REACHED)
        reached[todo[settled]] = True
        inside = (np.abs(x[todo]) <= model.bound + 1.0).all(axis=1)
        todo = todo[good & ~settled & inside]
        if not len(todo):
            break
    return KktPoints(x[reached], multipliers[reached], residual[reached])


def lagrangian_hessian(
    model: Model, x: np.ndarray, weights: np.ndarray, rows: tuple[Row, ...]
) -> np.ndarray:
    """Hessian of U - weights . (closure, rows) in scaled energy, [K, n, n]; weights [K, m + r]."""
    m, count = model.equation_count, len(x)
    mu = np.zeros((len(model.structure.gaps), count))
    for r, row in enumerate(rows):
        if row.kind == "gap":
            mu[row.index] -= row.side * weights[:, m + r]
    out = _mapped(model.structure, "hessian", count)(
        x.T, _columns(model.parameters, count), _columns(1.0, count), -weights[:, :m].T, mu
    )
    return _unpack(out, count)


def _solve(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Solve many small systems; by pseudo-inverse where one of them is exactly singular."""
    try:
        return np.linalg.solve(a, b[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.einsum("kij,kj->ki", np.linalg.pinv(a, rcond=1e-14), b)


def bracketed_roots(f: Callable[[np.ndarray], np.ndarray], low: Any, high: Any) -> np.ndarray:
    """Find a root of f, one for each bracket [low, high] [K], by the Illinois form of regula falsi.

    f takes positions [K] and returns values [K] of opposite signs at the two ends; brackets shrink to rounding.
    """
    a, b = np.array(low, dtype=float), np.array(high, dtype=float)
    fa, fb = f(a), f(b)
    best = np.where(np.abs(fa) <= np.abs(fb), a, b)
    least = np.minimum(np.abs(fa), np.abs(fb))
    for k in range(60):
        change = np.where(fb != fa, fb - fa, 1.0)
        c = np.where(k % 3 == 2, 0.5 * (a + b), b - fb * (b - a) / change)
        c = np.where((c > np.minimum(a, b)) & (c < np.maximum(a, b)), c, 0.5 * (a + b))
        fc = f(c)
        better = np.abs(fc) < least
        best, least = np.where(better, c, best), np.where(better, np.abs(fc), least)
        crosses = (fc > 0) != (fb > 0)
        a, fa = np.where(crosses, b, a), np.where(crosses, fb, 0.5 * fa)
        b, fb = c, fc
        if ((np.abs(b - a) <= 4e-16 * (1 + np.abs(b))) | (fb == 0)).all():
            break
        if np.abs(c - best).max() <= 1e-16 and k > 8 and least.max() <= 1e-16:
            break
    return best


def distinct(x: np.ndarray, apart: float) -> np.ndarray:
    """Positions of states [K, n] that differ from all earlier kept ones by more than `apart` (largest entry)."""
    kept: list[int] = []
    left = np.arange(len(x))
    while len(left):
        first = left[0]
        kept.append(int(first))
        left = left[np.abs(x[left] - x[first]).max(axis=1) > apart]
    return np.array(kept, dtype=int)
