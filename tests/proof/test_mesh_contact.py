"""Minima with contact of meshes that fold flat: against a scan that knows rotations and a collision library alone.

The scan shares no code with the proof: facets by rotation matrices, what crosses by the Flexible Collision Library.
"""

import functools
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import CertificateError, OptionError
from origami_nlp.pattern_problem import PatternProblem, order_layers
from origami_nlp.proof import (
    certificate_of_mesh,
    check_proof,
    mesh_from_dict,
    mesh_to_dict,
    prove_mesh,
    why_no_mesh_contact,
    why_no_strip,
)
from origami_nlp.proof.check_layers import FlatLayers
from origami_nlp.proof.check_strip_sheet import FlatDisk
from origami_nlp.proof.folded_edges import FoldedEdges
from origami_nlp.proof.mesh_contact import FoldingContact, FoldingCurve
from origami_nlp.proof.mesh_states import as_folding_mesh
from origami_nlp.proof.strip_contact import CROSSING, UNKNOWN
from tests.folding_rows import folding_row
from tests.independent.rigid import Rigid, _mesh, fcl
from tests.proof.test_meshes import round_one_facet, sprung

ROWS = {
    "touches": lambda: folding_row(0),
    "long": lambda: folding_row(6, reach=1.5),
    **{str(s): (lambda s=s: folding_row(s, reach=(0.9, 1.5)[s % 2])) for s in range(7, 17)},
    "three": lambda: folding_row(1, 3),
}


def sectors(pattern, v):
    """Of a vertex between its creases, in order [4]."""
    out = [pattern.ends[c].sum() - v.vertex for c in v.creases]
    u = pattern.corners[out, :2] - pattern.corners[v.vertex, :2]
    z = u @ [1, 1j]
    return np.abs(np.angle(np.roll(z, -1) / z)), np.sign(np.angle(z[1] / z[0]))


def curve(pattern, ways, t):
    """Folds [n, K] where tan(phi/2) of the first crease is t, in one of two ways round each vertex."""
    tangents, left = {0: np.ones(1)}, list(zip(pattern.vertices, ways, strict=True))
    while left:
        v, way = next(x for x in left if set(x[0].creases) & tangents.keys())
        left.remove((v, way))
        (a1, a2, _, _), _ = sectors(pattern, v)
        across = (
            -math.cos((a1 + a2) / 2) / math.cos((a1 - a2) / 2)
            if way > 0
            else math.sin((a1 + a2) / 2) / math.sin((a1 - a2) / 2)
        )
        if way > 0:
            # tan(phi_2/2) = -[cos((a1 + a2)/2) / cos((a1 - a2)/2)]^-1 tan(phi_1/2)
            rate = np.array([1, across, 1, -across])
        else:
            rate = np.array([1, across, -1, across])
        known = next(i for i, c in enumerate(v.creases) if c in tangents)
        for c, r in zip(v.creases, rate / rate[known] * tangents[v.creases[known]], strict=True):
            tangents.setdefault(c, np.atleast_1d(r))
    rates = np.array([tangents[c][0] for c in range(pattern.creases)])
    return 2 * np.arctan(rates[:, None] * t)


