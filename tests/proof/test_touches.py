"""Full contact: rows of touches and their points in 50 digits, who crosses, and minima against searches."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf

from benchmarks import family_scene
from origami_nlp import Scene, State, classify, find_minima
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Vertex, examples
from origami_nlp.proof import ReducedVertex, prove, why_not
from origami_nlp.proof.pieces import VertexPiece
from origami_nlp.proof.rows import Gap, variables
from origami_nlp.proof.touches import APART, CROSSED, TouchedPiece, separation
from tests.computed_once import panel_result, shared, thinned
from tests.proof.fifty_digits import (
    WIDTHS,
    boxes,
    cross,
    dot,
    exact_sectors,
    fold_quaternion,
    points,
    random_vertex,
    turn_x,
    turn_z,
    value_of,
)

pytestmark = pytest.mark.usefixtures("fifty_digits")


def uneven(number: int) -> Scene:
    """A vertex of degree 5 whose sectors differ widely: facets touch often."""
    rng = np.random.default_rng([number, 9])
    while True:
        sectors = rng.dirichlet(np.full(5, 2.0)) * 2 * math.pi
        if sectors.max() < 2.8 and sectors.min() > 0.15:
            break
    k, rest = 10 ** rng.uniform(-1, 1, 5), rng.uniform(-math.pi, math.pi, 5)
    vertex = Vertex(tuple(sectors.tolist()))
    return Scene(vertex, tuple(k.tolist()), tuple(rest.tolist()), "none", "full")


TOUCHING = family_scene("full-contact", 11)
PANELS = examples.panels()


SCENES = {"touching": TOUCHING, "uneven": uneven(6)}


@shared
def proof_of(name):
    return prove(ReducedVertex(SCENES[name]))


@pytest.fixture
def touching():
    return proof_of("touching")


@pytest.mark.parametrize("width", WIDTHS)
def test_rows_of_a_touch_hold_their_values(width):
    """Ray k off facet j seen from both ends of the facet, by rotation matrices; beyond an end boxes go."""
    rng = np.random.default_rng([7, int(width * 1e9)])
    vertex = random_vertex(rng, 5)
    refused = 0
    for j in range(5):
        k = (j + 3) % 5
        posed = TouchedPiece(vertex, (Gap("facet", (k, j)),))
        lower, upper, pins = boxes(rng, 5, width, 4)
        middle, half = variables(lower, upper)
        form, _ = posed.rows(lower, upper, pins)
        a = exact_sectors(vertex)
        for box, x, xi in points(rng, lower, upper, pins, middle, half):
            i = [(j + s) % 5 for s in range(5)]
            far = turn_x(x[i[1]]) * turn_z(a[i[1]]) * turn_x(x[i[2]]) * turn_z(a[i[2]])
            near = turn_x(-x[i[0]]) * turn_z(-a[i[4]]) * turn_x(-x[i[4]]) * turn_z(-a[i[3]])
            p, q = far[:, 0], near[:, 0]
            for row, value in enumerate([p[2], q[2]]):
                value *= mp.sin(a[j])
                off = abs(value - value_of(form, 4 + row, box, xi))
                # the sine of pi is 0 in the form, and not in fifty digits
                assert off <= mpf(form.error[4 + row, box]) + mpf(10) ** -45
            inside = p[1] < 0 < q[1] and dot(p, (mp.cos(a[j]), -mp.sin(a[j]), 0)) < 2
            out = bool((form.centre[6:10, box] == 1).any())
            refused += out
            assert not (out and inside and abs(p[2]) + abs(q[2]) < 1e-9)
    assert refused > 3 or width > 0.5


@pytest.mark.slow
@pytest.mark.parametrize("width", [0.0, 1e-6, 1e-3, 0.1])
def test_the_minor_of_a_touch_holds_its_value_at_closed_states(width, touching):
    """det [G | C | w] of five creases with axes and the gradient of the gap by quaternions."""
    rng = np.random.default_rng(int(width * 1e9))
    scene = TOUCHING
    sectors = list(map(mpf, scene.vertex.sector_angles))
    rest = rng.uniform(-3, 3, 5)  # other springs: with its own the minor vanishes
    top = mpf(max(scene.stiffness))
    seen = 0
    for point in touching.points[:8]:
        if any(point.stratum):
            continue
        x = point.fold_angles[:, None]
        lower = x - width * rng.uniform(0, 1, x.shape)
        upper = lower + width
        _, c = fold_quaternion(sectors, list(map(mpf, point.fold_angles)))
        torque = [
            mpf(k) / top * (mpf(v) - mpf(r))
            for k, v, r in zip(scene.stiffness, point.fold_angles, rest.tolist(), strict=True)
        ]
        for j in range(5):
            k = (j + 3) % 5
            others = replace(scene, rest_angles=tuple(rest.tolist()), contact="fold-limits")
            posed = TouchedPiece(VertexPiece(ReducedVertex(others)), (Gap("facet", (k, j)),))
            form, _ = posed.rows(lower, upper, np.zeros((5, 1), dtype=int))
            middle, half = variables(lower, upper)
            xi = [
                mpf(v - m) / mpf(h) if h else mpf(0)
                for v, m, h in zip(x[:, 0], middle[:, 0], half[:, 0], strict=True)
            ]
            normal = cross(c[j], c[(j + 1) % 5])
            normal = [v / mp.norm(mp.matrix(normal)) for v in normal]
            between = {(j + 1) % 5, (j + 2) % 5}
            w = [dot(normal, cross(c[i], c[k])) if i in between else mpf(0) for i in range(5)]
            value = mp.det(mp.matrix([[torque[i], *c[i], w[i]] for i in range(5)]))
            off = abs(value - value_of(form, -1, 0, xi))
            assert off <= form.error[-1, 0] + 1e-10  # the state closes to 1e-12
            seen += abs(value) > 1e-3
    assert seen >= 5


def height(c, k, j, a):
    """Gap of ray k off facet j."""
    return dot(cross(c[j], c[(j + 1) % 5]), c[k]) / mp.sin(a[j])


def gradient(c, k, j, a):
    """Of the gap at a closed state: the folds between turn the ray, and those on the other side are left."""
    normal = [v / mp.sin(a[j]) for v in cross(c[j], c[(j + 1) % 5])]
    out = [mpf(0)] * 5
    if k > j:
        for i in range(j + 1, k):
            out[i] = dot(normal, cross(c[i], c[k]))
    else:
        for i in range(k + 1, j + 1):
            out[i] = -dot(normal, cross(c[i], c[k]))
    return out


@pytest.mark.slow
@pytest.mark.parametrize("scene", thinned([uneven(6), TOUCHING, uneven(1)], 3))
def test_minima_are_those_of_a_thorough_search(scene):
    model = ReducedVertex(scene)
    proof = prove(model)
    assert proof.finished and all(r.alone for r in proof.regions)
    found = np.array(
        [m.fold_angles for m in find_minima(scene, effort="thorough", escape=False).minima]
    )
    mine = np.array([p.fold_angles for p in proof.minima])
    assert found.shape == mine.shape
    far = np.abs(found[:, None] - mine).max(axis=2)
    assert (far.min(axis=0) < 1e-8).all() and (far.min(axis=1) < 1e-8).all()
    for point in proof.points:
        kind = classify(State(model.problem, point.fold_angles)).verdict
        assert point.is_minimum is None or (kind == "minimum") == point.is_minimum


@pytest.mark.parametrize(
    "scene", thinned([*map(uneven, range(4)), *(PANELS[i] for i in (1, 5, 7, 12, 16))], 2)
)
def test_signs_agree_with_the_test_of_single_states(scene):
    """Critical points within fold limits: crossing, or not, by intervals and by `PatternProblem.refuses`."""
    model, limits = (
        ReducedVertex(scene),
        prove(ReducedVertex(replace(scene, contact="fold-limits"))),
    )
    x = np.array([model.problem.reduce(p.fold_angles) for p in limits.points])
    pins = np.array([p.stratum for p in limits.points])
    verdicts, _ = separation(model, x, np.array([p.radius for p in limits.points]), pins, ())
    assert verdicts.any() or scene.degree > 5
    for state, verdict in zip(x, verdicts, strict=True):
        if verdict:
            assert verdict == (CROSSED if model.problem.refuses(state) else APART)


@pytest.mark.parametrize("number", thinned([9, 2, 4, 16, 8], 3))
def test_minima_of_panels(number):
    """Those of the search are proved, or in a region that is judged by its cone; no others."""
    scene = PANELS[number]
    proof = prove(ReducedVertex(scene))
    assert not proof.undecided
    found = [m.phi for m in panel_result(scene).minima]
    for p in proof.minima:
        assert min(np.abs(x - p.fold_angles).max() for x in found) < 1e-8
    for x in found:
        proved = any(np.abs(x - p.fold_angles).max() < 1e-8 for p in proof.minima)
        singular = any(np.abs(x - c.lower).max() < 1e-4 for c in proof.singular)
        assert proved or (singular and number == 4)
    assert any(p.touches for p in proof.minima) == (number in (4, 8, 16))


def test_what_is_not_proved_says_so():
    three = ReducedVertex(family_scene("full-contact", 2))
    assert why_not(three) == "3 degrees of freedom: touches are proved for at most 2"
    with pytest.raises(OptionError, match="3 degrees of freedom"):
        prove(three)
    stopped = prove(ReducedVertex(TOUCHING), boxes=60_000)  # enough within fold limits
    assert not stopped.finished and not stopped.complete
    assert all("on facet" in c.reason for c in stopped.undecided)
