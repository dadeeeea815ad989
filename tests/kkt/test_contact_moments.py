"""Contact moments: finite differences of the optimal energy, and ranges of dependent ones."""

import math

import numpy as np
import pytest

from origami_nlp import examples
from tests.computed_once import panel_result
from tests.independent.search_manifold import Piece
from tests.independent.search_stationary import gap, solve

PANELS = examples.panels()
DIFFERENCES = 1e-6  # relative agreement with finite differences


@pytest.fixture(scope="module")
def minima():
    """(piece, minimum) for every minimum with closed contacts of the 18 panels."""
    return [
        (Piece.of(scene), m)
        for scene in (
            PANELS[k] for k in (4, 8, 15)
        )  # one with handles, one of each kind of contact
        for m in panel_result(scene).minima
        if m.contacts
    ]


@pytest.fixture(scope="module")
def pinned(minima):
    return [(p, m) for p, m in minima if m.kind == "contact-pinned"]


def state(piece, minimum):
    return np.array(minimum.fold_angles[: piece.size])


def as_contact(piece, contact, x):
    """Return a reported contact in this formulation, and how often it occurs in the whole vertex."""
    if contact.type == "fold-limit":
        v = int(piece.orbit[contact.creases[0] - 1])
        assert [i + 1 for i in np.flatnonzero(piece.orbit == v)] == list(contact.creases)
        return ("limit", v, 1 if x[v] > 0 else -1), len(contact.creases)
    if contact.text == "creases 3 and 7 on each other":
        # tips of degree 8 that meet on the axis, each as far off it: what is reported is the moment of the angle of one
        # off the plane of a facet at the other, with an image in each quarter
        (creases,), _ = piece.fold(x)
        normal = np.cross(creases[1], creases[2]) / math.sin(piece.chain[1])
        return ("axis", int(piece.orbit[2]), 1), 4 * 2 * abs(normal[1])
    assert contact.text.startswith("creases 1 and 4 on each other")
    # the opening is the angle of one of them off the plane of the facet at the other, in both halves
    # of the vertex: the same for either facet, since they stand at equal angles to the mirror; of its
    # two signs the admissible one
    assert abs(x[0] - x[-1]) <= 1e-12
    sides = [
        s for s in (1, -1) if piece.admissible(solve(piece, x, (("plane", 0, s),), (1e-3,)).x)[0]
    ]
    assert len(sides) == 1
    return ("plane", 0, sides[0]), 2


def slope_of_optimal_energy(piece, x, held, which, step=1e-4):
    """Derivative of the least energy in the opening of one held contact: Richardson's h and h/2."""

    def difference(h):
        energies = []
        for sign in (1, -1):
            openings = [0.0] * len(held)
            openings[which] = sign * h
            s = solve(piece, x, held, tuple(openings))
            assert s.residual <= 1e-12
            assert gap(piece, held[which], s.x)[0] == pytest.approx(sign * h, abs=1e-12)
            energies.append(piece.energy(s.x))
        return (energies[0] - energies[1]) / (2 * h)

    return (4 * difference(step / 2) - difference(step)) / 3


def test_there_are_pinned_states_of_each_kind(pinned):
    assert {c.type for _, m in pinned for c in m.contacts} == {"fold-limit", "facet-pair"}
    pairs = {c.text for _, m in pinned for c in m.contacts if c.type == "facet-pair"}
    assert pairs == {"creases 1 and 4 on each other", "creases 3 and 7 on each other"}


def test_moments_are_slopes_of_the_optimal_energy(pinned):
    for piece, m in pinned:
        x = state(piece, m)
        found = [as_contact(piece, c, x) for c in m.contacts]
        held = tuple(c for c, _ in found)
        for i, (contact, (_, images)) in enumerate(zip(m.contacts, found, strict=True)):
            slope = slope_of_optimal_energy(piece, x, held, i)
            assert contact.multiplier > 0 and slope > 0
            assert slope == pytest.approx(images * contact.multiplier, rel=DIFFERENCES)


def test_touching_states_carry_nothing(minima):
    touching = [(p, m) for p, m in minima if m.kind == "contact-touching"]
    assert touching
    for piece, m in touching:
        x = state(piece, m)
        held = tuple(as_contact(piece, c, x)[0] for c in m.contacts)
        for i, contact in enumerate(m.contacts):
            slope = slope_of_optimal_energy(piece, x, held, i)
            scale = float(piece.stiffness.sum())
            assert contact.multiplier == 0 and abs(slope) <= 1e-10 * scale


def test_relaxing_the_loaded_limit_of_a_handle_pays_the_lower_end_of_its_range(minima):
    """Beyond the limit the handle widens into the surface, and one contact carries everything."""
    handles = [(p, m) for p, m in minima if m.local_dimension == 1]
    assert handles
    for piece, m in handles:
        x = state(piece, m)
        loaded = [c for c in m.contacts if c.multiplier_range[0] > 0]
        assert len(loaded) == 1
        held, images = as_contact(piece, loaded[0], x)
        # the whole load on one contact makes the state move fast with its opening: small steps
        slope = slope_of_optimal_energy(piece, x, (held,), 0, step=1e-7)
        assert slope == pytest.approx(images * loaded[0].multiplier_range[0], rel=DIFFERENCES)
