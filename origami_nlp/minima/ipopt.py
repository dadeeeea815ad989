"""IPOPT on the nonlinear programme of a structure: one solver per structure and set of facet pairs, reused."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.kkt import Solve
from origami_nlp.numerics import cross
from origami_nlp.programme import Model, Row, Structure, compile_structure, separation_rows

OPTIONS = {
    "print_level": 0,
    "sb": "yes",
    "max_iter": 120,
    "acceptable_iter": 0,  # no "acceptable" stops: an answer converged or it did not
    "bound_relax_factor": 0.0,  # the default leaves fold angles 1e-8 beyond pi
    "mu_strategy": "adaptive",  # fewer iterations, and stays in narrow basins that steps of a fixed mu jump over
    "mu_init": 0.1,
    "bound_push": 1e-3,
    "bound_frac": 1e-3,
}
"""IPOPT options (exact Hessians are CasADi's default)."""

TOLERANCE = 1e-7
"""IPOPT's tolerance for springs of equal stiffness; soft springs need it smaller, the polish does the rest."""

Pairs = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class _Programme:
    solver: ca.Function
    lower: np.ndarray
    upper: np.ndarray


@lru_cache(maxsize=64)
def build_solver(structure: Structure, pairs: Pairs, tolerance: float) -> _Programme:
    """Build IPOPT for a structure with separating planes for `pairs` (cached)."""
    f = compile_structure(structure)
    unknowns: list[ca.SX] = [f.x]
    rows: list[ca.SX] = [f.piece.equations]
    equalities = f.piece.equations.shape[0]
    lower, upper = [0.0] * equalities, [0.0] * equalities
    for index, gap in enumerate(structure.gaps):
        if gap.type != "facet-pair":
            rows.append(f.gaps[index])
            lower.append(0.0)
            upper.append(math.inf)
    for i, j in pairs:
        normal = ca.SX.sym(f"n_{i}_{j}", 3)
        unknowns.append(normal)
        rows += [
            ca.dot(normal, normal) - 1,
            separation_rows(f.piece, (i, j), [*ca.vertsplit(normal)]),
        ]
        lower += [0.0] * 5
        upper += [0.0] + [math.inf] * 4
    nlp = {
        "x": ca.vertcat(*unknowns),
        "p": f.p,
        "f": f.energy,
        "g": ca.vertcat(*rows),
    }
    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt": {**OPTIONS, "tol": tolerance},
    }
    return _Programme(ca.nlpsol("origami", "ipopt", nlp, options), np.array(lower), np.array(upper))


@lru_cache(maxsize=64)
def build_boundary_solver(structure: Structure, tolerance: float) -> _Programme:
    """Build IPOPT without separating planes, with every gap as a row that a call may hold closed (cached)."""
    f = compile_structure(structure)
    equalities = f.piece.equations.shape[0]
    lower = [0.0] * equalities + [
        -math.inf if gap.type == "facet-pair" else 0.0 for gap in structure.gaps
    ]
    upper = [0.0] * equalities + [math.inf] * len(structure.gaps)
    nlp = {"x": f.x, "p": f.p, "f": f.energy, "g": ca.vertcat(f.piece.equations, f.gaps)}
    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt": {**OPTIONS, "tol": tolerance},
    }
    return _Programme(
        ca.nlpsol("boundary", "ipopt", nlp, options), np.array(lower), np.array(upper)
    )


def solve_on_boundary(model: Model, start: np.ndarray, row: Row) -> Solve:
    """Minimise the energy among states that keep one contact closed; facet pairs are not kept apart."""
    programme = build_boundary_solver(model.structure, tolerance_for(model))
    bound = np.full(model.size, model.bound)
    low, high = -bound, bound.copy()
    lower, upper = programme.lower, programme.upper
    x0 = np.asarray(start, dtype=float).copy()
    if row.kind == "limit":
        low[row.index] = high[row.index] = x0[row.index] = row.side * math.pi
    else:
        upper = upper.copy()
        lower = lower.copy()
        position = len(lower) - len(model.structure.gaps) + row.index
        lower[position] = upper[position] = 0.0
    out = programme.solver(x0=x0, p=model.parameters, lbx=low, ubx=high, lbg=lower, ubg=upper)
    stats = programme.solver.stats()
    return Solve(
        x=np.asarray(out["x"]).ravel(),
        status=str(stats["return_status"]),
        iterations=int(stats["iter_count"]),
        residual=math.nan,
        pull=np.asarray(out["lam_x"]).ravel(),
        pair_force={},
    )


def tolerance_for(model: Model) -> float:
    """Return IPOPT's tolerance for a model: a power of ten, so that a sweep shares its solvers."""
    return max(1e-12, TOLERANCE * min(1.0, 10.0 ** math.floor(math.log10(10 * model.softness))))


def solve(model: Model, start: np.ndarray, pairs: Pairs = ()) -> Solve:
    """Minimise the energy from `start` [n] with separating planes for `pairs`."""
    programme = build_solver(model.structure, pairs, tolerance_for(model))
    n = model.size
    x0 = np.asarray(start, dtype=float)
    bound = np.full(n, model.bound)
    if pairs:
        rays = model.rays(x0)
        normals = [separating_normal(rays, pair) for pair in pairs]
        x0 = np.concatenate([x0, *normals])
        bound = np.concatenate([bound, np.full(3 * len(pairs), 1.5)])
    out = programme.solver(
        x0=x0, p=model.parameters, lbx=-bound, ubx=bound, lbg=programme.lower, ubg=programme.upper
    )
    stats = programme.solver.stats()
    x = np.asarray(out["x"]).ravel()
    g = np.asarray(out["g"]).ravel()
    lam_g = np.asarray(out["lam_g"]).ravel()
    violation = max(
        0.0,
        float(np.max(programme.lower - g, initial=0)),
        float(np.max(g - programme.upper, initial=0)),
    )
    last = len(g) - 5 * len(pairs)
    force = {
        pair: float(np.abs(lam_g[last + 5 * m + 1 : last + 5 * m + 5]).max())
        for m, pair in enumerate(pairs)
    }
    return Solve(
        x=x[:n],
        status=str(stats["return_status"]),
        iterations=int(stats["iter_count"]),
        residual=violation,
        pull=np.asarray(out["lam_x"]).ravel()[:n],
        pair_force=force,
    )


def separating_normal(rays: np.ndarray, pair: tuple[int, int]) -> np.ndarray:
    """Return the unit normal that best separates two facets, among the planes through two of their
    rays.

    If they cross there is none; the best of these planes is still where IPOPT starts.
    """
    i, j = pair
    n = len(rays)
    corners = rays[[i, (i + 1) % n, j, (j + 1) % n]]
    a, b = np.triu_indices(4, 1)
    normals = cross(corners[a], corners[b])
    length = np.linalg.norm(normals, axis=1)
    normals = normals[length > 1e-9] / length[length > 1e-9, None]
    # planes that only touch both facets on one side are as good as the bisector of the two groups
    middle = corners[:2].sum(axis=0) - corners[2:].sum(axis=0)
    if np.linalg.norm(middle) > 1e-9:
        normals = np.vstack([normals, middle / np.linalg.norm(middle)])
    normals = np.vstack([normals, -normals])
    margin = np.min(normals @ (corners * np.array([1, 1, -1, -1])[:, None]).T, axis=1)
    return normals[int(margin.argmax())]
