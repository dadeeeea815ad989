"""Minima of cone branches, one by one: against IPOPT, 50 digits and sums over creases."""

import mpmath as mp
import numpy as np
import pytest

from origami_nlp.paper import cone
from tests.computed_once import thinned
from tests.independent import cone_branches as brute

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


def test_slopes_are_the_sum_over_creases():
    """A', B' of classes against every assignment's own fold angles; A'', B'' and energies by differences."""
    rng = np.random.default_rng(8)
    for degree in (6, 8, 10):
        s = rng.uniform(0.01, cone.Cone(degree).steep_end - 0.01, 5)
        for rest in ("waterbomb", "paper"):
            every = cone.Branches.of(cone.Cone(degree, rest))
            at_rest = every.cone.at_rest(-0.3)
            free = np.where(np.arange(degree) % 2 == 0, at_rest.odd, at_rest.even)
            for row in range(len(every)):

                def at(x, row=row, every=every, at_rest=at_rest):
                    return cone.BranchEnergy(every[[row]], at_rest, s=x)

                h = 1e-5
                for value, derivative in (("energies", "slopes"), ("slopes", "curvatures")):
                    for kind in (0, 1):
                        above, below = (getattr(at(x), value)[kind] for x in (s + h, s - h))
                        slope = getattr(at(s), derivative)[kind]
                        step = (above - below) / (2 * h)
                        np.testing.assert_allclose(slope, step, rtol=1e-6, atol=1e-6)
                wells, energies, flat = at(s).wells, at(s).energies, at(s).flat
                for kind in (0, 1):
                    np.testing.assert_allclose(
                        wells[kind], flat[kind] - energies[kind], rtol=1e-9, atol=1e-11
                    )
            for flaps, d in brute.branches(degree):
                mask = every.of_class(*cone.class_of(flaps), d)
                odd, even = cone.BranchEnergy(every[mask], at_rest, s=s).slopes
                angles = brute.cone_fold_angles(degree, d * s, flaps)
                terms = (angles.value - free) * d * angles.first
                np.testing.assert_allclose(odd, terms[:, ::2].sum(axis=1), rtol=1e-11)
                np.testing.assert_allclose(even, terms[:, 1::2].sum(axis=1), rtol=1e-11)
