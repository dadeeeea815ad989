"""Minima of cone branches, one by one: against IPOPT, 50 digits and sums over creases."""

import math

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

from origami_nlp.paper import cone
from tests.computed_once import thinned
from tests.independent import cone_branches as brute


def tighten(nlp):
    options = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-12}}
    options["ipopt"]["bound_relax_factor"] = 0.0
    options["ipopt"]["hessian_approximation"] = "exact"
    return ca.nlpsol("solver", "ipopt", nlp, options)


def closed_loop(phi):
    """Vector part of the product of all folds as a quaternion."""
    q = (1, 0, 0, 0)
    n = phi.shape[0]
    for i in range(n):
        c, s = ca.cos(phi[i] / 2), ca.sin(phi[i] / 2)
        x, y = s * math.cos(2 * math.pi * i / n), s * math.sin(2 * math.pi * i / n)
        a, b, d, e = q
        q = (
            a * c - b * x - d * y,
            a * x + b * c - e * y,
            a * y + d * c + e * x,
            b * y - d * x + e * c,
        )
    return ca.vertcat(*q[1:])


@pytest.mark.parametrize("word", [(1, 1, 1), (1, 1, -1), (1, -1, -1), (-1, -1, -1)])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_degree_6_branch_equals_an_ipopt_solve_of_the_closed_vertex(word, direction):
    """All six fold angles are free; closure and equal even folds leave the branch: no closed form."""
    r, v = 0.4, -0.35
    m = cone.count(6, r, v).minima
    valleys, changes = cone.class_of(word)
    own = m.of_class(valleys, changes, direction)
    phi, s = ca.SX.sym("phi", 6), ca.SX.sym("s")
    rest = brute.rest_angles(6, v)
    stiffness = [1.0, r] * 3
    energy = sum(stiffness[i] * (phi[i] - rest[i]) ** 2 / 2 for i in range(6))
    ties = ca.vertcat(*[phi[2 * j + 1] + 2 * word[j] * s for j in range(3)])
    end = brute.branch_end(6, word, direction)
    solver = tighten(
        {"x": ca.vertcat(phi, s), "f": energy, "g": ca.vertcat(closed_loop(phi), ties)}
    )
    start = float(np.abs(m.elevation[own][0])) * 0.9 + 0.02 if own.any() else end / 2
    angles = brute.cone_fold_angles(6, direction * start, word).value
    answer = solver(
        x0=[*angles, start],
        lbx=[-math.pi] * 6 + [1e-3],
        ubx=[math.pi] * 6 + [end],
        lbg=0,
        ubg=0,
    )
    found = float(answer["x"][6])
    if own.any():
        k = int(np.argmin(np.abs(np.abs(m.elevation[own]) - found)))
        assert abs(m.elevation[own][k]) == pytest.approx(found, abs=1e-7)
        assert m.energy[own][k] == pytest.approx(float(answer["f"]), rel=1e-8, abs=1e-10)
    else:
        assert found == pytest.approx(1e-3, abs=1e-8)  # pressed against the lower bound


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
            direction = int(m.direction[k])
            side = cone.SideEnergy.of(degree, direction, elevation)
            row = int(
                np.nonzero((side.valleys == m.valleys[k]) & (side.changes == m.changes[k]))[0][0]
            )
            args = (degree, direction, side.weights[row].tolist(), int(m.valleys[k]), ratio)
            s = abs(m.elevation[k])
            if not m.interior[k]:
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
            for direction in (1, -1):
                side = cone.SideEnergy.of(cone.Cone(degree, rest), direction, -0.3)
                odd, even = side.at(s).slopes
                free = np.where(np.arange(degree) % 2 == 0, side.rest.odd, side.rest.even)
                for flaps, d in brute.branches(degree):
                    if d != direction:
                        continue
                    row = cone.assignment_classes(degree).index(flaps)
                    angles = brute.cone_fold_angles(degree, d * s, flaps)
                    terms = (angles.value - free) * d * angles.first
                    np.testing.assert_allclose(odd[row], terms[:, ::2].sum(axis=1), rtol=1e-11)
                    np.testing.assert_allclose(even[row], terms[:, 1::2].sum(axis=1), rtol=1e-11)
                h = 1e-5
                for value, derivative in (
                    ("energies", "slopes"),
                    ("slopes", "curvatures"),
                ):
                    for kind in (0, 1):
                        above, below, slope = (
                            getattr(side.at(x), name)[kind]
                            for x, name in ((s + h, value), (s - h, value), (s, derivative))
                        )
                        step = (above - below) / (2 * h)
                        np.testing.assert_allclose(slope, step, rtol=1e-6, atol=1e-6)
                wells, energies, flat = side.at(s).wells, side.at(s).energies, side.at(s).flat
                for kind in (0, 1):
                    np.testing.assert_allclose(
                        wells[kind], flat[kind] - energies[kind], rtol=1e-9, atol=1e-11
                    )
