"""Barriers of patterns between states that differ in the sign of a vertex: bounds, and paths that attain them."""

import itertools
import math
import time

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import origami_nlp as o
from origami_nlp.barriers.passes import LISTED, RIGID, SIGNED
from origami_nlp.barriers.traced import pattern_passes
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, classify
from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem, PopSigns, flat_with, least_flat_energy
from origami_nlp.pattern_states import list_flat_vertices
from tests.command_line import run
from tests.independent.search_sheets import sheet_of


def checked(found) -> None:
    """Paths lead from one minimum to the other, do not cross, climb as high as is said, and change signs where flat."""
    pattern, problem = found.result.pattern, PatternProblem(found.result.pattern)
    for p in found.passes:
        if not len(p.path):
            continue
        ends = [found.result.minima[k - 1].phi for k in (p.from_state, p.to_state)]
        assert all(np.abs(x - y).max() < 1e-6 for x, y in zip(p.path[[0, -1]], ends, strict=True))
        energies = pattern.energy(p.path)
        assert energies.max() == pytest.approx(p.energy, rel=1e-9)
        assert max(p.path_energy) == pytest.approx(p.energy, rel=1e-9)
        assert np.abs(np.diff(p.path, axis=0)).max() < 0.5
        for x in p.path:
            assert problem.residual(x) < 1e-12 and not problem.crossings.find(x)
        for vertex in PopSigns(pattern).vertices:
            around = (pattern.ends == vertex).any(axis=1)
            sides = np.sign(np.where(np.abs(s := p.path[:, around].sum(axis=1)) < 1e-9, 0, s))
            passed = [k for k in range(1, len(sides)) if sides[k - 1] * sides[k] < 0]
            assert not passed
            assert not np.abs(p.path[sides == 0][:, around]).any()


def test_the_barrier_of_a_yoshimura_vertex(tmp_path):
    """0.372454 J: the lowest state with the vertex flat, from which paths go down to both sides."""
    out = tmp_path / "barriers.json"
    done = run("barriers", "yoshimura:2x2", "-o", out)
    assert done.code == 0 and "0.3724538" in done.out and "over listed states" in done.out
    found = o.load(out)
    (p,) = found.passes
    assert p.energy == pytest.approx(0.372454, abs=1e-6) and p.why == LISTED
    pattern = found.result.pattern
    ((vertex, least, listed),) = [(b.vertex, b.least, b.listed) for b in found.flat_vertices]
    around = (pattern.ends == vertex).any(axis=1)
    by_hand = 0.5 * (pattern.stiffness * pattern.rest**2)[around].sum()
    assert least == p.least == pytest.approx(by_hand, rel=1e-12)
    assert least < listed == p.listed == pytest.approx(p.energy, rel=1e-12)
    checked(found)
    assert found.matrix().max() == p.energy and len(o.draw(found, tmp_path / "b.png").axes) == 1


def test_a_twist_passes_through_its_flat_state():
    """Generic vertices of degree 4: one flat, all flat; the closed form is the energy of the flat state."""
    found = o.find_barriers("squaretwist", o.find_minima("squaretwist", starts=4, escape=False))
    pattern = found.result.pattern
    flat = float(pattern.energy(np.zeros(pattern.creases)))
    exact = [p for p in found.passes if p.why == SIGNED]
    assert len(exact) == 6 and {p.pass_kind for p in exact} == {"flat state"}
    assert [p.energy for p in exact] == pytest.approx([flat] * 6, rel=1e-12)
    assert all(b.least == pytest.approx(flat, rel=1e-12) for b in found.flat_vertices)
    assert all(p.is_lowest for p in exact)
    checked(found)
    others = [p for p in found.passes if math.isinf(p.energy)]
    assert others and all(p.least == pytest.approx(flat) for p in others)
    assert str(found).count("no path ") == 44 and ">= " not in str(found)
    assert {p.why for p in others} == {RIGID} and len(others) == 22
    # fully folded states are isolated: what closes beside them is there, or beyond fold limits
    sheet, rng = sheet_of(pattern), np.random.default_rng(0)
    alone = [m for m in found.result.minima if not m.local_dimension]
    assert len(alone) == 4 and all((np.abs(m.phi) == math.pi).all() for m in alone)
    for m in alone:
        inward = -np.sign(m.phi) * rng.uniform(0, 0.1, (400, pattern.creases))
        states, closed = sheet.closed(m.phi + inward, 30)
        near = closed & (np.abs(states - m.phi).max(axis=1) < 0.3)
        assert near.sum() > 30 and math.isinf(m.escape.barrier if m.escape else math.inf)
        within = near & (np.abs(states) <= math.pi + 1e-9).all(axis=1)
        assert (np.abs(states[within] - m.phi).max(axis=1) < 1e-3).all()


