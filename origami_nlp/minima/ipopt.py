"""IPOPT on the nonlinear program of a structure: one solver per structure and set of facet pairs, reused."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.kkt import Solve, Stratum
from origami_nlp.numerics import CLOSURE_TOL, DEPENDENT, NEAR_SINGULAR_TOL
from origami_nlp.pattern import HingeLaw
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import (
    PLANE_ROWS,
    Contact,
    Nlp,
    Pairs,
    Problem,
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

MOST_CONFIRMED = 100
"""Variables up to which IPOPT confirms minima: it needs a compiled Hessian, whose number of entries is their square."""
TOLERANCE = 1e-7
"""IPOPT's tolerance for springs of equal stiffness; soft springs need it smaller, the polish does the rest."""


@dataclass(frozen=True)
class Solver:
    """IPOPT for one form of problem, and the bounds of its rows."""

    solver: ca.Function
    lower: np.ndarray
    upper: np.ndarray


WARM = {
    **OPTIONS,
    "mu_strategy": "monotone",
    "mu_init": 1e-9,
    "warm_start_init_point": "yes",
    "warm_start_bound_push": 1e-9,
    "warm_start_bound_frac": 1e-9,
    "warm_start_slack_bound_push": 1e-9,
    "warm_start_slack_bound_frac": 1e-9,
    "warm_start_mult_bound_push": 1e-9,
}
"""Options of a solve that starts at its answer: nothing is pushed off a contact."""


@dataclass(frozen=True)
class Confirmation:
    """What IPOPT says of a state that it is started at, with the multipliers of its closed contacts.

    Attributes
    ----------
    status
        Its return status.
    iterations
        It made: few where it agrees, most at contacts that carry no moment.
    moved
        Largest change of a fold angle [rad].
    """

    status: str
    iterations: int
    moved: float

    @property
    def agrees(self) -> bool:
        """Whether IPOPT stays at the state: within `NEAR_SINGULAR_TOL` [rad], since its barrier keeps off idle
        contacts."""
        return self.status == "Solve_Succeeded" and self.moved <= NEAR_SINGULAR_TOL


@lru_cache(maxsize=64)
def build_solver(
    structure: Structure, pairs: Pairs, tolerance: float, laws: tuple[HingeLaw | None, ...] = ()
) -> Solver:
    """Build IPOPT with separating planes for `pairs`, and whole laws (cached)."""
    return _built(pose_apart(structure, pairs, laws), OPTIONS, tolerance)


@lru_cache(maxsize=256)
def build_warm(structure: Structure, gaps: tuple[int, ...], tolerance: float) -> Solver:
    """Build IPOPT for starts at its answers, with some gaps as rows (cached)."""
    return _built(pose_with_gaps(structure, gaps), WARM, tolerance)


def _built(nlp: Nlp, options: dict[str, Any], tolerance: float) -> Solver:
    form = {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}
    quiet: dict[str, Any] = {"print_time": False, "error_on_fail": False}
    quiet["ipopt"] = {**options, "tol": tolerance}
    return Solver(ca.nlpsol("origami", "ipopt", form, quiet), nlp.lower, nlp.upper)


def confirm(model: Solvable, stratum: Stratum) -> Confirmation:
    """Solve once from a state with its own multipliers: only closed contacts are rows, each on its open side."""
    state, contacts = stratum.state, stratum.contacts
    gaps = tuple(dict.fromkeys(c.index for c in contacts if not c.is_limit))
    solver = build_warm(model.structure, gaps, tolerance_for(model))
    m, x, limits = model.equation_count, state.x, model.fold_limits
    lower, upper = solver.lower.copy(), solver.upper.copy()
    pull, row_pull = np.zeros(model.size), np.zeros(len(lower))
    forces = np.maximum(stratum.multiplier_set.smallest, 0.0)
    rest = state.gradient - stratum.slopes.T @ forces
    row_pull[:m] = -np.linalg.lstsq(state.jacobian.T, rest, rcond=DEPENDENT)[0]
    for contact, force in zip(contacts, forces.tolist(), strict=True):
        if contact.is_limit:
            # CasADi: gradient of f + lam_g . g + lam_x . x, positive at upper bounds, negative at lower ones
            pull[contact.index] = contact.side * force
        else:
            row = m + gaps.index(contact.index)
            (lower if contact.side > 0 else upper)[row] = 0.0
            row_pull[row] = -contact.side * force
    out = solver.solver(
        x0=x,
        p=model.parameters.at(x),
        lbx=limits.low,
        ubx=limits.high,
        lbg=lower,
        ubg=upper,
        lam_x0=pull,
        lam_g0=row_pull,
    )
    stats = solver.solver.stats()
    moved = float(np.abs(np.asarray(out["x"]).ravel() - x).max())
    return Confirmation(str(stats["return_status"]), int(stats["iter_count"]), moved)


