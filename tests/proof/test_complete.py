"""All critical points of scenes: against searches, 50 digits, Morse's count, and other ways to state the same scene."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf

import origami_nlp as o
from benchmarks import family_scene
from origami_nlp import Scene, find_minima
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, classify
from origami_nlp.pattern import Vertex, examples, linear
from origami_nlp.proof import ReducedVertex, prove
from origami_nlp.proof.boxes import prune, strata
from origami_nlp.proof.proving import pose
from origami_nlp.proof.roots import BoxKkt, certify, newton
from tests.computed_once import thinned
from tests.proof.fifty_digits import cross, dot, fold_quaternion, multiply

DEGREE4 = [family_scene("fold-limits", number) for number in (0, 5, 10, 15, 20)]
DEGREE5 = [family_scene("fold-limits", number) for number in (1, 6)]


def states(proof) -> np.ndarray:
    return np.array([p.fold_angles for p in proof.minima])


@pytest.mark.parametrize("scene", thinned([*DEGREE4, *DEGREE5], 4))
def test_proved_minima_are_those_of_a_thorough_search(scene):
    proof = prove(ReducedVertex(scene))
    assert proof.complete and proof.finished and not proof.singular
    found = np.array(
        [m.fold_angles for m in find_minima(scene, effort="thorough", escape=False).minima]
    )
    assert len(found) == len(proof.minima)
    far = np.abs(found[:, None] - states(proof)).max(axis=2)
    assert (far.min(axis=0) < 1e-8).all() and (far.min(axis=1) < 1e-8).all()


def test_box_counts_and_the_flat_lemma_stay_small():
    four, five = prove(ReducedVertex(DEGREE4[0])), prove(ReducedVertex(DEGREE5[0]))
    assert four.boxes < 6_000 and five.boxes < 100_000
    lemma = pose(ReducedVertex(DEGREE4[0]))[1]
    assert lemma.radius >= 1e-3 and pose(ReducedVertex(DEGREE5[0]))[1].radius >= 1e-3
    assert lemma.minimum is False and "no minimum" in lemma.text


@pytest.mark.slow
def test_three_dof_are_proved():
    scene = family_scene("fold-limits", 2)
    proof = prove(ReducedVertex(scene))
    assert proof.complete and proof.boxes < 1_500_000
    found = np.array(
        [m.fold_angles for m in find_minima(scene, effort="thorough", escape=False).minima]
    )
    far = np.abs(found[:, None] - states(proof)).max(axis=2)
    assert (far.min(axis=1) < 1e-8).all()


@pytest.mark.slow
@pytest.mark.parametrize("scene", [DEGREE4[0], DEGREE5[0]])
def test_points_hold_in_50_digits(scene):
    """Newton in 50 digits on x and m: distance of the root, signs at closed creases, reduced Hessian."""
    proof = prove(ReducedVertex(scene))
    n = scene.degree
    with mp.workdps(50):
        total = sum(map(mpf, scene.vertex.sector_angles))
        sectors = [mpf(a) * 2 * mp.pi / total for a in scene.vertex.sector_angles]
        k = list(map(mpf, scene.stiffness))
        rest = list(map(mpf, scene.rest_angles))
        for point in proof.points:
            free = [i for i in range(n) if not point.stratum[i]]
            x = [
                mpf(v) if not s else s * mp.pi
                for v, s in zip(point.fold_angles, point.stratum, strict=True)
            ]
            m = list(map(mpf, point.moment))
            for _ in range(6):
                q, c = fold_quaternion(sectors, x)
                size = len(free)
                f, jacobian = mp.matrix(size + 3, 1), mp.matrix(size + 3, size + 3)
                for a, i in enumerate(free):
                    f[a] = k[i] * (x[i] - rest[i]) - dot(m, c[i])
                    for b, j in enumerate(free):
                        jacobian[a, b] = (k[i] if i == j else 0) - (
                            dot(m, cross(c[j], c[i])) if j < i else 0
                        )
                        for row in range(3):
                            jacobian[size + row, b] = half_product(c[j], q)[row + 1]
                    for row in range(3):
                        jacobian[a, size + row] = -c[i][row]
                for row in range(3):
                    f[size + row] = q[row + 1]
                step = mp.lu_solve(jacobian, f)
                for a, i in enumerate(free):
                    x[i] -= step[a]
                m = [v - step[size + row] for row, v in enumerate(m)]
            assert mp.norm(f) < mpf(10) ** -40 and q[0] > 0
            far = max((abs(x[i] - mpf(point.fold_angles[i])) for i in free), default=0)
            assert far <= point.radius < point.unique_radius
            for i in range(n):
                if point.stratum[i]:
                    left = point.stratum[i] * (k[i] * (x[i] - rest[i]) - dot(m, c[i]))
                    assert mp.sign(left) == point.pinned_signs[i]
            assert index_of(k, m, c, free) == point.index


def half_product(c, q):
    return [v / 2 for v in multiply([mpf(0), *c], q)]


def index_of(k, m, c, free):
    """Negative eigenvalues of the Hessian on the kernel of the axes, by a basis of that kernel."""
    size = len(free)
    axes = mp.matrix([[c[i][row] for i in free] for row in range(3)])
    hessian = mp.matrix(size, size)
    for a, i in enumerate(free):
        for b, j in enumerate(free):
            hessian[a, b] = k[i] if a == b else -dot(m, cross(c[min(i, j)], c[max(i, j)])) / 2
    _, _, v = mp.svd_r(axes.T * axes)
    basis = v[3:, :].T
    if size == 3:
        return 0
    values = mp.eigsy(basis.T * hessian * basis, eigvals_only=True)
    return sum(1 for value in values if value < 0)


def test_there_is_one_root_where_one_is_said_to_be():
    """Newton from random states in the uniqueness box ends at its root, or outside."""
    model = ReducedVertex(DEGREE5[0])
    system = BoxKkt(model)
    rng = np.random.default_rng(0)
    for point in prove(model).points:
        pins = np.tile(point.stratum, (60, 1))
        x = (
            point.fold_angles
            + np.where(pins == 0, rng.uniform(-1, 1, pins.shape), 0) * point.unique_radius
        )
        ends, _, converged = newton(system, x, pins)
        far = np.abs(ends - point.fold_angles).max(axis=1)
        assert converged.any()
        inside = converged & (far <= point.unique_radius)
        assert (far[inside] < 1e-9).all()


def test_what_is_no_root_is_not_certified():
    model = ReducedVertex(DEGREE4[0])
    system = BoxKkt(model)
    point = prove(model).points[0]
    x, pins = point.fold_angles[None], np.array([point.stratum])
    lam = 2 * np.array([point.moment]) / model.problem.scale
    assert len(certify(system, x, lam, pins)) == 1
    for shift in (1e-6, 1e-4, 0.1):
        moved = x + np.where(pins == 0, shift, 0.0)
        roots = certify(system, moved, lam, pins)
        # either nothing, or a box wide enough to hold the true root
        assert all(r > 0.5 * shift for r in roots.radius)


def count(proof):
    return Counter((p.index, p.is_minimum, sum(map(abs, p.stratum))) for p in proof.points)


def test_morse_sums_do_not_depend_on_the_springs():
    """Critical points whose closed creases all press count (-1)^index; with the flat state's -1 they sum to what the
    closed states of degree 4 (a graph with its ends) have as Euler characteristic: the same for all springs."""
    rng = np.random.default_rng(3)
    vertex = DEGREE4[0].vertex
    sums = set()
    for _ in range(6):
        k, rest = 10 ** rng.uniform(-1, 1, 4), rng.uniform(-3, 3, 4)
        scene = Scene(vertex, tuple(k), tuple(rest), "none", "fold-limits")
        proof = prove(ReducedVertex(scene))
        assert proof.complete
        pressed = [p for p in proof.points if max(p.pinned_signs) < 1]
        sums.add(sum((-1) ** p.index for p in pressed) - 1)
    assert len(sums) == 1


@pytest.mark.parametrize("index", thinned(range(18), 9))
def test_panels_leave_no_box(index):
    """The paper's panels with fold limits: states of a search are proved minima, or lie in a singular cluster."""
    scene = replace(examples.panels()[index], contact="fold-limits")
    model = ReducedVertex(scene)
    proof = prove(model, boxes=20_000)
    assert proof.finished and not proof.undecided
    assert proof.boxes < (12_000 if scene.degree == 6 else 3_000)
    boxes = [(c.lower, c.upper) for c in proof.singular]
    found = [m.phi for m in find_minima(scene, escape=False).minima]
    for x in found:
        proved = [p for p in proof.points if np.abs(p.fold_angles - x).max() < 1e-7]
        assert all(p.is_minimum is not False for p in proved)
        held = [b for b in boxes if (b[0] - 1e-6 <= x).all() and (x <= b[1] + 1e-6).all()]
        assert proved or held
    for point in proof.minima:
        assert min(np.abs(x - point.fold_angles).max() for x in found) < 1e-7