@pytest.mark.parametrize("signs", ["-++-+-+++-++", "-++-+--+++--"])
def test_a_miura_folded_flat_at_all_creases_cannot_move(signs):
    """Planes of motions that closure leaves to second order are shut as well; what closes there is beyond limits."""
    pattern = as_pattern("miura:3x3")
    phi = np.array([math.pi if c == "+" else -math.pi for c in signs])
    what = classify(State(PatternProblem(pattern), phi))
    assert (what.verdict, what.local_dimension) == ("minimum", 0)
    assert what.reason.startswith("isolated: contact closes every direction that closure leaves to")
    rng = np.random.default_rng(0)
    inward = -np.sign(phi) * rng.uniform(0, 0.1, (1000, len(phi)))
    inward *= rng.uniform(size=inward.shape) < 0.5
    states, closed = sheet_of(pattern).closed(phi + inward, 30)
    near = closed & (np.abs(states - phi).max(axis=1) < 0.3)
    assert near.sum() > 900
    assert (np.abs(states[near]).max(axis=1) > math.pi + 1e-6).all()


def test_which_creases_are_flat_with_a_vertex():
    """All of a twist; of a Miura all but one line; of a waterbomb more than those round the vertex."""
    for name, many in (("squaretwist", {12}), ("miura:3x3", {9}), ("yoshimura:3x3", {6})):
        pattern = as_pattern(name)
        assert {int(flat_with(pattern, v).sum()) for v in PopSigns(pattern).vertices} == many
    resch = as_pattern("resch:1x2")
    more = {v: int(flat_with(resch, v).sum()) for v in PopSigns(resch).vertices}
    assert more == {0: 9, 4: 6, 7: 6}
    # whatever closes with the vertex flat has the others flat too
    problem, flat, rng = PatternProblem(resch), flat_with(resch, 0), np.random.default_rng(0)
    around = (resch.ends == 0).any(axis=1)
    for _ in range(5):
        start = np.where(around, 0.0, rng.uniform(-1, 1, resch.creases))
        found = least_squares(
            lambda x, a=around: problem.closure(np.where(a, 0.0, x))[0],
            start,
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
        )
        x = np.where(around, 0.0, found.x)
        if np.abs(found.fun).max() < 1e-9:
            assert np.abs(x[flat]).max() < 2e-3


@pytest.mark.parametrize("seed", range(3))
def test_a_side_of_half_a_turn_makes_a_lune(seed):
    """Own rotations: round a vertex with a sector of 180 degrees only its two collinear creases fold."""
    rng = np.random.default_rng(seed)
    sectors = np.r_[math.pi, rng.dirichlet(np.full(4, 3.0)) * math.pi]

    def off(phi):
        turn = Rotation.identity()
        for sector, fold in zip(sectors, phi, strict=True):
            turn = turn * Rotation.from_rotvec([fold, 0, 0]) * Rotation.from_rotvec([0, 0, sector])
        return turn.as_rotvec()

    for _ in range(10):
        found = least_squares(off, rng.uniform(-2, 2, 5), xtol=1e-15, ftol=1e-15, gtol=1e-15)
        if np.abs(found.fun).max() < 1e-10:
            assert np.abs(np.sin(found.x[2:] / 2)).max() < 1e-3  # a double root
            assert abs(math.sin((found.x[0] - found.x[1]) / 2)) < 1e-3


