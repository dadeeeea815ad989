"""No three maxima on a branch: certificates are checked by other means than they are made by, false ones refused."""

import json
from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

pytest.importorskip("flint")
from flint import arb

from studies.at_most_six import prove_branch
from tests.independent.at_most_six import Check, Curve, Refused, _ball, _halves

SIX = (62, 100, 119, 79)
STIFFNESS, REST = (0.02, 0.0186, 0.0129, 0.0135), (-180, -141, 180, 180)
LINE = (Fraction(-1), Fraction(1))


@cache
def small():
    """A certificate of branch 1 that leaves much open, as text."""
    return json.dumps(prove_branch(SIX, 1, pair_depth=5, depth=3))


@cache
def known():
    """Its branch, with what is known of it."""
    return Check(json.loads(small())).curve


def checked(certificate):
    """Check a certificate of the same branch."""
    return Check({**certificate, "triples": ["open"]}, known())


def mixture(leader):
    """How much of each of the eight functions the slope of the record has, springs in order from the leader."""
    found = []
    for i in range(4):
        k, rest = STIFFNESS[(leader - 1 + i) % 4], REST[(leader - 1 + i) % 4]
        found += [k * Fraction(180 + rest, 360), k * Fraction(180 - rest, 360)]
    return [_ball(Fraction(x)) for x in found]


@cache
def maxima():
    """Two cells with a maximum of the record's energy each, by signs of its slope."""
    share = mixture(known().leader)

    def slope(y):
        rows = known().slopes(y, Fraction(0))
        return sum((a * row[0] for a, row in zip(share, rows, strict=True)), arb(0))

    grid = [Fraction(i, 64) for i in range(-63, 64)]
    signs = [slope(y) for y in grid]
    return [
        (a, b)
        for (a, b), (up, down) in zip(pairwise(grid), pairwise(signs), strict=True)
        if up > 0 and down < 0
    ]


def leaf_of(tree, node, places):
    """The leaf of a tree whose box holds these places, as (list that holds it, index)."""
    for i, part in enumerate(_halves(node), 1):
        if all(a <= p <= b for (a, b), p in zip(part, places, strict=True)):
            if tree[i][0] == "split":
                return leaf_of(tree[i], part, places)
            return tree, i
    raise AssertionError("no leaf")


def leaves(tree):
    if tree[0] == "split":
        for part in tree[1:]:
            yield from leaves(part)
    elif isinstance(tree[0], int):
        yield tree


def test_a_certificate_is_checked_by_spherical_triangles():
    stated = json.loads(small())
    found = checked(stated)
    assert found.leaves == stated["leaves"][0] > 80
    assert len(found.open[2]) == stated["open"][0]
    assert found.most_maxima is None  # what is left open is said


def test_the_record_has_two_maxima_on_the_branch_and_at_most_five_states_are_refused():
    first, second = ((a + b) / 2 for a, b in maxima())
    if first + second > 0:
        first, second = -second, -first
    stated = json.loads(small())
    tree, i = leaf_of(stated["pairs"], (LINE, LINE), (first, second))
    assert tree[i] == ["open"]
    size = {len(x) for x in leaves(stated["pairs"])}
    rng = np.random.default_rng(0)
    tried = [x for x in leaves(stated["pairs"])][::20]
    tried += [rng.integers(0, 1000, n).tolist() for n in size for _ in range(5)]
    for multipliers in tried:  # "no two maxima here", with whatever numbers
        tree[i] = multipliers
        with pytest.raises(Refused):
            checked(stated)


def test_what_is_multiplied_is_never_positive_where_an_energy_has_its_maxima():
    share = mixture(known().leader)
    one, two = maxima()
    for hull, count in ((one, 1), (two, 1), ((one[0], two[1]), 2)):
        for wider in (Fraction(0), Fraction(1, 64)):
            rows = known().statements(hull[0] - wider, hull[1] + wider, count)
            for column in zip(*rows, strict=True):
                assert sum((a * x for a, x in zip(share, column, strict=True)), arb(0)) <= 0


@pytest.mark.parametrize(
    "damage",
    [
        lambda c: c["pairs"].pop(),
        lambda c: c.update(pairs=["mirror"]),
        lambda c: next(leaves(c["pairs"])).__setitem__(0, -1),
        lambda c: next(leaves(c["pairs"])).append(1),
        lambda c: [x.__setitem__(slice(None), [0] * len(x)) for x in leaves(c["pairs"])],
        lambda c: c.update(pairs=["pair"]),
    ],
)
def test_damaged_certificates_are_refused(damage):
    stated = json.loads(small())
    damage(stated)
    with pytest.raises((Refused, ValueError)):
        checked(stated)


