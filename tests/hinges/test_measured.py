"""Measured hinges: laws found again from noise, bands that cover, loops by the shoelace, bad files by a line each."""

from __future__ import annotations

import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import SceneError, SceneFileError
from origami_nlp.pattern import read_law
from tests.command_line import run

GAP, NOISE = 1.5e-3, 2e-3


def true(x):
    return 0.05 * (x - 0.5) + 0.03 * np.sin(3 * x)


def slope(x):
    return 0.05 + 0.09 * np.cos(3 * x)


def cycle(rng, noise=NOISE, gap=GAP, rows=301):
    up = np.linspace(-1.5, 2.0, rows)
    x = np.concatenate([up, up[::-1]])
    y = true(x) + gap * np.repeat([1, -1], rows) + noise * rng.normal(size=x.size)
    return o.HingeData(x, y, name="tape")


def written(folder, data, name="tape.csv"):
    path = folder / name
    rows = [
        f"{math.degrees(a):.9f}, {t:.12g}" for a, t in zip(data.angle, data.torque, strict=True)
    ]
    path.write_text("# a test rig\nangle_deg, torque_Nm\n" + "\n".join(rows) + "\n")
    return path


def test_what_is_said_of_a_cycle_is_true():
    found = o.fit_hinge(cycle(np.random.default_rng(2)))
    assert abs(found.loop_area - 2 * GAP * 3.5) <= found.loop_error < 0.3 * found.loop_area
    for low, high in found.falling:
        assert (slope(np.linspace(low, high, 99)) < 0).all()
    assert found.falling and found.unsure < 0.35
    wells = [rest for rest in found.rests if rest.kind == "well"]
    x = np.linspace(-1.5, 2.0, 200_001)
    crossings = x[:-1][(true(x[:-1]) < 0) & (true(x[1:]) >= 0)]
    assert len(wells) == len(crossings)
    for rest, angle in zip(wells, crossings, strict=True):
        assert abs(rest.angle - angle) <= 1.5 * rest.known
        held = np.abs(true(x)) <= GAP
        near = x[held & (np.abs(x - angle) < 0.2)]
        assert np.allclose(rest.held, (near.min(), near.max()), atol=0.03)


def test_data_without_noise_is_the_law():
    x = np.radians(np.linspace(-120, 150, 91))
    # of a cubic spline 5/384 h^4 max |fourth derivative| at most (Hall and Meyer 1976), here of 22 intervals
    of_spline = 5 / 384 * (np.ptp(x) / 22) ** 4 * 0.03 * 3**4
    found = o.fit_hinge(o.HingeData(x, true(x)))
    assert np.abs(found.torque - true(found.angle)).max() <= of_spline
    assert math.isnan(found.loop_area)


def test_a_scene_has_the_law_of_a_file(tmp_path):
    data = cycle(np.random.default_rng(5))
    written(tmp_path, data)
    text = """
[vertex]
sector_angles_deg = [70, 80, 120, 90]
[creases]
stiffness = [1, 1, 1, 1]
rest_angles_deg = [0, 0, 0, 0]
limits_deg = [-80, 110]
law = "tape"
[model]
symmetry = "none"
contact = "fold-limits"
[laws.tape]
data = "tape.csv"
"""
    path = tmp_path / "scene.toml"
    path.write_text(text)
    scene = o.read_scene(path)
    assert scene.laws[0].coefficients == o.fit_hinge(tmp_path / "tape.csv").law.coefficients
    assert o.parse_scene(o.format_scene(scene)) == scene
    x = np.array([-1.0, 0.3, 1.5])
    assert np.abs(scene.laws[0].torque(x) - true(x)).max() < 3 * NOISE
    # beyond the data only on request, and then straight
    path.write_text(text.replace("limits_deg = [-80, 110]\n", ""))
    with pytest.raises(SceneError):
        o.read_scene(path)
    path.write_text(text.replace("limits_deg = [-80, 110]\n", "") + 'extrapolate = "linear"\n')
    law = o.read_scene(path).laws[0]
    beyond = np.linspace(2.1, 3.0, 5)
    assert np.ptp(law.slope(beyond)) < 1e-12 and law.breaks[-1] == math.pi
    ends = law.torque(np.array([2.0 - 1e-9, 2.0 + 1e-9]))
    assert abs(ends[1] - ends[0]) < 1e-9
    for wrong in ({"data": "tape.csv", "extrapolate": "cubic"}, {"data": "tape.csv", "knots": 3}):
        with pytest.raises(SceneError):
            read_law(wrong, "a", tmp_path)
    with pytest.raises(SceneFileError):
        read_law({"data": "nowhere.csv"}, "a", tmp_path)


ROWS = "\n".join(f"{a}, {0.01 * a}" for a in range(-30, 31, 5))
BAD = {
    "few": "0,0\n10,1\n20,2\n",
    "same": "10,0\n" * 9,
    "nan": ROWS + "\n35, nan",
    "beyond": ROWS + "\n190, 1",
    "radians": "\n".join(f"{a / 10}, {a}" for a in range(-30, 31)),
    "comma": ROWS.replace(",", ";") + "\n35;0,35",
    "commas": ROWS.replace(".", ","),
    "thousands": "angle_deg;torque_Nmm\n"
    + "\n".join(f"{a};1,{500 + a}" for a in range(-30, 31, 5)),
    "columns": ROWS + "\n35, 1, 2, 3",
    "names": "angle, moment\n" + ROWS,
    "twice": "angle_deg, angle_rad, torque_Nm\n0,0,0",
    "same torque": "\n".join(f"{a}, 1" for a in range(-30, 31)),
    "weights": "angle_deg,torque_Nm,weight\n" + "\n".join(f"{a},{a},{a}" for a in range(-30, 31)),
    "empty": "# nothing\n",
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_are_one_clear_line(tmp_path, case):
    path = tmp_path / "bad.csv"
    path.write_text(BAD[case])
    done = run("hinge", path)
    assert done.code == 2 and done.err.count("\n") == 1 and "bad.csv" in done.err


def test_units_and_separators_are_the_same_law(tmp_path):
    x = np.arange(-30, 31, 2)
    y = 0.01 * x + 1e-5 * x**3
    first = tmp_path / "a.csv"
    first.write_text("\n".join(f"{a},{float(t)!r}" for a, t in zip(x, y, strict=True)))
    second = tmp_path / "b.txt"
    second.write_text(
        "torque_Nmm\tangle_rad\tweight # mm\n"
        + "\n".join(
            f"{float(1e3 * t)!r}\t{math.radians(a)!r}\t2" for a, t in zip(x, y, strict=True)
        )
    )
    a, b = o.fit_hinge(first), o.fit_hinge(second)
    assert np.allclose(a.torque, b.torque, atol=1e-14) and np.allclose(a.angle, b.angle)
    third = tmp_path / "c.csv"  # a decimal comma is no separator
    third.write_text("angle_deg;torque_Nm;weight\n10,5;2\n")
    with pytest.raises(o.OrigamiError, match="line 2: '10,5' is no number"):
        o.fit_hinge(third)
