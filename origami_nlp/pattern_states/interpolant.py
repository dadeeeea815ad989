"""A curve of closed states between the states at which it was sampled: a polynomial of degree five a step.

At each sample the tangent t = phi' and the curvature phi'' = -J^+ c''(t, t) over arc length are known, so that a step
is fixed to order h^6; how far its middle is from closed states is measured, and steps are halved until that is little.
The energy along a step is then a polynomial of degree ten, and its wells are roots of one of degree nine: all of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern_problem import PaperSymmetry, PatternProblem, image
from origami_nlp.pattern_states.curve import ClosedStates, ClosureCurve

FITS = 1e-6
"""Distance of the middle of a step from closed states, at most [rad]."""
MOST_HALVINGS = 6
"""Of a step."""
ON_CURVE = 2e-5
"""A state this close to a curve is on it [rad]: what its polynomials are off, with room."""
REAL = 1e-6
"""Imaginary part, and excess over the ends, of roots in units of a step that count as real and inside."""

# phi(u) = sum_k b_k B_k(u): control points from values, derivatives and second derivatives at both ends
BEZIER = np.array(
    [
        [1, 0, 0, 0, 0, 0],
        [1, 1 / 5, 0, 0, 0, 0],
        [1, 2 / 5, 1 / 20, 0, 0, 0],
        [0, 0, 0, 1, -2 / 5, 1 / 20],
        [0, 0, 0, 1, -1 / 5, 0],
        [0, 0, 0, 1, 0, 0],
    ]
)
POWERS = np.array(
    [
        [1, 0, 0, 0, 0, 0],
        [-5, 5, 0, 0, 0, 0],
        [10, -20, 10, 0, 0, 0],
        [-10, 30, -30, 10, 0, 0],
        [5, -20, 30, -20, 5, 0],
        [-1, 5, -10, 10, -5, 1],
    ]
)
"""From control points to coefficients of 1, u, u^2, ..."""
CUTS = 17
"""Places in a step at which the nearest one to a state is looked for, again and again."""


@dataclass(frozen=True, eq=False, repr=False)
class Interpolant(ShortRepr):
    """A curve as polynomials.

    Attributes
    ----------
    states
        Closed states along it, [S, n] [rad].
    control
        Control points of each step, [S - 1, 6, n] [rad].
    ends
        As of the `ClosureCurve`.
    off
        Largest distance of the middle of a step from closed states [rad].
    odd
        As of the `ClosureCurve`.
    """

    states: np.ndarray
    control: np.ndarray
    ends: tuple[str, str]
    off: float
    odd: bool = False

    @property
    def fits(self) -> bool:
        """Whether the polynomials are as close to closed states as they are meant to be."""
        return self.off <= FITS

    def image(self, symmetry: PaperSymmetry) -> Interpolant:
        """Return where a symmetry of the paper takes it."""
        return replace(
            self, states=image(symmetry, self.states), control=image(symmetry, self.control)
        )

    @cached_property
    def boxes(self) -> np.ndarray:
        """Least and largest fold angles of the control points of each step, with room: no state of it is outside,
        [S - 1, 2, n]."""
        low, high = self.control.min(axis=1) - ON_CURVE, self.control.max(axis=1) + ON_CURVE
        return np.stack([low, high], axis=1)

    def may_hold(self, states: np.ndarray) -> np.ndarray:
        """Return which states are in the box of some step, of bool [K]."""
        low, high = self.boxes.swapaxes(0, 1)
        inside = (states >= low.min(axis=0)) & (states <= high.max(axis=0))
        out = inside.all(axis=1)
        for k in np.flatnonzero(out).tolist():
            out[k] = ((states[k] >= low) & (states[k] <= high)).all(axis=1).any()
        return out

    def at(self, step: int, u: float) -> np.ndarray:
        """Return the state at a share u of a step, [n]."""
        powers = u ** np.arange(6.0)
        here: np.ndarray = powers @ (POWERS @ self.control[step])
        return here

    def nearest(self, step: int, phi: np.ndarray) -> tuple[float, float]:
        """Return the share of a step that is nearest to a state [n], and how far it is: looked at closer and closer."""
        low, high, powers = 0.0, 1.0, POWERS @ self.control[step]
        for _ in range(5):
            shares = np.linspace(low, high, CUTS)
            apart = np.linalg.norm(shares[:, None] ** np.arange(6.0) @ powers - phi, axis=1)
            k = int(apart.argmin())
            low, high = shares[max(k - 1, 0)], shares[min(k + 1, CUTS - 1)]
        return float(shares[k]), float(apart[k])


def interpolate(problem: PatternProblem, curve: ClosureCurve) -> Interpolant:
    """Fix a curve between its states.

    Parameters
    ----------
    problem
        The problem.
    curve
        Of `follow_curve`.

    Returns
    -------
    Interpolant
        With further states where steps were too long.
    """
    phi, closed = list(curve.phi), ClosedStates(problem)
    data = list(zip(curve.tangents, curve.bends, strict=True))
    begin = (
        len(phi) // 2 - 1 if curve.odd else 0
    )  # of an odd curve the step through the flat state, and what follows
    states, pieces, off = [phi[begin]], list[np.ndarray](), 0.0
    stack = [(phi[i], data[i], phi[i + 1], data[i + 1], 0) for i in range(begin, len(phi) - 1)]
    stack.reverse()
    while stack:
        a, of_a, b, of_b, depth = stack.pop()
        control = _step(a, of_a, b, of_b)
        through = curve.odd and not pieces  # its middle is flat
        guess = halves(halves(control)[1])[0][-1] if through else halves(control)[0][-1]
        middle, residual = problem.project(guess)
        apart = float(np.abs(middle - guess).max()) if residual <= CLOSURE_TOL else np.inf
        if apart > FITS and depth < MOST_HALVINGS and np.isfinite(apart) and not through:
            at = closed.at(middle, b - a)
            of_middle = at.tangent, at.bend
            stack.append((middle, of_middle, b, of_b, depth + 1))
            stack.append((a, of_a, middle, of_middle, depth + 1))
            continue
        states.append(b)
        pieces.append(control)
        off = max(off, apart)
    if curve.odd:
        states = [*(-x for x in states[:1:-1]), *states]
        pieces = [*(-x[::-1] for x in pieces[:0:-1]), *pieces]
    control = np.array(pieces).reshape(-1, 6, problem.size)
    return Interpolant(np.array(states), control, curve.ends, off, curve.odd)


def halves(control: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cut a step in its middle (de Casteljau): control points of both halves, [6, n] each."""
    row, before, after = control, [control[0]], [control[-1]]
    for _ in range(5):
        row = 0.5 * (row[1:] + row[:-1])
        before.append(row[0])
        after.append(row[-1])
    return np.array(before), np.array(after[::-1])


