"""Stiffness against motions that break a symmetry: by null spaces of all rows at once."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space

import origami_nlp as o
from origami_nlp.contact import breaking_stiffnesses, find_contacts
from origami_nlp.minima import full_scene, group_average, hessian_spectra
from origami_nlp.pattern_problem import pose
from tests.computed_once import panel_result

SCENE = o.examples.degree6("5*pi/12", ratio=1)
LOADED = o.examples.degree8("pi/4", symmetry="D1", contact="fold-limits")
OPTIONS = {"max_starts": 32, "prove": False, "escape": False}


def test_without_loaded_contacts_it_is_the_breaking_block_of_the_spectrum():
    for minimum in o.find_minima(SCENE, **OPTIONS).minima:
        state = o.State(pose(full_scene(SCENE)), np.array(minimum.fold_angles))
        wanted = hessian_spectra(state, SCENE)[1]
        assert wanted and breaking_stiffnesses(state, SCENE) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.slow  # seconds of curves or searches
def test_loaded_contacts_stay_closed():
    scene, seen = replace(LOADED, preload=(-0.4, *[0] * 7)), set()
    for pinned in find_contacts(
        o.find_minima(scene, **OPTIONS | {"max_starts": 8}), check=False
    ).states:
        state = o.State(pose(full_scene(scene)), np.array(pinned.minimum.fold_angles))
        piece = state.on(state.pieces[0])
        moments = piece.multiplier_set.smallest
        loaded = [c for c, m in zip(piece.contacts, moments, strict=True) if m > 1e-9]
        if not pinned.breaking or np.isnan(pinned.breaking).any() or not loaded:
            continue
        held = state.on(loaded)
        z = null_space(np.vstack([state.jacobian, held.slopes, group_average(scene)]))
        values = np.linalg.eigvalsh(z.T @ held.hessian @ z) * state.problem.scale
        assert pinned.breaking == pytest.approx(values, rel=1e-9)
        seen.add(len(values))
    assert seen == {2}


@pytest.mark.slow  # seconds of curves or searches
def test_a_state_without_one_hessian_has_no_number():
    found = panel_result(o.examples.degree6("pi/3"))
    report = find_contacts(found, check=False)
    assert any(np.isnan(s.breaking).all() and s.breaking for s in report.states)
