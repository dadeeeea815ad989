"""Where no certificate decides on a state that is too large for kernels: a lower state refutes it only downhill."""

from types import SimpleNamespace

import numpy as np
import pytest

from origami_nlp.kkt.large import lower_beside

ROOM = np.pi


def state_of(energy):
    """State 0 of two free angles without closure, with an energy of the first of them."""
    limits = SimpleNamespace(
        clip=lambda x: np.clip(x, -ROOM, ROOM),
        room=lambda x: ROOM - np.abs(x),
        inside=lambda x: np.abs(x) <= ROOM,
    )
    problem = SimpleNamespace(
        energy=lambda x: energy(x[0]),
        energy_change=lambda x, y: energy(y[0]) - energy(x[0]),
        scale=1.0,
        fold_limits=limits,
        project=lambda x, still: (x, 0.0),
        refuses=lambda x: "",
    )
    return SimpleNamespace(problem=problem, x=np.array([0.0, 1.0]))


@pytest.mark.parametrize(
    ("energy", "refuted"),
    [
        (lambda t: -(t**2), True),
        (lambda t: -(t**4), True),  # too little to be seen at first
        (lambda t: 1e-4 * t**2 - t**4, False),  # a minimum, 2.5e-9 below the passes beside it
        (lambda t: 0.155 * t**2 - 100 * t**4, False),
        (lambda t: t**2, False),
    ],
)
def test_a_lower_state_behind_a_rise_refutes_nothing(energy, refuted):
    way = np.array([1.0, 0.0])
    undecided = SimpleNamespace(more=(way, -way))
    assert (lower_beside(state_of(energy), undecided) is not None) == refuted
