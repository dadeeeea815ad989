"""IPOPT on the plain form of an origami, read from top to bottom.

    min U(y)   subject to   closure(y) = 0,   gap_k(y) >= 0,   low <= y <= high

`PatternProblem.symbols` states U, closure and gaps in CasADi, which differentiates them; IPOPT is an interior-point
method (Nocedal and Wright, Numerical Optimization, chapter 19).  Rows of closure depend on each other: they are
projected on their row space at the start.  Which gaps keep facets apart depends on the state: those of features that
are near each other at the start are rows, on the side on which they are there; where facets cross at the answer, what
passed becomes a row as well, and the same start is solved from again.  Of a disjunction the rows are those of one
piece, the first that the start is on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.kkt import Solve, polish
from origami_nlp.numerics import BALANCED, CLOSURE_TOL, OUTSIDE
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Contact, Nlp
from origami_nlp.search.starts import StartState

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
BESIDE_OPTIONS = {
    **OPTIONS,
    "mu_strategy": "monotone",
    "mu_init": 1e-6,
    "bound_push": 1e-8,
    "bound_frac": 1e-8,
    "perturb_always_cd": "yes",  # where closure loses rank its rows depend on each other
}
"""Of a solve from beside its answer: a barrier that is strong at first would lead elsewhere."""
TOLERANCE = 1e-7
"""IPOPT's tolerance for springs of equal stiffness; soft springs need it smaller, the polish does the rest."""
NEAR = 0.1
"""Features that face each other closer at the start, over the sheet's size, are rows."""
EVERYWHERE = 10.0
"""All features face each other closer, over the sheet's size."""
MOST_ROUNDS = 4
"""Times that a start is solved from with more rows."""
BESIDE = 1e-3
"""How far from a minimum its confirmation starts [rad]."""
NEARBY = 0.05
"""A lower answer that is nearer to a minimum speaks against it [rad]; further away it is another state."""
MOST_CONFIRMED = 40
"""Variables up to which minima are confirmed."""
Solved = tuple[Solve, tuple[Contact, ...], np.ndarray]
"""What a solver ended at, what presses there, and with which multipliers."""


@dataclass(frozen=True, repr=False)
class IpoptAnswer(ShortRepr):
    """What IPOPT answers from a start.

    Attributes
    ----------
    x
        Variables, [n] [rad]: IPOPT's own, not polished.
    fold_angles
        Of all creases, [N] [rad].
    energy
        There [J].
    status, iterations, violation
        Of IPOPT's last solve: its return status, and the largest violation of a row or bound.
    solves
        Solves, each with more rows.
    contacts
        Those that press: fold limits and gaps, whose multipliers are larger than what they are open by.
    multipliers
        Of these, over `scale`.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> answer = o.solve(o.pose("miura:2x2"), np.full(4, 0.3))
    >>> answer.succeeded, answer.solves, answer.violation < 1e-7
    (True, 1, True)
    """

    x: np.ndarray = field(metadata={"plain": False})
    fold_angles: np.ndarray
    energy: float
    status: str
    iterations: int
    violation: float
    solves: int
    contacts: tuple[Contact, ...] = field(metadata={"plain": False})
    multipliers: np.ndarray

    @property
    def succeeded(self) -> bool:
        """Whether IPOPT reports convergence."""
        return self.status == "Solve_Succeeded"


def solve(problem: PatternProblem, y0: np.ndarray) -> IpoptAnswer:
    """Minimise the energy of an origami from a state by IPOPT.

    Parameters
    ----------
    problem
        Of `origami_nlp.pose`.
    y0
        Variables to start from, [n] [rad]; it need not close, facets must not cross at the closed state beside it.

    Returns
    -------
    IpoptAnswer
        Where it ended, judged by nobody: `origami_nlp.classify` takes `State(problem, polished)`.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> problem = o.pose("miura:2x2")
    >>> answer = o.solve(problem, np.full(problem.size, 0.3))
    >>> answer.status, round(answer.energy, 6), answer.contacts
    ('Solve_Succeeded', 0.014778, ())
    """
    ended, pressed, forces, solves = solve_apart(problem, np.asarray(y0, float))
    x, status = ended.x, ended.status
    shown = x, problem.expand(x), float(problem.energy(x))
    return IpoptAnswer(*shown, status, ended.iterations, ended.residual, solves, pressed, forces)