def tolerance_for(model: Problem) -> float:
    """Return IPOPT's tolerance for a model: a power of ten, so that a sweep shares its solvers."""
    return max(
        CLOSURE_TOL,
        TOLERANCE * min(1.0, 10.0 ** math.floor(math.log10(10 * model.parameters.softness))),
    )


def solve_beside(
    problem: PatternProblem, start: np.ndarray, contacts: Sequence[Contact]
) -> tuple[Solve, tuple[Contact, ...]]:
    """Minimise the energy from a state `start` [n], where gaps of contacts stay open; return those that press too."""
    symbols = problem.symbols()
    posed = _built(symbols.nlp(start, contacts), OPTIONS, tolerance_for(problem))
    limits = problem.fold_limits
    bounds = {"lbx": limits.low, "ubx": limits.high, "lbg": posed.lower, "ubg": posed.upper}
    out = posed.solver(x0=start, p=symbols.values, **bounds)
    stats, found = posed.solver.stats(), {k: np.asarray(v).ravel() for k, v in out.items()}
    x, g, pull = found["x"], found["g"], found["lam_x"]
    violation = float(np.maximum(posed.lower - g, g - posed.upper).max(initial=0.0))
    gaps = [c for c in contacts if not c.is_limit]
    first = len(g) - len(gaps)
    open_by = {c: (g[first + k], found["lam_g"][first + k]) for k, c in enumerate(gaps)}
    open_by |= {c: (c.at - c.side * x[c.index], pull[c.index]) for c in contacts if c.is_limit}
    # of gap and force, whose product is IPOPT's barrier, the larger one is no remains of it
    pressed = tuple(c for c in contacts if abs(open_by[c][1]) > open_by[c][0])
    ended = Solve(x, str(stats["return_status"]), int(stats["iter_count"]), violation, pull, None)
    return ended, pressed


def solve(model: Solvable, start: np.ndarray, pairs: Pairs = ()) -> Solve:
    """Minimise the energy from `start` [n] with separating planes for `pairs`."""
    laws = model.parameters.laws
    whole = () if laws is None else laws.laws
    problem = build_solver(model.structure, pairs, tolerance_for(model), whole)
    n = model.size
    x0 = np.asarray(start, dtype=float)
    low, high = model.fold_limits.low, model.fold_limits.high
    if pairs:
        rays = model.rays(x0)
        normals = [separating_normal(rays, pair) for pair in pairs]
        x0 = np.concatenate([x0, *normals])
        most = np.full(3 * len(pairs), 1.5)
        low, high = np.concatenate([low, -most]), np.concatenate([high, most])
    out = problem.solver(
        x0=x0, p=model.parameters.vector, lbx=low, ubx=high, lbg=problem.lower, ubg=problem.upper
    )
    stats = problem.solver.stats()
    x = np.asarray(out["x"]).ravel()
    g = np.asarray(out["g"]).ravel()
    lam_g = np.asarray(out["lam_g"]).ravel()
    violation = max(
        0.0,
        float(np.max(problem.lower - g, initial=0)),
        float(np.max(g - problem.upper, initial=0)),
    )
    # five rows a pair come last: |n| = 1, and four rays on their sides of the plane
    last = len(g) - PLANE_ROWS * len(pairs)
    force = {
        pair: float(np.abs(lam_g[last + PLANE_ROWS * m + 1 : last + PLANE_ROWS * (m + 1)]).max())
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
