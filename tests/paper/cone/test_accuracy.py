"""Minima of cone branches, one by one: against IPOPT, 50 digits and sums over creases."""

import mpmath as mp
import numpy as np
import pytest

from origami_nlp.paper import cone
from tests.computed_once import thinned

# ---------------------------------------------------------------- digits


def slope_mp(degree, direction, weights, valleys, r, v, s):
    """F at 50 digits from arctangents, and the terms it sums."""
    n = degree // 2
    k = mp.tan(mp.pi / 4 - mp.pi / degree)
    big = mp.tan(2 * mp.pi / degree)

    def sizes(x):
        t = mp.tan(x / 2)
        return [4 * mp.atan(k * t), 4 * mp.atan(t / k), 2 * mp.atan(big * mp.sin(x))]

    def first(x):
        t2 = mp.tan(x / 2) ** 2
        return [
            2 * k * (1 + t2) / (1 + k**2 * t2),
            2 * k * (1 + t2) / (k**2 + t2),
            2 * big * mp.cos(x) / (1 + big**2 * mp.sin(x) ** 2),
        ]

    odd = sizes(abs(v))[0 if v > 0 else 1]
    g = direction * odd
    terms = [
        w * (z + c * g) * d
        for w, z, c, d in zip(weights, sizes(s), (-1, 1, 1), first(s), strict=True)
    ]
    even = r * 2 * (valleys * (2 * s - 2 * abs(v)) + (n - valleys) * (2 * s + 2 * abs(v)))
    return sum(terms) + even


@pytest.mark.parametrize("degree", thinned([10, 6, 1000], 3))
@pytest.mark.parametrize("elevation", [1e-10, -0.4])
def test_minima_agree_with_50_digits(degree, elevation):
    ratio = 0.7
    found = cone.count(degree, ratio, elevation)
    m = found.minima
    rng = np.random.default_rng(0)
    with mp.workdps(50):
        for k in rng.choice(len(m), min(len(m), 8), replace=False).tolist():
            own = m.branches[k]
            weights = own.odd_creases.tolist()
            args = (degree, int(own.direction), weights, int(own.valleys), ratio)
            s = abs(m.elevation[k])
            if m.kind[k] != "interior":
                value = -slope_mp(*args, mp.mpf(elevation), mp.mpf(float(s)))
                assert float(value) == pytest.approx(m.multiplier[k], rel=1e-12)
            else:
                root = mp.findroot(
                    lambda x, args=args: slope_mp(*args, mp.mpf(elevation), x),
                    (mp.mpf(s), mp.mpf(s) * (1 + mp.mpf(10) ** -6)),
                    tol=mp.mpf(10) ** -80,
                )
                assert float(abs(root - s) / root) < 1e-12
