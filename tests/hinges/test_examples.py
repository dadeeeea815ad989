"""Packaged examples of hinges: what their files say they do, by hand."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

import origami_nlp as o
from origami_nlp.hinges import HINGE_EXAMPLES, bistable_strip
from origami_nlp.pattern import frame_pattern, parse_fold


def found(name):
    return o.find_minima(o.parse_scene(HINGE_EXAMPLES[name]()), prove=False, escape=False).minima


def test_a_tape_spring_locks_and_folds():
    """Book folds about creases 1 and 3: by hand the torques of both balance at one angle."""
    scene = o.parse_scene(HINGE_EXAMPLES["tape-spring"]())
    law, k, rest = scene.laws[0], scene.stiffness[2], scene.rest_angles[2]
    angle, torque = np.radians(law_table()[0]), law_table()[1]
    tape = PchipInterpolator(angle, torque)

    def balance(phi):
        return float(tape(phi)) + k * (phi - rest)

    assert law.torque(np.array([0.5])) == pytest.approx(float(tape(0.5)), abs=1e-9)
    locked, folded = (
        brentq(balance, 0.0, math.radians(8)),
        brentq(balance, math.radians(40), math.radians(150)),
    )
    states = sorted(m.fold_angles[0] for m in found("tape-spring"))
    assert states == pytest.approx([locked, folded], abs=1e-7)
    assert (
        balance(math.radians(10)) > 0 > balance(math.radians(18))
    )  # between them the tape has buckled


def law_table():
    import tomllib

    table = tomllib.loads(HINGE_EXAMPLES["tape-spring"]())["laws"]["tape"]
    return np.array(table["angle_deg"], float), np.array(table["torque"])


def test_magnets_latch_a_crease():
    states = found("magnets")
    assert min(abs(math.degrees(m.fold_angles[1]) - 59) for m in states) < 1
    latched = [m for m in states if abs(math.degrees(m.fold_angles[1])) > 150]
    assert latched and len(states) > len(latched)
    for m in latched:  # within the reach of the magnets: three widths of the well
        assert abs(math.degrees(m.fold_angles[1]) - 165) < 3 * 12


def test_thick_panels_rest_on_their_stops():
    (state,) = found("thick-panel")
    stop = math.pi - 2 * math.atan(6 / (2 * 4))
    assert state.fold_angles[1] == pytest.approx(stop, abs=1e-9)
    assert state.fold_angles[3] == pytest.approx(stop, abs=1e-9)
    assert {c.type for c in state.contacts} == {"fold-limit"}
    # Miura: tan(a/2) = cos(60 deg) tan(b/2) of the straight line and the zigzag
    assert abs(state.fold_angles[0]) == pytest.approx(
        2 * math.atan(0.5 * math.tan(stop / 2)), abs=1e-9
    )


@pytest.mark.parametrize("creases", [2, 3])
def test_a_strip_has_two_states_a_crease(creases):
    sheet = frame_pattern(parse_fold(json.dumps(bistable_strip(creases)))[0])
    states = o.find_minima(sheet, escape=False).minima
    signs = {tuple(np.sign(m.fold_angles).astype(int)) for m in states}
    assert len(states) == len(signs) == 2**creases
    assert np.degrees(np.abs([m.fold_angles for m in states])) == pytest.approx(50, abs=1e-3)
