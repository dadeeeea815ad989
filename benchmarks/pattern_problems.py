"""Patterns that solvers are measured on: one start each, and the state below it to more digits than any of them has.

The reference is found in extended precision by code of its own: closure as a product of quaternions in `longdouble`,
Newton on stationarity and closure, residuals in extended and steps in double precision, so that each step takes off
what the last one left.  For Miura sheets the closed form says the same a second way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from origami_nlp.errors import OptionError
from origami_nlp.numerics import Factor
from origami_nlp.pattern import Pattern, examples
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import descend

GUESS = 0.4
"""Fold angle of mountains and valleys that all solvers start from, closed by the package [rad]."""
DECADES = 2.0
"""Of stiffness, drawn once, in patterns with many degrees of freedom: with equal springs a torque step is Newton's."""
SPRINGS: dict[str, tuple[float, bool] | None] = {
    "miura:4x4": (1.2, True),
    "miura:8x8": (1.2, True),
    "miura:16x16": (1.2, True),
    "miura:32x32": (1.2, True),
    "waterbomb:5x5": (1.0, False),
    "yoshimura:6x6": (1.0, False),
    "metasheet:4x4": None,
}
"""Patterns: rest angle of their mountains and valleys [rad], and whether all stiffnesses are 1; None: their own."""
QUICK = ("miura:4x4", "metasheet:4x4")
NEWTON_STEPS = 8
"""Of the reference: each takes off some ten digits."""


@dataclass(frozen=True, eq=False)
class PatternTask:
    """One pattern, one start, one answer.

    Attributes
    ----------
    name
        As commands take it.
    pattern
        With its springs.
    sheet
        Its problem.
    start
        Closed fold angles [rad], [n].
    exact
        Fold angles of the reference in extended precision, [n].
    energy
        Its energy.
    residual
        Largest entry of its closure and of its stationarity over the mean stiffness.
    """

    name: str
    pattern: Pattern
    sheet: PatternProblem
    start: np.ndarray
    exact: np.ndarray
    energy: float
    residual: float

    def angle_error(self, phi: np.ndarray) -> float:
        """Return the largest difference of fold angles [n] to the reference [rad]."""
        return float(np.abs(phi - self.exact).max())

    def energy_error(self, phi: np.ndarray) -> float:
        """Return the relative difference of the energy of fold angles [n] to the reference's."""
        p = self.pattern
        own = 0.5 * (p.stiffness * (phi - p.rest.astype(self.exact.dtype)) ** 2).sum()
        return abs(float(own - self._exact_energy) / self.energy)

    @property
    def _exact_energy(self) -> np.floating:
        p = self.pattern
        return 0.5 * (p.stiffness * (self.exact - p.rest) ** 2).sum()


def pattern_problems(names: Sequence[str] | None = None) -> list[PatternTask]:
    """Make problems.

    Parameters
    ----------
    names
        Keys of `SPRINGS`; all of them by default.

    Returns
    -------
    list of PatternTask

    Raises
    ------
    OptionError
        If a pattern has no state below its start that contact and fold limits leave alone.
    """
    return [_problem(name) for name in (SPRINGS if names is None else names)]


def _problem(name: str) -> PatternTask:
    kind, _, size = name.partition(":")
    rows, columns = map(int, size.split("x"))
    pattern = examples.pattern(kind, rows, columns)
    springs = SPRINGS[name]
    if springs is not None:
        rest, equal = springs
        drawn = np.random.default_rng(0).uniform(-DECADES / 2, DECADES / 2, pattern.creases)
        pattern = pattern.with_springs(1.0 if equal else (10.0**drawn).tolist(), rest)
    sheet = PatternProblem(pattern)
    start, _ = sheet.project(GUESS * pattern.signs)
    end = descend(sheet, start)
    if not end.arrived or np.abs(end.phi).max() >= math.pi:
        raise OptionError(f"pattern {name} has no free state below its start: take another")
    exact, residual = refine(sheet, end.phi)
    energy = float(0.5 * (pattern.stiffness * (exact - pattern.rest) ** 2).sum())
    return PatternTask(name, pattern, sheet, start, exact, energy, residual)


