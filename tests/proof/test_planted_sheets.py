"""Provers of sheets with one lemma broken: the second program, or a scan, sees what each of them loses, or claims."""

import pytest
from flint import arb_series

import origami_nlp as o
from origami_nlp.proof import (
    certify,
    check_proof,
    products,
    prove_sheet,
    quads,
    sheets,
)
from origami_nlp.proof.products import FoldingSheet, ProductSearch
from origami_nlp.proof.quads import QuadCurve, QuadSheet, QuadVertex
from tests.patterns import strip
from tests.proof.test_products import sprung
from tests.proof.test_quads import half_turns


def checked(sheet):
    """Whether the second program has the same list."""
    said = certify(sheet, 2_000)
    return not said.undecided and not check_proof(said).refused


SCENES = {
    "folds flat": (checked, lambda: sprung(o.examples.pattern("miura", 2, 3), 0)),
    "curves": (checked, lambda: half_turns(0)),
    "a strip": (checked, lambda: strip(3, 3, 2)),
}


@pytest.mark.parametrize("name", SCENES)
def test_unbroken_provers_agree(name):
    agrees, make = SCENES[name]
    assert agrees(make())


def without_a_set(patch):
    true = FoldingSheet.kinds
    patch.setattr(
        FoldingSheet, "kinds", property(lambda self: (k for k in true.fget(self) if k != (2, 2, 2)))
    )


def with_a_sign_of_multipliers_wrong(patch):
    true = FoldingSheet._cross

    def cross(self, one, equal):
        found = true(self, one, equal)
        return found._replace(multipliers={s: (-a, p) for s, (a, p) in found.multipliers.items()})

    patch.setattr(FoldingSheet, "_cross", cross)


def with_states_that_all_stay(patch):
    patch.setattr(ProductSearch, "_stays", lambda *given: True)


def without_a_mode(patch):
    true = QuadSheet.signs
    patch.setattr(QuadSheet, "signs", lambda self, m: None if m[:1] == (-1,) else true(self, m))


def with_a_sign_across_wrong(patch):
    true = QuadVertex.others

    def others(self, p, z, opposite):
        one, two, three = true(self, p, z, opposite)
        return [one, two, -three]

    patch.setattr(QuadVertex, "others", others)


def without_remainders(patch):
    true = quads.narrowed

    def narrowed(box, at, away):
        return true(arb_series([*(box[j] for j in range(3)), 0], 4), at, 1e-6 * away)

    patch.setattr(quads, "narrowed", narrowed)


def with_bends_of_the_other_sign(patch):
    true = QuadCurve.over

    def over(self, x):
        at = true(self, x)
        return at and at._replace(second=-at.second)

    patch.setattr(QuadCurve, "over", over)


def without_what_ends_a_curve(patch):
    true = sheets._piece

    def piece(curve, a, b):
        found = true(curve, a, b)
        held = found is not None and found.kind == sheets.HELD
        return found._replace(kind=sheets.SLOPE) if held else found

    patch.setattr(sheets, "_piece", piece)


def without_a_side_of_the_flat_state(patch):
    true = quads.least

    def least(over, *given):
        return sheets.Least() if over.__self__.side < 0 else true(over, *given)

    patch.setattr(quads, "least", least)


def with_zeros_halved_to_the_wrong_side(patch):
    patch.setattr(sheets, "_halved", lambda sign, low, high: (low, low))


BROKEN = {
    without_a_set: "folds flat",
    with_a_sign_of_multipliers_wrong: "folds flat",
    with_states_that_all_stay: "folds flat",
    without_a_mode: "curves",
    with_a_sign_across_wrong: "curves",
    without_remainders: "a strip",
    with_bends_of_the_other_sign: "a strip",
    without_what_ends_a_curve: "a strip",
    without_a_side_of_the_flat_state: "curves",
    with_zeros_halved_to_the_wrong_side: "curves",
}


@pytest.mark.parametrize("broken", BROKEN, ids=lambda one: one.__name__)
def test_a_broken_lemma_is_seen(monkeypatch, broken):
    agrees, make = SCENES[BROKEN[broken]]
    broken(monkeypatch)
    assert not agrees(make())


def test_a_relation_that_nearly_holds_is_left_open(monkeypatch):
    """Of a loop whose product of multipliers is 1 to within what sectors deviate, nothing is claimed."""
    monkeypatch.setattr(products, "CLOSURE_TOL", 1e-40)
    sheet = sprung(o.examples.pattern("squaretwist"), 0)
    assert prove_sheet(sheet).undecided or not check_proof(certify(sheet, 2_000)).refused
