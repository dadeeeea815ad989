"""The tracer on curves whose points, lengths and ends are known, none of them of a vertex."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from origami_nlp.continuation import CLOSED_CURVE, SINGULAR, ContinuationOptions, End, Trace, trace

STEPS = ContinuationOptions(first=1e-2, longest=0.1, shortest=1e-10, turn=0.05, sharpest=0.2)


@dataclass(frozen=True)
class At:
    x: np.ndarray
    tangent: np.ndarray
    bend: np.ndarray


@dataclass(frozen=True)
class Level:
    """The curve f(x) = 0 in a plane, from its gradient and Hessian; singular where the gradient vanishes."""

    f: Callable[[np.ndarray], float]
    gradient: Callable[[np.ndarray], np.ndarray]
    hessian: Callable[[np.ndarray], np.ndarray]

    @property
    def root(self) -> np.ndarray:
        return np.ones(2)

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        for _ in range(20):
            g = self.gradient(x)
            if abs(self.f(x)) <= 1e-15 * max(1.0, g @ g):
                return x
            if g @ g < 1e-20:
                return None
            x = x - self.f(x) * g / (g @ g)
        return None

    def frame(self, x: np.ndarray, along: np.ndarray) -> At | None:
        g = self.gradient(x)
        if (size := np.linalg.norm(g)) < 1e-9:
            return None
        t = np.array([-g[1], g[0]]) / size
        t = np.copysign(1.0, t @ along) * t
        return At(x, t, -(t @ self.hessian(x) @ t) * g / size**2)


CIRCLE = Level(lambda x: (x @ x - 1) / 2, lambda x: x, lambda x: np.eye(2))
# a state x under a load: load = x - x^3 turns back twice, at x = +-1 / sqrt(3)
SNAP = Level(
    lambda z: z[1] - z[0] + z[0] ** 3,
    lambda z: np.array([3 * z[0] ** 2 - 1, 1.0]),
    lambda z: np.array([[6 * z[0], 0.0], [0.0, 0.0]]),
)
CUSP = Level(
    lambda z: z[1] ** 2 - z[0] ** 3,
    lambda z: np.array([-3 * z[0] ** 2, 2 * z[1]]),
    lambda z: np.array([[-6 * z[0], 0.0], [0.0, 2.0]]),
)


def traced(
    curve: Level, start: tuple[float, float], steps: ContinuationOptions, *ends: End[At]
) -> Trace[At]:
    first = curve.frame(np.array(start), np.array([1.0, 1e-3]))
    assert first is not None
    found = trace(curve, first, steps, ends)
    assert found is not None
    return found


def leaves(low: float) -> End[At]:
    """The half-plane x > low."""
    return End(
        lambda points: next((k for k, p in enumerate(points) if p.x[0] < low), len(points)), "left"
    )


@pytest.mark.parametrize("angle", [0.0, 0.3, 2.0])
def test_a_closed_curve_ends_where_it_began_and_has_its_length(angle: float) -> None:
    start = (math.cos(angle), math.sin(angle))
    coarse, fine = (traced(CIRCLE, start, replace(STEPS, turn=turn)) for turn in (0.08, 0.02))
    for found in (coarse, fine):
        assert found.end == CLOSED_CURVE and found.behind == 0
        assert np.abs(found.states[-1] - start).max() == 0 == found.s[0]
        assert (np.diff(found.s) > 0).all() and np.diff(found.s).max() < 2 * STEPS.longest
        assert np.abs(np.linalg.norm(found.states, axis=1) - 1).max() < 1e-14
    errors = [abs(found.s[-1] - 2 * math.pi) for found in (coarse, fine)]
    assert errors[1] < 1e-7 and errors[1] < 0.02 * errors[0]  # the fourth power of the step


@pytest.mark.parametrize("together", [1, 12])
@pytest.mark.parametrize("low", [0.3, -0.5, -0.9999])
def test_an_end_is_bisected_to_the_shortest_step(low: float, together: int) -> None:
    found = traced(CIRCLE, (1.0, 0.0), replace(STEPS, together=together, turn=0.02), leaves(low))
    assert found.start == found.end == "left"
    assert (found.states[:, 0] >= low).all()
    slope = math.sqrt(1 - low * low)
    assert found.states[[0, -1], 0] - low == pytest.approx(0, abs=2 * STEPS.shortest * slope)
    assert found.s[[0, -1]] == pytest.approx([-math.acos(low), math.acos(low)], abs=1e-7)
    assert found.behind == int(np.flatnonzero(found.s == 0)[0])
    turning = np.sign([p.x[0] * p.tangent[1] - p.x[1] * p.tangent[0] for p in found.frames])
    assert abs((turning * found.signs).sum()) == len(
        found.s
    )  # one way round, once signs are counted


def test_a_curve_over_state_and_load_goes_around_its_turning_points() -> None:
    found = traced(SNAP, (0.0, 0.0), replace(STEPS, far=3.0), leaves(-1.0))
    load = found.states[:, 1]
    inner = np.abs(found.states[:, 0]) < 1
    assert load[inner].max() == pytest.approx(2 / math.sqrt(27), abs=1e-3)
    assert load[inner].min() == pytest.approx(-2 / math.sqrt(27), abs=1e-3)
    assert {found.start, found.end} == {"left", "longer than 3 rad"}


def test_a_cusp_ends_a_curve_as_singular() -> None:
    found = traced(CUSP, (1.0, 1.0), replace(STEPS, far=3.0))
    assert {found.start, found.end} == {SINGULAR, "longer than 3 rad"}
    assert np.linalg.norm(found.states, axis=1).min() < 1e-5
