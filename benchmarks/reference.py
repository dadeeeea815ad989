"""50-digit solutions of the KKT system, computed by the benchmark itself from a polished state.

Unknowns are the variables x and one multiplier for each of a set of independent constraints: closed contacts and
loop closure, whichever are independent at the state (closure loses rank on thin sets and at flat foldings).
Newton's matrix is analytic (`exact_piece`).  Afterwards every equation of closure and every closed contact, those
left out included, must vanish to 45 digits, or there is no reference, and `Unsolved` says why.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mpmath as mp
import numpy as np

from benchmarks.exact_piece import ExactPiece, Jet
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.problem import Contact, Model, Problem

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
    rows, multipliers: contacts held closed, and their multipliers (energy / `Model.scale`), if they are unique.
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


def solve_reference(model: Model, start: np.ndarray, rows: tuple[Contact, ...]) -> Reference:
    """Solve the KKT system near `start` [n] with `rows` closed to 50 digits.

    Raises
    ------
    Unsolved
        If Newton does not converge near by, or a constraint that was left out is not met.
    """
    with mp.workdps(WORKING):
        piece = ExactPiece(model)
        problem = ""
        for turn in range(
            model.equation_count
        ):  # dependent equations of closure: any may be the good one
            chosen, unique = _independent(model, start, rows, turn)
            try:
                x, lam = _newton(piece, start, rows, chosen)
                return _finish(model, piece, x, rows, chosen, lam, unique)
            except Unsolved as error:
                problem = problem or str(error)
        flat = np.round(start / math.pi)
        if np.abs(start - math.pi * flat).max() <= DUPLICATE_TOL:  # a flat folding, known exactly
            x = np.array([mp.pi * int(m) for m in flat])
            return _finish(model, piece, x, rows, (), np.zeros(0, dtype=object), unique=False)
        raise Unsolved(problem)


def _constraints(
    piece: ExactPiece, x: np.ndarray, rows: tuple[Contact, ...]
) -> tuple[list[Jet], list[Jet]]:
    """Return the jets of closure, and of rows (>= 0 when open)."""
    closure, gaps = piece.evaluate(x, tuple(r.index for r in rows if not r.is_limit))
    n, zero = piece.size, mp.mpf(0)
    jets = []
    for row in rows:
        if not row.is_limit:
            g = gaps[row.index]
            jets.append(Jet(row.side * g.value, row.side * g.first, row.side * g.second))
        else:
            first = np.array([mp.mpf(-row.side if v == row.index else 0) for v in range(n)])
            jets.append(Jet(mp.pi - row.side * x[row.index], first, np.full((n, n), zero)))
    return closure, jets


def _independent(
    model: Problem, x: np.ndarray, rows: tuple[Contact, ...], turn: int
) -> tuple[tuple[int, ...], bool]:
    """Choose independent constraints: positions in (rows, closure); and tell whether these are all.

    `turn` says with which equation of closure to begin.
    """
    local = model.local(x)
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
    return tuple(chosen), len(chosen) == len(everything)


def _newton(
    piece: ExactPiece,
    start: np.ndarray,
    rows: tuple[Contact, ...],
    chosen: tuple[int, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Return x and the multipliers of the chosen constraints."""
    n, m = piece.size, len(chosen)
    x = np.array([mp.mpf(float(v)) for v in start])
    lam = np.full(m, mp.mpf(0))
    for step in range(MOST_STEPS):
        closure, jets = _constraints(piece, x, rows)
        held = [[*jets, *closure][c] for c in chosen]
        a = np.array([jet.first for jet in held]).reshape(m, n)
        pull = piece.stiffness * (x - piece.rest)
        if step == 0:  # least-squares multipliers of the start
            guess = np.linalg.lstsq(a.T.astype(float), pull.astype(float), rcond=None)[0]
            lam = np.array([mp.mpf(float(v)) for v in guess])
        hessian = np.diag(piece.stiffness)
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
    model: Model,
    piece: ExactPiece,
    x: np.ndarray,
    rows: tuple[Contact, ...],
    chosen: tuple[int, ...],
    lam: np.ndarray,
    unique: bool,
) -> Reference:
    """Check every equation, and read off energy, multipliers and eigenvalues."""
    closure, jets = _constraints(piece, x, rows)
    everything = [*jets, *closure]
    residual = max((abs(j.value) for j in everything), default=mp.mpf(0))
    if residual > mp.mpf(10) ** -(DIGITS - 5):
        raise Unsolved(f"a constraint left out for dependence is off by {float(residual):.0e}")
    held = [everything[c] for c in chosen]
    if unique or chosen:
        pull = piece.stiffness * (x - piece.rest)
        force = pull - sum((v * j.first for v, j in zip(lam, held, strict=True)), 0 * pull)
        residual = max(residual, *(abs(v) for v in force))
    multipliers = np.zeros(0)
    loaded: tuple[Contact, ...] = ()
    eigenvalues = np.zeros(0)
    if unique:
        value = dict(zip(chosen, lam, strict=True))
        of_row = [value[r] for r in range(len(rows))]
        multipliers = np.array([float(v) for v in of_row])
        loaded = tuple(row for row, v in zip(rows, of_row, strict=True) if v > 1e-13)
        kept = [c for c in chosen if c >= len(rows) or rows[c] in loaded]
        hessian = np.diag(piece.stiffness)
        for c in chosen:
            hessian = hessian - value[c] * everything[c].second
        eigenvalues = _reduced(model, hessian, [everything[c].first for c in kept])
    energy = piece.energy(x)
    near = np.array([float(v) for v in x])
    return Reference(
        near,
        np.array([float(v - mp.mpf(h)) for v, h in zip(x, near.tolist(), strict=True)]),
        tuple(mp.nstr(v, DIGITS) for v in x),
        float(energy),
        float(energy - mp.mpf(float(energy))),
        rows,
        multipliers,
        loaded,
        eigenvalues,
        float(residual),
    )


def _reduced(model: Problem, hessian: np.ndarray, gradients: list[np.ndarray]) -> np.ndarray:
    """Return the eigenvalues of the Hessian on the kernel of `gradients`, in the metric of all N fold angles."""
    root = np.array([mp.sqrt(int(m)) for m in model.multiplicity])
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
    return np.sort(np.array([float(v * mp.mpf(model.scale)) for v in values]))
