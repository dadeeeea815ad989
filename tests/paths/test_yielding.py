"""Hinges that yield under a load, against incremental energies minimised along a closed form of the closed states."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from tests.independent import scan_four
from tests.paths.test_hinges import SECTORS, random_scene


def simulated(k, rest, most, start, loads):
    """Stick-slip: at each load the nearest minimum of what is stored and taken, along a branch over crease 1.

    Returns fold angles [L, 4], plastic angles [L, 4] and the plastic work, of loads [L].
    """
    phi_1 = np.linspace(-np.pi + 1e-6, np.pi - 1e-6, 40_001)
    both = np.split(scan_four._with_first_given(np.radians(SECTORS), phi_1), 2)
    x = min(both, key=lambda b: np.abs(b - start).max(axis=1).min())
    j, p, work = int(np.abs(x - start).max(axis=1).argmin()), np.zeros(4), 0.0
    states, moved = [], []
    for t in loads:

        def slipped(i, p=p):
            e = x[i] - rest - p
            return e, np.maximum(np.abs(k * e) - most, 0.0) / k  # how far a hinge slips

        def total(i, p=p, t=t):
            e, over = slipped(i, p)
            return float((0.5 * k * (np.abs(e) - over) ** 2 + most * over).sum() - t * x[i, 0])

        while (best := min((j - 1, j, j + 1), key=total)) != j:
            j = best
        e, over = slipped(j)
        slip = np.sign(e) * over
        p, work = p + slip, work + float(most @ np.abs(slip))
        states.append(x[j])
        moved.append(p)
    return np.array(states), np.array(moved), work


@pytest.mark.parametrize("seed", [3, *(pytest.param(k, marks=pytest.mark.slow) for k in (14, 22))])
def test_a_path_is_that_of_stick_slip(seed):
    scene, rng = random_scene(seed=seed), np.random.default_rng(1000 + seed)
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    start = np.array(o.find_minima(scene, prove=False, escape=False).minima[0].fold_angles)
    borne = np.abs(k * (start - rest))
    most = (1.02 + 0.3 * rng.random()) * borne.mean() * rng.uniform(0.8, 1.5, 4)
    most = np.maximum(most, 1.05 * borne)
    to = float(rng.choice([-1, 1]) * most.max() * rng.uniform(0.5, 2))
    path = o.load_path(scene, 1, to=to, yield_torque=most.tolist(), unload=True)
    assert path.legs[-1].why == "range" and path.legs[-1].points[-1].t == 0 and not path.alarms
    yields = [e for e in path.events if e.type == "yields"]
    assert yields and path.plastic_work > 0
    up = np.linspace(0, to, 1_001)
    states, moved, work = simulated(k, rest, most, start, np.concatenate([up, up[::-1]]))
    # the simulation steps the load by to / 1,000 and the angle by 2e-4: its error, and no more
    assert np.abs(states[-1] - path.legs[-1].points[-1].fold_angles).max() < 5e-3
    assert np.abs(moved[-1] - path.legs[-1].moved).max() < 5e-3
    assert work == pytest.approx(path.plastic_work, rel=1e-2)
    for event in yields:
        i = int(event.contact.removeprefix("crease ")) - 1
        first = up[np.flatnonzero(np.abs(moved[: len(up), i]) > 1e-12)[0]]
        assert first == pytest.approx(event.t, abs=2e-3 * abs(to))
        phi = np.array(event.fold_angles)
        before = next(leg for leg in path.legs if leg.points[-1].t == event.t).moved
        assert abs(k[i] * (phi - rest - before)[i]) == pytest.approx(most[i], rel=1e-9)


def test_work_of_the_load_is_stored_or_taken():
    """The area under load against angle is the energy stored and the plastic work, loading and unloading."""
    scene = random_scene(seed=1)
    start = np.array(o.find_minima(scene).minima[0].fold_angles)
    most = 1.1 * np.abs(scene.stiffness * (start - scene.rest_angles)).max()
    path = o.load_path(scene, 1, to=-0.8, yield_torque=float(most), unload=True)
    points = [p for leg in path.legs for p in leg.points]
    t, angle = np.array([p.t for p in points]), np.array([p.angle for p in points])
    area = float(np.sum(0.5 * (t[1:] + t[:-1]) * np.diff(angle)))
    stored = points[-1].energy - points[0].energy
    assert area == pytest.approx(stored + path.plastic_work, rel=2e-3)
    assert path.dissipated == path.plastic_work


def test_a_path_that_begins_far_away_snaps_at_the_flat_state():
    """There the energy falls along the other curve that crosses: by samples of all closed states."""
    scene = random_scene(seed=13)
    path = o.load_path(scene, 1, to=12.0)
    assert np.linalg.norm(path.legs[0].points[0].fold_angles) > 1.0
    snap = path.snaps[0]
    assert snap.type == "flat state" and not any(snap.before)
    x = scan_four.closed_states(np.radians(SECTORS), 20_001)
    away = np.linalg.norm(x, axis=1)
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)

    def energy(x):
        return (0.5 * k * (x - rest) ** 2).sum(axis=-1) - snap.t * x[..., 0]

    near = x[(away > 0.02) & (away < 0.04)]
    assert energy(near).min() < float(energy(np.zeros(4))) - 1e-3
