"""Proofs that hold are confirmed; every other one is refused, with the claim that is wrong."""

import ast
import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from flint import ctx

import origami_nlp.proof.check as check_module
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.problem import Model
from origami_nlp.proof import certificate as c, certificate_of, check_proof, prove
from tests.computed_once import shared
from tests.proof.balls import closed_states
from tests.proof.slow_prover import proved, proved_slowly
from tests.proof.wedges import WEDGES

GOOD = proved(4, 3)
"""Two minima, one pinned."""


def subtree_end(kinds, start):
    """Position after the subtree that starts at a node."""
    wanted, place = 1, start
    while wanted:
        wanted += {c.SPLIT: 1, c.CONTRACT: 0, c.NARROW: 0}.get(int(kinds[place]), -1)
        place += 1
    return place


def walk(certificate):
    """Each node with its stratum and box, as the statement of the tree says."""
    nodes, n = certificate.nodes, certificate.scene.degree
    place, boxes = 0, iter(nodes.boxes)
    up = math.nextafter(math.pi, 4)
    for pins in itertools.product((0, 1, -1), repeat=n):
        stack = [[(s * math.pi,) * 2 if s else (-up, up) for s in pins]]
        while stack:
            box = stack.pop()
            yield place, pins, box
            if nodes.kind[place] == c.SPLIT:
                axis = nodes.number[place]
                a, b = box[axis]
                for half in ((0.5 * (a + b), b), (a, 0.5 * (a + b))):
                    stack.append([half if j == axis else e for j, e in enumerate(box)])
            elif nodes.kind[place] in (c.CONTRACT, c.NARROW):
                lower, upper = next(boxes)
                stack.append(list(zip(lower, upper, strict=True)))
            place += 1


def changed(certificate, **fields):
    """The certificate with other entries of its tree."""
    return replace(certificate, nodes=replace(certificate.nodes, **fields))


def with_point(number, **fields):
    points = list(GOOD.points)
    points[number] = replace(points[number], **fields)
    return replace(GOOD, points=tuple(points))


def cut(certificate, start, end):
    """Without the nodes from start to end; boxes of contractions among them go too."""
    nodes = certificate.nodes
    contract = np.isin(nodes.kind, (c.CONTRACT, c.NARROW))
    before, gone = int(contract[:start].sum()), int(contract[start:end].sum())
    return changed(
        certificate,
        kind=np.delete(nodes.kind, slice(start, end)),
        number=np.delete(nodes.number, slice(start, end)),
        boxes=np.delete(nodes.boxes, slice(before, before + gone), axis=0),
    )


MINIMUM = max(i for i, p in enumerate(GOOD.points) if p.is_minimum)
PINNED = next(i for i, p in enumerate(GOOD.points) if any(p.stratum))


@pytest.fixture(autouse=True)
def _precision_is_given_back():
    """By every check, whether it confirms or refuses."""
    before = ctx.prec
    yield
    assert ctx.prec == before


def test_a_good_proof_is_confirmed():
    found = check_proof(GOOD)
    assert not found.refused and not found.open
    assert found.minima == tuple(i for i, p in enumerate(GOOD.points, 1) if p.is_minimum)
    assert len(found.minima) >= 2
    assert sum(found.indices.values()) == len(GOOD.points)
    assert sum(found.nodes.values()) == len(GOOD.nodes.kind)
    assert found.lines[0].startswith("checked: complete")
    assert any("python-flint" in line for line in found.trusted)


@pytest.mark.slow
def test_a_second_search_finds_the_same_critical_points():
    one, other = proved(4, 3), proved_slowly(4, 3)
    assert not check_proof(other).refused
    assert len(one.points) == len(other.points)
    for p in one.points:
        near = [
            q for q in other.points if p.stratum == q.stratum and np.allclose(p.x, q.x, atol=1e-9)
        ]
        assert len(near) == 1
        assert (p.index, p.pinned_signs) == (near[0].index, near[0].pinned_signs)
        assert np.allclose(p.moment, near[0].moment, rtol=1e-7, atol=1e-9)


@pytest.mark.slow
def test_leaves_outside_the_box_of_their_point_are_refused():
    """Leaves of the plain prover are wide: its points are said to be alone in less."""
    wide = proved_slowly(4, 3)
    for number, p in enumerate(wide.points):
        points = list(wide.points)
        points[number] = replace(p, unique_radius=max(1e-6, p.radius))
        found = check_proof(replace(wide, points=tuple(points)))
        assert f"is not inside the box of point {number + 1}" in found.refused


def removed(number, kind, label=0):
    """The proof without a point; leaves that rested on it get another reason."""
    nodes = GOOD.nodes
    kinds, numbers = nodes.kind.copy(), nodes.number.copy()
    root = kinds == c.ROOT
    own = root & (numbers == number)
    kinds[own], numbers[own] = kind, label
    numbers[root & (nodes.number > number)] -= 1
    points = GOOD.points[:number] + GOOD.points[number + 1 :]
    return replace(changed(GOOD, kind=kinds, number=numbers), points=points)


