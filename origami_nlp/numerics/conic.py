"""A conic program: linear rows, second-order cones and linear matrix inequalities, solved by Clarabel.

    maximise c . v   subject to   rows v = 0,   slack = a v + b in a cone (>= 0, second order, or semidefinite).

Its dual y bounds the objective: `ConicSolution.bound`, up to `ConicSolution.residual`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from origami_nlp.arguments import require
from origami_nlp.numerics.tolerances import BALANCED, DEPENDENT, NONZERO

EQUAL, POSITIVE, BALL, DEFINITE = "=", ">=", "|.|<=", "psd"

ACCURACIES = (1e-10, 1e-9, 1e-8)
"""Of gap and feasibility, asked for in turn: where a problem is badly scaled the first is below its rounding."""


def smatrix(v: np.ndarray) -> np.ndarray:
    """Return the symmetric matrix of the vector [q (q + 1) / 2] that `svector` made."""
    q = round((math.sqrt(8 * len(v) + 1) - 1) / 2)
    out = np.zeros((q, q))
    j, i = np.tril_indices(q)  # columns of the upper triangle, one after the other
    out[i, j] = out[j, i] = np.where(i == j, v, v / math.sqrt(2))
    return out


def svector(m: np.ndarray) -> np.ndarray:
    """Return the upper triangle of symmetric matrices [..., q, q], column by column, with <a, b> = tr(A B)."""
    # off-diagonal entries count twice in tr(A B): the factor sqrt 2 makes it a dot product
    j, i = np.tril_indices(m.shape[-1])
    return np.where(i == j, m[..., i, j], m[..., i, j] * math.sqrt(2))


@dataclass(frozen=True)
class ConeRows:
    """Rows of one cone: slack = a v + b lies in it.

    Attributes
    ----------
    cone
        ``"="`` (slack = 0), ``">="``, ``"|.|<="`` (the first entry bounds the norm of the others) or ``"psd"``.
    a
        Shape [r, V].
    b
        Shape [r].
    words
        What the rows say, for people: all of them, or one for each.
    """

    cone: str
    a: np.ndarray
    b: np.ndarray
    words: str | tuple[str, ...]

    @classmethod
    def of(cls, cone: str, a: Any, words: str | tuple[str, ...], b: Any = 0.0) -> ConeRows:
        """Return rows of numbers: a is one row [V] or several, b one number or one for each."""
        a = np.atleast_2d(np.asarray(a, float))
        return cls(cone, a, np.broadcast_to(np.asarray(b, float), len(a)), words)


@dataclass(frozen=True)
class ConicSolution:
    """What the solver found, and the dual that proves it.

    Attributes
    ----------
    status
        Of Clarabel: ``"Solved"``, ``"PrimalInfeasible"``, ...
    v
        The point, shape [V]; where the rows contradict each other of no use.
    duals
        y of each of the problem's `rows`, in their cones' duals.
    bound
        Where solved: no point has a larger objective than this, up to `residual`.
    residual
        Largest entry of c + sum A' y (solved), or of sum A' y over |b . y| (infeasible).
    iterations
        Of the interior point method.
    """

    status: str
    v: np.ndarray
    duals: tuple[np.ndarray, ...]
    bound: float
    residual: float
    iterations: int

    @property
    def solved(self) -> bool:
        """Whether the point is an optimum to the solver's full accuracy."""
        return self.status == "Solved"

    @property
    def infeasible(self) -> bool:
        """Whether the dual proves that the rows contradict each other."""
        return self.status == "PrimalInfeasible"


