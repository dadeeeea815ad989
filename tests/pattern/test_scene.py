"""Scenes: angles, TOML round trip, packaged families, detection of symmetry on known vertices."""

import math

import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp import Scene, Vertex, examples, format_scene, parse_scene
from origami_nlp.errors import AngleError
from origami_nlp.pattern import format_angle, parse_angle


@given(st.integers(-1000, 1000), st.integers(1, 720))
def test_multiples_of_pi_read_back(p, q):
    value = parse_angle(f"{p}*pi/{q}")
    assert value == pytest.approx(p * math.pi / q, rel=1e-15)
    # one rounding of p pi and one of the division
    assert parse_angle(format_angle(value)) == pytest.approx(value, rel=4e-16)


def test_degrees_are_read():
    assert parse_angle("-22.5deg") == math.radians(-22.5)
    with pytest.raises(AngleError):
        parse_angle("pi deg")


@given(st.floats(-1e6, 1e6))
def test_numbers_read_back_exactly_or_as_a_multiple_of_pi(x):
    assert parse_angle(format_angle(x)) == pytest.approx(x, rel=4e-16, abs=0)


@settings(max_examples=40)
@given(st.text(max_size=80))
def test_any_text_is_an_angle_or_an_angle_error(text):
    try:
        assert math.isfinite(parse_angle(text))
    except AngleError as error:
        assert "\n" not in str(error)


@given(st.lists(st.floats(0.05, 3.0), min_size=3, max_size=9), st.data())
def test_scenes_survive_toml(parts, data):
    total = sum(parts)
    angles = [2 * math.pi * p / total for p in parts] if len(parts) > 3 else [math.pi / 2] * 4
    if max(angles) >= math.pi - 1e-9:
        return
    n = len(angles)
    unit = data.draw(st.floats(1e-12, 1e12))
    stiffness = [
        unit * k for k in data.draw(st.lists(st.floats(1e-4, 1e4), min_size=n, max_size=n))
    ]
    rest = data.draw(st.lists(st.floats(-math.pi, math.pi), min_size=n, max_size=n))
    name = data.draw(st.one_of(st.none(), st.text(st.characters(codec="utf-8"), max_size=20)))
    scene = Scene(Vertex(tuple(angles)), tuple(stiffness), tuple(rest), "none", name=name)
    assert parse_scene(format_scene(scene)) == scene


@pytest.mark.parametrize("scene", examples.panels(), ids=lambda s: s.name)
def test_packaged_families_match_the_paper(scene):
    a = scene.vertex.sector_angles
    n = scene.degree
    ratio = float(scene.name.split("r_k = ")[1])
    mountain = [k for k, r in zip(scene.stiffness, scene.rest_angles, strict=True) if r < 0]
    valley = [k for k, r in zip(scene.stiffness, scene.rest_angles, strict=True) if r > 0]
    assert len(set(mountain)) == len(set(valley)) == 1
    assert mountain[0] / valley[0] == pytest.approx(ratio, rel=1e-14)
    assert mountain[0] * valley[0] == pytest.approx(0.025**2, rel=1e-14)
    if n == 6:
        assert a[2] == a[0] == a[3] == a[5]
        assert a[1] == pytest.approx(math.pi - 2 * a[0])
        # Maekawa's theorem, to which the paper appeals for its assignments
        assert abs(len(mountain) - len(valley)) == 2
        assert scene.group.name == "D1"
    else:
        assert a[0] + a[1] == pytest.approx(math.pi / 2)
        assert scene.group.name == "D2"
    assert parse_scene(format_scene(scene)) == scene


def test_auto_finds_the_largest_group():
    assert examples.degree6("pi/4", 1, symmetry="auto").group.name == "D2"
    assert examples.degree6("5*pi/12", 1, symmetry="auto").group.name == "D1"
    assert examples.degree8("pi/4", 1, symmetry="auto").group.name == "D4"
    hexagon = Scene(Vertex(("pi/3",) * 6), (1,) * 6, (0.5,) * 6)
    assert hexagon.group.name == "D6"
    pinwheel = Scene(Vertex((1, math.pi - 1) * 2), (1, 2, 1, 2), (0.1, 0.2, 0.1, 0.2))
    assert pinwheel.group.name == "C2"
    skew = Scene(Vertex((1, 1.2, 1.4, 2 * math.pi - 3.6)), (1,) * 4, (0.1,) * 4)
    assert skew.group.name == "none"


def test_vertex_from_degrees():
    assert Vertex.from_degrees([90, 90, 90, 90]) == Vertex(("pi/2",) * 4)
    assert "pi/2" in repr(Vertex(("pi/2",) * 4))
