"""Provers with one lemma broken: scans of closed states see what each of them loses, or claims."""

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.proof import ReducedVertex, boxes, flat, pieces, prove, proving, roots, rows
from tests.computed_once import shared
from tests.independent.scan_four import minima
from tests.pattern_states.test_completeness import generic


def scene_of(sectors, stiffness, rest):
    vertex = o.Vertex.from_degrees(sectors)
    return o.Scene(vertex, stiffness, tuple(np.radians(rest)), "none", "fold-limits")


SCENES = {
    "generic": scene_of((70, 80, 120, 90), (1, 2, 3, 2), (57, -29, 17, 46)),
    "limits": generic(916, 4),
    "flat": scene_of((70, 80, 120, 90), (1, 2, 3, 2), (2, -1, 0.7, 1.5)),
}


@shared
def scanned(name):
    scene = SCENES[name]
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    limits = np.array([[-math.pi] * 4, [math.pi] * 4])
    sectors = np.array(scene.vertex.sector_angles)
    return minima(lambda x: (x - rest) ** 2 @ k / 2, sectors, limits, "fold-limits", 4001)[1]


def agrees(name):
    """Whether the minima that are proved are those of the scan; states judged by their cones may be either."""
    proof = prove(ReducedVertex(SCENES[name]))
    assert proof.finished
    proved = np.array([p.fold_angles for p in proof.minima]).reshape(-1, 4)
    left = [c for c in (*proof.singular, *proof.undecided)]
    known = scanned(name)
    lost = [
        x
        for x in known
        if not (np.abs(proved - x).max(axis=1) < 0.02).any()
        and not any((c.lower - 0.02 <= x).all() and (x <= c.upper + 0.02).all() for c in left)
    ]
    more = [x for x in proved if not (np.abs(known - x).max(axis=1) < 0.02).any()]
    return not lost and not more


@pytest.mark.parametrize("name", SCENES)
def test_unbroken_provers_agree_with_the_scan(name):
    assert len(scanned(name)) >= 2 and agrees(name)


def without_a_stratum(patch):
    true = proving.strata

    def some(n, limits=None):
        every = true(n, limits)
        return every[(every.pins != 0).any(axis=0)]

    patch.setattr(proving, "strata", some)


def without_limits(patch):
    true = proving.strata

    def some(n, limits=None):
        every = true(n, limits)
        return every[(every.pins == 0).all(axis=0)]

    patch.setattr(proving, "strata", some)


def with_a_sign_of_minors_wrong(patch):
    def minors(self, folded, torques):
        slopes = self.slopes(folded)
        pairs = zip(self.subsets.T, self.without.T, strict=True)
        terms = [torques[w] * slopes[o] for w, o in pairs]
        return sum(terms[1:], terms[0])

    patch.setattr(pieces.Piece, "minors", minors)


def with_half_of_the_loop_turned_the_other_way(patch):
    true = rows.Chain.turned

    def turned(self, v, axes, steps, radii, known):
        return true(self, v, axes, steps, np.abs(radii), known)

    patch.setattr(rows.Chain, "turned", turned)


def without_remainders(patch):
    true = rows.Quadratic.affine

    def affine(self):
        form = true(self)
        return rows.Affine(form.centre, form.slopes, 1e-3 * form.error)

    patch.setattr(rows.Quadratic, "affine", affine)


def with_boxes_contracted_too_far(patch):
    true = boxes._bounds

    def bounds(found, asked, keep):
        low, high = true(found, asked, keep)
        return low + 0.3 * (high - low), high - 0.3 * (high - low)

    patch.setattr(boxes, "_bounds", bounds)


def with_a_flat_state_that_is_alone_too_far(patch):
    patch.setattr(proving, "flat_lemma", lambda vertex: flat.Flat(1.0, 1, False))


def with_boxes_that_are_said_to_hold_a_root(patch):
    patch.setattr(proving, "holds", lambda system, found, small: np.zeros(len(small), dtype=int))


def with_signs_at_limits_wrong(patch):
    true = roots._signs
    patch.setattr(roots, "_signs", lambda *given: -true(*given))


def with_indices_of_another_matrix(patch):
    true = roots._index

    def index(system, at, free, radius, lean, which):
        found = true(system, at, free, radius, lean, which)
        return np.where(found < 0, found, np.where(found > 0, found - 1, 1))

    patch.setattr(roots, "_index", index)


BROKEN = {
    without_a_stratum: "generic",
    without_limits: "limits",
    with_a_sign_of_minors_wrong: "generic",
    with_half_of_the_loop_turned_the_other_way: "generic",
    without_remainders: "generic",
    with_boxes_contracted_too_far: "generic",
    with_a_flat_state_that_is_alone_too_far: "flat",
    with_boxes_that_are_said_to_hold_a_root: "generic",
    with_signs_at_limits_wrong: "limits",
    with_indices_of_another_matrix: "generic",
}


@pytest.mark.parametrize("broken", BROKEN, ids=lambda one: one.__name__)
def test_a_broken_lemma_is_seen(monkeypatch, broken):
    broken(monkeypatch)
    assert not agrees(BROKEN[broken])


def test_a_touch_left_out_is_seen(monkeypatch):
    """The minimum that crease 4 on facet 1 holds is one of a thorough search."""
    from benchmarks import family_scene

    scene = family_scene("full-contact", 11)
    monkeypatch.setattr(proving, "contact_strata", lambda model: ())
    found = o.find_minima(scene, prove=False, escape=False).minima
    assert len(prove(ReducedVertex(scene)).minima) < len(found)