def solve_apart(
    problem: PatternProblem, y0: np.ndarray, solver: Callable[..., Solved] | None = None
) -> tuple[Solve, tuple[Contact, ...], np.ndarray, int]:
    """Solve from a start by `solve_with` or another, again with more rows as long as facets pass through each other."""
    start, _ = problem.project(problem.fold_limits.clip(y0))
    start = problem.fold_limits.clip(start)
    rows = list(rows_near(problem, start))
    for solves in range(1, MOST_ROUNDS + 1):
        solved = (*(solver or solve_with)(problem, start, rows), solves)
        ended = solved[0]
        new = [c for c in _passed(problem, start, ended.x) if c not in rows]
        if not new:
            break
        rows += new
    return solved


def rows_near(problem: PatternProblem, x: np.ndarray) -> tuple[Contact, ...]:
    """Return gaps of features that are near each other at a state, those that touch by the first piece there."""
    if not problem.touching:
        return ()
    closed = problem.closed(x)
    touching = [*closed.base, *(c for choice in closed.branches for c in choice[0])]
    near = problem.features.facing(problem.placed(x), NEAR)
    return tuple(
        c
        for c in dict.fromkeys([*touching, *(problem.contact_of(t) for t, gap in near if gap > 0)])
        if not c.is_limit
    )


def _passed(problem: PatternProblem, start: np.ndarray, end: np.ndarray) -> list[Contact]:
    """Return gaps between facets that cross at an answer, open at the start and negative there."""
    closed, residual = problem.project(end)
    crossed = problem.crossed(closed) if residual <= CLOSURE_TOL else ()
    if not crossed:
        return []
    here, there = problem.placed(start), problem.placed(closed)
    every = problem.features.facing(there, EVERYWHERE)
    of_pairs = [t for t, _ in every if tuple(sorted(t.facets)) in crossed]
    flipped = [problem.contact_of(t) for t in of_pairs]
    before = [t.gap(here) for t in of_pairs]
    return [
        c if gap > 0 else Contact(c.kind, c.index, -c.side, c.at)
        for c, gap, t in zip(flipped, before, of_pairs, strict=True)
        if gap * t.gap(there) < 0
    ]


def solve_with(
    problem: PatternProblem,
    start: np.ndarray,
    contacts: Sequence[Contact],
    options: Mapping[str, object] = OPTIONS,
) -> Solved:
    """Minimise the energy from a state `start` [n], where gaps of contacts stay open; what presses, with multipliers.

    Fold limits among the contacts are told of; all limits are bounds.
    """
    symbols, limits = problem.symbols(), problem.fold_limits
    rows = symbols.row_space(start)
    nlp, solver = solver_for(problem, rows.shape[1], contacts, options)
    bounds = {"lbx": limits.low, "ubx": limits.high, "lbg": nlp.lower, "ubg": nlp.upper}
    out = solver(x0=start, p=np.append(symbols.values, rows.T.ravel()), **bounds)
    stats, found = solver.stats(), {k: np.asarray(v).ravel() for k, v in out.items()}
    x, g, pull = found["x"], found["g"], found["lam_x"]
    violation = float(np.maximum(nlp.lower - g, g - nlp.upper).max(initial=0.0))
    gaps = [c for c in contacts if not c.is_limit]
    first = len(g) - len(gaps)
    # CasADi: gradient of f + lam_g . g + lam_x . x vanishes; a row that is open by g >= 0 has lam_g <= 0
    open_by = {c: (g[first + k], -found["lam_g"][first + k]) for k, c in enumerate(gaps)}
    at_limits = limits.contacts(x, np.ones(problem.size, bool)) if problem.has_limits else ()
    open_by |= {c: (c.at - c.side * x[c.index], c.side * pull[c.index]) for c in at_limits}
    # of gap and force, whose product is IPOPT's barrier, the larger one is no remains of it
    pressed = tuple(c for c, (gap, force) in open_by.items() if force > max(gap, OUTSIDE))
    status, count = str(stats["return_status"]), int(stats["iter_count"])
    ended = Solve(x, status, count, violation, pull)
    return ended, pressed, np.array([open_by[c][1] for c in pressed])


