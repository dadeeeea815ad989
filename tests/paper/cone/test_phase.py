"""Phase boundaries of cones: different counts on either side, and nothing but boundaries where counts change."""

import itertools
import json
import math

import numpy as np
import pytest

from origami_nlp.paper import cone
from origami_nlp.paper.cone.phase_curves import KINDS
from tests.command_line import run

SIDE = 1e-9
SLOW = pytest.mark.slow


def counts_of(branches, ratio, nu, depth):
    """Minima of one class: (inside, at its end)."""
    found = cone.count(branches.cone, ratio, nu, depth=depth).minima
    own = found.of_class(branches.valleys, branches.changes, branches.direction)
    return int((own & found.interior).sum()), int((own & ~found.interior).sum())


def sample(curve, many, rng):
    """Points of a curve away from its ends and from the largest ratios."""
    inner = np.arange(1, len(curve.ratio) - 1)
    inner = inner[(curve.ratio[inner] > 1e-4) & (curve.ratio[inner] < 1e4)]
    return rng.choice(inner, min(many, len(inner)), replace=False) if len(inner) else inner


@pytest.mark.parametrize("degree", [6, *(pytest.param(n, marks=SLOW) for n in (8, 10, 12))])
def test_counts_differ_on_both_sides_of_every_boundary(degree):
    rng = np.random.default_rng(degree)
    kinds = set()
    for curve in cone.phase_boundaries(degree, lines=60):
        for k in sample(curve, 3, rng):
            nu, ratio = float(curve.rest_elevation[k]), float(curve.ratio[k])
            sides = [counts_of(curve.branches, ratio * (1 + s * SIDE), nu, 0.0) for s in (-1, 1)]
            assert sides[0] != sides[1], (curve, nu, ratio)
            assert curve.kind == "end" or abs(sum(sides[0]) - sum(sides[1])) == 1
            kinds.add(curve.kind)
    assert {"start", "end"} <= kinds


@pytest.mark.parametrize("rest", ["waterbomb", "paper"])
def test_rest_angles_of_many_are_those_of_one(rest):
    low, high = cone.Cone(12, rest).rest_range
    nu = np.linspace(low, high, 41)[1:-1]
    odd, even = cone.Cone(12, rest).rest_angles(nu)
    single = [cone.Cone(12, rest).at_rest(float(v)) for v in nu]
    assert np.allclose(odd, [s.odd for s in single], rtol=1e-15, atol=0)
    assert np.allclose(even, [s.even for s in single], rtol=1e-15, atol=0)


def test_printed_plateaus_agree_with_the_symbolic_claims():
    """s5.plateau-N counts branches of finite depth as r -> infinity; so do the maps."""
    from origami_nlp.symbolic.claims.section5 import stiff_even_minima

    for degree in (6, 8):
        counts = cone.count_map(degree, [1e7], [0.3, -0.3], depth=1e-3)
        assert (counts.total == stiff_even_minima(degree // 2)).all()


def test_command_writes_map_and_boundaries(tmp_path):
    files = {k: tmp_path / f"phase.{k}" for k in ("png", "csv", "json")}
    wanted = [f"--output={file}" for file in files.values()]
    result = run(*"paper cone phase --degree 8 --size 6".split(), *wanted)
    assert result.code == 0, result.err
    reported = json.loads(files["json"].read_text())
    assert reported["schema"] == "origami-nlp/paper/1" and reported["branches"] == "32"
    assert {b["kind"] for b in reported["boundaries"]} <= set(KINDS)
    rows = np.loadtxt(files["csv"], delimiter=",", skiprows=1)
    assert len(rows) == 36
    for nu, ratio, *numbers in rows[::17]:
        count = cone.count(8, ratio, nu)
        assert numbers == [count.stable_interior, count.stable_contact, count.falling_at_cut]
    assert np.array(reported["interior"]).shape == (6, 6)
    assert files["png"].stat().st_size > 10_000


def test_diagram_counts_only_inside_when_asked():
    both, inside = (cone.phase_diagram(6, size=5, contact=c) for c in (True, False))
    assert (both.minima == both.map.interior + both.map.contact + both.map.cut).all()
    assert (inside.minima == both.map.interior).all() and (inside.minima < both.minima).any()


M2V_REGIONS = (((math.pi / 8, math.pi / 6), 0.7), ((-math.pi / 2, -math.pi / 36), 7.0))
"""Where M_2V up is said to be stable "for nearly every parameter set": nu_0 and the largest r."""


def m2v_shares(direction: int, mirror: int, size: int = 4) -> list[float]:
    """Share of each region in which M_2V of degree 6 holds an interior minimum deeper than 1e-3.

    direction: +1 up, -1 down in our convention.  mirror: -1 where nu_0 is minus the paper's.
    """
    branches = next(b for b in cone.energy_classes(6) if (b.valleys, b.direction) == (1, direction))
    first, last = cone.Cone(6).rest_range
    cells = (np.arange(size) + 0.5) / size
    shares = []
    for (low, high), top in M2V_REGIONS:
        nu = mirror * (low + (high - low) * cells)
        grid = itertools.product(0.01 * (top / 0.01) ** cells, nu[(first < nu) & (nu < last)])
        shares.append(float(np.mean([counts_of(branches, r, v, 1e-3)[0] > 0 for r, v in grid])))
    return shares


def test_m2v_up_never_holds_a_minimum_in_our_convention():
    """Both A and B climb from the flat state on M_2V up; the paper's sentence fits M_2V down."""
    assert m2v_shares(1, -1) == m2v_shares(1, 1) == [0, 0]
    assert m2v_shares(-1, 1)[0] > m2v_shares(-1, -1)[0]
