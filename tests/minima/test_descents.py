"""Descents in batches: their ends are KKT points by the model's own derivatives; labels and workers change nothing."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.kkt import project
from origami_nlp.minima.descents import Descents
from origami_nlp.pattern import Relabelling, canonical_labels
from origami_nlp.problem import Model
from origami_nlp.starts import EFFORTS, Samples
from tests.computed_once import thinned


def vertex(degree, seed, contact, symmetry="none"):
    rng = np.random.default_rng(seed)
    s = rng.uniform(0.5, 1.5, degree)
    return Scene(
        Vertex(tuple(s * 2 * math.pi / s.sum())),
        tuple(10 ** rng.uniform(-1, 1, degree)),
        tuple(rng.uniform(-math.pi, math.pi, degree)),
        symmetry=symmetry,
        contact=contact,
    )


def test_a_stratum_that_exists_only_while_it_is_held_keeps_its_end():
    model = Model(examples.degree6("pi/3", ratio=0.01))
    guess = np.array([[-math.pi, t, -math.pi, 3 - 2 * t] for t in (1.6, 1.8, 2.1)])
    at_limit = np.where(guess == -math.pi, -1, 0)  # phi_1 = phi_3 = phi_5 = -pi: nothing opens
    x, residual = project(model, guess, frozen=at_limit != 0)
    ends = Descents(model).run(Samples.on(x, at_limit, hold=True))
    assert (residual <= 1e-12).all() and ends.settled.all()
    assert (np.abs(ends.samples.x[:, [0, 2]]) == math.pi).all()
    found = find_minima(model.scene, prove=False, max_starts=64, escape=False)
    handle = [m for m in found.minima if m.local_dimension == 1]
    assert min(np.abs(model.reduce(m.fold_angles) - ends.samples.x[0]).max() for m in handle) < 1e-6


@pytest.mark.parametrize(
    "labels", thinned([((2, True, True),), ((3, False, False),), ((0, True, False),)], 3)
)
def test_labels_change_nothing(labels):
    for scene in (vertex(6, 4, "fold-limits"), vertex(6, 2, "full")):
        new = Relabelling(*labels, 6)
        other = new.relabelled(scene)
        one, two = (
            find_minima(s, seed=3, effort="quick", prove=False, escape=False)
            for s in (scene, other)
        )
        mapped = sorted(new.back(np.array(m.fold_angles)).tolist() for m in two.minima)
        assert len(one.minima) == len(two.minima)
        assert np.allclose(sorted(m.fold_angles for m in one.minima), mapped, atol=1e-10)
        assert sorted(m.kind for m in one.minima) == sorted(m.kind for m in two.minima)
        assert one.search.starts == two.search.starts


def test_canonical_labels_are_the_same_for_all_labels():
    scene = vertex(5, 8, "full")
    first = canonical_labels(scene).relabelled(scene)
    for start in range(5):
        for backward in (False, True):
            for over in (False, True):
                other = Relabelling(start, backward, over, 5).relabelled(scene)
                same = canonical_labels(other).relabelled(other)
                assert np.allclose(same.vertex.sector_angles, first.vertex.sector_angles)
                assert np.allclose(same.stiffness, first.stiffness)
                assert np.allclose(same.rest_angles, first.rest_angles)


def test_workers_change_nothing():
    scene = vertex(6, 6, "fold-limits")
    alone, shared = (
        find_minima(scene, workers=w, effort="quick", prove=False, escape=False) for w in (1, 2)
    )
    assert [(m.fold_angles, m.hits) for m in alone.minima] == [
        (m.fold_angles, m.hits) for m in shared.minima
    ]


def test_effort_and_what_it_says():
    scene = vertex(6, 6, "fold-limits")
    quick, normal = (
        find_minima(scene, effort=e, prove=False, escape=False) for e in ("quick", "normal")
    )
    assert quick.search.starts < normal.search.starts and normal.search.stopped_by == "rule"
    assert len(quick.minima) <= len(normal.minima)
    assert normal.search.every_corner
    one = find_minima(vertex(4, 1, "full"), prove=False, escape=False)
    assert one.search.stopped_by == "complete"
    assert all(m.solver.agrees and m.solver.came_back == "same" for m in normal.minima)


def test_all_corners_is_said_only_where_all_were_tried():
    from origami_nlp.problem import vertices
    from origami_nlp.starts import Rounds

    for degree, effort in ((5, "quick"), (6, "quick"), (6, "normal"), (9, "normal")):
        model = Model(vertex(degree, 7, "fold-limits"))
        rounds = Rounds(model, 0, EFFORTS[effort])
        every = len(vertices(model, 10**6, np.random.default_rng(0)))
        assert rounds.every_corner == (rounds.corners == every)
    capped = find_minima(examples.degree6("pi/3", 1), max_starts=16, prove=False, escape=False)
    assert capped.search.corners < 18 and not capped.search.every_corner


def test_rounding_does_not_stall_descents_at_contacts_that_force_each_other_shut():
    """Near the flat-folded states of this panel two contacts hold a third: it has no slope but rounding's."""
    model = Model(examples.degree6("pi/3", 100))
    at = np.array([-0.3406, 0.6624, 0.6624, -0.3406])
    x = at + 1e-12 * np.random.default_rng(0).uniform(-1, 1, (60, 4))
    limit = np.array([-3.12, math.pi, 3.13, -math.pi])
    near = limit * (1 - np.linspace(0, 0.01, 20)[:, None] * [1, 0, 1, 0])
    at_limit = np.where(np.abs(near) == math.pi, np.sign(near), 0).astype(int)
    descents = Descents(model)
    starts = [Samples.on(x), Samples.on(near, at_limit)]
    ends = [descents.run(descents.closing.close(s, 12, 1e-14)) for s in starts]
    for end in ends:
        assert end.converged.all()
        assert np.ptp(end.samples.x, axis=0).max() < 1e-8