def _step(
    a: np.ndarray,
    of_a: tuple[np.ndarray, np.ndarray],
    b: np.ndarray,
    of_b: tuple[np.ndarray, np.ndarray],
) -> np.ndarray:
    """Return control points of a step, [6, n]."""
    chord = float(np.linalg.norm(b - a))
    bend = 0.5 * (of_a[1] @ of_a[1] + of_b[1] @ of_b[1])
    h = chord * (1 + min(chord**2 * bend, 1.0) / 24)  # length of the arc over the chord
    ends = np.array([a, h * of_a[0], h * h * of_a[1], b, h * of_b[0], h * h * of_b[1]])
    control: np.ndarray = BEZIER @ ends
    return control


def stationary(problem: PatternProblem, curve: Interpolant) -> list[tuple[int, float, bool]]:
    """Return where the energy is stationary inside a curve.

    Parameters
    ----------
    problem
        The problem.
    curve
        Of `interpolate`.

    Returns
    -------
    list of tuple
        Step, share of it, and whether the slope rises there: a well, else a top.
    """
    found = []
    if not problem.parameters.plain:
        slopes = _sampled_slopes(problem, curve)
        one, two = np.sign(slopes[:, :-1]), np.sign(slopes[:, 1:])
        # a slope that is 0 at a sample belongs to what comes before it
        for step, k in zip(*np.nonzero((one != 0) & (one != two)), strict=True):
            a, b = slopes[step, k], slopes[step, k + 1]
            found.append((int(step), float((k + a / (a - b)) / (slopes.shape[1] - 1)), bool(b > a)))
        return found
    for step, s in enumerate(_slopes(problem, curve)):
        # u <= 1: no root where the constant is larger than the sum of all other coefficients, as in most steps
        if (np.abs(s[1:]).sum() < abs(s[0])) or not np.abs(s).max():
            continue
        roots = np.polynomial.polynomial.polyroots(s)
        for r in roots[np.abs(roots.imag) < REAL].real:
            u = min(max(float(r), 0.0), 1.0)
            rises = np.polynomial.polynomial.polyval(r, s[1:] * np.arange(1.0, 10.0)) > 0
            if abs(u - r) < REAL:
                found.append((step, u, bool(rises)))
    return found


def _slopes(problem: PatternProblem, curve: Interpolant) -> np.ndarray:
    """Slopes of the energy over u in each step, coefficients of 1, u, ..., [S - 1, 10]."""
    c = POWERS @ curve.control  # coefficients of u^k, [S - 1, 6, n]
    pull = c.copy()
    springs = problem.parameters
    pull[:, 0] -= springs.rest
    pull *= springs.stiffness
    pull[:, 0] -= springs.load
    speed = c[:, 1:] * np.arange(1.0, 6.0)[:, None]
    slope = np.zeros((len(c), 10))
    for i in range(6):
        for k in range(5):
            slope[:, i + k] += np.einsum("sn,sn->s", pull[:, i], speed[:, k])
    return slope


def _sampled_slopes(problem: PatternProblem, curve: Interpolant) -> np.ndarray:
    """Slopes of the energy over u at even shares of each step, [S - 1, `CUTS`]: laws are no polynomials along it."""
    u = np.linspace(0.0, 1.0, CUTS)[:, None]
    c = POWERS @ curve.control
    x = np.einsum("uk,skn->sun", u ** np.arange(6.0), c)
    speed = np.einsum("uk,skn->sun", u ** np.arange(5.0), c[:, 1:] * np.arange(1.0, 6.0)[:, None])
    slopes: np.ndarray = (problem.torque(x) * speed).sum(axis=2)
    return slopes


def wells(problem: PatternProblem, curve: Interpolant) -> list[np.ndarray]:
    """Return where the energy has its minima along a curve: inside, and at ends that it falls towards.

    Parameters
    ----------
    problem
        The problem.
    curve
        Of `interpolate`.

    Returns
    -------
    list of numpy.ndarray
        Fold angles [n], to the accuracy of the polynomials.
    """
    found = [curve.at(step, u) for step, u, rises in stationary(problem, curve) if rises]
    if not problem.parameters.plain:
        sampled = _sampled_slopes(problem, curve)
        first, last = sampled[0, 0], float(sampled[-1, -1])
    else:
        slope = _slopes(problem, curve)
        first, last = slope[0, 0], float(slope[-1].sum())
    if curve.ends[0] == "limit" and first >= 0:
        found.append(curve.states[0])
    if curve.ends[1] == "limit" and last <= 0:
        found.append(curve.states[-1])
    return found
