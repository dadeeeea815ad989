"""Hinge laws: pieces against formulas, minima against scans that share no code, no false state at the top of a well."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.errors import FoldFileError, OptionError, SceneError
from origami_nlp.inverse_design import Target, Targets
from origami_nlp.pattern import (
    HingeLaw,
    detent,
    double_well,
    linear,
    make_pattern,
    moved_cubic,
    one_sided,
    parse_fold,
    polynomial,
    read_law,
    sum_of,
    table,
    well,
)
from origami_nlp.pattern_problem import pose

EPS = np.finfo(float).eps

FORMULAS = [
    (linear(2.0, 0.5), lambda x: (x - 0.5) ** 2),
    (polynomial([1.0, 0.0, 0.3], 0.2), lambda x: 0.5 * (x - 0.2) ** 2 + 0.075 * (x - 0.2) ** 4),
    (well(1.5, 1.0, 0.4), lambda x: -1.5 * np.exp(-0.5 * ((x - 1.0) / 0.4) ** 2)),
    (double_well(2.0, 1.2, 0.1), lambda x: 2.0 * (((x - 0.1) / 1.2) ** 2 - 1) ** 2),
    (detent(0.4, 5, 0.3), lambda x: 0.2 * (1 - np.cos(5 * (x - 0.3)))),
    (well(1.0, 0.3071, 0.02), lambda x: -np.exp(-0.5 * ((x - 0.3071) / 0.02) ** 2)),
    (detent(1.0, 32), lambda x: 0.5 * (1 - np.cos(32 * x))),
]


@pytest.mark.parametrize(("law", "energy"), FORMULAS, ids=lambda one: getattr(one, "name", ""))
def test_pieces_are_the_formula(law, energy):
    x = np.linspace(-math.pi, math.pi, 1_001)
    exact = energy(x) - energy(np.linspace(-math.pi, math.pi, 200_001)).min()
    assert np.abs(law.energy(x) - exact).max() <= 2e-6 * exact.max()
    step = 1e-5
    slope = (energy(x[1:-1] + step) - energy(x[1:-1] - step)) / (2 * step)
    assert np.abs(law.torque(x[1:-1]) - slope).max() <= 1e-4 * np.abs(slope).max()
    # what is computed with them agrees to rounding: change, derivative, the other side of the paper
    # (the energy is a sum over pieces, each rounded)
    rounding = (1e-13 + EPS * len(law.breaks)) * exact.max()
    assert np.allclose(law.change(x[:-1], x[1:]), np.diff(law.energy(x)), rtol=0, atol=rounding)
    assert np.allclose(law.turned().energy(-x), law.energy(x), atol=1e-12 * exact.max())


def with_knots(law, knots):
    """The same law in more pieces."""
    x = np.unique(np.concatenate([law.breaks, knots]))
    own = np.clip(np.searchsorted(law.breaks, x[:-1], "right") - 1, 0, len(law.coefficients) - 1)
    c = moved_cubic(np.array(law.coefficients)[own].T, x[:-1] - np.array(law.breaks)[own]).T
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), law.name)


def work(law, a, b):
    """Energy at b less that at a in rational numbers."""

    def energy(x):
        piece, total = int(np.searchsorted(law.breaks[1:-1], x, "right")), Fraction(0)
        for k in range(piece + 1):
            p, q, r, s = (Fraction(v) for v in law.coefficients[k])
            h = Fraction(x if k == piece else law.breaks[k + 1]) - Fraction(law.breaks[k])
            total += (((p / 4 * h + q / 3) * h + r / 2) * h + s) * h
        return total

    return float(energy(b) - energy(a))


@pytest.mark.parametrize("step", [1e-3, 1e-6, 1e-9])
def test_small_changes_of_large_energies_keep_their_digits(step):
    """A stiff hinge far from where its law rests, and steps over its knots: energies are 1e10 times the change."""
    law = with_knots(polynomial([1e8, 0, 1e7], 3.0), np.linspace(-math.pi, math.pi, 301))
    rng = np.random.default_rng(1)
    a = rng.choice(law.breaks[1:-1], 20) - step * rng.uniform(0, 1, 20)
    b = a + step
    exact = [work(law, *pair) for pair in zip(a.tolist(), b.tolist(), strict=True)]
    assert np.allclose(law.change(a, b), exact, rtol=1e-13)
    assert np.allclose(law.change(b, a), np.negative(exact), rtol=1e-13)


def test_far_origins_and_stiff_hinges_change_no_list():
    """Laws that rest 50 rad away, held back by preload; wells 4e5 J above others, with a knot where they rest."""
    rng = np.random.default_rng(2)
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    stiffness, rest = 10.0 ** rng.choice([-4, 4], 4), rng.uniform(-1.5, 1.5, 4)
    springs = Scene(vertex, tuple(stiffness), tuple(rest), "none", "fold-limits")
    laws = tuple(map(linear, stiffness, rest + 50))
    far = replace(springs, laws=laws, preload=tuple(-50 * stiffness))
    steep = sum_of([double_well(1e6, 1.0), polynomial([2e5, 0, 0], 1.0)])
    torque = steep.torque(np.linspace(-1.4, -0.6, 801))
    bottom = -1.4 + 1e-3 * np.flatnonzero(np.diff(np.sign(torque)) > 0)
    soft = tuple(linear(1.0, a) for a in (0.4, -0.2, 0.7))
    two = [replace(springs, laws=(law, *soft)) for law in (steep, with_knots(steep, bottom))]
    for one, other in ((springs, far), two):
        a, b = (o.find_minima(s, escape=False, prove=False) for s in (one, other))
        assert len(a.minima) == len(b.minima) >= 2 and not b.search.undecided
        apart = [
            [np.abs(np.subtract(x.fold_angles, y.fold_angles)).max() for y in b.minima]
            for x in a.minima
        ]
        assert np.min(apart, axis=1).max() < 1e-6


def test_casadi_has_the_same_pieces():
    v = Vertex.from_degrees((70, 80, 120, 90))
    laws = (double_well(1.0, 1.0), None, detent(0.3, 6), one_sided(4.0, 1.0))
    model = pose(Scene(v, (1,) * 4, (0.2,) * 4, "none", laws=laws))
    whole = model.symbols()
    p = ca.vertcat(whole.springs, ca.vec(whole.corners))
    h, g = ca.hessian(whole.energy, whole.y)
    solved = ca.Function("energy", [whole.y, p], [g, h])
    rng = np.random.default_rng(0)
    for x in rng.uniform(-math.pi, math.pi, (50, 4)):
        torque, bent = (np.array(v) for v in solved(x, whole.values))
        assert np.allclose(torque.ravel(), model.parameters.torque(x), atol=1e-12)
        assert np.allclose(bent, model.parameters.hessian(x), atol=1e-11)
        assert model.energy(x) == pytest.approx(model.pattern.energy(x), rel=1e-13)


def strip(creases):
    """Facets in a row: every crease folds by itself."""
    row = creases + 2
    corners = np.array([(i, j) for j in (0, 1) for i in range(row)], float)
    return make_pattern(corners, [(i, i + 1, row + i + 1, row + i) for i in range(row - 1)])


def crosses(folds):
    """Whether facets of length 1 in a row, folded one after the other, intersect: by turns of triangles."""
    heading = np.concatenate([[0.0], np.cumsum(folds)])
    x = np.vstack(
        [np.zeros(2), np.cumsum(np.stack([np.cos(heading), np.sin(heading)], axis=1), axis=0)]
    )

    def turn(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    return any(
        turn(x[i], x[i + 1], x[j]) * turn(x[i], x[i + 1], x[j + 1]) < 0
        and turn(x[j], x[j + 1], x[i]) * turn(x[j], x[j + 1], x[i + 1]) < 0
        for i, j in itertools.combinations(range(len(x) - 1), 2)
        if j > i + 1
    )


@pytest.mark.parametrize(
    ("creases", "rolled"),
    [
        (2, 0),
        (3, 0),
        *(pytest.param(k, 2 * (k == 8), marks=pytest.mark.slow) for k in (5, 8)),
    ],
)
def test_a_strip_of_wells_has_all_their_combinations_that_do_not_cross(creases, rolled):
    """Of the longest the two that roll up cross: nine facets are more than a turn."""
    result = o.find_minima(strip(creases).with_laws(double_well(1.0, 0.7)), escape=False)
    found = {tuple(np.round(m.fold_angles, 6).tolist()) for m in result.minima}
    all_ = set(itertools.product((-0.7, 0.7), repeat=creases))
    crossing = {folds for folds in all_ if crosses(folds)}
    assert found == all_ - crossing and len(crossing) == rolled and len(result.minima) == len(found)


def test_one_sided_springs_become_stops():
    """States and moments differ by the inverse of the stiffness: slope -1 over three decades."""
    v = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(v, (1, 2, 3, 2), (1.0, -0.5, 2.9, 0.8), "none", "fold-limits")
    stop = o.find_minima(
        replace(scene, limits=[(-math.pi, math.pi)] * 2 + [(-math.pi, 2.0), (-math.pi, math.pi)])
    )
    held = np.array(stop.minima[0].fold_angles)
    assert held[2] == 2.0
    off, moments = [], []
    for stiffness in (1e2, 1e3, 1e4):
        soft = sum_of([linear(3.0, 2.9), one_sided(stiffness, 2.0, 1e-6)])
        result = o.find_minima(replace(scene, laws=(None, None, soft, None)))
        found = np.array([m.fold_angles for m in result.minima])
        near = found[np.abs(found - held).max(axis=1).argmin()]
        off.append(np.abs(near - held).max())
        moments.append(stiffness * (near[2] - 2.0 - 0.5e-6))  # rounded over 1e-6
    assert np.allclose(np.diff(np.log10(off)), -1, atol=0.1)
    nearer = np.diff(moments)
    assert nearer[0] / nearer[1] == pytest.approx(10, rel=0.1)
    assert moments[-1] == pytest.approx(stop.minima[0].contacts[0].multiplier, rel=1e-3)


def test_files_keep_laws(tmp_path):
    v = Vertex.from_degrees((70, 80, 120, 90))
    laws = (
        double_well(1.0, 1.0),
        None,
        table(np.linspace(-3, 3, 9), np.linspace(-3, 3, 9) ** 3),
        detent(0.2, 4),
    )
    scene = Scene(v, (1,) * 4, (0.5,) * 4, "none", limits=(-2.5, 2.5), laws=laws)
    assert o.parse_scene(o.format_scene(scene)) == scene
    sheet = strip(2).with_laws([laws[0], None])
    result = o.find_minima(sheet, escape=False, prove=False, starts=2)
    o.save(result, tmp_path / "result.json")
    again = o.read_result(tmp_path / "result.json")
    assert again.pattern.laws == sheet.laws
    o.write_fold(result, tmp_path / "states.fold")
    read = o.read_pattern(tmp_path / "states.fold")
    assert [law and law.name for law in read.laws] == [law and law.name for law in sheet.laws]
    # of a vertex, and of a pattern with vertices, both as FOLD says where creases are
    found = o.find_minima(scene, escape=False, prove=False, max_starts=16)
    o.write_fold(found, tmp_path / "vertex.fold")
    back = o.read_fold_scene(tmp_path / "vertex.fold", on_note=lambda note: None)
    phi = np.array(found.minima[0].fold_angles)
    assert back.laws == scene.laws and np.allclose(back.limits, scene.limits)
    assert back.energy(phi) == pytest.approx(scene.energy(phi))
    miura = o.examples.pattern("miura", 2, 2)
    miura = miura.with_laws([laws[0], None, detent(0.2, 4)] + [None] * (miura.creases - 3))
    many = o.find_minima(miura, escape=False, prove=False, starts=0, contact="fold-limits")
    o.write_fold(many, tmp_path / "miura.fold")
    read = o.read_pattern(tmp_path / "miura.fold")

    def placed(sheet):
        middles = sheet.corners[sheet.ends].mean(axis=1)[:, :2]
        return {
            tuple(np.round(m - middles.mean(axis=0), 6) + 0.0): law
            for m, law in zip(middles, sheet.laws, strict=True)
        }

    assert placed(read) == placed(miura)


@pytest.mark.parametrize(
    ("numbers", "laws", "why"),
    [
        ([0, 1], [], ":law"),
        ([5], [], r"law\[0\] = 5"),
        ([None], [3], "laws a list of tables"),
        ([None], [{"type": "tabel"}], r"laws\[0\]"),
        ([None], None, "origaminlp:laws"),
    ],
)
def test_wrong_laws_in_fold_are_named(numbers, laws, why):
    data = o.examples.crease_pattern("miura:2x2")
    edges = len(data["edges_vertices"])
    numbers = numbers * edges if len(numbers) == 1 else numbers
    data = {**data, "edges_origaminlp:law": numbers, "origaminlp:laws": laws}
    with pytest.raises(FoldFileError, match=why):
        parse_fold(json.dumps(data))


TEXT = """
[vertex]
sector_angles_deg = [70, 80, 120, 90]
[creases]
stiffness = [1, 1, 1, 1]
rest_angles_deg = [10, 0, 0, 0]
limits_deg = [-150, 150]
law = ["", "snap", "tape", "snap"]
[laws.snap]
sum = [{type = "linear", stiffness = 0.1}, {type = "double-well", energy = 0.5, at_deg = 60}]
[laws.tape]
type = "table"
angle_deg = [-160, -80, -20, 0, 20, 80, 160]
torque = [-0.4, -0.3, -0.5, 0, 0.5, 0.3, 0.4]
"""


def test_laws_are_stated_in_scene_files():
    scene = o.parse_scene(TEXT)
    assert scene.laws[0] is None and scene.laws[1] is scene.laws[3]
    assert scene.torque(np.radians([10, 0, 80, 0]))[[0, 2]] == pytest.approx([0.0, 0.3])


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('"snap"]', '"snip"]', r"laws.snip"),
        ("-160, -80", "-140, -80", "tape"),
        ("-20, 0, 20", "-20, 0, -20", "table"),
        ('type = "table"', 'type = "tabel"', "tabel"),
        ("energy = 0.5, ", "", "energy"),
        ("-0.4, -0.3", '"a", -0.3', "tape"),
        ("at_deg = 60", "at_deg = 600", "at_deg = 600"),
    ],
)
def test_wrong_laws_are_named(old, new, why):
    with pytest.raises((SceneError, o.OrigamiError), match=why):
        o.parse_scene(TEXT.replace(old, new))


def test_what_does_not_know_laws_says_so():
    sheet = o.examples.pattern("metasheet", 2, 2).with_laws([double_well(1.0, 1.0)] * 4)
    scene = replace(o.examples.degree6("pi/3"), laws=(double_well(1.0, 1.0),) * 6)
    assert scene.group.name == "C6" or scene.group.name.startswith("D")
    with pytest.raises(OptionError):
        o.design(Targets(sheet, (Target("flat", (0.0,) * 4),)))
    # preload beside a law is a load, not the angle to which a spring is wound
    loaded = replace(scene, symmetry="none", preload=(0.1,) * 6)
    x = np.linspace(-0.5, 0.6, 6)
    assert loaded.energy(x) == pytest.approx(scene.energy(x) - 0.1 * x.sum())
    assert pose(loaded).energy(x) == pytest.approx(loaded.energy(x))


def test_a_law_is_refused_that_is_none():
    for make in (
        lambda: detent(1.0, 3.5),
        lambda: detent(1.0, -3),
        lambda: detent(1.0, 400),
        lambda: well(1.0, math.nan, 0.2),
        lambda: polynomial([1.0, "a"]),
    ):
        with pytest.raises(OptionError):
            make()
    with pytest.raises(SceneError):
        HingeLaw((-1.0, 0.0, 1.0), ((0, 0, 0, 0.0), (0, 0, 1, 1.0)))
    with pytest.raises(SceneError):
        HingeLaw((-1.0, 1.0), ((0, 0, 0, 1.0),))
    with pytest.raises(SceneError):
        read_law({"type": "lambda x: x"}, "bad")
