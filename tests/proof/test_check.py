"""What the check of a proof may use, and what it refuses."""

import ast
from dataclasses import replace
from pathlib import Path

import pytest

import origami_nlp as o
import origami_nlp.proof.check as check_module
from origami_nlp.errors import OptionError
from origami_nlp.proof import certify, check_proof, write_certificate
from origami_nlp.proof.certificate import OpenRegion
from tests.command_line import run
from tests.computed_once import shared
from tests.proof.test_certificate import SCENE
from tests.proof.test_products import sprung
from tests.proof.test_quads import half_turns, quads


def test_the_proof_of_a_vertex_is_not_checked_and_says_so(tmp_path):
    certificate, path = certify(SCENE, 100_000), tmp_path / "proof.json"
    with pytest.raises(OptionError, match="vertex"):
        check_proof(certificate)
    write_certificate(certificate, path)
    done = run("check-proof", path)
    assert done.code == 2 and not done.out
    assert done.err.count("\n") == 1 and "of a vertex" in done.err


def test_the_check_shares_nothing_with_the_search():
    """All that it may use of the package: the reading of certificates, and errors."""
    tree = ast.parse(Path(check_module.__file__).read_text())
    modules = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
    modules |= {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
    own = {m for m in modules if m and m.startswith("origami_nlp")}
    assert own == {"origami_nlp.errors", "origami_nlp.proof.certificate"}
    assert "flint" not in modules


SHEETS = {
    "folds flat": lambda: sprung(o.examples.pattern("miura", 2, 3), 0),
    "curves": lambda: half_turns(0),
    "rigid": lambda: quads(28),
}


@shared
def said(name):
    return certify(SHEETS[name](), 30_000)


@pytest.mark.parametrize("name", SHEETS)
def test_what_is_found_again_is_confirmed(name):
    found = check_proof(said(name))
    assert found.minima == len(said(name).minima) and not found.open
    assert found.lines[0].startswith("checked: ") and "lemmas" in found.lines[-1]


@pytest.mark.parametrize("name", SHEETS)
def test_omissions_and_additions_are_refused(name):
    one = said(name)
    few, (first, *_) = one.minima[1:], one.minima
    assert "is not listed" in check_proof(replace(one, minima=few)).refused
    off = replace(first, fold_angles=tuple(a + 1e-4 for a in first.fold_angles))
    assert "not found again" in check_proof(replace(one, minima=(*few, off))).refused
    assert "not found again" in check_proof(replace(one, minima=(*one.minima, first))).refused
    wide = replace(off, radius=1.0)
    assert "to within 1 rad" in check_proof(replace(one, minima=(*few, wide))).refused
    # what is left open elsewhere is no reason for a minimum to be missing
    n = len(first.fold_angles)
    far = OpenRegion((3.0,) * n, (3.1,) * n, "elsewhere")
    assert check_proof(replace(one, minima=few, undecided=(far,))).refused
    anywhere = OpenRegion((-3.2,) * n, (3.2,) * n, "anywhere")
    found = check_proof(replace(one, minima=few, undecided=(anywhere,)))
    assert not found.refused and found.open == ("anywhere",)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda s: replace(s, stiffness=(2 * s.stiffness[0], *s.stiffness[1:])),
        lambda s: replace(s, rest=(*s.rest[:-1], -s.rest[-1])),
        lambda s: replace(
            s, corners=tuple((x + 0.01 * (i == 5), y) for i, (x, y) in enumerate(s.corners))
        ),
        lambda s: replace(s, facets=s.facets[:-1]),
        lambda s: replace(s, facets=(s.facets[0][::-1], *s.facets[1:])),
    ],
)
@pytest.mark.parametrize("name", ["folds flat", "curves"])
def test_other_sheets_and_springs_are_refused(name, wrong):
    one = said(name)
    assert check_proof(replace(one, sheet=wrong(one.sheet))).refused