def springs(factor):
    """The proof, said of a scene whose first spring is stiffer."""
    s = GOOD.scene
    k = (s.stiffness[0] * factor, *s.stiffness[1:])
    return replace(GOOD, scene=replace(s, stiffness=k))


def undecided_root():
    """A root leaf that names a box which is not there."""
    kinds = GOOD.nodes.kind.copy()
    kinds[np.flatnonzero(kinds == c.ROOT)[0]] = c.UNDECIDED
    return changed(GOOD, kind=kinds)


def first_leaf(which, **becomes):
    fields = {name: getattr(GOOD.nodes, name).copy() for name in becomes}
    place = np.flatnonzero(GOOD.nodes.kind == which)[0]
    for name, value in becomes.items():
        fields[name][place] = value
    return changed(GOOD, **fields)


def flipped():
    p = GOOD.points[PINNED]
    signs = tuple(-s for s in p.pinned_signs)
    return with_point(PINNED, pinned_signs=signs, is_minimum=None)


def off(number, by):
    x = list(GOOD.points[number].x)
    j = GOOD.points[number].stratum.index(0)
    x[j] += by
    return with_point(number, x=tuple(x))


P = GOOD.points[MINIMUM]
MUTATIONS = {
    "a wrong sign": (flipped, "sign at crease"),
    "a minimum is none": (lambda: with_point(MINIMUM, is_minimum=False), "is_minimum"),
    "no minimum is one": (
        lambda: with_point(
            next(i for i, p in enumerate(GOOD.points) if not p.is_minimum), is_minimum=True
        ),
        "is_minimum",
    ),
    "another index": (lambda: with_point(MINIMUM, index=1), "index"),
    "another energy": (lambda: with_point(MINIMUM, energy=P.energy + 1e-6), "energy"),
    "another moment": (
        lambda: with_point(MINIMUM, moment=(P.moment[0] + 1e-4, *P.moment[1:])),
        "moment",
    ),
    "a point a little off": (lambda: off(MINIMUM, 1e-7), "not within"),
    "a point where none is": (lambda: off(MINIMUM, 0.4), "point"),
    "radius 0": (lambda: with_point(MINIMUM, radius=0.0), "not within"),
    "a point removed, closed": (lambda: removed(MINIMUM, c.CLOSED), "closed state"),
    "a point removed, minor": (lambda: removed(MINIMUM, c.MINOR, 15), "minor"),
    "a point removed, flat": (lambda: removed(MINIMUM, c.FLAT), "flat state"),
    "a point removed, another": (lambda: removed(MINIMUM, c.ROOT, 0), "stratum|inside"),
    "a point twice": (lambda: replace(GOOD, points=(*GOOD.points, P)), "one and the same"),
    "root box far larger": (lambda: with_point(MINIMUM, unique_radius=1.0), "alone"),
    "a stiffer spring": (lambda: springs(1.001), "point|node"),
    "a stiffer spring, no points": (
        lambda: replace(springs(1.5), points=()),
        "node",
    ),
    "r0 enlarged": (lambda: replace(GOOD, r0=0.5), "critical"),
    "r0 shrunken": (lambda: replace(GOOD, r0=1e-9), "flat state"),
    "first stratum dropped": (
        lambda: cut(GOOD, 0, subtree_end(GOOD.nodes.kind, 0)),
        "node|tree",
    ),
    "last stratum dropped": (
        lambda: cut(GOOD, len(GOOD.nodes.kind) - 1, len(GOOD.nodes.kind)),
        "the tree ends",
    ),
    "a node more": (
        lambda: changed(
            GOOD,
            kind=np.append(GOOD.nodes.kind, np.uint8(c.CLOSED)),
            number=np.append(GOOD.nodes.number, np.int32(0)),
        ),
        "more than its strata",
    ),
    "a box that is not there": (undecided_root, "no undecided"),
    "a split of no crease": (lambda: first_leaf(c.SPLIT, number=7), "not free"),
    "a split of a negative crease": (lambda: first_leaf(c.SPLIT, number=-1), "not free"),
    "a minor of three": (lambda: first_leaf(c.MINOR, number=7), "4 free"),
    "a minor beyond": (lambda: first_leaf(c.MINOR, number=15 + 16 - 1), "4 free"),
    "a negative minor": (lambda: first_leaf(c.MINOR, number=-2), "4 free"),
    "twins that are none": (lambda: first_leaf(c.MINOR, kind=c.TWIN, number=1), "coincide"),
    "twins that are one": (lambda: first_leaf(c.MINOR, kind=c.TWIN, number=5), "coincide"),
    "a point that is not there": (lambda: first_leaf(c.ROOT, number=99), "no point"),
    "a negative point": (lambda: first_leaf(c.ROOT, number=-1), "no point"),
    "the whole stratum closed": (lambda: whole(c.CLOSED, 0), "closed state"),
    "the whole stratum a minor": (lambda: whole(c.MINOR, 15), "minor"),
    "the whole stratum a point": (lambda: whole(c.ROOT, 0), "inside"),
    "full contact": (
        lambda: replace(GOOD, scene=replace(GOOD.scene, contact="full")),
        "fold-limits",
    ),
}


