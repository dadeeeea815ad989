"""Where a published state closes that does not close where it should: other sector angles, other signs of pi."""

from __future__ import annotations

import itertools
import math

import numpy as np

from origami_nlp.closed_forms import wedge3
from origami_nlp.folding import check_admissible
from origami_nlp.numerics import ROUNDED, quaternion as quat
from origami_nlp.pattern import Vertex, format_angle
from studies.published import INDEPENDENT, PRINTED


def closing_alphas(degree: int, independent: np.ndarray, scan: int = 2000) -> tuple[float, ...]:
    """Return every sector angle alpha_1 of the paper's family at which a state closes.

    Local minima of |vec q|^2 over alpha_1 in (0, pi/2) are refined by Gauss-Newton.  Angles within `PRINTED` of a
    multiple of pi/12 are returned as that multiple.
    """
    phi = independent[list(INDEPENDENT[degree])]
    alphas = np.linspace(0.0, math.pi / 2, scan + 1)[1:-1]
    size = np.linalg.norm(_defect(degree, phi, alphas), axis=-1)
    padded = np.concatenate([[np.inf], size, [np.inf]])
    low = np.flatnonzero((padded[1:-1] <= padded[:-2]) & (padded[1:-1] <= padded[2:]))
    found: list[float] = []
    for alpha in alphas[low]:
        a = float(alpha)
        for _ in range(40):
            h = 1e-6
            f, up, down = _defect(degree, phi, np.array([a, a + h, a - h]))
            slope = (up - down) / (2 * h)
            change = float(slope @ f) / max(float(slope @ slope), 1e-300)
            a -= float(np.clip(change, -1e-3, 1e-3))
            if abs(change) < 10 * ROUNDED:
                break
        if not 0 < a < math.pi / 2:
            continue
        twelfth = round(a / (math.pi / 12)) * (math.pi / 12)
        if abs(a - twelfth) <= PRINTED:
            a = twelfth
        if float(np.linalg.norm(_defect(degree, phi, np.array([a]))[0])) > PRINTED:
            continue
        if all(abs(a - b) > PRINTED for b in found):
            found.append(a)
    return tuple(sorted(found))


def mean_of_rows(independent: np.ndarray, step: float = math.pi / 128) -> float | None:
    """Return alpha_1 where a degree-8 state is the mean of the states at elevations +step and -step, or None.

    A grid that fills its row of elevation zero with the mean of the two rows next to it lists points that are no
    states: the mean of two closed states does not close.
    """
    phi1, phi2, phi3 = independent
    for k in range(1, 6):
        alpha = k * math.pi / 12
        rows = [
            [wedge3(2, alpha, v, phi2, branch).value for branch in (1, -1)] for v in (step, -step)
        ]
        for up, down in itertools.product(*rows):
            if np.abs((up + down) / 2 - (phi1, phi3)).max() <= PRINTED:
                return alpha
    return None


def named_alpha(alpha: float) -> str:
    """Write a multiple of pi/12 as such, another angle with four decimals."""
    text = format_angle(alpha)
    return text if "pi" in text else f"{alpha:.4f}"


def other_sides(
    vertex: Vertex, independent: np.ndarray, degree: int, tolerance: float
) -> np.ndarray | None:
    """Return the state with other signs of its +-pi that is admissible, fewest changes first; or None."""
    at_pi = np.flatnonzero(np.abs(np.abs(independent) - math.pi) <= tolerance)
    for count in range(1, len(at_pi) + 1):
        for flipped in itertools.combinations(at_pi, count):
            y = independent.copy()
            y[list(flipped)] *= -1
            if check_admissible(
                vertex, y[list(INDEPENDENT[degree])], tolerance=tolerance
            ).admissible:
                return y
    return None


def _defect(degree: int, phi: np.ndarray, alphas: np.ndarray) -> np.ndarray:
    """Return vec q of all folds for each alpha_1, shape [alphas, 3]."""
    b = math.pi - 2 * alphas if degree == 6 else math.pi / 2 - alphas
    a = alphas
    sectors = (a, b, a, a, b, a) if degree == 6 else (a, b, b, a, a, b, b, a)
    azimuth = np.zeros_like(alphas)
    q = tuple(np.full_like(alphas, v) for v in quat.IDENTITY)
    for angle, sector in zip(phi, sectors, strict=True):
        axis = (np.cos(azimuth), np.sin(azimuth), np.zeros_like(azimuth))
        q = quat.multiply(q, quat.fold(math.cos(angle / 2), math.sin(angle / 2), axis))
        azimuth = azimuth + sector
    return np.stack(q[1:], axis=-1)