@dataclass
class ConicProgram:
    """A conic program that grows row by row.

    Parameters
    ----------
    size
        Number V of unknowns; `more` adds some.
    """

    size: int
    rows: list[ConeRows] = field(default_factory=list)

    def more(self, count: int) -> slice:
        """Add unknowns and return where they are."""
        where = slice(self.size, self.size + count)
        self.size += count
        return where

    def add(self, cone: str, a: Any, b: Any, words: str | tuple[str, ...]) -> None:
        """Add rows a v + b in a cone; a may have fewer columns than there will be unknowns."""
        a, b = np.atleast_2d(np.asarray(a, float)), np.atleast_1d(np.asarray(b, float))
        if len(b):
            self.rows.append(ConeRows(cone, a, b, words))

    def matrix(self, rows: ConeRows) -> np.ndarray:
        """Return a of some rows with a column for each unknown, [r, V]."""
        missing = self.size - rows.a.shape[1]
        return np.pad(rows.a, ((0, 0), (0, missing))) if missing else rows.a

    def maximise(self, c: np.ndarray) -> ConicSolution:
        """Solve for the largest c . v.

        Parameters
        ----------
        c
            Shape [V].

        Returns
        -------
        ConicSolution
            With the dual of each block of rows.

        Raises
        ------
        OptionError
            If Clarabel is not installed.
        """
        from scipy import sparse  # heavy: where a program is solved alone

        clarabel = solver()
        cones = {
            POSITIVE: clarabel.NonnegativeConeT,
            BALL: clarabel.SecondOrderConeT,
            DEFINITE: lambda r: clarabel.PSDTriangleConeT(round((math.sqrt(8 * r + 1) - 1) / 2)),
        }
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        c = np.pad(c, (0, self.size - len(c)))
        # y = -left / |left|^2 has A' y = 0 and b . y = -1: A v + b = 0 has no solution (Fredholm)
        point, along, contradiction = self._on_equal()
        if contradiction is not None:
            return self._answer("PrimalInfeasible", point, c, np.zeros(0), contradiction, 0)
        # v = point + along u: without equal rows it needs fewer digits
        some = [r for r in self.rows if r.cone != EQUAL]
        a = np.vstack([self.matrix(r) for r in some])
        b = np.concatenate([r.b for r in some]) + a @ point
        matrix = sparse.csc_matrix(-a @ along)
        kinds = [cones[r.cone](len(r.b)) for r in some]
        none = sparse.csc_matrix((along.shape[1],) * 2)
        for accuracy in ACCURACIES:
            settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = accuracy
            found = clarabel.DefaultSolver(none, -along.T @ c, matrix, b, kinds, settings).solve()
            if str(found.status) in ("Solved", "PrimalInfeasible"):
                break
        v = point + along @ np.array(found.x)
        return self._answer(str(found.status), v, c, np.array(found.z), None, int(found.iterations))

    def _on_equal(self) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Return a point [V] of the equal rows, a basis [V, u] along them, and their dual where they contradict."""
        equal = [r for r in self.rows if r.cone == EQUAL]
        if not equal:
            return np.zeros(self.size), np.eye(self.size), None
        a, b = np.vstack([self.matrix(r) for r in equal]), np.concatenate([r.b for r in equal])
        u, values, vt = np.linalg.svd(a)
        rank = int((values > DEPENDENT * values[0]).sum())
        point = vt[:rank].T @ ((u[:, :rank].T @ -b) / values[:rank])
        left = a @ point + b
        off = float(np.abs(left).max()) > BALANCED * (1.0 + float(np.abs(point).max()))
        return point, vt[rank:].T, -left / (left @ left) if off else None

    def _answer(
        self,
        status: str,
        v: np.ndarray,
        c: np.ndarray,
        z: np.ndarray,
        equal: np.ndarray | None,
        iterations: int,
    ) -> ConicSolution:
        """Complete the dual z of the other rows by that of the equal ones, which makes its sum vanish best."""
        aim = np.zeros_like(c) if status == "PrimalInfeasible" else c
        others = [r for r in self.rows if r.cone != EQUAL]
        if not len(z):
            z = np.zeros(sum(len(r.b) for r in others))
        ends = np.cumsum([len(r.b) for r in others])
        parts = dict(zip(map(id, others), np.split(z, ends[:-1]), strict=True))
        rows = [r for r in self.rows if r.cone == EQUAL]
        if rows:
            if equal is None:
                pull = aim + sum(self.matrix(r).T @ parts[id(r)] for r in others)
                a = np.vstack([self.matrix(r) for r in rows])
                equal = np.linalg.lstsq(a.T, -pull, rcond=DEPENDENT)[0]
            ends = np.cumsum([len(r.b) for r in rows])
            parts |= zip(map(id, rows), np.split(equal, ends[:-1]), strict=True)
        duals = tuple(parts[id(r)] for r in self.rows)
        # weak duality: c . v <= sum b . y for every feasible v, but for (c + sum A' y) . v, the residual
        left = float(np.abs(aim + self.pull(duals)).max())
        work = sum(float(r.b @ y) for r, y in zip(self.rows, duals, strict=True))
        if status == "PrimalInfeasible":
            left /= max(abs(work), NONZERO)
        return ConicSolution(status, v, duals, work, left, iterations)

    def pull(self, duals: tuple[np.ndarray, ...]) -> np.ndarray:
        """Return sum A' y over all rows, [V]."""
        return sum(
            (self.matrix(r).T @ y for r, y in zip(self.rows, duals, strict=True)),
            np.zeros(self.size),
        )


def solver() -> Any:
    """Return the module of the solver.

    Raises
    ------
    OptionError
        If it is not installed.
    """
    return require("clarabel", "design", "design")