def solver_for(
    problem: PatternProblem, rank: int, contacts: Sequence[Contact], options: Mapping[str, object]
) -> tuple[Nlp, ca.Function]:
    """Return the program with so many rows of closure, which are parameters, and gaps of contacts, and its solver."""
    symbols, gaps = problem.symbols(), tuple(c for c in contacts if not c.is_limit)
    ipopt = {"tol": tolerance_for(problem), **options}
    key = rank, gaps, tuple(ipopt.items())
    if key not in symbols.solvers:
        nlp = symbols.program(ca.SX.sym("U", symbols.closure.shape[0], rank), gaps)
        form = {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}
        asked: dict[str, Any] = {"print_time": False, "error_on_fail": False, "ipopt": ipopt}
        symbols.solvers[key] = nlp, ca.nlpsol("origami", "ipopt", form, asked)
    return symbols.solvers[key]


def tolerance_for(problem: PatternProblem) -> float:
    """Return IPOPT's tolerance for a problem, a power of ten."""
    softness = problem.parameters.softness
    return max(CLOSURE_TOL, TOLERANCE * min(1.0, 10.0 ** math.floor(math.log10(10 * softness))))


@dataclass(frozen=True)
class Confirmation:
    """What IPOPT says of a minimum from a state 1e-3 rad away.

    Attributes
    ----------
    status
        Its return status.
    iterations
        It made.
    moved
        Largest difference of a fold angle between its answer and the minimum [rad].
    lower
        Whether its answer is lower.
    """

    status: str
    iterations: int
    moved: float
    lower: bool = False

    @property
    def came_back(self) -> str:
        """What it came back with: ``same`` state (within `BESIDE`: its barrier keeps off contacts), ``other``, or
        ``none``."""
        if self.status != "Solve_Succeeded":
            return "none"
        return "same" if self.moved <= BESIDE else "other"

    @property
    def agrees(self) -> bool:
        """Whether nothing speaks against the minimum: no lower state beside it."""
        return not (self.came_back == "other" and self.lower and self.moved <= NEARBY)


def confirm(problem: PatternProblem, x: np.ndarray) -> Confirmation | None:
    """Solve by IPOPT from beside a minimum [n], with the gaps of its piece; None with too many variables, or forces in
    space.
    """
    if problem.size > MOST_CONFIRMED or problem.parameters.dead is not None:
        return None
    aside = x + BESIDE * np.sin(1.0 + np.arange(len(x)))
    start, _ = problem.project(problem.fold_limits.clip(aside))
    ended, _, _ = solve_with(
        problem, problem.fold_limits.clip(start), rows_near(problem, x), BESIDE_OPTIONS
    )
    far, fell = float(np.abs(ended.x - x).max()), problem.energy_change(x, ended.x)
    return Confirmation(ended.status, ended.iterations, far, bool(fell < -BALANCED * problem.scale))


class ByIpopt:
    """Ways down of a problem by IPOPT, as `Follower` has them: slower, and it needs no compiler.

    Attributes
    ----------
    work
        Iterations so far.
    """

    usable = True

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self.work = problem, 0

    def __call__(self, start: StartState, *given: object) -> tuple[np.ndarray, str]:
        """Return where a start leads, polished, [n], and why it ends there: ``""`` where IPOPT converged."""
        x = self.problem.fold_limits.hold(start.x, start.side)
        ended, pressed, _, _ = solve_apart(self.problem, x)
        self.work += ended.iterations
        if not ended.succeeded:
            return ended.x, f"IPOPT: {ended.status}"
        x = polish(self.problem, ended, pressed).x
        return x, "" if self.problem.residual(
            x
        ) <= CLOSURE_TOL else "IPOPT: its answer does not close"

    def each(
        self, starts: Sequence[StartState], *given: object
    ) -> list[Callable[[], tuple[np.ndarray, str]]]:
        """Return what tells where each of some starts leads."""
        return [partial(self, start) for start in starts]
