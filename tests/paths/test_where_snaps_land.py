"""Where a snap lands, by small steps of overdamped motion in code of its own; what confirms it."""

import numpy as np
import pytest

from benchmarks.families import fold_limits, full_contact
from origami_nlp import find_minima, load_path
from tests.independent.rotations import fold, rotation_vector

STEP = 5e-3
"""Of the motion [rad], in the metric of the springs."""


def moved(scene, torque, phi):
    """The state at which overdamped motion comes to rest: each crease k dphi/dtime = its torque, creases within pi."""
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    root, sectors = np.sqrt(k / k.mean()), scene.vertex.sector_angles
    for _ in range(40_000):
        pull = (torque - k * (phi - rest)) / root / k.mean()
        shut, held = np.abs(phi) >= np.pi - 1e-12, np.zeros(len(phi), bool)
        for _ in phi:  # creases that are pushed against their limits stay there
            rows = np.vstack([fold(sectors, phi)[0][0].T / root, np.eye(len(phi))[held]])
            rate = pull - np.linalg.pinv(rows) @ (rows @ pull)
            into = shut & ~held & (rate * phi > 1e-13)
            if not into.any():
                break
            held |= into
        if np.linalg.norm(rate) < 1e-7:
            return phi
        ahead = STEP * rate / max(np.linalg.norm(rate), 0.1)
        phi = np.clip(phi + ahead / root, -np.pi, np.pi)
        for _ in range(4):  # back onto closure
            creases, product = fold(sectors, phi)
            rows = (creases[0].T / root)[:, ~held]
            phi[~held] -= np.linalg.pinv(rows) @ rotation_vector(product)[0] / root[~held]
            phi = np.clip(phi, -np.pi, np.pi)
    raise AssertionError("it does not come to rest")


MANY = [pytest.param(k, marks=pytest.mark.slow) for k in (1, 2, 3, 6, 9, 13, 14, 24, 25)]


@pytest.mark.slow  # a second look at what other tests of the room say
@pytest.mark.parametrize("number", [12, *MANY])
def test_a_snap_lands_where_slow_motion_comes_to_rest(number):
    scene = fold_limits(number)
    snaps = [s for s in load_path(scene, 1, confirm=False).snaps if s.type == "fold"]
    assert snaps
    for snap in snaps:
        torque = np.zeros(scene.degree)
        torque[0] = snap.t * (1 + 1e-4)
        end = moved(scene, torque, np.array(snap.before))
        assert np.abs(end - snap.before).max() > 0.05
        assert end == pytest.approx(np.array(snap.after), abs=2e-3)


def test_a_search_confirms_the_state_of_the_path_itself():
    """Beside the flat state, where closure loses rank."""
    path = load_path(full_contact(0), 1)
    (snap,) = path.snaps
    assert snap.type == "flat state" and snap.confirmed.found == (True, True)
    there = find_minima(path.driver.at(snap.confirmed.t[0]), prove=False, escape=False).minima
    assert min(np.abs(m.fold_angles).max() for m in there) < 0.1 < np.abs(snap.after).max()
