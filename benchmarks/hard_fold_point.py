"""Hard case: a minimum and a saddle about to annihilate, with the stiffness ratio known in closed form.

A vertex of degree 6 with equal sectors keeps D_3 on its cone branch with three valley flaps: all odd creases fold
by phi_o(v), all even ones by 2 v, v < 0 the elevation (paper, section 4).  With rest angle c at every crease and
stiffness k_o, k_e, k_o (phi_o - c) phi_o' + k_e (2 v - c) 2 = 0 at stationary elevations: at r = k_o / k_e these solve

    r = R(v) = -2 (2 v - c) / ((phi_o(v) - c) phi_o'(v)),

so that minimum and saddle meet where R'(v) = 0: one equation, solved to 50 digits.  The package's own way does not
know the branch: it solves the KKT system of the model together with g = 0, where g vanishes exactly when the KKT
matrix is singular (bordered system; Griewank and Reddien 1984).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.hard_case import HardCase, Measured, Outcome
from origami_nlp.kkt import State, classify, newton
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.problem import Model

REST = -3.0
"""Rest angle of every crease [rad]: the ratio is then stationary along the branch."""
MOST_STEPS = 40
NEAR = -0.4636
"""Elevation [rad] near which it is."""


def ratio_scene(ratio: float, symmetry: str = "D3") -> Scene:
    """Equal sectors of pi/3, k_odd / k_even = ratio, every crease at rest at -3 rad."""
    root = math.sqrt(ratio)
    return Scene(Vertex((math.pi / 3,) * 6), (root, 1 / root) * 3, (REST,) * 6, symmetry)


def exact_fold_point(digits: int = 50) -> tuple[Any, Any, Any]:
    """Return (ratio, elevation, odd fold angle) where minimum and saddle meet, to `digits`."""
    with mp.workdps(digits + 20):
        slope = mp.cot(mp.pi / 4 - mp.pi / 6)  # alpha = pi/3; steep root of the partial fold angle

        def odd(v: Any) -> Any:
            return -4 * mp.atan(mp.tan(v / 2) * slope)

        def odd_slope(v: Any) -> Any:
            t = mp.tan(v / 2)
            return -2 * slope * (1 + t**2) / (1 + (t * slope) ** 2)

        def ratio(v: Any) -> Any:
            return -2 * (2 * v - REST) / ((odd(v) - REST) * odd_slope(v))

        h = mp.mpf(10) ** -30
        v = mp.findroot(lambda v: (ratio(v + h) - ratio(v - h)) / (2 * h), mp.mpf(NEAR))
        return +ratio(v), +v, +odd(v)


@dataclass(frozen=True)
class FoldPoint:
    """Where minimum and saddle meet: ratio, variables x [n], null direction [n] of the KKT matrix, Newton steps."""

    ratio: float
    x: np.ndarray
    direction: np.ndarray
    steps: int


def find_fold_point(start: np.ndarray, ratio: float, symmetry: str = "D3") -> FoldPoint:
    """Solve KKT and singular KKT matrix for (x, multipliers, log ratio) by Newton from a rough guess.

    Raises
    ------
    ValueError
        If Newton does not converge.
    """
    n, y = len(start), np.append(start, math.log(ratio))
    model = Model(ratio_scene(ratio, symmetry))
    local = model.local(start)
    lam = np.linalg.lstsq(local.closure_jacobian.T, local.gradient * model.scale, rcond=None)[0]
    y = np.concatenate([start, lam, [math.log(ratio)]])
    border: tuple[np.ndarray, np.ndarray] | None = None

    def system(y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the residual and the KKT matrix, in the scene's units, and the singular vector."""
        model = Model(ratio_scene(math.exp(y[-1]), symmetry))
        x, lam = y[:n], y[n:-1]
        local = model.local(x)
        jac, scale = local.closure_jacobian, model.scale
        gradient = scale * local.gradient - jac.T @ lam
        gaps = np.zeros(len(model.structure.gaps))
        hessian = scale * model.hessian(x, -lam / scale, gaps)
        matrix = np.block([[hessian, -jac.T], [-jac, np.zeros((len(jac), len(jac)))]])
        return np.concatenate([gradient, local.closure]), matrix, x

    def residual(y: np.ndarray) -> np.ndarray:
        f, matrix, _ = system(y)
        assert border is not None
        b, c = border
        bordered = np.block([[matrix, b[:, None]], [c[None], np.zeros((1, 1))]])
        g = np.linalg.solve(bordered, np.append(np.zeros(len(f)), 1.0))[-1]
        return np.append(f, g)

    for steps in range(1, MOST_STEPS + 1):  # noqa: B007
        _, matrix, _ = system(y)
        u, _, vt = np.linalg.svd(matrix)
        border = (u[:, -1], vt[-1])
        h = 1e-6
        jac = np.column_stack(
            [(residual(y + h * e) - residual(y - h * e)) / (2 * h) for e in np.eye(len(y))]
        )
        move = -np.linalg.solve(jac, residual(y))
        move *= min(1.0, 0.2 / float(np.abs(move).max()))
        y = y + move
        if np.abs(move).max() <= 1e-13:
            break
    else:
        raise ValueError("the augmented system did not converge")
    direction = vt[-1][:n] / np.linalg.norm(vt[-1][:n])
    return FoldPoint(math.exp(y[-1]), y[:n], direction, steps)


