"""Proofs of strips that hold are confirmed; every other one is refused, with the claim that is wrong."""

import functools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from flint import ctx

import origami_nlp as o
import origami_nlp.proof.check_strips as check_strips
from origami_nlp.errors import CertificateError, OptionError
from origami_nlp.pattern import make_pattern
from origami_nlp.proof import (
    certificate_of_strip,
    check_proof,
    read_certificate,
    strip_from_dict,
    strip_to_dict,
    write_certificate,
)
from origami_nlp.proof.strip_certificate import TouchingBox
from tests.computed_once import prove_strip
from tests.patterns import strip


@functools.cache
def certified(seed, vertices, contact):
    pattern = strip(seed, vertices + 1, 2)
    return certificate_of_strip(pattern, prove_strip(pattern, contact=contact))


def good_one():
    return certified(3000, 2, False)


def at_limit():
    return certified(3009, 1, True)


def touching():
    """Six minima: one that facets hold."""
    return certified(23, 2, True)


def with_curve(said, number, **fields):
    curves = list(said.curves)
    curves[number] = replace(curves[number], **fields)
    return replace(said, curves=tuple(curves))


def with_claim(said, number, box, claim):
    curve = said.curves[number]
    claims = (*curve.claims[:box], claim, *curve.claims[box + 1 :])
    touches = tuple(t for t in curve.touches if t.box != box)
    return with_curve(said, number, claims=claims, touches=touches)


def place(said, claim):
    """The first box of a claim: its curve, and its number there."""
    return next(
        (number, curve.claims.index(claim))
        for number, curve in enumerate(said.curves)
        if claim in curve.claims
    )


@pytest.mark.parametrize("good", [good_one, at_limit])
def test_a_proof_is_confirmed(good, tmp_path):
    write_certificate(good(), tmp_path / "proof.json")
    assert read_certificate(tmp_path / "proof.json") == good()
    found = check_proof(tmp_path / "proof.json")
    assert found.refused == "" and found.open == ()
    assert found.minima == tuple(range(1, len(good().minima) + 1))
    assert found.points == tuple(m.fold_angles for m in good().minima)


def test_contact_is_confirmed_and_the_list_with_it():
    good = touching()
    kinds = {c for curve in good.curves for c in curve.claims}
    assert {"touching", "crossing", "limit", "outside"} <= kinds
    check = check_strips.StripCheck(good, lambda done, total: None)
    check.run()
    assert check.open == [] and len(check.found) == 6

    def refused(*minima):
        """What is said of another list, once the boxes are known to hold."""
        check.said = replace(good, minima=minima)
        with pytest.raises(check_strips.Refused) as caught:
            check._lists()
        return str(caught.value)

    for k in range(6):
        assert "not listed" in refused(*good.minima[:k], *good.minima[k + 1 :])
    held = next(m for m in good.minima if m.touching)
    others = tuple(m for m in good.minima if m is not held)
    assert "other facets" in refused(*others, replace(held, touching=((0, 1),)))
    assert "holds" in refused(*others, replace(held, touching=()))
    low = held.theta[0]
    assert "do not meet" in refused(*others, replace(held, theta=(low - 1e-6, low - 1e-7)))


def test_false_claims_of_contact_are_refused():
    good = touching()

    def shown(number, box, claim, touches=()):
        check = check_strips.StripCheck(good, lambda done, total: None)
        check.sheet = check_strips.FlatSheet(good)
        check.contact = check_strips.CheckedContact(check.sheet)
        curve = with_claim(good, number, box, claim).curves[number]
        if touches:
            curve = replace(curve, touches=(TouchingBox(box, touches),))
        check._confirm(number, curve, box, claim)

    number, box = place(good, "crossing")
    for claim in ("rising", "falling"):
        with pytest.raises(check_strips.Refused):
            shown(number, box, claim)
    number, box = place(good, "convex")
    with pytest.raises(check_strips.Refused):
        shown(number, box, "crossing")
    number, box = place(good, "touching")
    (stated,) = [t.touches for t in good.curves[number].touches if t.box == box]
    shown(number, box, "touching", stated)
    (f, i), *rest = stated[0].corners
    turned = (*rest[:2], (rest[2][0], rest[2][1] ^ 1), (f, i))
    false = [
        (replace(stated[0], facets=(0, 1)),),
        (replace(stated[0], corners=turned),),
        (replace(stated[0], corners=((f, 99), *rest)),),
    ]
    for touches in false:
        with pytest.raises(check_strips.Refused):
            shown(number, box, "touching", touches)
    with pytest.raises(check_strips.Refused):
        shown(number, box, "falling")