def refine(sheet: PatternProblem, phi: np.ndarray) -> tuple[np.ndarray, float]:
    """Take a stationary state without contact to extended precision.

    Parameters
    ----------
    sheet
        The problem.
    phi
        The state, good to some digits, [n] [rad].

    Returns
    -------
    phi : numpy.ndarray
        Of `numpy.longdouble`, [n].
    residual : float
        Largest entry of closure, and of stationarity over the mean stiffness.
    """
    wide = np.longdouble
    k = sheet.pattern.stiffness.astype(wide) / wide(sheet.pattern.stiffness.mean())
    rest, state = sheet.pattern.rest.astype(wide), phi.astype(wide)
    lam = sheet.multipliers(phi)[0].astype(wide)
    best, smallest = state, math.inf
    for _ in range(NEWTON_STEPS):
        closure, pull = wide_closure(sheet.pattern, state, lam)
        balance = k * (state - rest) - pull
        residual = float(max(np.abs(closure).max(), np.abs(balance).max()))
        if residual >= smallest:
            break
        best, smallest = state, residual
        near = state.astype(float)
        h, j = sheet.hessian(near, lam.astype(float)), sheet.closure.jacobian(near)
        d, other = Factor(h, j).solve(-balance.astype(float), -closure.astype(float))
        state, lam = state + d, lam - other
    return best, smallest


def wide_closure(
    pattern: Pattern, phi: np.ndarray, multipliers: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Evaluate closure of the vertices, and its gradient weighed by multipliers, in the precision of phi.

    A vertex's product of quaternions is cut before each crease: vec(A f' B) with f' = (-sin, cos b)/2 in between.

    Parameters
    ----------
    pattern
        Without holes; in its flat reference state.
    phi
        Fold angles [rad], [n].
    multipliers
        Of closure, [m].

    Returns
    -------
    closure : numpy.ndarray
        Vector parts, [m].
    pull : numpy.ndarray
        Gradient of multipliers . closure, [n].
    """
    closure, pull = np.zeros(3 * len(pattern.vertices), phi.dtype), np.zeros(len(phi), phi.dtype)
    axes = pattern.corners[pattern.ends[:, 1]] - pattern.corners[pattern.ends[:, 0]]
    wide = axes.astype(phi.dtype)
    wide /= np.sqrt((wide**2).sum(axis=1, keepdims=True))
    by_degree: dict[int, list[int]] = {}
    for v, loop in enumerate(pattern.vertices):
        by_degree.setdefault(len(loop.creases), []).append(v)
    for degree, members in by_degree.items():
        rows = 3 * np.array(members)[:, None] + np.arange(3)
        creases = np.array([pattern.vertices[v].creases for v in members])
        signs = np.array([pattern.vertices[v].signs for v in members], phi.dtype)
        half, b = phi[creases] / 2, signs[..., None] * wide[creases]
        folds = np.concatenate([np.cos(half)[..., None], np.sin(half)[..., None] * b], axis=2)
        slopes = np.concatenate([-np.sin(half)[..., None], np.cos(half)[..., None] * b], axis=2) / 2
        one = np.zeros((len(members), 4), phi.dtype)
        one[:, 0] = 1
        before, after = [one], [one]
        for i in range(degree):
            before.append(_times(before[-1], folds[:, i]))
            after.append(_times(folds[:, degree - 1 - i], after[-1]))
        closure[rows] = before[-1][:, 1:]
        for i in range(degree):
            turned = _times(_times(before[i], slopes[:, i]), after[degree - 1 - i])
            np.add.at(pull, creases[:, i], (turned[:, 1:] * multipliers[rows]).sum(axis=1))
    return closure, pull


def _times(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Multiply quaternions [K, 4]."""
    a, b, c, d = p.T
    e, f, g, h = q.T
    return np.stack(
        [
            a * e - b * f - c * g - d * h,
            a * f + b * e + c * h - d * g,
            a * g - b * h + c * e + d * f,
            a * h + b * g - c * f + d * e,
        ],
        axis=1,
    )


def miura_state(pattern: Pattern, acute: float = math.pi / 3) -> np.ndarray:
    """Return the state of least energy of a Miura sheet with equal springs, folded as its letters say.

    Its straight creases fold by h and its zigzags by z with tan(h/2) = cos(acute) tan(z/2): one unknown.

    Parameters
    ----------
    pattern
        Of `examples.pattern("miura", ...)`, one stiffness and one size of rest angles.
    acute
        Angle of its parallelograms [rad].

    Returns
    -------
    numpy.ndarray
        Fold angles [rad], [n].
    """
    straight = np.abs(pattern.directions[:, 1]) < 1e-9
    rows, zigzags = int(straight.sum()), int((~straight).sum())
    rest = float(np.abs(pattern.rest).max())

    def row(z: float) -> float:
        return 2 * math.atan(math.cos(acute) * math.tan(z / 2))

    def slope(z: float) -> float:
        t = math.cos(acute) * math.tan(z / 2)
        turn = math.cos(acute) / math.cos(z / 2) ** 2 / (1 + t * t)
        return rows * (row(z) - rest) * turn + zigzags * (z - rest)

    z = brentq(slope, 1e-6, math.pi - 1e-6, xtol=1e-15, rtol=1e-15)
    return pattern.signs * np.where(straight, row(z), z)
