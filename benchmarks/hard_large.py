"""Hard cases of size: wedges of a vertex with 60 creases, and the cone with 1000 creases next to the flat state."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.hard_case import HardCase, Measured, Outcome
from benchmarks.hard_springs import against_50_digits
from origami_nlp.closed_forms import cone_fold_angles
from origami_nlp.minima import find_minima
from origami_nlp.numerics import quaternion as quat
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.problem import Model

DEGREE = 60
STARTS = 150
"""Cap on random starts: completeness is not the question here."""


def _wedge_scene(group: str, period: int, contact: str) -> Scene:
    """60 equal sectors; stiffness and rest angles repeat after `period` creases, mirrored for D_n."""
    j = np.arange(DEGREE) % period
    if group == "D":
        j = np.minimum(j, period - j)  # both ends of the wedge lie on creases
    stiffness = 1.0 + 0.5 * np.cos(1.3 * j)
    rest = 1.2 * np.cos(np.pi * j) * (1 - 0.1 * j)
    name = f"{group}{DEGREE // period}"
    vertex = Vertex((2 * math.pi / DEGREE,) * DEGREE)
    return Scene(vertex, tuple(stiffness.tolist()), tuple(rest.tolist()), name, contact)  # type: ignore[arg-type]


def _wedges() -> Iterator[Outcome]:
    for group, period in (("D", 2), ("D", 4), ("D", 6), ("C", 3), ("C", 4)):
        for contact in ("fold-limits", "full"):
            if group == "C" and contact == "full":
                continue
            scene = _wedge_scene(group, period, contact).of_one_winding
            result = find_minima(scene, max_starts=STARTS)
            title = f"{scene.group.name}, {Model(scene).size} fold angles, contact {contact}"
            outcome = against_50_digits(title, result, 1e-12)
            whole = [_closure(np.array(m.fold_angles)) for m in result.minima]
            closes = Measured("closure of all 60 folds", max(whole, default=0.0), 1e-12)
            words = f"{len(result.minima)} minima"
            yield replace(outcome, measured=(*outcome.measured, closes), verdict=words)


def _closure(fold_angles: np.ndarray) -> float:
    """Largest entry of q - 1 for the product of all folds of a vertex with equal sectors."""
    n = len(fold_angles)
    q: tuple[Any, ...] = (1.0, 0.0, 0.0, 0.0)
    for j, phi in enumerate(fold_angles):
        azimuth = 2 * math.pi * j / n
        axis = (math.cos(azimuth), math.sin(azimuth), 0.0)
        q = quat.multiply(q, quat.fold(math.cos(phi / 2), math.sin(phi / 2), axis))
    return max(abs(abs(q[0]) - 1), *(abs(v) for v in q[1:]))


def _exact_cone(degree: int, elevation: float, flaps: tuple[int, ...]) -> list[Any]:
    """All fold angles of the cone to 50 digits: partial angles from cos of spherical triangles.

    A flap is two arcs of length a = 2 pi / N whose ends stand pi/2 + v from the axis and whose tip stands
    pi/2 - v .. : solved here from the tangent half-angle form, whose closure is checked at 50 digits.
    """
    a, v = 2 * mp.pi / degree, mp.mpf(elevation)
    shallow = 2 * mp.atan(mp.tan(v / 2) * mp.tan(mp.pi / 4 - a / 2))
    steep = -2 * mp.atan(mp.tan(v / 2) * mp.cot(mp.pi / 4 - a / 2))
    direction = 1 if v >= 0 else -1
    rho = [shallow if direction * f > 0 else steep for f in flaps]
    out = []
    for j, f in enumerate(flaps):
        out += [rho[j - 1] + rho[j], -2 * direction * f * v]
    return out


def _closure_50(fold_angles: list[Any]) -> float:
    q: tuple[Any, ...] = (mp.mpf(1), mp.mpf(0), mp.mpf(0), mp.mpf(0))
    for j, phi in enumerate(fold_angles):
        azimuth = 2 * mp.pi * j / len(fold_angles)
        axis = (mp.cos(azimuth), mp.sin(azimuth), mp.mpf(0))
        q = quat.multiply(q, quat.fold(mp.cos(phi / 2), mp.sin(phi / 2), axis))
    return float(max(abs(v) for v in q[1:]))


def _cones() -> Iterator[Outcome]:
    for degree, elevation in (
        (1000, 1e-10),
        (1000, -1e-10),
        (1000, 1e-3),
        (1000, 1.0),
        (6, 1e-10),
        (60, 1e-10),
    ):
        n = degree // 2
        flaps = tuple(1 if (j * j) % 7 < 3 else -1 for j in range(n))
        ours = cone_fold_angles(degree, elevation, flaps).value
        with mp.workdps(60):
            exact = _exact_cone(degree, elevation, flaps)
            proof = _closure_50(exact)
            errors = [
                float(abs((mp.mpf(float(p)) - q) / q)) if q else abs(float(p))
                for p, q in zip(ours, exact, strict=True)
            ]
        # closure turns by the sum of all angle errors
        measured = (
            Measured("angles, relative", max(errors), 1e-14),
            Measured("closure", _closure(ours), 4 * degree * np.finfo(float).eps),
            Measured("closure of the closed form at 50 digits", proof, 1e-50),
        )
        verdict = f"largest fold angle {np.abs(ours).max():.3g} rad"
        yield Outcome(f"N = {degree}, elevation {elevation:g}", measured, verdict, True)


LARGE_CASES = (
    HardCase(
        "wedges of a vertex of degree 60",
        "a product of 60 folds; facets of 6 degrees that may meet all others",
        "50-digit solution of the wedge's KKT system at each minimum; the whole vertex must close as well",
        "fold angles to 1e-12",
        _wedges,
    ),
    HardCase(
        "cone next to the flat state, N = 1000",
        "arccos of the paper's partial fold angles loses half the digits near 1; 1000 folds add their errors",
        "tangent half-angle form, which closes to 50 digits",
        "fold angles to a relative 1e-14 at elevation 1e-10; closure to 4 N eps",
        _cones,
    ),
)