def scanned(pattern, steps=100):
    """Minima seen on samples of all curves, and which signs at their ends are left downhill without a collision."""
    rigid = Rigid(pattern)
    minima, left = [], set()
    for ways in itertools.product((1, -1), repeat=len(pattern.vertices)):

        def at(theta, ways=ways):
            phi = curve(pattern, ways, np.tan(theta))
            energy = 0.5 * pattern.stiffness @ (phi - pattern.rest[:, None]) ** 2
            return phi, energy, np.array([not rigid.collide(x) for x in phi.T])

        theta = np.linspace(-0.5 * math.pi, 0.5 * math.pi, steps + 2)[1:-1]
        phi, energy, free = at(theta)
        if np.abs(rigid.open(phi[:, steps // 3])).max() > 1e-9:
            continue  # of a cycle
        wall = np.r_[np.inf, np.where(free, energy, np.inf), np.inf]
        least = free & (wall[1:-1] < wall[:-2]) & (wall[1:-1] < wall[2:])
        for k in np.flatnonzero(least):
            if not 0 < k < steps - 1:
                continue
            low, high = theta[k - 1], theta[k + 1]
            while high - low > 1e-6:
                near = np.linspace(low, high, 9)
                _, height, open_ = at(near)
                best = int(np.where(open_, height, np.inf).argmin())
                low, high = near[max(best - 1, 0)], near[min(best + 1, 8)]
            minima.append(at(np.array([near[best]]))[0][:, 0])
        for k, inner in ((0, 1), (steps - 1, steps - 2)):
            if free[k] and energy[inner] < energy[k]:
                left.add(tuple(np.sign(phi[:, k]).astype(int).tolist()))
    return np.array(minima), left


def folded_flat(pattern):
    """Signs of all creases by which vertices close at +-180 degrees."""
    for signs in itertools.product((1, -1), repeat=pattern.creases):
        if all(math.prod(signs[c] for c in v.creases) < 0 for v in pattern.vertices):
            yield signs


def assert_folded_flat_but(left, sheet, proof):
    """Of states folded flat, by signs of their folds, those are proved whose layers have an order, but `left`."""
    problem = PatternProblem(sheet)
    paper = {
        s
        for s in folded_flat(sheet)
        if order_layers(problem, math.pi * np.array(s)).verdict == "ordered"
    }
    folded = {
        tuple(np.sign(m.fold_angles).astype(int).tolist())
        for m in proof.minima
        if np.abs(m.fold_angles).min() > 3.14
    }
    assert folded == paper - left


@pytest.mark.parametrize(
    "name", ["touches", *(pytest.param(n, marks=pytest.mark.slow) for n in list(ROWS)[1:])]
)
def test_lists_are_those_of_a_scan_with_collisions(name):
    sheet = ROWS[name]()
    assert why_no_strip(sheet).endswith("folds flat")
    proof = prove_mesh(sheet, contact=True)
    assert proof.undecided == ()
    inside = np.array([m.fold_angles for m in proof.minima if np.abs(m.fold_angles).max() < 3.14])
    seen, left = scanned(sheet)
    far = np.abs(inside[:, None] - seen[None]).max(axis=2)
    assert len(inside) == len(seen)
    assert far.min(axis=0).max() < 1e-3 and far.min(axis=1).max() < 1e-3
    assert_folded_flat_but(left, sheet, proof)
    said = certificate_of_mesh(sheet, proof)
    found = check_proof(mesh_from_dict(mesh_to_dict(said)))
    assert found.lines[0].startswith("checked: complete"), found.lines[0]


@functools.cache
def said_of_touches():
    sheet = ROWS["touches"]()
    return certificate_of_mesh(sheet, prove_mesh(sheet, contact=True))


@pytest.mark.parametrize(
    "k", [4, *(pytest.param(k, marks=pytest.mark.slow) for k in (0, 1, 2, 3, 5))]
)
def test_planted_omissions_are_refused(k):
    said = said_of_touches()
    less = replace(said, minima=said.minima[:k] + said.minima[k + 1 :])
    assert "a minimum is not listed" in check_proof(less).lines[0]


def test_states_that_cross_are_refused():
    sheet = ROWS["touches"]()
    free = certificate_of_mesh(sheet, prove_mesh(sheet))
    assert check_proof(free).lines[0].startswith("checked: complete")
    assert check_proof(replace(free, contact=True)).lines[0].startswith("refused")
    with pytest.raises(CertificateError, match="within fold limits"):
        mesh_from_dict(mesh_to_dict(replace(free, generic=True, contact=True)))


@pytest.mark.parametrize(
    "sheet",
    [
        folding_row(0),
        pytest.param(o.examples.pattern("squaretwist"), marks=pytest.mark.slow),
        pytest.param(folding_row(0, 3), marks=pytest.mark.slow),
        pytest.param(sprung(round_one_facet(0), 0), marks=pytest.mark.slow),
    ],
)
def test_layers_of_flat_foldings_are_those_of_the_kernel(sheet):
    layers = FlatLayers(FlatDisk(certificate_of_mesh(sheet, prove_mesh(sheet, boxes=10))))
    problem, paper = PatternProblem(sheet), 0
    for signs in folded_flat(sheet):
        verdict = order_layers(problem, math.pi * np.array(signs)).verdict
        assert layers.can_be_stacked(signs) == (verdict == "ordered")
        paper += verdict == "ordered"
    assert paper > 0


def test_a_row_that_folds_flat_is_proved_as_a_mesh():
    """A strip's curves end where it is folded flat: other signs of folds are states there that no curve reaches."""
    sheet = folding_row(0)
    assert why_no_strip(sheet) == "vertex 1 folds flat"
    proof = prove_mesh(sheet)
    assert len(proof.minima) == 28 and proof.undecided == ()
    folded = [m for m in proof.minima if np.abs(m.fold_angles).min() > 3.14]
    assert len(folded) == 24


@pytest.mark.slow
def test_a_search_says_that_its_list_is_proved_with_contact():
    result = o.find_minima(folding_row(0), escape=False, prove=True)
    assert result.completeness.status == "proved", result.completeness.reason


def test_what_is_not_decided_is_named():
    six = o.examples.pattern("waterbomb", 2, 2)
    assert "has not four creases" in why_no_mesh_contact(six)
    with pytest.raises(OptionError, match="has not four creases"):
        prove_mesh(six, contact=True)


TWIST = o.examples.pattern("squaretwist")


def twist_ends():
    """Each curve of the square twist, with its two ends."""
    mesh, _ = as_folding_mesh(TWIST)
    ways = itertools.product(*(c.modes for c in mesh.crossings))
    products = {p for modes in ways for p in mesh.products(modes)}
    curves = sorted({c for p in products for c in p.curves})
    return [(mesh, FoldingCurve(mesh, c, TWIST), side) for c in curves for side in (1, -1)]


@pytest.mark.parametrize(
    "which", [pytest.param(k, marks=() if k in (0, 3) else pytest.mark.slow) for k in range(12)]
)
def test_flaps_that_fold_edge_to_edge_are_as_a_collision_library_says(which):
    mesh, curve, side = twist_ends()[which]
    contact = FoldingContact(TWIST, mesh.deviation)
    edges = FoldedEdges(contact, curve.rows, curve.still, side, 0.06, mesh.deviation)
    known = {p: edges.pair(*p) for p in contact.pairs}
    rigid = Rigid(TWIST)
    for tau in (0.02, 0.05):
        phi = np.zeros(TWIST.creases)
        for kappa, sign, creases in curve.rows:
            for c, s in creases:
                phi[c] = 2 * side * sign * s * math.atan(float(kappa.centre) / tau)
        assert np.abs(rigid.open(phi)).max() < 1e-9
        x = rigid.polygons(phi)
        for (a, b), verdict in known.items():
            hit = fcl.collide(
                _mesh(x[a]), _mesh(x[b]), fcl.CollisionRequest(), fcl.CollisionResult()
            )
            assert verdict == UNKNOWN or (verdict == CROSSING) == bool(hit)
    # sides on one line decide: eight of the ends
    assert len(set(known.values())) > 1 or set(known.values()) == {UNKNOWN}


@functools.cache
def said_of_twist(seed=None):
    sheet = TWIST if seed is None else sprung(TWIST, seed)
    proof = prove_mesh(sheet, contact=True)
    return sheet, proof, certificate_of_mesh(sheet, proof)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [None, 0, 1])
def test_the_square_twist_is_that_of_a_scan_with_collisions(seed):
    sheet, proof, said = said_of_twist(seed)
    assert proof.undecided == () and len(proof.minima) == (8 if seed is None else 10)
    seen, left = scanned(sheet)
    inside = np.array([m.fold_angles for m in proof.minima if np.abs(m.fold_angles).max() < 3.14])
    far = np.abs(inside[:, None] - seen[None]).max(axis=2)
    assert far.min(axis=0).max() < 1e-3 and far.min(axis=1).max() < 1e-3
    assert_folded_flat_but(left, sheet, proof)
    assert check_proof(said).lines[0].startswith("checked: complete")


@pytest.mark.slow
@pytest.mark.parametrize("k", range(0, 8, 3))
def test_planted_omissions_of_the_square_twist_are_refused(k):
    _, _, said = said_of_twist()
    less = replace(said, minima=said.minima[:k] + said.minima[k + 1 :])
    assert "a minimum is not listed" in check_proof(less).lines[0]
