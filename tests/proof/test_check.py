"""What the check of a proof may use, and what it refuses."""

import ast
from dataclasses import replace
from pathlib import Path

import pytest

import origami_nlp as o
from benchmarks import family_scene
from origami_nlp.pattern import linear
from origami_nlp.proof import (
    certify,
    check,
    check_proof,
    vertex_check,
    write_certificate,
)
from origami_nlp.proof.certificate import OpenRegion
from tests.command_line import run
from tests.computed_once import shared
from tests.pattern_states.test_completeness import generic
from tests.proof.test_certificate import SCENE
from tests.proof.test_products import sprung
from tests.proof.test_quads import half_turns, quads

CHECKS = {
    check: {"pattern", "proof.certificate", "proof.vertex_check"},
    vertex_check: {"pattern"},
}


def test_the_check_shares_nothing_with_the_prover():
    """All that it may use of the package: scenes and certificates."""
    for module, allowed in CHECKS.items():
        tree = ast.parse(Path(module.__file__).read_text())
        used = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
        used |= {a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names}
        own = {m.removeprefix("origami_nlp.") for m in used if m and m.startswith("origami_nlp")}
        assert own == allowed


SHEETS = {
    "folds flat": lambda: sprung(o.examples.pattern("miura", 2, 3), 0),
    "curves": lambda: half_turns(0),
}


@shared
def said(name):
    return certify(SHEETS[name](), 30_000)


@pytest.mark.parametrize("name", SHEETS)
def test_what_is_found_again_is_confirmed(name):
    found = check_proof(said(name))
    assert found.minima == len(said(name).minima) and not found.open
    assert found.lines[0].startswith("checked: ") and "lemmas" in found.lines[-1]


def test_rigid_states_stay_open_in_a_certificate():
    one = certify(quads(28), 30_000)
    assert len(one.undecided) == 2 and len(check_proof(one).open) == 2


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


def of(degrees, stiffness, rest, symmetry="none", **more):
    vertex = o.Vertex.from_degrees(degrees)
    return o.Scene(vertex, stiffness, rest, symmetry, "fold-limits", **more)


VERTICES = {
    "generic": SCENE,
    "stops": replace(SCENE, limits=((0.2, 3), (-3, 3), (-1, 1), (-2, 2))),
    "at rest in the flat state": of((70, 80, 120, 90), (1, 2, 3, 2), (0, 0, 0, 0)),
    "folds flat": of((60, 80, 120, 100), (1, 2, 3, 4), (1, 0.2, -0.3, 0.4)),
    "creases on one line": of((90, 90, 90, 90), (1, 2, 3, 4), (1, 0.2, -0.3, 0.4)),
    "a mirror": of((60, 70, 110, 110, 70, 60)[1:5], (1, 2, 3, 2), (1, 0.2, 0.5, 0.2), "D1"),
    "C3, two windings": of((60,) * 6, (1, 2) * 3, (1, -0.3) * 3, "C3"),
    "D4, two windings": of((45,) * 8, (1, 2) * 4, (1,) * 8, "D4"),
    "preload": replace(SCENE, preload=(0.3, -0.2, 0.1, 0.0)),
}


@shared
def said_of(name):
    return certify(VERTICES[name], 50_000)


@pytest.mark.parametrize("name", VERTICES)
def test_the_list_of_a_vertex_is_found_again(name):
    one = said_of(name)
    found = check_proof(one)
    assert not found.refused and found.minima == len(one.minima)
    assert len(found.open) == len(one.undecided) + one.scene.is_symmetric
    assert "balls" in found.lines[-1] and "lemmas" in found.lines[-1]


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene",
    [
        family_scene("fold-limits", 1),
        *(replace(o.examples.panels()[i], contact="fold-limits") for i in (0, 4, 9, 13)),
    ],
)
def test_lists_of_degree_five_and_of_panels_are_found_again(scene):
    one = certify(scene, 100_000)
    found = check_proof(one)
    assert one.minima and not found.refused and found.minima == len(one.minima)


