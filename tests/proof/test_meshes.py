"""All minima of meshes whose vertices fold flat: against closures, proofs and searches that know no closed form."""

import functools
import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import CertificateError, OptionError
from origami_nlp.pattern import make_pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import hold_against
from origami_nlp.proof import (
    certificate_of_mesh,
    check_proof,
    mesh_from_dict,
    mesh_to_dict,
    read_certificate,
    why_no_mesh,
    why_no_quad_mesh,
    write_certificate,
)
from origami_nlp.proof.mesh_states import as_folding_mesh
from origami_nlp.proof.sheet_certificate import OpenInterval
from tests.computed_once import prove_mesh, thinned
from tests.folding_rows import folding_row
from tests.independent.rigid import Rigid
from tests.patterns import wheel


def sprung(pattern, seed):
    """A pattern with springs over two decades that rest anywhere."""
    rng = np.random.default_rng(seed)
    n = pattern.creases
    return pattern.with_springs(
        stiffness=(0.02 * 10 ** rng.uniform(-1, 1, n)).tolist(),
        rest_angles=rng.uniform(-3, 3, n).tolist(),
    )


def round_one_facet(seed):
    """Four vertices that fold flat round a quadrangle, with sectors that close no loop but by chance."""
    rng = np.random.default_rng(seed)
    corners = np.array([0, 1, 1 + 1j, 1j]) + 0.2 * (rng.uniform(-1, 1, (4, 2)) @ [1, 1j])
    points, faces = list(corners), [(0, 1, 2, 3)]
    for k in range(4):
        here, after, before = (corners[(k + i) % 4] for i in (0, 1, -1))
        inside = np.angle((before - here) / (after - here))
        # sectors inside, s, 180 - inside, 180 - s
        s = rng.uniform(0.35, 0.65) * math.pi
        away = (before - here) / abs(before - here) * np.exp(1j * s)
        points += [here + 0.4 * away, here + 0.4 * away * np.exp(1j * (math.pi - inside))]
        faces.append((k, 4 + 2 * k, 5 + 2 * k))
    for k in range(4):
        n = (k + 1) % 4
        faces.append((n, k, 5 + 2 * k, 4 + 2 * n))
    return make_pattern(np.array([[z.real, z.imag] for z in points]), faces)


MESHES = {
    "miura:2x3": lambda: o.examples.pattern("miura", 2, 3),
    "miura:3x3": lambda: o.examples.pattern("miura", 3, 3),
    "squaretwist": lambda: o.examples.pattern("squaretwist"),
    "a quadrangle": lambda: round_one_facet(3),
}


@pytest.mark.parametrize("name", thinned(list(MESHES)[:3], 2))
def test_closed_states_are_those_of_the_products(name):
    pattern = MESHES[name]()
    mesh, _ = as_folding_mesh(pattern)
    assert mesh is not None
    products = {
        f
        for way in itertools.product(*(c.modes for c in mesh.crossings))
        for f in mesh.products(way)
    }
    rigid, rng, closed = Rigid(pattern), np.random.default_rng(0), 0
    for _ in range(30):
        phi = _closed(rigid, rng.uniform(-2, 2, pattern.creases))
        if phi is None or np.abs(phi).max() > math.pi or not _is_paper(pattern, phi):
            continue
        closed += 1
        assert min(_distance(mesh, f, phi) for f in products) < 1e-5
    assert closed > 5


def _closed(rigid, phi):
    """Close fold angles by Newton steps."""
    for _ in range(60):
        miss = rigid.open(phi)
        if np.abs(miss).max() < 1e-12:
            return phi
        phi = phi - np.clip(np.linalg.pinv(rigid.differences(phi), rcond=1e-5) @ miss, -0.5, 0.5)
    return None


def _is_paper(pattern, phi):
    """Whether each vertex comes back turned by no full turn."""
    for v in pattern.vertices:
        ends = pattern.ends[list(v.creases)].sum(axis=1) - v.vertex
        turn = np.eye(2, dtype=complex)
        for c, u in zip(v.creases, pattern.corners[ends] - pattern.corners[v.vertex], strict=True):
            x, y, _ = u / np.linalg.norm(u) * math.sin(phi[c] / 2)
            turn = turn @ (
                math.cos(phi[c] / 2) * np.eye(2) - 1j * np.array([[0, x - 1j * y], [x + 1j * y, 0]])
            )
        if turn[0, 0].real < 0:
            return False
    return True


def _distance(mesh, product, phi):
    """How far fold angles are from a product."""
    far = [abs(phi[c]) for c in product.flat]
    far += [abs(abs(phi[c]) - math.pi) for row in product.folded for c, _ in row]
    for curve in product.curves:
        c0, s0 = curve[0].creases[0]
        t = math.tan(s0 * phi[c0] / 2)
        for m in curve:
            x = 2 * math.atan(m.sign * float(mesh.multiplier(m.key).centre) * t)
            far += [abs(math.remainder(phi[c] - s * x, 2 * math.pi)) for c, s in m.creases]
    for row in product.folded:
        (c0, s0) = row[0]
        far += [abs(s * np.sign(phi[c]) - s0 * np.sign(phi[c0])) for c, s in row]
    return max(far)


