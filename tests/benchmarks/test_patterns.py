"""Error against time on whole patterns: the reference, and where the methods end."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import origami_nlp as o
from benchmarks.patterns import measure_patterns, patterns_table, task, wide_closure
from origami_nlp.pattern_problem import Closure

WIDE = np.finfo(np.longdouble).eps < 1e-18


def miura_state(pattern, acute=math.pi / 3):
    """State of least energy of a Miura sheet with equal springs.

    Straight creases fold by h, zigzags by z, tan(h/2) = cos(acute) tan(z/2): one unknown.
    """
    straight = np.abs(pattern.directions[:, 1]) < 1e-9
    rest = float(np.abs(pattern.rest).max())

    def row(z):
        return 2 * math.atan(math.cos(acute) * math.tan(z / 2))

    def slope(z):
        t = math.cos(acute) * math.tan(z / 2)
        turn = math.cos(acute) / math.cos(z / 2) ** 2 / (1 + t * t)
        return straight.sum() * (row(z) - rest) * turn + (~straight).sum() * (z - rest)

    z = brentq(slope, 1e-6, math.pi - 1e-6, xtol=1e-15, rtol=1e-15)
    return pattern.signs * np.where(straight, row(z), z)


@pytest.mark.parametrize("size", [4, 8])
def test_the_reference_is_the_closed_form(size):
    one = task(f"miura:{size}x{size}")
    assert one.residual < (1e-17 if WIDE else 1e-14)
    assert np.abs(one.exact - miura_state(one.sheet.pattern)).max() < 5e-16


@pytest.mark.parametrize(("name", "size"), [("waterbomb", (2, 2)), ("metasheet", (3, 2))])
def test_extended_closure_is_that_of_the_package(name, size):
    """Off closure too; quaternions cut at each crease, against the package's closed-form derivatives."""
    pattern = o.examples.pattern(name, *size)
    rng = np.random.default_rng(3)
    phi, own = rng.uniform(-2, 2, pattern.creases), Closure(pattern)
    lam = rng.normal(size=own.count)
    closure, pull = wide_closure(pattern, phi.astype(np.longdouble), lam)
    assert np.abs((closure - own.values(phi)).astype(float)).max() < 1e-14
    assert np.abs((pull - own.jacobian(phi).T @ lam).astype(float)).max() < 1e-13


def test_methods_end_where_they_should():
    data = measure_patterns(["miura:4x4"])
    last = {p["method"]: p for p in data["points"]}
    assert last["this package"]["angle"] < 1e-12 and last["this package"]["closure"] < 1e-12
    # elastic rows give way by multipliers over the penalty, 1e8
    assert 1e-11 < last["IPOPT, elastic rows"]["angle"] < 1e-6
    refused = last["IPOPT, all rows"]
    assert math.isnan(refused["angle"]) and "Not_Enough_Degrees" in refused["status"]
    assert [row[0] for row in patterns_table(data).rows] == ["miura:4x4"] * 3