@pytest.mark.parametrize(
    "seed", [pytest.param(s, marks=[] if s < 2 else pytest.mark.slow) for s in range(20)]
)
def test_lists_of_random_vertices_are_found_again(seed):
    one = certify(generic(seed, 4), 50_000)
    found = check_proof(one)
    assert not found.refused and found.minima == len(one.minima)


def without(one, i):
    return replace(one, minima=(*one.minima[:i], *one.minima[i + 1 :]))


def moved(one, i, by, crease=0):
    angles = list(one.minima[i].fold_angles)
    angles[crease] += by
    state = replace(one.minima[i], fold_angles=tuple(angles))
    return replace(one, minima=(*without(one, i).minima, state))


def of_other(one, **more):
    return replace(one, scene=replace(one.scene, **more))


def scaled(one, name, crease, factor):
    values = list(getattr(one.scene, name))
    values[crease] *= factor
    return of_other(one, **{name: tuple(values)})


def turned(one):
    vertex = o.Vertex.from_degrees((71, 79, 120, 90))
    return of_other(one, vertex=vertex)


CHANGED = {
    "first missing": lambda c: without(c, 0),
    "last missing": lambda c: without(c, -1),
    "none listed": lambda c: replace(c, minima=()),
    "twice": lambda c: replace(c, minima=(*c.minima, c.minima[0])),
    "off by 1e-4": lambda c: moved(c, 0, 1e-4),
    "off by -1e-4": lambda c: moved(c, 1, -1e-4, 2),
    "mirrored": lambda c: moved(c, 0, -2 * c.minima[0].fold_angles[0]),
    "flat": lambda c: replace(c, minima=(*c.minima, replace(c.minima[0], fold_angles=(0.0,) * 4))),
    "wide": lambda c: replace(c, minima=tuple(replace(m, radius=1.0) for m in c.minima)),
    "saddle": lambda c: moved(moved(c, 0, 0.3), 0, 0.3, 1),
}
SPRINGS = {
    "stiffer": lambda c: scaled(c, "stiffness", 0, 1.001),
    "softer": lambda c: scaled(c, "stiffness", 2, 0.9),
    "other rest": lambda c: scaled(c, "rest_angles", 1, 1.01),
    "other sign": lambda c: scaled(c, "rest_angles", 3, -1),
    "preloaded": lambda c: of_other(c, preload=(0.01, 0.0, 0.0, 0.0)),
    "other sectors": turned,
    "narrow stops": lambda c: of_other(c, limits=((-0.02, 0.02),) * 4),
}
ASKED = {
    "contact": lambda c: of_other(c, contact="full"),
    "hinge laws": lambda c: of_other(c, laws=(linear(1, 0.1), None, None, None)),
    "loads": lambda c: of_other(c, fixed_facet=1, loads=(LOAD,)),
}
LOAD = {"force": (0.0, 0.0, 0.1), "facet": 2, "point": (0.5, 0.5)}


@pytest.mark.parametrize(
    ("name", "change"),
    [
        *(("stops", c) for c in {**CHANGED, **SPRINGS, **ASKED}.values()),
        ("generic", CHANGED["first missing"]),
        *(("D4, two windings", lambda c, i=i: without(c, i)) for i in range(4)),
        ("C3, two windings", lambda c: without(c, 0)),
        ("C3, two windings", lambda c: replace(c, undecided=())),
        # closed to 1e-12 round the flat state: a minute and a half
        pytest.param(
            "at rest in the flat state",
            lambda c: replace(c, undecided=()),
            marks=pytest.mark.slow,
        ),
        ("folds flat", lambda c: without(c, 1)),
        ("creases on one line", lambda c: replace(c, undecided=())),
        ("a mirror", lambda c: without(c, 0)),
    ],
)
def test_changed_certificates_of_vertices_are_refused(name, change):
    assert check_proof(change(said_of(name))).refused


def test_the_command_checks_a_vertex(tmp_path):
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    write_certificate(said_of("generic"), good)
    write_certificate(without(said_of("generic"), 0), bad)
    done, refused = run("check-proof", good), run("check-proof", bad)
    assert done.code == 0 and done.out.startswith("checked: 2 minima found again")
    assert refused.code == 1 and "not listed" in refused.out