@pytest.mark.parametrize("seed", thinned(range(4), 2))
def test_one_vertex_as_the_proof_of_vertices_has_it(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(0.3, 0.7, 2) * math.pi
    pattern = sprung(wheel([a, b, math.pi - a, math.pi - b]), seed)
    proof = prove_mesh(pattern)
    scene = o.Scene(
        o.Vertex([a, b, math.pi - a, math.pi - b]),
        rest_angles=pattern.rest.tolist(),
        stiffness=pattern.stiffness.tolist(),
        contact="fold-limits",
    )
    found = o.find_minima(scene, prove=True)
    assert found.completeness.status == "proved-except-singular" and not proof.undecided
    ours = sorted(pattern.energy(m.fold_angles) for m in proof.minima)
    assert ours == pytest.approx(sorted(m.energy for m in found.minima), abs=1e-9)


@pytest.mark.parametrize("seed", thinned(range(3), 3))
@pytest.mark.parametrize("name", MESHES)
def test_minima_are_found_again_by_the_check(name, seed):
    pattern = sprung(MESHES[name](), seed)
    proof = prove_mesh(pattern)
    assert proof.minima and not proof.undecided
    assert proof.deviation < 1e-14
    found = check_proof(certificate_of_mesh(pattern, proof))
    assert not found.refused and not found.open
    assert found.indices[1] == proof.maxima


def test_loops_that_do_not_close_are_rigid():
    proof = prove_mesh(sprung(round_one_facet(3), 0))
    assert proof.together == 0 and proof.isolated == proof.products
    assert all(np.isin(np.abs(m.fold_angles), (0.0, math.pi)).all() for m in proof.minima)


def test_a_search_has_the_same_list():
    found = o.find_minima(o.examples.pattern("miura", 2, 3), contact="fold-limits", escape=False)
    assert found.completeness.proved and len(found.minima) == 14
    assert not found.completeness.added
    assert "proportional" in found.completeness.over


def test_with_contact_only_the_list_within_fold_limits_is_proved():
    found = o.find_minima(o.examples.pattern("miura", 2, 2), escape=False, prove=True)
    assert found.completeness.status == "not-proved" and len(found.minima) == 2
    assert "contact of meshes that fold flat is not proved" in found.completeness.reason
    assert not found.completeness.added


def test_a_row_that_folds_flat_is_proved_as_a_mesh():
    """A strip's curves end where it is folded flat: other signs of folds are states there that no curve reaches."""
    sheet = folding_row(0)
    assert why_no_quad_mesh(sheet)
    proof = prove_mesh(sheet)
    assert len(proof.minima) == 28 and proof.undecided == ()
    folded = [m for m in proof.minima if np.abs(m.fold_angles).min() > 3.14]
    assert len(folded) == 24


def test_what_was_judged_is_listed_where_time_ends():
    pattern = o.examples.pattern("miura", 2, 3)
    problem, proof = PatternProblem(pattern), prove_mesh(pattern)
    done, judged = hold_against(proof, problem, [], False)
    assert done.proved and len(judged) == 14
    problem.until = -math.inf
    done, again = hold_against(proof, problem, judged[:3], False)
    assert not done.proved and "time was over" in done.reason and not again


@pytest.mark.slow
def test_random_springs_on_a_mesh():
    for seed in range(60):
        pattern = sprung(o.examples.pattern("miura", *((3, 3) if seed % 2 else (2, 4))), seed)
        found = check_proof(certificate_of_mesh(pattern, prove_mesh(pattern)))
        assert not found.refused and not found.open


@functools.cache
def good():
    pattern = sprung(o.examples.pattern("miura", 3, 3), 0)
    return certificate_of_mesh(pattern, prove_mesh(pattern))


def test_omissions_are_refused():
    said = good()
    for k in range(0, len(said.minima), 40):
        few = replace(said, minima=said.minima[:k] + said.minima[k + 1 :])
        assert "is not listed" in check_proof(few).refused
    twice = replace(said, minima=(*said.minima, said.minima[0]))
    assert "does not follow" in check_proof(twice).refused


def test_a_list_names_each_state_alone():
    """What a wide radius, or something left open, would let pass."""
    said = good()
    first, n = said.minima[0], len(said.creases)
    off = replace(first, fold_angles=tuple(0.1 + x for x in first.fold_angles), radius=1.0)
    assert "to within 1 rad" in check_proof(replace(said, minima=(off, *said.minima[1:]))).refused
    wide = (replace(first, radius=7.0),) * len(said.minima)
    assert "to within 7 rad" in check_proof(replace(said, minima=wide)).refused
    moving = next(m for m in said.minima if any(0 < abs(x) < 3 for x in m.fold_angles))
    others = tuple(m for m in said.minima if m is not moving)
    moved = replace(
        moving, fold_angles=tuple(x + 3e-10 * (0 < abs(x) < 3) for x in moving.fold_angles)
    )
    for radius, why in ((2e-10, "is not listed"), (3.1e-10, "")):
        found = check_proof(replace(said, minima=(replace(moved, radius=radius), *others)))
        assert why in found.refused and bool(found.refused) == bool(why)
    flat = next(m for m in said.minima if 0.0 in m.fold_angles)
    others = tuple(m for m in said.minima if m is not flat)
    nearly = replace(flat, fold_angles=tuple(x or 5e-12 for x in flat.fold_angles))
    assert "is not listed" in check_proof(replace(said, minima=(nearly, *others))).refused
    # what is left open elsewhere is no reason for a minimum to be missing
    elsewhere = (OpenInterval((0.0,) * n, (0.0,) * n, "elsewhere"),)
    few = replace(said, minima=said.minima[1:], undecided=elsewhere)
    assert "is not listed" in check_proof(few).refused
    anywhere = (OpenInterval((-3.2,) * n, (3.2,) * n, "anywhere"),)
    found = check_proof(replace(few, undecided=anywhere))
    assert not found.refused and found.open and len(found.minima) == len(few.minima)


def test_a_state_that_is_not_found_again_is_no_minimum():
    """Where the check itself leaves something open, only what it finds again counts; and it comes to an end."""
    pattern = o.examples.pattern("miura", 2, 2).with_springs(stiffness=1.0, rest_angles=[0.0] * 4)
    said = certificate_of_mesh(pattern, prove_mesh(pattern))
    flat = next(k for k, m in enumerate(said.minima, start=1) if not any(m.fold_angles))
    # hinges that hold nothing: U' is 0 along all curves, and what stands alone is a minimum still
    found = check_proof(replace(said, stiffness=(0.0,) * 4))
    assert not found.refused and found.open
    assert flat not in found.minima and f"minimum {flat} of the list: not found again" in found.open


@pytest.mark.parametrize(
    "wrong",
    [
        lambda s: replace(s, stiffness=(2 * s.stiffness[0], *s.stiffness[1:])),
        lambda s: replace(s, rest=(*s.rest[:-1], -s.rest[-1])),
        lambda s: replace(s, deviation=1e-17),
        lambda s: replace(
            s, corners=tuple((x + 0.01 * (x > 1) * (y == 1), y) for x, y in s.corners)
        ),
        lambda s: replace(s, creases=s.creases[1:], stiffness=s.stiffness[1:], rest=s.rest[1:]),
        lambda s: replace(
            s,
            minima=(
                replace(s.minima[0], fold_angles=tuple(1e-6 + x for x in s.minima[0].fold_angles)),
                *s.minima[1:],
            ),
        ),
    ],
)
def test_other_sheets_springs_and_states_are_refused(wrong):
    said = wrong(good())
    if len(said.creases) < 12:
        said = replace(
            said,
            minima=tuple(replace(m, fold_angles=m.fold_angles[1:]) for m in said.minima),
        )
    assert check_proof(said).refused


def test_a_certificate_survives_its_file(tmp_path):
    said = good()
    write_certificate(said, tmp_path / "mesh.json")
    assert read_certificate(tmp_path / "mesh.json") == said
    data = json.loads(json.dumps(mesh_to_dict(said)))
    with pytest.raises(CertificateError, match="stiffness"):
        mesh_from_dict(data | {"stiffness": [1.0]})


def test_flat_at_rest():
    """Springs that rest flat: the flat state, on all curves, and what stands alone at +-180 degrees."""
    pattern = o.examples.pattern("miura", 2, 3).with_springs(stiffness=1.0, rest_angles=[0.0] * 7)
    proof = prove_mesh(pattern)
    assert not proof.undecided
    (flat,) = [m for m in proof.minima if not m.fold_angles.any()]
    found = check_proof(certificate_of_mesh(pattern, proof))
    assert not found.refused and not found.open
    assert all((np.abs(m.fold_angles) == math.pi).any() for m in proof.minima if m is not flat)


def test_what_is_no_such_mesh_is_named():
    assert "four creases" in why_no_mesh(o.examples.pattern("waterbomb", 2, 2))
    why = why_no_mesh(o.examples.pattern("metasheet", 3, 3))
    assert "does not fold flat" in why
    with pytest.raises(OptionError, match="does not fold flat"):
        prove_mesh(o.examples.pattern("metasheet", 3, 3))
    found = prove_mesh(sprung(o.examples.pattern("squaretwist"), 0), boxes=20)
    assert found.undecided