def test_bounds_are_below_every_closed_state_with_the_vertex_flat():
    """Random springs and states of a waterbomb, closed with one vertex flat."""
    pattern, rng = as_pattern("waterbomb:2x2"), np.random.default_rng(1)
    problem, seen = PatternProblem(pattern), 0
    for vertex in PopSigns(pattern).vertices:
        flat = flat_with(pattern, vertex)
        for _ in range(4):
            sprung = pattern.with_springs(
                rng.uniform(0.1, 2, len(flat)).tolist(), rng.uniform(-3, 3, len(flat)).tolist()
            )
            around = (pattern.ends == vertex).any(axis=1)
            x, residual = problem.project(
                np.where(around, 0.0, rng.uniform(-0.5, 0.5, len(flat))), around
            )
            if residual < 1e-12:
                seen += 1
                assert sprung.energy(x) >= least_flat_energy(sprung, flat)
    assert seen > 8


def test_what_has_no_bound_is_refused():
    """Facets that may cross, and no curve: nothing is known of barriers."""
    free = o.find_minima("yoshimura:2x2", contact="fold-limits", starts=2, escape=False)
    with pytest.raises(OptionError, match="no vertex has a sign"):
        o.find_barriers(free.pattern, free)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["yoshimura:3x3", "waterbomb:2x2", "miura:3x3"])
def test_no_path_is_below_a_bound(name):
    """Whole sheets: paths are checked state by state; none is below the closed form."""
    found = o.find_barriers(name)
    checked(found)
    for p in itertools.filterfalse(lambda p: math.isinf(p.energy), found.passes):
        assert math.isnan(p.least) or p.energy >= p.least * (1 - 1e-12)
    assert any(p.why in (SIGNED, LISTED) for p in found.passes)


@pytest.mark.slow
def test_traced_passes_are_not_below_bounds_in_closed_form():
    """Two hundred pairs of sheets with one degree of freedom and random springs: by traced curves alone."""
    pairs, exact, rng = 0, 0, np.random.default_rng(5)
    for name in itertools.cycle(("squaretwist", "miura:3x3", "metasheet:2x4")):
        if pairs >= 200:
            break
        plain = as_pattern(name)
        n = plain.creases
        springs = (10 ** rng.uniform(-1, 1, n)).tolist(), rng.uniform(-3, 3, n).tolist()
        pattern = plain.with_springs(*springs)
        result = o.find_minima(pattern, starts=0, escape=False)
        bounds = [least_flat_energy(pattern, flat_with(pattern, v)) for v in result.sign_vertices]
        known = pattern_passes(result)
        for p in known[0].passes if known else ():
            one, two = (result.signs[k - 1] for k in (p.from_state, p.to_state))
            least = [b for b, *pair in zip(bounds, one, two, strict=True) if set(pair) == {*"+-"}]
            if least and math.isfinite(p.energy):
                pairs += 1
                exact += p.energy <= max(least) * (1 + 1e-9)
                assert p.energy >= max(least) * (1 - 1e-9)
    assert exact > 0.5 * pairs


@pytest.mark.parametrize("seconds", np.geomspace(3e-3, 0.3, 8).round(4))
def test_searches_that_end_before_the_first_state(seconds):
    """With a vertex flat, on a sheet where other creases still fold: nothing is listed, the bounds stand."""
    pattern = as_pattern("miura:4x4")
    for known, whole in zip(
        list_flat_vertices(pattern, until=time.monotonic() + seconds),
        list_flat_vertices(pattern, search=False),
        strict=True,
    ):
        assert not known.flat.all() and known.least <= whole.least
        assert known.states.shape[1] == pattern.creases