def whole(kind, number):
    """The stratum of free creases as one leaf."""
    end = subtree_end(GOOD.nodes.kind, 0)
    wrong = cut(GOOD, 1, end)
    kinds, numbers = wrong.nodes.kind.copy(), wrong.nodes.number.copy()
    kinds[0], numbers[0] = kind, number
    gone = int(GOOD.nodes.kind[0] in (c.CONTRACT, c.NARROW))
    return changed(wrong, kind=kinds, number=numbers, boxes=wrong.nodes.boxes[gone:])


@pytest.mark.parametrize("name", MUTATIONS)
def test_a_false_proof_is_refused_and_the_claim_named(name):
    make, words = MUTATIONS[name]
    found = check_proof(make())
    assert found.refused and any(word in found.refused for word in words.split("|"))
    assert found.lines == [f"refused: {found.refused}"]


def holds_closed_states(s, pins, box, seed):
    """Whether projection from random points of a box of a stratum ends in the box, closed."""
    low, high = np.array(box).T
    near = closed_states(s, np.random.default_rng(seed).uniform(low, high, (20, s.degree)), pins)
    inside = (near > low - 1e-15) & (near < high + 1e-15)
    return inside[:, np.array(pins) == 0].all(axis=1).any()


def test_leaves_with_another_reason_are_refused_where_it_is_false():
    """Minors hide closed states, and flat leaves too: such boxes are not closed."""
    tried = 0
    for place, pins, box in walk(GOOD):
        if GOOD.nodes.kind[place] not in (c.MINOR, c.FLAT):
            continue
        if not holds_closed_states(GOOD.scene, pins, box, place):
            continue
        kinds = GOOD.nodes.kind.copy()
        kinds[place] = c.CLOSED
        found = check_proof(changed(GOOD, kind=kinds))
        assert found.refused.startswith(f"node {place + 1} (closed")
        tried += 1
        if tried == 3:
            return
    pytest.fail(f"only {tried} leaves")


def test_contractions_that_cut_off_a_point_are_refused():
    rng, tried, contraction = np.random.default_rng(0), {c.CONTRACT: 0, c.NARROW: 0}, -1
    for place, pins, box in walk(GOOD):
        kind = GOOD.nodes.kind[place]
        if kind not in tried:
            continue
        contraction += 1
        for p in GOOD.points:
            within = all(a <= v <= b for v, (a, b) in zip(p.x, box, strict=True))
            if p.stratum != pins or not within or rng.random() < 0.8 or tried[kind]:
                continue
            side, boxes = int(rng.integers(2)), GOOD.nodes.boxes.copy()
            j = int(rng.choice([j for j, s in enumerate(pins) if not s]))
            boxes[contraction, side, j] = p.x[j] + 0.3 * (box[j][1 - side] - p.x[j])
            found = check_proof(changed(GOOD, boxes=boxes))
            assert found.refused.startswith(f"node {place + 1} ({c.KINDS[kind]}, ")
            assert "cut off" in found.refused or "outside" in found.refused
            tried[kind] += 1
    assert min(tried.values()) == 1


def test_a_dropped_subtree_is_refused():
    rng = np.random.default_rng(0)
    inner = np.flatnonzero(GOOD.nodes.kind == c.SPLIT)
    for place in rng.choice(inner, 1, replace=False):
        first = int(place) + 1  # the lower half
        wrong = cut(GOOD, first, subtree_end(GOOD.nodes.kind, first))
        assert check_proof(wrong).refused


def test_the_strata_of_a_tree_may_not_change_places():
    ends = [0]
    while ends[-1] < len(GOOD.nodes.kind):
        ends.append(subtree_end(GOOD.nodes.kind, ends[-1]))
    assert len(ends) == 3**4 + 1
    order = [*range(ends[2], ends[3]), *range(ends[1], ends[2])]
    kept = cut(GOOD, 0, 0)
    kinds, numbers = kept.nodes.kind.copy(), kept.nodes.number.copy()
    kinds[ends[1] : ends[3]], numbers[ends[1] : ends[3]] = (
        GOOD.nodes.kind[order],
        GOOD.nodes.number[order],
    )
    assert check_proof(changed(GOOD, kind=kinds, number=numbers)).refused