@pytest.mark.parametrize(
    "degrees",
    [
        (90, 90, 90, 90),
        (60, 80, 120, 100),
        pytest.param((50, 70, 60, 50, 130), marks=pytest.mark.slow),
    ],
)
def test_vertices_with_creases_on_one_line_need_the_twin_rule(degrees):
    rng = np.random.default_rng(5)
    n = len(degrees)
    k, rest = tuple(10 ** rng.uniform(-0.5, 0.5, n)), tuple(rng.uniform(-2, 2, n))
    model = ReducedVertex(Scene(Vertex.from_degrees(degrees), k, rest, "none", "fold-limits"))
    proof = prove(model)
    assert proof.finished and not proof.undecided
    for minimum in find_minima(model.scene, effort="thorough", escape=False).minima:
        x = np.array(minimum.fold_angles)
        assert any(np.abs(x - p.fold_angles).max() < 1e-7 for p in proof.minima) or any(
            (c.lower - 1e-6 <= x).all() and (x <= c.upper + 1e-6).all() for c in proof.singular
        )
    assert all("rank" in c.reason or "free" in c.reason for c in proof.singular)
    assert not any(p.is_minimum is None for p in proof.points)
    if degrees == (90, 90, 90, 90):
        posed, flat = pose(model)
        posed.twins = ()
        left = prune(posed, strata(n), flat=flat.radius, most=50_000)
        assert len(left.open)  # curves of boxes on which all minors vanish


