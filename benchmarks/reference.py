"""50-digit solutions of the KKT system, computed by the benchmark itself from a polished state.

Unknowns are the variables x and one multiplier for each of a set of independent constraints: closed contacts and
loop closure, whichever are independent at the state (closure loses rank on thin sets and at flat foldings).
Newton's matrix is analytic (`exact_vertex`).  Afterwards every equation of closure and every closed contact, those
left out included, must vanish to 45 digits, or there is no reference, and `Unsolved` says why.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mpmath as mp
import numpy as np

from benchmarks.exact_vertex import ExactVertex, Jet
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Contact

DIGITS = 50
WORKING = 60
MOST_STEPS = 10
INDEPENDENT = 1e-6
"""A constraint whose gradient keeps less than this off the span of the earlier ones is left out."""
FARTHEST = 1e-3
"""A solution farther from the polished state than this [rad] is another one."""


class Unsolved(ArithmeticError):
    """There is no 50-digit solution at a state; the message says why."""


@dataclass(frozen=True)
class Reference:
    """A state known to 50 digits.

    x, x_rest: fold angles of the variables [n] as a double and what it leaves, x exact = x + x_rest [rad].
    digits: the same as text.  energy, energy_rest: likewise [scene's units].
    rows, multipliers: contacts held closed, and their multipliers (energy / the problem's scale), if they are unique.
    loaded: those of `rows` with a multiplier.  eigenvalues: of the reduced Hessian on the subspace that keeps loaded
    contacts closed, per unit length in the space of all N fold angles [scene's units]; empty where not unique.
    residual: largest entry of closure, closed contacts and stationarity.
    """

    x: np.ndarray
    x_rest: np.ndarray
    digits: tuple[str, ...]
    energy: float
    energy_rest: float
    rows: tuple[Contact, ...]
    multipliers: np.ndarray
    loaded: tuple[Contact, ...]
    eigenvalues: np.ndarray
    residual: float

    def angle_error(self, x: np.ndarray) -> float:
        """Return the largest error of the fold angles x [n], below rounding too [rad]."""
        return float(np.abs((x - self.x) - self.x_rest).max())

    def energy_error(self, energy: float) -> float:
        """Return the error of an energy relative to the exact one; the energy itself where that is 0."""
        error = abs((energy - self.energy) - self.energy_rest)
        return error / self.energy if self.energy else energy


@dataclass(frozen=True)
class _Rows:
    """Contacts that are held closed: of a gap the ray, the facet, and the unit of the problem's gap."""

    contacts: tuple[Contact, ...]
    rays: tuple[tuple[int, int], ...]
    unit: tuple[float, ...]

    def at(self, vertex: ExactVertex, x: np.ndarray) -> tuple[list[Jet], list[Jet]]:
        """Return the jets of closure, and of contacts (>= 0 when open)."""
        closure, found = vertex.evaluate(x, self.rays)
        n, zero = vertex.size, mp.mpf(0)
        gaps = iter(jet.times(unit) for jet, unit in zip(found, self.unit, strict=True))
        jets = []
        for row in self.contacts:
            first = np.array([mp.mpf(-row.side if v == row.index else 0) for v in range(n)])
            limit = Jet(mp.pi - row.side * x[row.index], first, np.full((n, n), zero))
            jets.append(limit if row.is_limit else next(gaps))
        return closure, jets


def solve_reference(
    problem: PatternProblem, start: np.ndarray, rows: tuple[Contact, ...]
) -> Reference:
    """Solve the KKT system near `start` [n] with `rows` closed to 50 digits.

    Raises
    ------
    Unsolved
        If Newton does not converge near by, facets lie on each other, or a constraint that was left out is not met.
    """
    with mp.workdps(WORKING):
        vertex = ExactVertex(problem)
        held = _held(problem, vertex, start, rows)
        why = ""
        for turn in range(problem.equation_count):  # dependent equations: any may be the good one
            chosen, unique = _independent(problem, start, rows, turn)
            try:
                x, lam = _newton(vertex, start, held, chosen)
                return _finish(problem, vertex, x, held, chosen, lam, unique)
            except Unsolved as error:
                why = why or str(error)
        flat = np.round(start / math.pi)
        if np.abs(start - math.pi * flat).max() <= DUPLICATE_TOL:  # a flat folding, known exactly
            x = np.array([mp.pi * int(m) for m in flat])
            none = np.zeros(0, dtype=object)
            return _finish(problem, vertex, x, held, (), none, unique=False)
        raise Unsolved(why)


def _held(
    problem: PatternProblem, vertex: ExactVertex, start: np.ndarray, rows: tuple[Contact, ...]
) -> _Rows:
    """Find the ray and the facet of each gap, and its unit: slopes of a closed gap are equal but for that."""
    gaps = [row for row in rows if not row.is_limit]
    rays = tuple(_ray_and_facet(problem, row) for row in gaps)
    _, jets = vertex.evaluate(np.array([mp.mpf(float(v)) for v in start]), rays)
    ours = problem.local(start).openings(gaps)[1]
    theirs = [jet.first.astype(float) for jet in jets]
    unit = tuple(float(a @ b) / float(b @ b) for a, b in zip(ours, theirs, strict=True))
    return _Rows(rows, rays, unit)


def _ray_and_facet(problem: PatternProblem, row: Contact) -> tuple[int, int]:
    touch = problem.touch(row)
    a, b = touch.facets
    if touch.type == "vertex-face" and 0 != touch.corners[0] >= 0:
        return touch.corners[0] - 1, b
    if touch.type == "edge-edge" and 0 in touch.corners:
        p, q, r, s = touch.corners
        return (p + q - 1, b) if 0 in (p, q) else (r + s - 1, a)
    raise Unsolved("facets lie on each other")


def _independent(
    problem: PatternProblem, x: np.ndarray, rows: tuple[Contact, ...], turn: int
) -> tuple[tuple[int, ...], bool]:
    """Choose independent constraints: positions in (rows, closure); and tell whether the rows are all among them.

    `turn` says with which equation of closure to begin.
    """
    local = problem.local(x)
    _, gradients = local.openings(rows)
    basis: list[np.ndarray] = []
    chosen = []
    order = [r for r, row in enumerate(rows) if row.is_limit]
    m = len(local.closure)
    order += [len(rows) + (e + turn) % m for e in range(m)]
    order += [r for r, row in enumerate(rows) if not row.is_limit]
    everything = np.vstack([gradients, local.closure_jacobian])
    for c in order:
        v = everything[c] / max(1e-300, float(np.linalg.norm(everything[c])))
        for b in basis:
            v = v - (v @ b) * b
        if np.linalg.norm(v) > INDEPENDENT:
            basis.append(v / np.linalg.norm(v))
            chosen.append(c)
    # under a symmetry rows of closure depend on each other everywhere: only the loss of more counts
    regular = len(chosen) - len(rows) == problem.size - problem.dof
    return tuple(chosen), regular and set(range(len(rows))) <= set(chosen)


def _newton(
    vertex: ExactVertex,
    start: np.ndarray,
    rows: _Rows,
    chosen: tuple[int, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Return x and the multipliers of the chosen constraints."""
    n, m = vertex.size, len(chosen)
    x = np.array([mp.mpf(float(v)) for v in start])
    lam = np.full(m, mp.mpf(0))
    for step in range(MOST_STEPS):
        closure, jets = rows.at(vertex, x)
        held = [[*jets, *closure][c] for c in chosen]
        a = np.array([jet.first for jet in held]).reshape(m, n)
        pull = vertex.stiffness * (x - vertex.rest)
        if step == 0:  # least-squares multipliers of the start
            guess = np.linalg.lstsq(a.T.astype(float), pull.astype(float), rcond=None)[0]
            lam = np.array([mp.mpf(float(v)) for v in guess])
        hessian = np.diag(vertex.stiffness)
        for value, jet in zip(lam, held, strict=True):
            hessian = hessian - value * jet.second
        zero = np.full((m, m), mp.mpf(0))
        system = np.block([[hessian, -a.T], [a, zero]])
        right = np.concatenate([pull - a.T @ lam, np.array([j.value for j in held])])
        if max(abs(right)) < mp.mpf(10) ** -(DIGITS + 2):
            return x, lam
        try:
            move = np.array(mp.lu_solve(mp.matrix(system.tolist()), mp.matrix(right.tolist())))
        except ZeroDivisionError:
            raise Unsolved("the KKT matrix is singular") from None
        x, lam = x - move.ravel()[:n], lam - move.ravel()[n:]
        if float(max(abs(x - start))) > FARTHEST:
            raise Unsolved("Newton with 50 digits leaves the state")
    raise Unsolved("Newton with 50 digits does not converge")


def _finish(
    problem: PatternProblem,
    vertex: ExactVertex,
    x: np.ndarray,
    rows: _Rows,
    chosen: tuple[int, ...],
    lam: np.ndarray,
    unique: bool,
) -> Reference:
    """Check every equation, and read off energy, multipliers and eigenvalues."""
    closure, jets = rows.at(vertex, x)
    everything = [*jets, *closure]
    residual = max((abs(j.value) for j in everything), default=mp.mpf(0))
    if residual > mp.mpf(10) ** -(DIGITS - 5):
        raise Unsolved(f"a constraint left out for dependence is off by {float(residual):.0e}")
    held = [everything[c] for c in chosen]
    if unique or chosen:
        pull = vertex.stiffness * (x - vertex.rest)
        force = pull - sum((v * j.first for v, j in zip(lam, held, strict=True)), 0 * pull)
        residual = max(residual, *(abs(v) for v in force))
    multipliers = np.zeros(0)
    loaded: tuple[Contact, ...] = ()
    eigenvalues = np.zeros(0)
    if unique:
        value = dict(zip(chosen, lam, strict=True))
        of_row = [value[r] for r in range(len(rows.contacts))]
        multipliers = np.array([float(v) for v in of_row])
        loaded = tuple(row for row, v in zip(rows.contacts, of_row, strict=True) if v > 1e-13)
        kept = [c for c in chosen if c >= len(rows.contacts) or rows.contacts[c] in loaded]
        hessian = np.diag(vertex.stiffness)
        for c in chosen:
            hessian = hessian - value[c] * everything[c].second
        eigenvalues = _reduced(problem, hessian, [everything[c].first for c in kept])
    energy = vertex.energy(x)
    near = np.array([float(v) for v in x])
    return Reference(
        near,
        np.array([float(v - mp.mpf(h)) for v, h in zip(x, near.tolist(), strict=True)]),
        tuple(mp.nstr(v, DIGITS) for v in x),
        float(energy),
        float(energy - mp.mpf(float(energy))),
        rows.contacts,
        multipliers,
        loaded,
        eigenvalues,
        float(residual),
    )


def _reduced(
    problem: PatternProblem, hessian: np.ndarray, gradients: list[np.ndarray]
) -> np.ndarray:
    """Return the eigenvalues of the Hessian on the kernel of `gradients`, in the metric of all N fold angles."""
    root = np.array([mp.sqrt(int(m)) for m in problem.multiplicity])
    n, m = len(root), len(gradients)
    if m >= n:
        return np.zeros(0)
    scaled = hessian / np.outer(root, root)
    z = np.array([[mp.mpf(int(i == j)) for j in range(n)] for i in range(n)])
    if m:
        columns = mp.matrix([[g[i] / root[i] for g in gradients] for i in range(n)])
        q, _ = mp.qr(columns, mode="full")
        z = np.array(q.tolist()).reshape(n, n)[:, m:]
    inner = z.T @ scaled @ z
    values = mp.eigsy(mp.matrix(inner.tolist()), eigvals_only=True)
    return np.sort(np.array([float(v * mp.mpf(problem.scale)) for v in values]))