def test_omissions_are_refused():
    good = good_one()
    for k in range(len(good.minima)):
        less = (*good.minima[:k], *good.minima[k + 1 :])
        assert "a minimum is not listed" in check_proof(replace(good, minima=less)).refused
    less = replace(good, curves=good.curves[:-1])
    assert "4 curves" in check_proof(less).refused
    twice = replace(good, curves=(*good.curves[:-1], good.curves[0]))
    assert "4 curves" in check_proof(twice).refused
    curve = good.curves[1]
    short = with_curve(good, 1, ends=curve.ends[:-1], claims=curve.claims[:-1])
    assert "not all of it" in check_proof(short).refused
    assert "maxima" in check_proof(replace(good, maxima=1)).refused


def test_false_claims_are_refused():
    good = good_one()
    for claim, false in (
        ("falling", "rising"),
        ("rising", "falling"),
        ("convex", "rising"),
        ("convex", "concave"),
        ("outside", "rising"),
        ("rising", "outside"),
        ("falling", "outside"),
        ("limit", "outside"),
        ("limit", "falling"),
    ):
        number, box = place(good, claim)
        if claim in ("rising", "falling"):  # one in the midst of its like
            claims = good.curves[number].claims
            box = next(k for k in range(1, len(claims)) if claims[k - 1 : k + 2] == (claim,) * 3)
        assert "is not shown to be" in check_proof(with_claim(good, number, box, false)).refused
    number, box = place(good, "rising")
    assert "not asked about" in check_proof(with_claim(good, number, box, "crossing")).refused


def test_a_wider_box_is_refused():
    good = good_one()
    number, box = place(good, "convex")
    ends = list(good.curves[number].ends)
    at = box if good.curves[number].claims[box - 1] != "convex" else box + 1
    neighbour = good.curves[number].claims[at - 1]
    minimum = next(m for m in good.minima if m.signs == good.curves[number].signs)
    # the box beside the minimum is widened over it
    assert neighbour in ("rising", "falling")
    ends[at] = minimum.theta[1] + 1e-4
    assert check_proof(with_curve(good, number, ends=tuple(ends))).refused


def test_another_sheet_is_refused():
    good = good_one()
    corners = [list(c) for c in good.corners]
    corners[4][0] += 1e-3  # other sectors: other curves
    moved = replace(good, corners=tuple(map(tuple, corners)))
    assert check_proof(moved).refused
    softer = replace(good, stiffness=(0.5 * good.stiffness[0], *good.stiffness[1:]))
    assert check_proof(softer).refused
    rest = replace(good, rest=(good.rest[0] + 1e-3, *good.rest[1:]))
    assert check_proof(rest).refused
    assert "negative" in check_proof(replace(good, stiffness=(-1.0, *good.stiffness[1:]))).refused
    turned = tuple(f[::-1] if k == 1 else f for k, f in enumerate(good.facets))
    assert "counter-clockwise" in check_proof(replace(good, facets=turned)).refused
    less = replace(good, facets=good.facets[:-1])
    assert check_proof(less).refused
    assert "row" in check_proof(replace(good, row=(*good.row[:-1], good.row[0]))).refused


