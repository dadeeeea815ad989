"""Time to count the stable branches of a cone against its degree, beside brute force, each with its error.

Brute force folds every one of the 2^(N/2 + 1) branches on its own, on a grid of elevations, and counts
where the slope of the energy turns from falling to rising; its error is the number of points of the
(r_k, v_0) plane where it miscounts.  The error of the exact count is the largest relative error of the elevations of
its minima, against 40 digits.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from origami_nlp.closed_forms import cone_fold_angles
from origami_nlp.paper.cone import Cone, ConeMinima, assignment_classes, count, count_map

BRUTE_DEGREES = 18
"""Largest degree done by brute force (1,024 branches)."""
BRUTE_NODES = 200
MAP_DEGREES = (6, 8, 10, 12, 16, 50, 100)
MAP_SIZE = 400
SAMPLED = 12
"""Minima of each point compared with 40 digits."""


@dataclass(frozen=True)
class SpeedRow:
    """One degree of the table; CPU times in seconds, a point and a map of MAP_SIZE^2; None: not done.

    exact_error: largest relative error of an elevation; brute_wrong: points miscounted of `points`.
    """

    degree: int
    points: int
    classes: int
    exact_seconds: float
    exact_error: float
    brute_seconds: float | None
    brute_wrong: int | None
    map_seconds: float | None


def random_points(degree: int, number: int, seed: int) -> list[tuple[float, float]]:
    """Return (r_k, v_0): log-uniform in 1e-4 to 1e4, uniform in the range of the rest elevation."""
    rng = np.random.default_rng([seed, degree])
    ratios = 10 ** rng.uniform(-4, 4, number)
    return list(zip(ratios, rng.uniform(*Cone(degree).rest_range, number), strict=True))


def scan_branches(
    degree: int, ratio: float, elevation: float, nodes: int = BRUTE_NODES
) -> tuple[int, int]:
    """Count minima (inside, at the end) branch by branch on a grid of elevations."""
    cone = Cone(degree)
    rest = cone.at_rest(elevation)
    interior = contact = 0
    for direction in (1, -1):
        for flaps in product((1, -1), repeat=degree // 2):
            steep = sum(f != direction for f in flaps)
            end = float(cone.ends(steep))
            s = np.linspace(0.0, end, nodes + 1)[1:]
            angles = cone_fold_angles(degree, direction * s, flaps)
            terms = angles.value * angles.first * direction
            odd = (terms[:, ::2] - rest.odd * direction * angles.first[:, ::2]).sum(axis=1)
            even = (terms[:, 1::2] - rest.even * direction * angles.first[:, 1::2]).sum(axis=1)
            falls = odd + ratio * even < 0
            interior += int((falls[:-1] & ~falls[1:]).sum())
            contact += int(falls[-1])
    return interior, contact


def measure(
    degrees: Sequence[int],
    points: int = 5,
    seed: int = 0,
    maps: Sequence[int] = MAP_DEGREES,
    progress: Callable[[int], None] | None = None,
) -> list[SpeedRow]:
    """Time the methods on the same random points, one degree after the other."""
    rows = []
    for degree in degrees:
        assignment_classes.cache_clear()
        cases = random_points(degree, points, seed)
        start = time.process_time()
        counts = [count(degree, r, v) for r, v in cases]
        exact = (time.process_time() - start) / points
        error = max(
            elevation_error(degree, r, v, c.minima) for (r, v), c in zip(cases, counts, strict=True)
        )
        brute = wrong = plane = None
        if degree <= BRUTE_DEGREES:
            start = time.process_time()
            scanned = [scan_branches(degree, r, v) for r, v in cases]
            brute = (time.process_time() - start) / points
            pairs = [(c.stable_interior, c.stable_contact + c.falling_at_cut) for c in counts]
            wrong = sum(a != b for a, b in zip(scanned, pairs, strict=True))
        if degree in maps:
            start = time.process_time()
            v = np.linspace(*Cone(degree).rest_range, MAP_SIZE)
            count_map(degree, np.geomspace(1e-4, 1e4, MAP_SIZE), v)
            plane = time.process_time() - start
        size = len(assignment_classes(degree))
        rows.append(SpeedRow(degree, points, size, exact, error, brute, wrong, plane))
        if progress:
            progress(degree)
    return rows


def elevation_error(degree: int, ratio: float, elevation: float, minima: ConeMinima) -> float:
    """Return the largest relative error of some interior minima's elevations, against 40 digits.

    The slope is written out again from arctangents; one Newton step at 40 digits from a root good to
    1e-13 is good to 1e-25.
    """
    import mpmath as mp

    inside = np.nonzero(minima.interior)[0]
    rows = np.random.default_rng(0).permutation(inside)[:SAMPLED]
    n, worst = degree // 2, 0.0
    with mp.workdps(60):  # differences of energies lose 30
        k, big = mp.tan(mp.pi / 4 - mp.pi / degree), mp.tan(2 * mp.pi / degree)
        v0 = mp.mpf(elevation)

        def sizes(s: mp.mpf) -> list[mp.mpf]:
            t = mp.tan(s / 2)
            return [4 * mp.atan(k * t), 4 * mp.atan(t / k), 2 * mp.atan(big * mp.sin(s))]

        odd = sizes(abs(v0))[0 if v0 > 0 else 1]
        for row in rows.tolist():
            a, j = int(minima.valleys[row]), int(minima.changes[row]) // 2
            direction = int(minima.direction[row])
            p = a if direction > 0 else n - a
            weights, g = (p - j, n - p - j, 2 * j), direction * odd

            def energy(
                s: mp.mpf, a: int = a, weights: tuple[int, ...] = weights, g: mp.mpf = g
            ) -> mp.mpf:
                kinds = zip(weights, sizes(s), (-g, g, g), strict=True)
                even = a * (2 * s - 2 * abs(v0)) ** 2 + (n - a) * (2 * s + 2 * abs(v0)) ** 2
                return sum(w * (z + c) ** 2 for w, z, c in kinds) / 2 + ratio * even / 2

            s = mp.mpf(abs(float(minima.elevation[row])))
            h = s * mp.mpf(10) ** -10
            low, mid, high = energy(s - h), energy(s), energy(s + h)
            step = h * (high - low) / (2 * (high - 2 * mid + low))
            worst = max(worst, float(abs(step / s)))
    return worst