@pytest.mark.parametrize("change", [{"leader": 1}, {"sectors": ["60", "100", "120", "81"]}])
def test_another_branch_or_vertex_is_refused(change):
    with pytest.raises(Refused):
        Check({**json.loads(small()), **change})


def test_three_places_are_refused_where_pairs_are_open():
    stated = json.loads(small())
    stated["triples"] = ["pair"]
    with pytest.raises(Refused, match="no two places"):
        Check(stated, known())


BOX = ("50", "84", "129", "97")


@cache
def boxed():
    """A certificate for all vertices with sectors within 0.0001 degrees, that leaves much open, as text."""
    return json.dumps(prove_branch(BOX, 2, tolerance="0.0001", pair_depth=4, depth=3))


def thin(tree, kept):
    """Leave open all leaves but these few: the others take time."""
    for one in [x for x in leaves(tree) if x not in kept]:
        one[:] = ["open"]


def test_a_box_of_vertices_is_checked_and_a_wider_one_refused():
    stated = {**json.loads(boxed()), "triples": ["open"]}
    thin(stated["pairs"], [*leaves(stated["pairs"])][-2:])
    assert Check(stated).leaves == 2
    with pytest.raises(Refused):
        Check({**stated, "tolerance": "2"})


def test_no_two_maxima_is_refused_for_a_box_about_a_vertex_that_has_them():
    first, second = ((a + b) / 2 for a, b in maxima())
    first, second = (-second, -first) if first + second > 0 else (first, second)
    planted = {**json.loads(small()), "tolerance": "0.0001", "triples": ["open"]}
    curve = Curve(planted["sectors"], planted["leader"], planted["stretch"], "0.0001")
    tried = [[*x] for x in leaves(planted["pairs"])][::60]
    thin(planted["pairs"], [])
    tree, i = leaf_of(planted["pairs"], (LINE, LINE), (first, second))
    for multipliers in tried:
        tree[i] = multipliers
        with pytest.raises(Refused):
            Check(planted, curve)


@pytest.mark.parametrize("place", [Fraction(-3, 4), Fraction(1, 3)])
def test_what_sectors_add_is_what_neighbouring_vertices_have(place):
    off, none = Fraction(1, 10**6), Fraction(0)
    wide = Curve(list(BOX), 2, 4, "0.000001")
    for p in range(3):
        moved = [Fraction(a) for a in BOX]
        moved[p], moved[3] = moved[p] + off, moved[3] - off
        there = Curve([str(a) for a in moved], 2, 4).slopes(place, none)
        here, gains = wide.middle.slopes(place, none), wide.by_sectors(place, none)[p]
        for one, other, gain in zip(here, there, gains, strict=True):
            for j in range(7):
                assert (one[j] + _ball(off) * gain[j]).overlaps(other[j])
                size = abs(float(gain[j].mid())) + 1
                assert abs(float((other[j] - one[j]).mid()) * 10**6 - float(gain[j].mid())) < (
                    1e-2 * size
                )


def test_folds_close_the_vertex():
    """The branch of the check: rotations about the creases in turn are the identity."""
    curve = Curve([str(a) for a in SIX], known().leader, 4)
    from flint import arb_series

    azimuths = np.radians(np.cumsum((0, *SIX[:3])))
    for y in (Fraction(-3, 4), Fraction(-1, 10), Fraction(2, 5), Fraction(19, 20)):
        folds = [float(turn.fold.mid()) for turn in curve.folds(arb_series([_ball(y), 1]))]
        total = np.eye(3)
        for i in range(4):
            x, z = np.cos(azimuths[i]), np.sin(azimuths[i])
            cross = np.array([[0, 0, z], [0, 0, -x], [-z, x, 0]])
            angle = folds[(i - curve.leader + 1) % 4]
            total = total @ (
                np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
            )
        assert np.abs(total - np.eye(3)).max() < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sectors", "within", "mode", "leader"),
    [(SIX, "0", 1, 3), (SIX, "0", 2, 4), (BOX, "0.0001", 1, 1), (BOX, "0.0001", 2, 2)],
)
def test_no_three_maxima_on_a_branch_of_a_vertex_of_six(sectors, within, mode, leader):
    stated = prove_branch(sectors, mode, tolerance=within)
    assert stated["leader"] == leader
    assert Check(stated).most_maxima == 2
