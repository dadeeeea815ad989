"""Patterns with many degrees of freedom and random springs: no claimed minimum is refuted by independent code.

Closure by rotation matrices of scipy; crossings by the Flexible Collision Library; closed states beside it, drawn at
random with some of the fold limits let go, none of them lower but through facets.
"""

import math

import numpy as np
import pytest

from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_states import find_states

pytest.importorskip("fcl", reason="python-fcl, of the extra test")
from tests.independent.rigid import Rigid

PROBES = 200
"""Closed states beside each state."""


def sprung(name, seed):
    rng = np.random.default_rng(seed)
    pattern = as_pattern(name)
    n = pattern.creases
    return pattern.with_springs(list(10 ** rng.uniform(-1, 1, n)), list(rng.uniform(-3, 3, n)))


def beside(body, phi, rng, most):
    """Closed states beside one: of the creases at their limits all but two at most stay there."""
    at_limit = np.flatnonzero(math.pi - np.abs(phi) < 1e-9)
    slopes = body.differences(phi)
    for _ in range(20):
        opened = rng.choice(at_limit, rng.integers(0, min(2, len(at_limit)) + 1), replace=False)
        free = np.setdiff1d(np.arange(len(phi)), np.setdiff1d(at_limit, opened))
        _, values, vt = np.linalg.svd(slopes[:, free])
        rank = int((values > 1e-6).sum())
        if rank == len(free):
            continue
        inverse = np.zeros((len(phi), len(slopes)))
        inverse[free] = np.linalg.pinv(slopes[:, free], rcond=1e-6)
        for _ in range(most // 20):
            way = np.zeros(len(phi))
            way[free] = vt[rank:].T @ rng.normal(size=len(free) - rank)
            if len(opened) and (way[opened] * phi[opened] > 0).any():
                way = -way
            if len(opened) and (way[opened] * phi[opened] > 0).any():
                continue
            size = 10 ** rng.uniform(-4, -2)
            new = body.closed(phi + size * way / np.linalg.norm(way), inverse, within=1e-13)
            if new is not None and np.abs(new).max() <= math.pi and np.abs(new - phi).max() < 0.05:
                yield new


def check_admissible(name, seed, contact, most=PROBES):
    """Return how many minima were claimed, and how many states beside them were looked at."""
    pattern = sprung(name, seed)
    body, rng = Rigid(pattern), np.random.default_rng(seed)
    found = find_states(
        pattern.with_contact("full" if contact else "fold-limits"),
        starts=1,
        seed=seed,
        seconds=5.0,
        escape=False,
    )
    looked = 0
    for state in found.minima:
        phi, energy = state.phi, float(pattern.energy(state.phi))
        assert np.abs(body.open(phi)).max() < 1e-11
        assert np.abs(phi).max() <= math.pi
        assert energy == pytest.approx(state.energy, rel=1e-12)
        assert not contact or not body.deep(phi)
        for new in beside(body, phi, rng, most):
            looked += 1
            drop = energy - float(pattern.energy(new))
            if drop > 1e-11 * (1 + energy):
                assert contact and body.deep(new), (state.kind, drop, np.abs(new - phi).max())
    return len(found.minima), looked


def test_no_minimum_of_a_floppy_sheet_is_refuted():
    many, looked = check_admissible("yoshimura:3x3", 0, False, 20)
    assert many and looked > 10 * many
