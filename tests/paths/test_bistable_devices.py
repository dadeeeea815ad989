"""Snap loads of bistable vertices: through the flat state, beyond a pitchfork, and at one; by hand and by SciPy."""

from functools import cache

import numpy as np
import pytest

from origami_nlp import examples, load_path
from tests.independent.rotations import fold


@cache
def path(name, crease, to, state=1):
    return load_path(getattr(examples, name)(), crease, to=to, state=state)


def closure(scene, phi):
    """The three entries of the product of rotations at states [..., n] that vanish, by code of its own, [..., 3]."""
    turned = fold(np.array(scene.vertex.sector_angles), phi.reshape(-1, phi.shape[-1]))[1]
    return (turned - np.eye(3))[:, [0, 0, 1], [1, 2, 2]].reshape(*phi.shape[:-1], 3)


def slopes(scene, phi, h=1e-4):
    """Derivatives of closure [n, 3] by differences that are exact to the fourth order."""
    steps = h * np.eye(len(phi))
    near, far = (closure(scene, phi + d) - closure(scene, phi - d) for d in (steps, 2 * steps))
    return (8 * near - far) / (12 * h)


def reduced(scene, creases, t, phi):
    """Residual torque under torques t, the Hessian on the tangent space, and its basis, by finite differences."""
    n, h = len(phi), 1e-4
    slope = slopes(scene, phi)
    torque = np.array(scene.stiffness) * (phi - scene.rest_angles)
    torque[np.array(creases) - 1] -= t
    multipliers = np.linalg.lstsq(slope, torque, rcond=None)[0]
    one, two = h * np.eye(n)[:, None], h * np.eye(n)[None]
    signs = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    curved = sum(a * b * closure(scene, phi + a * one + b * two) for a, b in signs) / (4 * h * h)
    hessian = np.diag(scene.stiffness) - curved @ multipliers
    tangent = np.linalg.svd(slope.T)[2][3:].T
    balance = np.abs(torque - slope @ multipliers).max()
    return balance, tangent.T @ hessian @ tangent, tangent


def stiffness(scene, creases, t, phi):
    """Residual torque under torques t, and the eigenvalues of the reduced Hessian [N m/rad]."""
    balance, hessian, _ = reduced(scene, creases, t, phi)
    return balance, np.linalg.eigvalsh(hessian)


def test_a_waterbomb_snaps_through_the_flat_state_at_the_load_of_its_slope_there():
    """By hand: along a = -b / sqrt(1/2) the energy of springs and load is level at the flat state."""
    scene = examples.waterbomb()
    k, rests = scene.stiffness[0], np.array(scene.rest_angles)
    along = np.array([-np.sqrt(2) / 2, 1, 1, -np.sqrt(2) / 2, 1, 1])
    level = -k * (rests @ along) / 4  # torque on four creases that turn by 1
    found = path("waterbomb", 2, -0.06)
    (snap,) = found.snaps
    assert snap.type == "flat state" and snap.t == pytest.approx(level, rel=1e-9)
    assert not np.any(found.legs[0].points[-1].fold_angles)
    assert np.degrees(snap.after) == pytest.approx([-90, 0, 0, -90, 0, 0], abs=1e-6)
    assert snap.released == pytest.approx(k * (np.pi / 2) ** 2, rel=1e-9)


def test_a_pitchfork_is_one_event_and_its_two_branches_are_images():
    found = path("waterbomb", 1, 0.09)
    kinds = [(e.type, round(e.t, 9)) for e in found.events]
    assert len(set(kinds)) == len(kinds)
    assert all(e.located for e in found.events)
    numbers = {b.id for b in found.branches}
    assert all(set(e.branches) <= numbers for e in found.events)
    again = next(e for e in found.events if abs(e.t - 0.0811602327791) < 1e-12)
    _, soft = stiffness(examples.waterbomb(), (1, 4), again.t, np.array(again.fold_angles))
    assert abs(soft[0]) < 1e-6


@pytest.mark.parametrize(("crease", "creases"), [(1, (1, 4)), (2, (2, 3, 5, 6))])
def test_the_stiffness_at_the_start_is_that_of_the_reduced_hessian(crease, creases):
    scene, found = examples.waterbomb(), path("waterbomb", crease, 0.09 if crease == 1 else -0.06)
    phi = np.array(found.legs[0].points[0].fold_angles)
    hessian, tangent = reduced(scene, creases, 0.0, phi)[1:]
    force = tangent.T @ np.isin(np.arange(1, 7), creases).astype(float)
    mean = force @ np.linalg.solve(hessian, force) / len(creases)  # per torque on each of them
    assert found.start_stiffness == pytest.approx(1 / mean, rel=1e-6)
    assert found.stiffness_unit == "N m/rad"
    after = found.legs[-1].stiffness  # of the state after the snap, under the load there
    assert after > 0 and np.isnan(found.legs[1].stiffness) == (crease == 1)
