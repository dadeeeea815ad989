"""Rows of wedges and periods: zero at the critical points of the whole vertex; twins where axes say so."""

import itertools
import math

import numpy as np
import pytest
from flint import arb, ctx

from origami_nlp import find_minima
from origami_nlp.pattern import Scene, Vertex, examples
from origami_nlp.problem import Model
from origami_nlp.proof import certificate_of, check_proof, prove
from origami_nlp.proof.check_bounds import States
from origami_nlp.proof.check_points import CheckedStratum
from origami_nlp.proof.check_wedges import piece_of
from tests.computed_once import thinned
from tests.proof.wedges import WEDGES

SCENES = {
    **WEDGES,
    "D1 at pi/3": examples.degree6("pi/3", 1.0, contact="fold-limits"),
    "D1 through facets": Scene(
        Vertex((1.0, 0.8, 1.1, 2 * math.pi - 4.8, 1.1, 0.8)),
        (1.0, 1.0, 2.0, 3.0, 3.0, 2.0),
        (0.4, 0.4, -1.1, 0.7, 0.7, -1.1),
        symmetry="D1",
        contact="fold-limits",
    ),
}


WIDE = math.pi / 2 - 0.1  # 0.5 - 0.4 + WIDE is a quarter turn
ACROSS = (1.0, 0.4, WIDE, 2 * math.pi - 1.8 - 2 * WIDE, WIDE, 0.4)


pytestmark = pytest.mark.usefixtures("bits_64")


@pytest.mark.parametrize("name", SCENES)
def test_no_row_excludes_a_critical_point(name):
    """Points are those of the whole vertex, by `test_check_points`: around them nothing is said to be absent."""
    s, rng, seen = SCENES[name], np.random.default_rng(0), 0
    piece = piece_of(s)
    for p in prove(Model(s)).points:
        free = [j for j, q in enumerate(p.stratum) if not q]
        with ctx.workprec(128):
            x = [
                float(b.mid())
                for b in CheckedStratum(piece_of(s), p.stratum).locate(p.x, p.moment).x
            ]
        seen += len(free) > piece.rank
        for size in (1e-9, 1e-4, 0.1):
            box = tuple(
                (
                    max(-3.2, v - size * rng.random()) - 1e-14,
                    min(3.2, v + size * rng.random()) + 1e-14,
                )
                for v in x
            )
            states = States(piece, box, p.stratum)
            states.add_critical()
            assert not states.empty
            new = states.narrowed(box)
            assert all(a - 1e-13 <= x[j] <= b + 1e-13 for j in free for a, b in [new[j]])
    assert seen


@pytest.mark.parametrize(
    "sectors, symmetry",
    [
        ((math.pi / 2,) * 4, "D1"),
        ((math.pi / 3,) * 6, "D1"),
        (ACROSS, "D1"),
        ((math.pi / 4,) * 8, "D2"),
        ((math.pi / 6,) * 12, "D3"),
        ((0.5, 0.5, math.pi - 1.0) * 2, "C2"),
        ((math.pi / 4,) * 8, "C2"),
    ],
)
def test_twins_are_the_creases_that_turn_freely(sectors, symmetry):
    """One turned, the other turned back: closure stays as it is, at random angles of the stratum."""
    n, rng = len(sectors), np.random.default_rng(0)
    s = Scene(Vertex(sectors), (1.0,) * n, (0.3,) * n, symmetry=symmetry, contact="fold-limits")
    piece, found, across = piece_of(s), 0, False
    for pins in itertools.product((0, 1, -1), repeat=piece.count):
        free = [j for j, q in enumerate(pins) if not q]
        for a, b in itertools.combinations_with_replacement(free, 2):
            sign = piece.twin(a, b, pins)
            if sign is None:
                continue
            found += 1
            across |= a == b
            for _ in range(3):  # turn one, and the other back: closure does not change
                x = [arb.pi() * q if q else arb(rng.uniform(-2, 2)) for q in pins]
                y, step = list(x), arb(0.3)
                y[a] += step * piece.over[a]
                if a != b:
                    y[b] -= sign * step * piece.over[b]
                one, other = piece.at(x)[0], piece.at(y)[0]
                if a == b:  # about the mirror's normal: what is off turns with it
                    one, other = ([sum((v * v for v in g), arb(0))] for g in (one, other))
                assert all(abs(p - q) < 1e-12 for p, q in zip(one, other, strict=True))
    assert found
    assert across == (sectors == ACROSS)


@pytest.mark.parametrize("rest", thinned([((math.pi, 0.3),), ((2.9, 0.3),), ((math.pi, 2.0),)], 3))
def test_minima_with_a_crease_shut_on_the_mirror_are_not_lost(rest):
    """Folded in two along the mirror: what lies across its creases does not turn freely."""
    cross = Vertex(("pi/2",) * 4)
    s = Scene(cross, (1.0,) * 4, (math.pi, rest[1], rest[0], rest[1]), "D1", "fold-limits", 1)
    found = certificate_of(s, prove(Model(s), record=True))
    assert not check_proof(found).refused
    minima = [m.fold_angles[:3] for m in find_minima(s, prove=False, escape=False).minima]
    assert any(abs(abs(m[0]) - math.pi) < 0.2 for m in minima)
    for m in minima:
        known = [np.abs(np.subtract(p.x, m)).max() < 1e-6 for p in found.points]
        known += [
            all(a - 1e-6 <= v <= b + 1e-6 for a, v, b in zip(c.lower, m, c.upper, strict=True))
            for c in (*found.singular, *found.undecided)
        ]
        assert any(known)
