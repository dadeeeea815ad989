"""States of patterns over a parameter: as those of the vertex they consist of, and as the closed form of the Miura."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

import origami_nlp as o
from origami_nlp.continuation import GeometryLine
from origami_nlp.errors import OptionError

FEW = {"checks": 1, "effort": "quick"}


def miura_torque(alpha, k, rest, large, t):
    """dU/dt of a Miura whose large folds are t and whose others have tan(x / 2) = cos(alpha) tan(t / 2)."""
    small = 2 * np.arctan(np.cos(alpha) * np.tan(t / 2))
    slope = np.cos(alpha) / (np.cos(t / 2) ** 2 + (np.cos(alpha) * np.sin(t / 2)) ** 2)
    signs = np.sign(rest)
    torques = np.where(
        large, k * (signs * t - rest) * signs, k * (signs * small - rest) * signs * slope
    )
    return float(torques.sum())


@pytest.mark.slow  # a survey of several seconds
def test_angles_of_a_miura_are_those_of_its_closed_form(tmp_path):
    """Its vertices move: closure itself changes along the family."""
    atlas = o.follow("miura:2x3", "alpha=57deg:61deg", **FEW)
    assert isinstance(atlas.family.line, GeometryLine) and not atlas.alarms
    reported = 0
    for alpha in np.radians([57, 58.3, 60.1, 61]):
        pattern = o.examples.pattern("miura:2x3", alpha=alpha)
        for state in atlas.at(alpha):
            phi = np.array(state.fold_angles)
            signs = np.sign(phi)
            if (signs != np.sign(pattern.rest)).any():
                continue  # another branch of its motions
            large = np.abs(phi) > np.abs(phi).max() - 1e-6
            given = alpha, pattern.stiffness, pattern.rest, large
            t = brentq(lambda v, g=given: miura_torque(*g, v), 0.01, 3.1, xtol=1e-14)
            assert np.abs(phi[large]).max() == pytest.approx(t, abs=1e-9)
            reported += 1
    assert reported == 4
    atlas.save(tmp_path / "a.json")
    back = o.read_result(tmp_path / "a.json")
    assert back.to_dict() == atlas.to_dict() and back.family.example == "miura:2x3"
    frames = atlas.to_fold()["file_frames"]
    assert len(frames) == sum(len(b.points) for b in atlas.branches)
    assert o.draw(atlas, tmp_path / "a.png").axes and atlas.view_content().tracks


@cache
def stiffened():
    return o.follow("metasheet:3x3", "creases.stiffness[1]=1:30", **FEW)


def both_sides(event, atlas):
    """The minima that a search finds, and that the atlas lists, beside an event."""
    for t in (0.99 * event.t, 1.01 * event.t):
        found = o.find_minima(atlas.family.scene_of(t), effort="quick", escape=False)
        yield t, found.minima, [s for s in atlas.at(t) if s.verdict == "minimum"]


def test_a_state_vanishes_where_its_hessian_does():
    """Stiffness of one crease of a metasheet: folds and contacts are events, and searches on both sides of it agree."""
    atlas = stiffened()
    (fold,) = [e for e in atlas.events if e.type == "fold"]
    assert fold.located and fold.residuals.kkt < 1e-10
    many = []
    for _, found, listed in both_sides(fold, atlas):
        assert [m.energy for m in found] == pytest.approx([s.energy for s in listed], rel=1e-9)
        many.append(len(listed))
    assert abs(many[0] - many[1]) == 1


def test_a_state_vanishes_where_its_contact_opens():
    """What searches find is followed, and each state that is followed is a minimum when judged by itself."""
    atlas = stiffened()
    (contact,) = [e for e in atlas.events if e.type == "nonsmooth-fold"]
    assert contact.located and "side 2-5 of facet 2" in contact.contact
    many = []
    for t, found, listed in both_sides(contact, atlas):
        energies = np.array([s.energy for s in listed])
        assert all(np.abs(energies - m.energy).min() < 1e-9 * m.energy for m in found)
        for s in listed:
            assert o.classify(atlas.family.scene_of(t), s.fold_angles).verdict == "minimum"
        many.append(len(listed))
    assert abs(many[0] - many[1]) == 1


def test_a_vertex_that_moves_and_what_is_refused():
    atlas = o.follow("miura:2x2", "vertices.x[0]=-0.1:0.1", **FEW)
    assert [i.minima for i in atlas.intervals] == [2] and not atlas.events
    for name, word in (
        ("nothing=0:1", "no number"),
        ("stiffness[99]=1:2", r"\[1\] to stiffness\[4\]"),
        ("vertices.x[99]=0:1", r"x\[0\] to x\[8\]"),
    ):
        with pytest.raises(OptionError, match=word):
            o.follow("miura:2x2", name, **FEW)
