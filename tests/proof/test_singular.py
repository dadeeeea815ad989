"""Singular states stand alone: on every stratum, never beside a planted critical point, and what must not be shown."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples
from origami_nlp.errors import OptionError
from origami_nlp.numerics import DUPLICATE_TOL
from origami_nlp.problem import Kinematics, Model
from origami_nlp.proof import isolated, pose, prove
from origami_nlp.proof.blow_up import Site
from origami_nlp.proof.singular import RADII
from tests.computed_once import thinned
from tests.proof.singular_scenes import (
    CROSS,
    HANDLES,
    KAWASAKI,
    PAIRS,
    SIXTY,
    TWIST,
    flat_foldings,
    handles,
    scene,
    touched,
)


@pytest.mark.parametrize(("plain", "a", "b"), HANDLES)
def test_handles_in_balance_stand_alone_on_all_their_strata(plain: Scene, a: int, b: int) -> None:
    states = handles(plain, a, b)
    assert len(states) >= 2
    model = Model(plain)
    for x in states:
        strata = [s for s in touched(np.where(np.abs(np.abs(x) - math.pi) < 1e-9, x, 0.0))]
        for s in strata:
            found = isolated(model, x + 1e-5, s)
            assert found.radius >= 1e-5, (x, s, found.reason)
            np.testing.assert_allclose(found.point, x, atol=1e-12)
        beside = x.copy()
        t = x[b]
        beside[[a, b]] += (0.05, 0.0)
        assert isolated(model, beside, strata[0]).radius == 0.0 and x[b] == t
        slope = handle_slope(model, x, a, b)
        along = x.copy()
        along[[a, b]] += (0.05, 0.05 * slope)
        lost = isolated(model, along, strata[0])
        assert lost.radius == 0.0 and "balance" in lost.reason


def handle_slope(model: Model, x: np.ndarray, a: int, b: int) -> float:
    """How b turns with a where the pair stays closed."""
    kinematics = Kinematics(model)
    jacobian = kinematics.closure(kinematics.fold(x[None]))[1][0]
    return -float(jacobian[:, a] @ jacobian[:, b] / (jacobian[:, b] @ jacobian[:, b]))


@pytest.mark.parametrize("ratio", thinned(examples.RATIOS, 3))
def test_facets_at_right_angles_to_the_mirror_stand_alone(ratio: float) -> None:
    """Where closure of the wedge loses rank beyond a crease that is turned by pi/2."""
    model = Model(examples.degree6("pi/3", ratio, contact="fold-limits"))
    x = np.array([-1.0, 0.5, 1.0, 0.0]) * math.pi
    kinematics = Kinematics(model)
    jacobian = kinematics.closure(kinematics.fold(x[None]))[1][0]
    assert np.linalg.svd(jacobian[:, 1:])[1][1] < 1e-15 < 0.1 < np.linalg.svd(jacobian)[1][1]
    found = isolated(model, x + 1e-5, (-1, 0, 0, 0))
    assert found.radius >= 1e-4
    np.testing.assert_allclose(found.point, x, atol=1e-15)


@pytest.mark.parametrize("degrees", [KAWASAKI, CROSS, PAIRS, TWIST])
def test_flat_foldings_with_random_springs_stand_alone_on_every_stratum(
    degrees: tuple[int, ...],
) -> None:
    model = Model(scene(degrees, 0))
    radii = [isolated(model, x, s).radius for x in flat_foldings(model) for s in touched(x)]
    assert len(radii) > 10
    assert min(radii) >= 1e-3


@pytest.mark.parametrize("alpha", examples.DEGREE6_ALPHAS)
@pytest.mark.parametrize("ratio", thinned(examples.RATIOS, 3))
def test_flat_foldings_of_the_panels_stand_alone(alpha: str, ratio: float) -> None:
    model = Model(examples.degree6(alpha, ratio, contact="fold-limits"))
    found = [isolated(model, x, s) for x in flat_foldings(model) for s in touched(x)]
    assert len(found) > 100
    assert min(f.radius for f in found) >= 1e-5
    assert {f.core for f in found} <= {0.0, DUPLICATE_TOL}


@pytest.mark.parametrize("seed", range(12))
def test_the_flat_state_of_generic_vertices_agrees_with_its_own_lemma(seed: int) -> None:
    """Two derivations of the same blow-up: affine forms over boxes there, quadratic forms here."""
    rng = np.random.default_rng(seed)
    n = 4 + seed % 3
    sectors = rng.uniform(0.3, 1.0, n)
    sectors *= 2 * math.pi / sectors.sum()
    springs = np.exp(rng.uniform(-1, 1, n)), rng.uniform(-3, 3, n)
    model = Model(Scene(Vertex(tuple(sectors)), *map(tuple, springs), "none", "fold-limits"))
    other = pose(model)[1]
    found = isolated(model, np.zeros(n), (0,) * n)
    assert (found.radius > 0) == (other.radius > 0)
    assert found.radius >= other.radius


@pytest.mark.parametrize(
    ("degrees", "symmetry"),
    [
        ((45, 90, 45, 45, 90, 45), "D1"),
        ((70, 110, 70, 110), "C2"),
        ((30, 60, 60, 30, 30, 60, 60, 30), "D2"),
        ((50, 70, 50, 70, 50, 70), "D3"),
        ((50, 70, 50, 70, 50, 70), "C3"),
    ],
)
def test_the_flat_state_of_wedges_stands_alone(degrees: tuple[int, ...], symmetry: str) -> None:
    model = Model(scene(degrees, 1, symmetry))
    assert model.symmetry == symmetry
    assert isolated(model, np.zeros(model.size), (0,) * model.size).radius >= 1e-3


@pytest.mark.parametrize(
    "plain",
    [
        scene(KAWASAKI, 0),
        scene(CROSS, 0),
        examples.degree6("pi/3", 1.0, contact="fold-limits"),
        examples.degree8("pi/6", 1.0, contact="fold-limits"),
    ],
    ids=["kawasaki", "cross", "degree 6", "degree 8"],
)
def test_what_the_search_leaves_at_singular_states_is_decided(plain: Scene) -> None:
    proof = prove(Model(plain))
    assert proof.finished and proof.singular and not proof.undecided
    model = Model(plain)
    for cluster in proof.singular:
        middle = 0.5 * (np.array(cluster.lower) + cluster.upper)
        found = isolated(model, middle, cluster.stratum)
        assert found.holds(cluster.lower, cluster.upper), (cluster, found)
        wide = np.array(cluster.upper) + 2 * found.radius
        assert not found.holds(cluster.lower, wide)


def test_units_and_the_start_of_the_labels_do_not_matter() -> None:
    plain = scene(KAWASAKI, 0)
    model, x = Model(plain), flat_foldings(Model(plain))[3]
    vertex = Vertex.from_degrees(KAWASAKI[1:] + KAWASAKI[:1])
    turned = Model(
        Scene(
            vertex,
            tuple(1e6 * np.roll(plain.stiffness, -1)),
            tuple(np.roll(plain.rest_angles, -1)),
            "none",
            "fold-limits",
        )
    )
    for s in touched(x):
        other = isolated(turned, np.roll(x, -1), tuple(np.roll(s, -1)))
        assert isolated(model, x, s).radius == other.radius > 0


# --- what must not be shown


def planted(
    seed: int, degrees: tuple[int, ...]
) -> tuple[Model, np.ndarray, tuple[int, ...], float] | None:
    """Springs for which a state beside a flat folding is critical: model, folding, stratum, distance."""
    rng = np.random.default_rng(seed)
    plain = Scene(
        Vertex.from_degrees(degrees),
        (1,) * len(degrees),
        (0,) * len(degrees),
        "none",
        "fold-limits",
    )
    model = Model(plain)
    kinematics, states, n = Kinematics(model), flat_foldings(model), model.size
    x = states[rng.integers(len(states))]
    s = np.rint(x / math.pi) * (rng.random(n) < 0.4)
    free = s == 0
    if free.sum() < 4:
        return None
    u = rng.uniform(-1, 1, n) * free
    u = np.where(x == 0, u, -np.abs(u) * np.sign(x))
    y = x + 10 ** rng.uniform(-4, -2.3) * u
    for _ in range(50):
        value, jacobian = kinematics.closure(kinematics.fold(y[None]))
        y[free] -= np.linalg.lstsq(jacobian[0][:, free], value[0], rcond=1e-9)[0]
    value, jacobian = kinematics.closure(kinematics.fold(y[None]))
    away = float(np.abs(y - x).max())
    if np.abs(value).max() > 1e-15 or not 1e-5 < away < 9e-3 or np.abs(y).max() > math.pi:
        return None
    k, torque = np.exp(rng.uniform(-1, 1, n)), jacobian[0].T @ rng.normal(size=3)
    torque *= rng.uniform(0.1, 1) / np.abs(torque / k).max()
    rest = np.where(free, y - torque / k, rng.uniform(-3, 3, n))
    if np.abs(rest).max() > math.pi:
        return None
    final = Model(Scene(plain.vertex, tuple(k), tuple(rest), "none", "fold-limits"))
    return final, x, tuple(s.astype(int).tolist()), away


def plants() -> list[tuple[Model, np.ndarray, tuple[int, ...], float]]:
    tried = [planted(seed, d) for d in (KAWASAKI, CROSS, PAIRS) for seed in range(30)]
    tried += [planted(seed, SIXTY) for seed in range(5)]
    return [p for p in tried if p is not None]


@pytest.mark.slow
def test_a_planted_critical_point_is_never_inside_the_radius() -> None:
    found = [(isolated(model, x, s), away) for model, x, s, away in plants()]
    assert len(found) >= 10
    for what, away in found:
        assert what.radius < away
    assert sum(what.radius > 0 for what, _ in found) >= len(found) // 3


def test_without_their_errors_rows_would_exclude_planted_critical_points(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = Site.forms

    def careless(self: Site, strata: list, radius: float):
        forms, loose = whole(self, strata, radius)
        forms.error[:], forms.tilt_linear[:], forms.tilt_quadratic[:] = 0, 0, 0
        return forms, loose

    monkeypatch.setattr(Site, "forms", careless)
    found = [(isolated(model, x, s), away) for model, x, s, away in plants()]
    assert any(what.radius >= away for what, away in found)


def test_branches_pass_through_flat_foldings_and_only_the_minors_exclude_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = Model(scene(KAWASAKI, 0))
    states = flat_foldings(model)
    assert min(isolated(model, x, (0, 0, 0, 0)).radius for x in states) > 0
    monkeypatch.setattr(Site, "_minors", lambda self, seen: iter(()))
    bare = Model(scene(KAWASAKI, 0))
    found = [isolated(bare, x, (0, 0, 0, 0)) for x in states]
    lost = [f.reason for f in found if not f.radius]
    assert len(lost) >= 4 and all("along u" in why for why in lost)
    # with one crease held nothing moves: closure alone
    for x in states[np.abs(states[:, 0]) > 0]:
        assert isolated(bare, x, (round(x[0] / math.pi), 0, 0, 0)).radius > 0


@pytest.mark.parametrize("miss", [1e-6, 1e-5])
def test_a_vertex_that_nearly_folds_flat_has_no_such_state(miss: float) -> None:
    sectors = np.radians(KAWASAKI) + np.array([miss, 0, 0, -miss])
    exact_model, plain = Model(scene(KAWASAKI, 0)), scene(KAWASAKI, 0)
    near = Model(
        Scene(Vertex(tuple(sectors)), plain.stiffness, plain.rest_angles, "none", "fold-limits")
    )
    x = flat_foldings(exact_model)[-1]
    found = isolated(near, x, (0, 0, 0, 0))
    assert found.radius == 0.0 and "closes" in found.reason


def test_a_vertex_within_rounding_of_one_that_folds_flat_is_that_one() -> None:
    sectors = np.radians(KAWASAKI) + np.array([1e-10, 0, 0, -1e-10])
    plain = scene(KAWASAKI, 0)
    made = Scene(Vertex(tuple(sectors)), plain.stiffness, plain.rest_angles, "none", "fold-limits")
    assert made.relations.moved > 0  # the scene said so
    x = flat_foldings(Model(made))[-1]
    assert isolated(Model(made), x, (0, 0, 0, 0)).radius in RADII


def test_a_state_off_its_stratum_is_refused() -> None:
    model = Model(scene(KAWASAKI, 0))
    x = flat_foldings(model)[-1]
    wrong = tuple(-round(t) for t in x / math.pi)
    with pytest.raises(OptionError, match="fold-limits"):
        isolated(Model(examples.degree6("pi/3")), np.zeros(4), (0,) * 4)
    assert "stratum" in isolated(model, x, wrong).reason
    assert isolated(model, x, wrong).radius == 0.0
    assert isolated(model, (0.5, 0.7, 0.1, 0.3), (0, 0, 0, 0)).radius == 0.0