@pytest.mark.parametrize("contact", ["fold-limits", "full"])
@pytest.mark.parametrize("scene", [DEGREE4[0], examples.degree6("pi/3", 1.0)], ids=["C1", "D1"])
def test_a_problem_with_a_load_is_proved_with_its_load(scene, contact):
    """The load was dropped: minima of the unloaded vertex were called all of the loaded one."""
    scene = replace(scene, contact=contact)
    model = o.pose(scene)
    load = 0.3 * np.sin(1.0 + np.arange(model.size))
    loaded, torque = model.loaded(load), load * model.scale / model.multiplicity
    proof = prove(ReducedVertex(scene, loaded))
    assert proof.finished and proof.minima
    for p in proof.minima:
        x = model.reduce(p.fold_angles)
        assert classify(State(loaded, x)).verdict == "minimum"
    stated = replace(scene, preload=tuple(model.expand(torque).tolist()))
    found = np.array([m.phi for m in find_minima(stated, escape=False).minima])
    far = np.abs(found[:, None] - states(proof)).max(axis=2)
    assert (far.min(axis=0) < 1e-8).all()
    twice = replace(model.parameters, stiffness=2 * model.parameters.stiffness)
    one, two = (prove(ReducedVertex(scene, p)) for p in (model, model.varied(twice)))
    assert np.allclose(states(one), states(two))


def test_hinge_laws_are_refused_and_the_list_says_so():
    scene = replace(DEGREE4[0], laws=tuple(map(linear, (1, 2, 3, 4), (0.1, 0.2, 0.3, 0.4))))
    with pytest.raises(OptionError, match="hinge laws"):
        prove(ReducedVertex(scene))
    known = find_minima(scene, prove=True, escape=False).completeness
    assert known.status == "not-proved" and "hinge laws" in known.reason
