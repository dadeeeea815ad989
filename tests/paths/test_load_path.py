"""Load paths: snaps, hysteresis and contact events, confirmed by searches, by energy balance and from behind."""

import json
from functools import cache

import numpy as np
import pytest

from origami_nlp import draw, examples, format_scene, load_path
from tests.command_line import run
from tests.independent.rotations import fold
from tests.paths.test_sheet_loads import work_of

SCENE = examples.degree6("5*pi/12", ratio=1)
SNAP, AGAIN = -0.138149523101, -0.123882378029
"""Found by another program, with other steps: N m on crease 1."""


@cache
def loop():
    return load_path(SCENE, 1, to=-0.2, unload=True)


def test_the_snap_and_where_it_becomes_stable_again():
    there, back = loop().snaps
    assert there.type == "fold" and there.t == pytest.approx(SNAP, abs=1e-10)
    assert back.type == "nonsmooth-fold" and back.t == pytest.approx(AGAIN, abs=1e-10)
    assert [leg.why for leg in loop().legs] == ["snap", "range", "snap", "range"]
    assert not loop().alarms and not loop().driver.keeps
    for event in loop().events:
        assert event.located and max(event.residuals.kkt, abs(event.residuals.event)) < 1e-11


def test_the_work_of_the_load_is_energy_on_legs_and_lost_in_snaps():
    for leg in loop().legs:
        gained = leg.points[-1].energy - leg.points[0].energy
        assert work_of(leg.points) == pytest.approx(gained, rel=1e-3)
    lost = sum(work_of(leg.points) for leg in loop().legs)
    lost += sum(s.t * (s.angle[1] - s.angle[0]) for s in loop().snaps)
    assert lost == pytest.approx(loop().dissipated, rel=1e-3)
    for snap in loop().snaps:  # by the energy of springs alone
        springs = SCENE.energy(snap.before) - SCENE.energy(snap.after)
        way = snap.before[0] - snap.after[0]
        assert snap.released == pytest.approx(springs - snap.t * way, abs=1e-14)


def test_states_on_the_path_close_and_balance_by_finite_differences():
    sectors = np.array(SCENE.vertex.sector_angles)
    for leg in loop().legs:
        for p in leg.points[:: max(1, len(leg.points) // 6)]:
            phi = np.array(p.fold_angles)
            assert np.abs(fold(sectors, phi)[1] - np.eye(3)).max() < 1e-12
            assert SCENE.energy(phi) == pytest.approx(p.energy, abs=1e-15)
            if (np.abs(phi) > np.pi - 1e-9).any():
                continue
            h = 1e-6 * np.eye(6)
            slopes = [
                (fold(sectors, phi + d)[1] - fold(sectors, phi - d)[1]).ravel() / 2e-6 for d in h
            ]
            torque = np.array(SCENE.stiffness) * (phi - SCENE.rest_angles) - p.t * np.eye(6)[0]
            left = (
                torque - np.array(slopes) @ np.linalg.lstsq(np.array(slopes), torque, rcond=1e-6)[0]
            )
            assert np.abs(left).max() < 1e-8


def test_a_state_that_is_stable_with_its_symmetry_alone_keeps_it_and_says_so():
    path = load_path(examples.degree6("pi/3"), 1, to=0.06, effort="quick", max_starts=24)
    assert path.driver.keeps == "D1" and len(path.alarms) == 1 and "keeps it" in path.alarms[0]
    for p in path.legs[0].points:  # creases 2 and 6, 3 and 5 are images
        assert p.fold_angles[1:3] == p.fold_angles[:3:-1]


def test_the_command_writes_numbers_a_figure_and_frames(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(format_scene(SCENE))
    args = ("--crease", "1", "--to", "-0.15", "--no-full", "--effort", "quick")
    code, out, err = run("load", scene, *args, "-o", "-", "-o", tmp_path / "path.fold")
    assert code == 0, err
    data = json.loads(out)
    assert data["schema"] == "origami-nlp/path/2" and data["driver"]["unit"] == "N m"
    assert [e["type"] for e in data["events"]] == ["fold", "nonsmooth-fold"]
    assert data["events"][0]["t"] == pytest.approx(SNAP, abs=1e-10)
    assert {"id", "kind", "points", "ends"} <= set(data["branches"][0])
    frames = json.loads((tmp_path / "path.fold").read_text())["file_frames"]
    assert len(frames) == sum(len(leg["points"]) for leg in data["legs"])
    assert len(loop().to_fold()["file_frames"]) == sum(len(leg.points) for leg in loop().legs)
    assert len(draw(loop(), tmp_path / "load.png").axes) == 3
