"""Rows in C are those of NumPy: the same enclosures to rounding, the same boxes, the same verdicts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.families import family_scene
from origami_nlp import Model, Scene, Vertex, examples
from origami_nlp.numerics import SWITCH
from origami_nlp.proof import compiled_boxes, prove
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.boxes import BEYOND
from origami_nlp.proof.complete import pose
from origami_nlp.proof.straight_line import straight_line
from origami_nlp.proof.touches import contact_strata
from tests.computed_once import thinned

PANELS = examples.panels()
TURNED = Scene(
    Vertex.from_degrees((70, 50) * 3), (1.0, 2.0) * 3, (0.5, -1.0) * 3, "C3", "fold-limits"
)
SCENES = [PANELS[k] for k in (1, 9, 11)]
SCENES += [family_scene("fold-limits", k) for k in range(3)]
SCENES += [family_scene("full-contact", 1), TURNED]
SAME = 1e-13
"""Relative: sums are added up in an order that the processor's NumPy chooses."""


def forms_of(scene):
    yield pose(Model(replace(scene, contact="fold-limits")))[0]
    if scene.contact == "full":
        yield from (stratum.posed for stratum in contact_strata(Model(scene)))


def random_boxes(rng, n, width, count=70):
    """Boxes on any strata, some of one point."""
    pins = rng.choice([0, 0, 0, 1, -1], (n, count))
    lower = rng.uniform(-math.pi, math.pi, (n, count))
    upper = np.minimum(lower + width * rng.integers(0, 3, (n, count)), BEYOND)
    return np.where(pins, pins * math.pi, lower), np.where(pins, pins * math.pi, upper), pins


def parts(form):
    return form.centre, form.slopes, form.error


@pytest.mark.parametrize("scene", SCENES, ids=range(len(SCENES)))
def test_enclosures_are_those_of_numpy(scene):
    rng = np.random.default_rng(1)
    seen = 0
    for forms in forms_of(scene):
        program = straight_line(forms)
        if program is None:
            pytest.skip("no C compiler, or it is switched off")
        for width in (7.0, 0.1, 1e-5, 0.0):
            angles = Angles.over(*random_boxes(rng, forms.size, width))
            for one, other in zip(program(angles), forms.enclosed(angles), strict=True):
                size = other.magnitude()
                for a, b in zip(parts(one), parts(other), strict=True):
                    room = size[..., None, :] if a.ndim > size.ndim else size
                    assert a.shape == b.shape and (np.abs(a - b) <= SAME * room).all()
                # they differ by less than the rounding that each allows for
                off = np.abs(one.centre - other.centre) + np.abs(one.slopes - other.slopes).sum(
                    axis=-2
                )
                assert (off <= np.minimum(one.error, other.error)).all()
                seen += one.centre.size
    assert seen > 500


@pytest.mark.parametrize("scene", [SCENES[0], SCENES[6], TURNED], ids=["D", "none", "C"])
def test_a_vertex_is_noted_once_and_each_has_its_own_springs(scene):
    rng = np.random.default_rng(2)
    programs = []
    # springs that keep the symmetry: 1 and 0 are the numbers that tracing would leave out
    for k, rest in ((1.0, 0.0), (3.0, 0.7)):
        stiffness = tuple(np.array(scene.stiffness) ** k)
        sprung = replace(
            scene, stiffness=stiffness, rest_angles=tuple(rest * np.array(scene.rest_angles))
        )
        for forms in forms_of(sprung):
            program = straight_line(forms)
            if program is None:
                pytest.skip("no C compiler, or it is switched off")
            programs.append(program)
            angles = Angles.over(*random_boxes(rng, forms.size, 0.1))
            for one, other in zip(program(angles), forms.enclosed(angles), strict=True):
                off = np.abs(one.centre - other.centre)
                assert (off <= SAME * other.magnitude()).all() and (off <= other.error).all()
    half = len(programs) // 2
    for one, other in zip(programs[:half], programs[half:], strict=True):
        assert one._noted is other._noted and one._slots is not other._slots


def test_other_sectors_are_noted_anew():
    forms = [
        next(forms_of(replace(TURNED, vertex=Vertex.from_degrees((70 + d, 50 - d) * 3))))
        for d in (0, 1)
    ]
    programs = [straight_line(f) for f in forms]
    if None in programs:
        pytest.skip("no C compiler, or it is switched off")
    assert programs[0]._noted is not programs[1]._noted
    angles = Angles.over(*random_boxes(np.random.default_rng(3), forms[0].size, 0.1))
    values = [p(angles)[0].centre for p in programs]
    assert np.abs(values[0] - values[1]).max() > 1e-3


@pytest.mark.parametrize("number", thinned(range(len(PANELS)), 3))
def test_panels_are_proved_the_same(number, monkeypatch):
    assert_same(PANELS[number], monkeypatch)


@pytest.mark.parametrize("family", ["fold-limits", "full-contact"])
@pytest.mark.parametrize(
    "number", [0, pytest.param(1, marks=pytest.mark.slow), pytest.param(2, marks=pytest.mark.slow)]
)
def test_random_vertices_are_proved_the_same(family, number, monkeypatch):
    if (family, number) != ("full-contact", 2):  # three degrees of freedom are too many there
        assert_same(family_scene(family, number), monkeypatch)


def assert_same(scene, monkeypatch):
    one = prove(Model(scene))
    monkeypatch.setenv(SWITCH, "0")
    monkeypatch.setattr(compiled_boxes, "_MADE", [])
    assert straight_line(pose(Model(replace(scene, contact="fold-limits")))[0]) is None
    other = prove(Model(scene))
    assert (one.boxes, one.complete, one.flat) == (other.boxes, other.complete, other.flat)
    assert [p.stratum for p in one.points] == [p.stratum for p in other.points]
    assert [p.is_minimum for p in one.points] == [p.is_minimum for p in other.points]
    assert [c.stratum for c in one.singular] == [c.stratum for c in other.singular]
    for a, b in zip(one.points, other.points, strict=True):
        assert np.abs(np.subtract(a.x, b.x)).max() <= a.radius + b.radius