def test_minima_are_refused_where_they_are_not():
    good = good_one()
    m = good.minima[0]
    for wrong in (
        replace(m, theta=(m.theta[0] + 1e-6, m.theta[1] + 1e-6)),
        replace(m, theta=(0.9 * m.theta[0], 0.9 * m.theta[0])),
        replace(m, fold_angles=(m.fold_angles[0] + 1e-6, *m.fold_angles[1:])),
        replace(m, touching=((0, 5),)),
        replace(m, fold_angles=tuple(0.1 + x for x in m.fold_angles), radius=1.0),
    ):
        assert check_proof(replace(good, minima=(wrong, *good.minima[1:]))).refused
    twice = replace(good, minima=(*good.minima, m))
    assert "does not follow" in check_proof(twice).refused
    limit = at_limit()
    k = next(k for k, m in enumerate(limit.minima) if math.pi in np.abs(m.fold_angles))
    m = limit.minima[k]
    wrong = replace(m, theta=(m.theta[0] * 1.001, m.theta[1] * 1.001))
    assert check_proof(
        replace(limit, minima=(*limit.minima[:k], wrong, *limit.minima[k + 1 :]))
    ).refused


def test_what_is_left_open_stays_open():
    good = good_one()
    number, box = place(good, "rising")
    found = check_proof(with_claim(good, number, box, "open"))
    assert found.refused == "" and len(found.open) >= 1 and found.to_dict()["complete"] is False
    pattern = strip(3000, 3, 2)
    few = certificate_of_strip(pattern, prove_strip(pattern, boxes=100))
    assert check_proof(few).open


def test_a_check_does_not_hang_on_the_settings_of_flint(monkeypatch):
    """Where a user's program keeps two terms of a series, second derivatives are there all the same."""
    monkeypatch.setattr(ctx, "cap", 2)
    found = check_proof(at_limit())
    assert found.refused == "" and found.open == () and ctx.cap == 2


def test_the_flat_state_at_rest_is_confirmed():
    pattern = strip(0, 3, 2).with_springs(stiffness=1.0, rest_angles=[0.0] * 7)
    found = check_proof(certificate_of_strip(pattern, prove_strip(pattern)))
    assert found.refused == "" and found.open == () and len(found.minima) == 1


def test_creases_that_reach_their_limits_at_once_are_confirmed():
    pattern = o.examples.pattern("metasheet", 2, 3)
    found = check_proof(certificate_of_strip(pattern, prove_strip(pattern)))
    assert found.refused == "" and found.open == () and len(found.minima) == 5


def test_facets_that_are_not_convex_are_refused_with_contact():
    corners = [[0, 0], [1, 0.1], [0.2, 1], [-1, 0.3], [-0.3, -1], [-0.1, 0.3]]
    faces = [(0, 1, 2), (0, 2, 5, 3), (0, 3, 4), (0, 4, 1)]
    pattern = make_pattern(corners, faces).with_springs(stiffness=0.01, rest_angles=0.5)
    said = certificate_of_strip(pattern, prove_strip(pattern))
    assert check_proof(said).refused == ""
    assert "not convex" in check_proof(replace(said, contact=True)).refused


def test_a_facet_of_two_pieces_has_no_certificate():
    corners = [[0, 0], [1, 0.1], [0.2, 1], [-1, 0.3], [-0.3, -1], [0.9, 0.8]]
    faces = [(0, 1, 5), (0, 5, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)]
    pattern = make_pattern(np.array(corners), faces, joins=[(0, 5)])
    pattern = pattern.with_springs(stiffness=0.01, rest_angles=0.5)
    proof = prove_strip(pattern)
    assert proof.minima
    with pytest.raises(OptionError, match="several pieces"):
        certificate_of_strip(pattern, proof)


def test_files_are_read_with_care():
    data = json.loads(json.dumps(strip_to_dict(good_one())))
    assert strip_from_dict(data) == good_one()
    for change, name in (
        ({"rest": [0.0]}, "rest"),
        ({"row": [99, *data["row"][1:]]}, "row"),
        ({"facets": [[0, 1, 77]]}, "facets"),
        ({"creases": [[0, -1]]}, "stiffness"),
        ({"minima": [{"theta": [0, 0]}]}, "minima"),
    ):
        with pytest.raises(CertificateError, match=name):
            strip_from_dict(data | change)


@pytest.mark.slow
def test_proofs_of_forty_strips_are_confirmed():
    for seed in range(40):
        found = check_proof(certified(3000 + seed, 1 + seed % 3, bool(seed % 2)))
        assert found.refused == "" and found.open == (), seed
