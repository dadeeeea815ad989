"""The check knows from the whole vertex how it closes: a proof that leaves a winding out is refused."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from flint import arb, ctx

from origami_nlp import find_minima
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.problem import Model
from origami_nlp.proof import (
    certificate_from_dict,
    certificate_of,
    certificate_to_dict,
    check_proof,
    prove,
)
from origami_nlp.proof.check_points import Refused
from origami_nlp.proof.check_wedges import piece_of
from origami_nlp.proof.check_whole import check_identity, closing_numbers
from tests.independent.rotations import spin_sign

STAR = Scene(Vertex(("pi/4",) * 8), (1, 2) * 4, (math.radians(131.0604),) * 8, "D4", "fold-limits")
SECTORS = (0.5, 0.3, 2 * math.pi / 3 - 0.8)
SCENES = {
    "D4": STAR,
    "D3": replace(
        STAR,
        vertex=Vertex(("pi/3",) * 6),
        stiffness=(1, 2) * 3,
        rest_angles=(2.9,) * 6,
        symmetry="D3",
    ),
    "C3": Scene(Vertex(SECTORS * 3), (1, 2, 0.7) * 3, (2.4, 1.9, -0.6) * 3, "C3", "fold-limits"),
    "C5": Scene(
        Vertex((0.5, 0.4 * math.pi - 0.5) * 5), (1, 2) * 5, (2.4, 1.9) * 5, "C5", "fold-limits"
    ),
}


def proof_of(scene):
    each = (prove(Model(one), record=True) for one in scene.of_each_winding)
    return certificate_of(scene, *each)


def test_numbers_of_closed_states_are_roots():
    """Cosines of w pi/n, w odd: isolated by FLINT from T_n + 1, compared with what the prover takes."""
    for n in range(1, 17):
        known = [math.cos(w * math.pi / n) for w in range(1, n + 1, 2)]
        found = closing_numbers(n)
        assert [float(r.mid()) for r in found] == pytest.approx(known, abs=1e-15)
        assert all(r.rad() < 1e-60 for r in found) and (found[-1] == -1) == bool(n % 2)


@pytest.mark.parametrize("name", SCENES)
def test_what_the_piece_makes_is_the_whole_vertex(name):
    scene = SCENES[name]
    with ctx.workprec(128):
        piece = piece_of(scene)
        check_identity(scene, piece)
        # the same product by rotation matrices, in doubles
        x = np.random.default_rng(0).uniform(-2, 2, piece.count)
        places = sorted(set(scene.group.orbit))
        phi = x[[places.index(o) for o in scene.group.orbit]]
        scalar = float(piece.vertex([arb(v) for v in x])[0].mid())
        assert (scalar > 0) == (spin_sign(np.array(scene.vertex.sector_angles), phi)[0] > 0)
        piece.sectors = [piece.sectors[0] + 0.01, piece.sectors[1] - 0.01, *piece.sectors[2:]]
        with pytest.raises(Refused, match="not what its piece"):
            check_identity(scene, piece)


@pytest.mark.parametrize("name", SCENES)
def test_proofs_of_every_winding_are_confirmed_and_none_may_be_left_out(name):
    good = proof_of(SCENES[name])
    good = certificate_from_dict(json.loads(json.dumps(certificate_to_dict(good))))
    found = check_proof(good)
    assert not found.refused
    every = [p for one in (good, *good.others) for p in one.points]
    assert found.minima == tuple(i for i, p in enumerate(every, 1) if p.is_minimum)
    for left in range(len(good.others)):
        others = tuple(o for k, o in enumerate(good.others) if k != left)
        why = check_proof(replace(good, others=others)).refused
        assert (
            f"wind {good.others[left].scene.winding} times" in why and "no tree covers them" in why
        )


def test_what_an_earlier_prover_proved_is_refused():
    """The tree of one winding alone, as it was once said to be all: a minimum of no energy was missing."""
    why = check_proof(certificate_of(STAR, prove(Model(STAR), record=True))).refused
    assert why == (
        "the whole vertex also closes where the number of its piece is -0.707107, states that wind 3 times round the "
        "axis: no tree covers them"
    )


def test_false_claims_of_another_winding_are_refused():
    good = proof_of(STAR)
    (other,) = good.others
    again = replace(good, others=(other, other))
    assert "not [3]" in check_proof(again).refused
    # the tree of one winding for that of another: its boxes hold states that close
    swapped = replace(good, others=(replace(other, nodes=good.nodes),))
    assert check_proof(swapped).refused.startswith("winding 3: ")
    moved = replace(other, points=good.points)
    assert check_proof(replace(good, others=(moved,))).refused.startswith("winding 3: point")
    springs = replace(other.scene, stiffness=(1, 2.5) * 4)
    assert (
        "another scene"
        in check_proof(replace(good, others=(replace(other, scene=springs),))).refused
    )
    # a state that winds three times is no state of the first tree
    alone = check_proof(other)
    assert not alone.refused and len(alone.minima) == 2


def test_a_period_of_four_creases_that_closes_by_itself():
    """T = -1: three equations, one degree of freedom."""
    sectors = (0.5, 0.6, 0.4, 2 * math.pi / 3 - 1.5)
    springs = (1.0, 2.0, 0.7, 1.3) * 3, (2.4, 1.9, -0.6, 1.0) * 3
    scene = Scene(Vertex(sectors * 3), *springs, "C3", "fold-limits", winding=3)
    proof = prove(Model(scene), record=True)
    assert proof.finished and not proof.undecided
    found = check_proof(certificate_of(scene, proof))
    assert not found.refused and len(found.minima) == len(proof.minima) > 0
    searched = find_minima(scene, prove=False, escape=False)
    regular = [m for m in searched.minima if np.abs(np.abs(m.fold_angles) - math.pi).min() > 1e-6]
    for m in regular:
        x = Model(scene).reduce(np.array(m.fold_angles))
        assert min(np.abs(np.subtract(p.x, x)).max() for p in proof.minima) < 1e-7