def _guess() -> np.ndarray:
    """Odd and even fold angles at the rounded elevation, good to a few hundredths."""
    return np.array([2.85, 2 * NEAR])


def beside(point: FoldPoint, ratio: float, symmetry: str = "D3") -> list[tuple[np.ndarray, str]]:
    """Return the critical states near a fold point at another ratio, with their verdicts."""
    model: Model = Model(ratio_scene(ratio, symmetry))
    reach = math.sqrt(abs(ratio / point.ratio - 1))
    found: list[tuple[np.ndarray, str]] = []
    for factor in (0.25, 0.5, 1.0, 2.0, 4.0, 8.0):
        for sign in (1, -1):
            state, _ = newton(model, point.x + sign * factor * reach * point.direction, ())
            if state is None or not state.converged:
                continue
            near = np.abs(state.x - point.x).max() <= 50 * reach
            if near and all(np.abs(state.x - x).max() > 1e-3 * reach for x, _ in found):
                found.append((state.x, classify(State(model, state.x)).verdict))
    return sorted(found, key=lambda pair: float(pair[0][0]))


def _fold_point() -> Iterator[Outcome]:
    exact, elevation, odd = exact_fold_point()
    point = find_fold_point(_guess(), 0.16)
    error = float(abs(mp.mpf(point.ratio) / exact - 1))
    angles = max(abs(point.x[0] - float(odd)), abs(point.x[1] - 2 * float(elevation)))
    measured = (Measured("r_k", error, 1e-8), Measured("angles", angles, 1e-8))
    verdict = f"r_k = {point.ratio:.12g}, closed form {mp.nstr(exact, 20)}"
    yield Outcome("augmented system", measured, verdict, True, note=f"{point.steps} Newton steps")
    for power in (-4, -6, -8, -10, -12):
        distance = 10.0**power
        for side in (-1, 1):
            ratio = float(exact * (1 + side * mp.mpf(10) ** power))
            states = beside(point, ratio)
            verdicts = sorted(v for _, v in states)
            gone = not verdicts
            pair = verdicts == ["minimum", "saddle"]
            expected = pair if _exists(side) else gone
            verdict = " and ".join(verdicts) or "no critical state near"
            checks: tuple[Measured, ...] = ()
            if pair:
                apart = float(np.abs(states[0][0] - states[1][0]).max())
                verdict += f", {apart:.1e} rad apart"
                worst = max(_elevation_error(x, ratio) for x, _ in states)
                # the ratio moves the states as its square root: rounding of r counts as eps / sqrt(distance)
                allowed = max(1e-14, 20 * np.finfo(float).eps / math.sqrt(distance))
                checks = (Measured("angles", worst, allowed),)
            yield Outcome(
                f"r_k = r* (1 {'+' if side > 0 else '-'} 1e{power})", checks, verdict, expected
            )


def _exists(side: int) -> bool:
    """Return on which side of the fold point the pair exists: from the curvature of R(v), in closed form."""
    ratio, v, _ = exact_fold_point()
    return (_ratio_at(v + mp.mpf("1e-3")) - ratio) * side > 0


def _ratio_at(v: Any) -> Any:
    slope = mp.cot(mp.pi / 12)
    t = mp.tan(v / 2)
    odd, odd_slope = -4 * mp.atan(t * slope), -2 * slope * (1 + t**2) / (1 + (t * slope) ** 2)
    return -2 * (2 * v - REST) / ((odd - REST) * odd_slope)


def _elevation_error(x: np.ndarray, ratio: float) -> float:
    """Distance of a state from the closed-form stationary elevation beside it at this ratio."""
    with mp.workdps(40):
        v = mp.findroot(lambda v: _ratio_at(v) - mp.mpf(ratio), mp.mpf(float(x[1])) / 2, tol=1e-50)
        return float(abs(2 * v - mp.mpf(float(x[1]))))


FOLD_POINT_CASES = (
    HardCase(
        "a minimum about to annihilate with a saddle",
        "the KKT matrix is singular at the meeting; just before it, eigenvalues and distances shrink as sqrt(r - r*)",
        "on a cone branch the stationary elevations solve r = R(v): the meeting is R'(v) = 0, to 50 digits",
        "r* to 1e-8 from the augmented KKT system; a minimum and a saddle on one side, nothing on the other",
        _fold_point,
    ),
)
