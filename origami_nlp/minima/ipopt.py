"""IPOPT on the nonlinear programme of a structure: one solver per structure and set of facet pairs, reused."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.kkt import Solve
from origami_nlp.numerics import CLOSES
from origami_nlp.programme import (
    Contact,
    Pairs,
    Solvable,
    Structure,
    pose_apart,
    pose_with_gaps,
    separating_normal,
)

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


@dataclass(frozen=True)
class Solver:
    """IPOPT for one form of programme, and the bounds of its rows."""

    solver: ca.Function
    lower: np.ndarray
    upper: np.ndarray


@lru_cache(maxsize=64)
def build_solver(structure: Structure, pairs: Pairs | None, tolerance: float) -> Solver:
    """Build IPOPT with separating planes for `pairs`; for None without, but every gap as a row (cached)."""
    nlp = pose_with_gaps(structure) if pairs is None else pose_apart(structure, pairs)
    options: dict[str, Any] = {
        "print_time": False,
        "error_on_fail": False,
        "ipopt": {**OPTIONS, "tol": tolerance},
    }
    form = {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}
    return Solver(ca.nlpsol("origami", "ipopt", form, options), nlp.lower, nlp.upper)


def solve_on_boundary(model: Solvable, start: np.ndarray, row: Contact) -> Solve:
    """Minimise the energy among states that keep one contact closed; facet pairs are not kept apart."""
    programme = build_solver(model.structure, None, tolerance_for(model))
    bound = np.full(model.size, model.bound)
    low, high = -bound, bound.copy()
    lower, upper = programme.lower, programme.upper
    x0 = np.asarray(start, dtype=float).copy()
    if row.is_limit:
        low[row.index] = high[row.index] = x0[row.index] = row.side * math.pi
    else:
        upper = upper.copy()
        lower = lower.copy()
        position = model.equation_count + row.index
        lower[position] = upper[position] = 0.0
    out = programme.solver(
        x0=x0, p=model.parameters.vector, lbx=low, ubx=high, lbg=lower, ubg=upper
    )
    stats = programme.solver.stats()
    return Solve(
        x=np.asarray(out["x"]).ravel(),
        status=str(stats["return_status"]),
        iterations=int(stats["iter_count"]),
        residual=math.nan,
        pull=np.asarray(out["lam_x"]).ravel(),
        pair_force={},
    )


def tolerance_for(model: Solvable) -> float:
    """Return IPOPT's tolerance for a model: a power of ten, so that a sweep shares its solvers."""
    return max(
        CLOSES, TOLERANCE * min(1.0, 10.0 ** math.floor(math.log10(10 * model.parameters.softness)))
    )


def solve(model: Solvable, start: np.ndarray, pairs: Pairs = ()) -> Solve:
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
        x0=x0,
        p=model.parameters.vector,
        lbx=-bound,
        ubx=bound,
        lbg=programme.lower,
        ubg=programme.upper,
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
