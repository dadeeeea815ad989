"""States over a parameter: branches against searches, events, counts, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from benchmarks import random_vertex
from origami_nlp.errors import OptionError
from origami_nlp.minima import judge_in_full_space
from origami_nlp.paths import (
    draw_path,
    follow,
)

TYPES = "fold nonsmooth-fold closes leaves branching breaks-symmetry singular".split()


def generic(seed, degree):
    return random_vertex(np.random.default_rng(seed), degree, "full")


@pytest.fixture(scope="module")
def atlas():
    return follow(o.examples.degree6("5*pi/12"), "ratio=0.1:100")


def minima(states):
    return [np.array(s.fold_angles) for s in states if s.verdict == "minimum"]


def compare(atlas, t, **search):
    """Assert that branches and a search have the same minima at t; a search may miss what is certified."""
    found = o.find_minima(atlas.family.scene_of(t), prove=False, **search, escape=False)
    branches = minima(atlas.at(t))
    for m in found.minima:
        apart = [np.abs(np.array(m.fold_angles) - b).max() for b in branches]
        assert min(apart, default=9.0) < 1e-6, (t, np.degrees(m.fold_angles), m.kind)
    return len(branches) - len(found.minima)


@pytest.mark.slow  # seconds of curves or searches
def test_the_third_state_of_5_pi_12_is_born_without_an_eigenvalue(atlas):
    birth, closes = atlas.events
    assert (birth.type, closes.type) == ("nonsmooth-fold", "closes")
    assert birth.t == pytest.approx(1.788720163, abs=1e-9)
    at_birth = [p for b in atlas.branches for p in b.points if p.t == birth.t]
    assert at_birth and all(abs(p.eigenvalue) > 1e-3 for p in at_birth)
    assert [i.minima for i in atlas.intervals] == [2, 3, 3]
    for share, count in ((0.99, 2), (1.01, 3)):
        assert len(minima(atlas.at(birth.t * share))) == count
        assert compare(atlas, birth.t * share) >= 0
    assert not atlas.alarms


def test_a_minimum_that_sweeps_missed_is_there(atlas):
    angles = (31.08, -94.12, -94.12, 31.08, -94.12, -94.12)
    assert min(np.abs(np.degrees(b) - angles).max() for b in minima(atlas.at(1.8055))) < 0.01


def test_states_at_a_value_are_polished_and_judged(atlas):
    for t in (0.1, 1.0, 17.3, 100.0):
        for state in atlas.at(t):
            assert state.closure_residual < 1e-12 and state.kkt_residual < 1e-11
            assert state.verdict in ("minimum", "saddle")
            energy = atlas.family.scene_of(t).energy(state.fold_angles)
            assert state.energy == pytest.approx(energy, rel=1e-12)
    pinned = next(s for s in atlas.at(2.0) if s.kind == "contact-pinned")
    ends = [t for b in atlas.branches if b.kind == "contact-pinned" for t in b.t]
    assert (min(ends), max(ends)) == (atlas.events[0].t, 100.0) and pinned.energy > 0
    with pytest.raises(OptionError, match="outside"):
        atlas.at(101.0)


def test_every_event_is_located_in_its_own_function(atlas):
    for e in atlas.events:
        assert e.type in TYPES and e.located
        assert e.residuals.kkt < 1e-11 and abs(e.residuals.event) < 1e-11


def test_branches_are_turned_with_a_slider_over_the_parameter(atlas):
    content = atlas.view_content()
    assert [s.folded.fold_angles.tolist() for s in content.stations] == [
        list(e.fold_angles) for e in atlas.events
    ]
    known = {(p.t, p.fold_angles) for b in atlas.branches for p in b.points}
    shown = set()
    for track in content.tracks:
        steps = np.diff(track.parameter)
        assert (steps > 0).all() or (steps < 0).all()
        shown |= {
            (float(t), tuple(s.fold_angles.tolist()))
            for t, s in zip(track.parameter, track.states, strict=True)
        }
    assert shown == known
    html = atlas.view()._repr_html_()
    assert "nonsmooth-fold" in html and "branch 2" in html


@pytest.mark.slow  # seconds of curves or searches
def test_the_flat_state_on_a_curve_is_located_and_the_curve_leads_there():
    """By an equation at the flat state alone; by the points of the curve on both sides, whose size is linear in t."""
    atlas = follow(generic(1, 5), "creases.rest_angles[1]=-1:pi", checks=2)
    (event,) = [e for e in atlas.events if e.type == "singular"]
    assert all(e.located for e in atlas.events)
    assert set(event.fold_angles) == {0.0} and "flat" in event.note
    near = [
        (p.t - event.t, np.copysign(np.linalg.norm(p.fold_angles), p.t - event.t))
        for b in atlas.branches
        for p in b.points
        if abs(p.t - event.t) < 0.25 and np.abs(p.fold_angles).max() < 0.2
    ]
    apart, size = np.array(near).T
    assert apart.min() < 0 < apart.max() and len(near) > 4
    assert np.polyfit(apart, size, 2)[-1] == pytest.approx(0, abs=1e-4)


@pytest.mark.slow  # a survey of several seconds
def test_a_symmetry_that_is_lost_is_located():
    """On one side of the event the state is stable in the full space, on the other it is not."""
    atlas = follow(o.examples.degree8("pi/4"), "creases.rest_angles[2]=-2.2:-1.8", checks=2)
    event = next(e for e in atlas.events if e.type == "breaks-symmetry")
    assert event.located
    verdicts = []
    for t in (event.t - 0.02, event.t + 0.02):
        near = min(
            atlas.at(t), key=lambda s: np.abs(np.subtract(s.fold_angles, event.fold_angles)).max()
        )
        assert near.verdict == "minimum"
        verdicts.append(judge_in_full_space(atlas.family.scene_of(t), np.array(near.fold_angles)))
    assert [v.verdict == "stable" for v in verdicts].count(True) == 1
    for v in verdicts:
        assert (v.verdict == "stable") == (min(v.hessian_eigenvalues) > 0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_the_number_of_minima_changes_only_at_events(seed):
    atlas = follow(generic(100 + seed, 4 + seed % 3), "creases.rest_angles[1]=-pi:pi", checks=4)
    for interval in atlas.intervals:
        a, b = interval.t
        if b - a < 1e-3:
            continue
        for share in (0.2, 0.8):
            extra = compare(atlas, a + share * (b - a))
            assert extra >= 0
            assert len(minima(atlas.at(a + share * (b - a)))) == interval.minima


def test_an_atlas_comes_back_from_its_file(atlas, tmp_path):
    o.save(atlas, tmp_path / "atlas.json")
    back = o.read_result(tmp_path / "atlas.json")
    assert back.to_dict() == atlas.to_dict() and back.events == atlas.events
    assert back.intervals == atlas.intervals
    assert len(draw_path(back).axes) == len(draw_path(atlas).axes)
    with pytest.raises(OptionError, match="follow anew"):
        back.at(1.0)


def test_a_check_says_whether_it_is_complete():
    one = follow(generic(3, 4), "creases.rest_angles[1]=0.5:0.6", checks=1)
    assert one.checks[0].complete == ""
    two = follow(o.examples.degree6("pi/4"), "ratio=1:1.1", checks=1, prove=True, full=False)
    assert two.checks[0].complete == "proved"
