"""Modes of minima: eigenvalues, symmetry blocks, and the energy along geodesics to the first contact."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad

from origami_nlp import (
    Model,
    State,
    draw,
    examples,
    find_minima,
    find_modes,
    format_scene,
    load,
)
from origami_nlp.errors import OptionError
from origami_nlp.minima import full_scene, hessian_spectra
from origami_nlp.modes import geodesic
from origami_nlp.pattern import scene_pattern
from tests.command_line import run
from tests.independent.rotations import fold

SCENE = examples.degree6("5*pi/12", ratio=1)


@cache
def minima():
    return find_minima(SCENE, max_starts=32, prove=False, escape=False)


@cache
def modes():
    return find_modes(minima())


def test_blocks_are_those_of_the_full_spectrum_and_do_not_couple():
    model = Model(full_scene(SCENE))
    for state in modes().states:
        full, breaking = hessian_spectra(State(model, state.minimum.fold_angles), SCENE)
        assert state.eigenvalues() == pytest.approx(full, rel=1e-12)
        assert state.eigenvalues("breaking") == pytest.approx(breaking, rel=1e-12)
        assert len(state.eigenvalues("symmetric")) == 2 and not state.held
        assert state.coupling < 1e-15
        for mode in state.modes:
            d = mode.direction
            mirrored = d[(-np.arange(6)) % 6]
            sign = 1 if mode.block == "symmetric" else -1
            assert np.abs(mirrored - sign * d).max() < 1e-12


def test_the_energy_starts_as_the_eigenvalue_says_and_every_point_closes():
    for mode in (m for s in modes().states for m in s.modes):
        g, at = mode.along, int(np.flatnonzero(mode.along.s == 0)[0])
        h = g.s[at + 1]
        second = (g.rise[at + 1] + g.rise[at - 1] - 2 * g.rise[at]) / h**2
        assert second == pytest.approx(mode.eigenvalue, rel=2e-3)
        _, turn = fold(np.array(SCENE.vertex.sector_angles), g.states)
        assert np.abs(turn - np.eye(3)).max() < 1e-12
        energy = SCENE.energy(g.states)
        assert np.abs(energy - energy[at] - g.rise).max() < 1e-15


def test_ends_touch_and_go_no_further():
    model = Model(full_scene(SCENE))
    for mode in (m for s in modes().states for m in s.modes):
        for k, end in ((0, mode.along.ends[0]), (-1, mode.along.ends[1])):
            assert end.contacts and end.opening <= 1e-8
            beyond = mode.along.states[k] + 1e-6 * np.sign(mode.along.states[k])
            assert (np.abs(beyond) > np.pi).any() or model.refuses(beyond)
            assert all(not model.refuses(x) for x in mode.along.states[1:-1:20])


def test_a_mode_that_breaks_the_mirror_is_the_same_both_ways():
    for mode in (m for s in modes().states for m in s.modes if m.block == "breaking"):
        low, high = mode.along.ends
        assert -low.s == pytest.approx(high.s, rel=1e-10)
        assert low.rise == pytest.approx(high.rise, rel=1e-10)


def test_distances_converge_with_the_square_of_the_step():
    model = Model(full_scene(SCENE))
    held = State(model, minima().minima[1].fold_angles).on()
    direction = modes().states[1].modes[-1].direction
    s = [geodesic(held, direction, 0.02 * q).ends[1].s for q in (4, 2, 1)]
    assert (s[0] - s[1]) / (s[1] - s[2]) == pytest.approx(4, rel=0.2)
    assert abs(s[1] - s[2]) < 2e-5


def test_loaded_contacts_stay_closed_and_states_without_one_hessian_say_why():
    pinned = find_minima(
        replace(SCENE, preload=(-0.138, 0, 0, 0, 0, 0)), max_starts=32, prove=False, escape=False
    )
    found = find_modes(pinned, state=1).states[0]
    assert found.minimum.kind == "contact-pinned" and found.modes
    assert all("phi = -pi" in name for name in found.held)
    for mode in found.modes:
        assert np.abs(mode.along.states[:, (2, 4)] + np.pi).max() == 0
        assert not {c.index for end in mode.along.ends for c in end.contacts if c.is_limit} & {2, 4}
    singular = find_modes(
        find_minima(examples.degree6("pi/3"), max_starts=16, prove=False, escape=False)
    )
    assert all(s.why and not s.modes for s in singular.states)
    with pytest.raises(OptionError, match="1 to 3"):
        find_modes(pinned, state=4)


def test_a_pattern_of_one_vertex_has_the_modes_of_the_vertex():
    scene = replace(SCENE, symmetry="none")
    one = find_modes(find_minima(scene, effort="quick", prove=False, escape=False))
    # its states are those of the vertex, judged as of a sheet: no start has to find them again
    only = {"effort": "quick", "starts": 0, "prove": False, "escape": False}
    same = find_modes(find_minima(scene_pattern(scene), **only))
    known = {s.minimum.energy: s for s in one.states}
    assert [s.minimum.energy for s in same.states] == pytest.approx(sorted(known), rel=1e-12)
    reported = 0
    for state in same.states:
        near = [
            s for s in one.states
            if np.abs(np.subtract(s.minimum.fold_angles, state.minimum.fold_angles)).max() < 1e-9
        ]  # fmt: skip
        assert len(near) == 1 and bool(near[0].why) == bool(state.why)
        for a, b in zip(near[0].modes, state.modes, strict=True):
            assert b.eigenvalue == pytest.approx(a.eigenvalue, rel=1e-9)
            distinct = all(
                abs(m.eigenvalue - a.eigenvalue) > 1e-6 for m in near[0].modes if m is not a
            )
            if not distinct:
                continue
            reported += 1
            assert b.direction == pytest.approx(a.direction, abs=1e-9)
            for x, y in zip(a.along.ends, b.along.ends, strict=True):
                assert (y.s, y.rise) == pytest.approx((x.s, x.rise), abs=1e-9)
    assert reported >= 6


def miura_speed(t, long, short):
    """Length per angle t of so many creases, and of others with tan(x / 2) = tan(t / 2) / 2."""
    slope = 0.5 / (np.cos(t / 2) ** 2 + 0.25 * np.sin(t / 2) ** 2)
    return np.sqrt(long + short * slope**2)


def test_modes_of_a_miura_run_along_its_closed_form(tmp_path):
    """Every vertex has tan(x / 2) = cos(alpha) tan(y / 2) for its two pairs of creases."""
    pattern = examples.pattern("miura", 3, 3).with_springs(1.0, 0.0)
    rest = np.where(np.arange(12) % 3 == 0, 0.9, -0.4)
    sprung = pattern.with_springs(rest_angles=rest)
    found = find_minima(sprung, effort="quick", prove=False, escape=False)
    # where it is folded in half along lines, or has more degrees of freedom, its motion is another one
    kept = [m for m in found.minima if m.dof == 1 and np.abs(m.fold_angles).min() >= 0.05]
    assert 0 < len(kept) < len(found.minima)
    found = replace(found, minima=tuple(kept))
    modes = find_modes(found)
    along = [s for s in modes.states if s.modes]
    assert along
    for state in along:
        (mode,) = state.modes
        g, at = mode.along, int(np.flatnonzero(mode.along.s == 0)[0])
        tan = np.tan(g.states[np.abs(g.states).max(axis=1) < 3] / 2)
        long = np.abs(tan) > np.abs(tan).max(axis=1, keepdims=True) * 0.75
        share = np.abs(tan / np.abs(tan).max(axis=1, keepdims=True))
        assert np.abs(share[long] - 1).max() < 1e-9 and np.abs(share[~long] - 0.5).max() < 1e-9
        second = (g.rise[at + 1] + g.rise[at - 1] - 2 * g.rise[at]) / g.s[at + 1] ** 2
        assert second == pytest.approx(mode.eigenvalue, rel=2e-3)
        # length of the closed form from the state to where all creases are fully folded
        many = int(long[0].sum()), int((~long[0]).sum())
        y = np.abs(state.minimum.fold_angles).max()
        length, _ = quad(miura_speed, y, np.pi, many)
        far = min(mode.along.ends, key=lambda end: abs(abs(end.s) - length))
        assert abs(far.s) == pytest.approx(length, rel=1e-4) and "pi at crease" in far.why
    found.save(tmp_path / "states.json")
    modes.save(tmp_path / "modes.json")
    back = load(tmp_path / "modes.json")
    assert [s.eigenvalues() for s in back.states] == [s.eigenvalues() for s in modes.states]
    assert draw(modes, tmp_path / "modes.png").axes


def test_the_command_writes_numbers_and_a_figure(tmp_path):
    scene, figure = tmp_path / "scene.toml", tmp_path / "modes.png"
    scene.write_text(format_scene(SCENE))
    code, out, err = run("modes", scene, "--state", "2", "--effort", "quick", "-o", "-")
    assert code == 0, err
    data = json.loads(out)
    (state,) = data["states"]
    assert data["schema"] == "origami-nlp/modes/2" and state["number"] == 2
    values = [m["eigenvalue"] for m in state["modes"] if m["block"] == "symmetric"]
    assert values == pytest.approx(modes().states[1].eigenvalues("symmetric"), rel=1e-9)
    assert len(draw(modes(), figure).axes) == 4 and figure.stat().st_size > 10_000
    assert "held closed" not in str(modes()) and "#2.3" in str(modes())