@shared
def wedge_proof(name):
    each = WEDGES[name].of_each_winding
    return certificate_of(WEDGES[name], *(prove(Model(s), record=True) for s in each))


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] if n == "D1" else []) for n in WEDGES]
)
def test_proofs_of_wedges_are_confirmed(name):
    s = WEDGES[name]
    assert s.group.name == name
    good = wedge_proof(name)
    found = check_proof(good)
    assert not found.refused
    points = [p for one in (good, *good.others) for p in one.points]
    assert found.minima == tuple(i for i, p in enumerate(points, 1) if p.is_minimum) != ()


@pytest.mark.parametrize("name", ["D2", "C2"])
def test_false_proofs_of_wedges_are_refused(name):
    s = WEDGES[name]
    good = wedge_proof(name)
    number = next(i for i, p in enumerate(good.points) if p.is_minimum)
    kinds, numbers = good.nodes.kind.copy(), good.nodes.number.copy()
    own = (kinds == c.ROOT) & (numbers == number)
    kinds[own] = c.CLOSED
    assert "closed state" in check_proof(changed(good, kind=kinds)).refused
    kinds[own], numbers[own] = c.NONE, 0
    assert "critical state" in check_proof(changed(good, kind=kinds, number=numbers)).refused
    k = [
        v * (1 + 1e-3 * (o == s.group.orbit[0]))
        for v, o in zip(s.stiffness, s.group.orbit, strict=True)
    ]
    assert check_proof(replace(good, scene=replace(s, stiffness=tuple(k)))).refused
    wrong = [replace(p, index=(p.index or 0) + 1) for p in good.points]
    assert "index" in check_proof(replace(good, points=tuple(wrong))).refused
    flat = np.where(good.nodes.kind == c.SINGULAR, c.FLAT, good.nodes.kind).astype(np.uint8)
    assert "flat" in check_proof(replace(changed(good, kind=flat), r0=1e-3)).refused


@pytest.mark.slow
def test_a_cross_rests_on_twins():
    k, rest = (1.0, 2.0, 0.7, 1.4), (0.4, -1.1, 0.8, 2.0)
    s = Scene(Vertex(("pi/2",) * 4), k, rest, symmetry="none", contact="fold-limits")
    found = check_proof(certificate_of(s, prove(Model(s), record=True)))
    assert not found.refused and found.open and len(found.minima) == 2


def test_what_a_proof_leaves_open_is_told():
    """Root leaves handed to an undecided box: nothing is false, and nothing is complete."""
    number = MINIMUM
    wrong = removed(number, c.UNDECIDED)
    r = P.unique_radius
    low, high = (
        [v + s * r * (not q) for v, q in zip(P.x, P.stratum, strict=True)] for s in (-1, 1)
    )
    left = c.UndecidedBox(tuple(low), tuple(high), P.stratum, "time was over")
    found = check_proof(replace(wrong, undecided=(left,)))
    assert not found.refused
    assert len(found.open) == 1 and "time was over" in found.open[0]
    assert not found.lines[0].startswith("checked: complete")
    silent = check_proof(with_point(number, is_minimum=None))
    assert len(silent.open) == 1 and f"point {number + 1}" in silent.open[0]


def test_a_vertex_that_does_not_lie_flat_is_refused_by_name():
    vertex = Vertex((1.4,) * 4, flat=False)
    s = Scene(vertex, (1,) * 4, (1,) * 4, symmetry="none", contact="fold-limits")
    empty = c.Nodes(np.zeros(1, np.uint8), np.zeros(1, np.int32), np.zeros((0, 2, 4)))
    assert "lie flat" in check_proof(c.Certificate(s, 1e-3, (), (), (), empty)).refused


def test_the_check_shares_nothing_with_the_search():
    """All that the check may use of the package: the reading of scenes and files."""
    folder = Path(check_module.__file__).parent
    own = [*folder.glob("*certificate.py"), *sorted(folder.glob("check*.py"))]
    assert len(own) == 27
    known = {f"origami_nlp.proof.{path.stem}" for path in own}
    for path in own:
        tree = ast.parse(path.read_text())
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                modules = [node.module or ""]
            elif isinstance(node, ast.Import):
                modules = [alias.name for alias in node.names]
            else:
                continue
            for module in modules:
                if module.startswith("origami_nlp"):
                    allowed = {"origami_nlp.errors", "origami_nlp.io", "origami_nlp.pattern"}
                    assert module in known | allowed, f"{path.name} imports {module}"
                assert module.split(".")[0] not in ("pickle", "marshal", "shelve", "importlib")
        calls = {
            n.func.id
            for n in ast.walk(tree)
            if isinstance(n, ast.Call) and isinstance(n.func, ast.Name)
        }
        assert not calls & {"eval", "exec", "__import__", "compile"}
