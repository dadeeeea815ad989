"""All minima of meshes whose vertices fold flat: against closures, proofs and searches that know no closed form."""

import itertools
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import make_pattern
from origami_nlp.proof import as_sheet, why_no_contact
from origami_nlp.proof.sheets import precision
from tests.computed_once import prove_sheet, thinned
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
def test_closed_states_are_in_the_sets(name):
    pattern = MESHES[name]()
    sheet, _ = as_sheet(pattern)
    with precision():
        sets = [
            (kinds, groups)
            for kinds in sheet.kinds
            for signs in itertools.product(*sheet.signs(kinds))
            if (groups := _groups(sheet, kinds, signs)) is not None
        ]
    rigid, rng, closed = Rigid(pattern), np.random.default_rng(0), 0
    for _ in range(30):
        phi = _closed(rigid, rng.uniform(-2, 2, pattern.creases))
        if phi is None or np.abs(phi).max() > math.pi or not _is_paper(pattern, phi):
            continue
        closed += 1
        assert min(_distance(groups, phi) for _, groups in sets) < 1e-5
    assert closed > 5


def _groups(sheet, kinds, signs):
    """Of creases that are not 0: the kind of each group, and factors of tangents of half the folds."""
    free, turned = ({r for r, k in enumerate(kinds) if k == kind} for kind in (2, 1))
    groups = sheet.together(free | turned, signs, free)
    return groups and [
        (
            sheet.row[min(g)] in free,
            {c: s * float(sheet.value(p.tolist()).mid()) for c, (s, p) in g.items()},
        )
        for g in groups
    ]


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


def _distance(groups, phi):
    """How far fold angles are from a set."""
    left = dict(enumerate(phi.tolist()))
    far = [0.0]
    for moves, factors in groups:
        own = [left.pop(c) / 2 for c in factors]
        c0, f0 = next(iter(factors.items()))
        t = math.tan(phi[c0] / 2) / f0 if moves else math.copysign(1e12, phi[c0] * f0)
        far += [
            abs(math.remainder(2 * x - 2 * math.atan(f * t), 2 * math.pi))
            for x, f in zip(own, factors.values(), strict=True)
        ]
    return max(far + [abs(x) for x in left.values()])


@pytest.mark.parametrize("seed", thinned(range(4), 2))
def test_one_vertex_as_the_proof_of_vertices_has_it(seed):
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(0.3, 0.7, 2) * math.pi
    pattern = sprung(wheel([a, b, math.pi - a, math.pi - b]), seed)
    proof = prove_sheet(pattern)
    scene = o.Scene(
        o.Vertex([a, b, math.pi - a, math.pi - b]),
        rest_angles=pattern.rest.tolist(),
        stiffness=pattern.stiffness.tolist(),
        contact="fold-limits",
    )
    found = o.find_minima(scene, prove=True)
    assert found.completeness.status == "proved" and not proof.undecided
    ours = sorted(pattern.energy(m.fold_angles) for m in proof.minima)
    assert ours == pytest.approx(sorted(m.energy for m in found.minima), abs=1e-9)


def test_loops_that_do_not_close_are_rigid():
    proof = prove_sheet(sprung(round_one_facet(3), 0))
    assert " 0 curves" in proof.over and as_sheet(round_one_facet(3))[0].deviation < 1e-14
    assert all(np.isin(np.abs(m.fold_angles), (0.0, math.pi)).all() for m in proof.minima)


def test_a_search_has_the_same_list():
    found = o.find_minima(o.examples.pattern("miura", 2, 3), contact="fold-limits", escape=False)
    assert found.completeness.proved and len(found.minima) == 14
    assert not found.completeness.added
    assert "proportional" in found.completeness.over


def test_with_contact_only_the_list_within_fold_limits_is_proved():
    found = o.find_minima(o.examples.pattern("miura", 2, 2), escape=False, prove=True)
    assert found.completeness.status == "not-proved" and len(found.minima) == 2
    assert "contact of sheets that fold flat is not proved" in found.completeness.reason
    assert why_no_contact(o.examples.pattern("miura", 2, 2))
    assert not found.completeness.added


def test_a_row_that_folds_flat_is_proved_as_a_mesh():
    """A strip's curves end where it is folded flat: other signs of folds are states there that no curve reaches."""
    sheet = folding_row(0)
    proof = prove_sheet(sheet)
    assert len(proof.minima) == 28 and proof.undecided == ()
    folded = [m for m in proof.minima if np.abs(m.fold_angles).min() > 3.14]
    assert len(folded) == 24
