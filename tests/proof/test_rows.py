"""Rows over boxes hold their values: folds by rotation of frames and by quaternions, in doubles and in 50 digits."""

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

from origami_nlp import Scene
from origami_nlp.pattern import Vertex, examples, winding_number
from origami_nlp.proof import ReducedVertex
from origami_nlp.proof.pieces import OneMirror, Period, VertexPiece, Wedge, apart, piece_of
from origami_nlp.proof.proving import pose
from origami_nlp.proof.rows import Quadratic, Triples, pairs, variables
from tests.closed_states import closed_states
from tests.proof.fifty_digits import cross, dot, multiply

BOXES = 10_000


def scene_of(degrees, stiffness, rest, symmetry):
    vertex = Vertex.from_degrees(degrees)
    return Scene(vertex, stiffness, rest, symmetry, "fold-limits")


def generic(n):
    rng = np.random.default_rng(n)
    sectors = np.full(n, 7.0)
    while sectors.max() > 0.9 * math.pi:
        sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * math.pi
    return Scene(
        Vertex(tuple(sectors.tolist())),
        10 ** rng.uniform(-1, 1, n),
        rng.uniform(-3, 3, n),
        "none",
        "fold-limits",
    )


HEXAGON = scene_of((60,) * 6, (1, 2) * 3, (0.5, -1) * 3, "C3")
SCENES = {
    **{f"degree {n}": generic(n) for n in (4, 5, 6, 7)},
    "D1, creases on both mirrors": examples.degree6("5*pi/12", 10.0, contact="fold-limits"),
    "D1, mirrors through facets": scene_of(
        (50, 70, 40, 70, 50, 80), (1, 2, 3, 3, 2, 1), (0.5, -1, 1, 1, -1, 0.5), "D1"
    ),
    "D2": examples.degree8("pi/12", 3.0, contact="fold-limits"),
    "D3": scene_of((35, 35, 50) * 3, (1, 2, 1) * 3, (0.7, -1.1, 0.7) * 3, "D3"),
    "C2": scene_of((40, 60, 80) * 2, (1, 2, 0.5) * 2, (0.3, -1, 2) * 2, "C2"),
    "C3": scene_of((50, 40, 30) * 3, (1, 2, 0.5) * 3, (0.3, -1, 1) * 3, "C3"),
}


class Exact:
    """A piece folded by angles, numbers of any kind: vectors of the chain, and products of folds."""

    def __init__(self, piece, angles, sectors, cos=np.cos, sin=np.sin):
        self.piece, self.angles, self.cos, self.sin = piece, angles, cos, sin
        chain = piece.chain
        x, y, z = [[int(i == j) + 0 * angles[0] for i in range(3)] for j in range(3)]
        first, up, self.rays, self.normals, self.frames = y, z, [], [], []
        for p, (v, w) in enumerate(zip(chain.variable, chain.weight, strict=True)):
            self.rays.append(x)
            self.frames.append((x, y, z))
            if v >= 0:
                y, z = self.turned(y, z, angles[v] * w)
            self.normals.append(z)
            last = [-a for a in y]
            x, y = self.turned(x, y, sectors[p])
        self.vectors = [*self.rays, *self.normals, first, last, up]
        self.sectors = sectors

    def turned(self, x, y, angle):
        c, s = self.cos(angle), self.sin(angle)
        turned = [c * a + s * b for a, b in zip(x, y, strict=True)]
        return turned, [c * b - s * a for a, b in zip(x, y, strict=True)]

    def product(self, steps, sectors=False):
        """Folds in the frame of the sheet; or with the sectors after them, each in its own frame."""
        zero = 0 * self.angles[0]
        q, beta = [zero + 1, zero, zero, zero], 0
        for p in steps:
            beta = 0 if sectors else sum(self.sectors[:p], 0 * self.sectors[0])
            half = self.angles[self.piece.chain.variable[p % self.piece.chain.steps]] / 2
            c, s = self.cos(half), self.sin(half)
            q = multiply(q, [c, s * self.cos(beta), s * self.sin(beta), zero])
            if sectors:
                half = self.sectors[p % self.piece.size] / 2
                q = multiply(q, [self.cos(half), 0, 0, self.sin(half)])
        return q

    def triples(self, wanted=None):
        return [
            dot(self.vectors[u], cross(self.vectors[v], self.vectors[w]))
            for u, v, w in wanted or self.piece.triples.wanted
        ]

    def closure(self, middle):
        piece, n = self.piece, self.piece.size
        if isinstance(piece, VertexPiece):
            a, b = self.product(range(piece.half)), self.product(range(piece.half, n))
            b0 = middle.product(range(piece.half, n))
            back = multiply([b[0], *(-v for v in b[1:])], b0)
            return [u - v for u, v in zip(multiply(a, b0), back, strict=True)]
        if isinstance(piece, Period):
            return [self.product(range(n), True)[0] - piece.level]
        if not isinstance(piece, OneMirror):
            return [dot(self.vectors[-3], self.vectors[-2]) + piece.level]
        at = piece.rays[n // 2]
        off = [u - v for u, v in zip(self.vectors[-3], self.vectors[-2], strict=True)]
        seen = [dot(e, off) for e in self.frames[at]]
        x, y, z = (
            sum(e[i] * s for e, s in zip(middle.frames[at], seen, strict=True)) for i in range(3)
        )
        return [y, x, z]

    def minors(self, torque):
        piece = self.piece
        if isinstance(piece, Period):
            n = piece.size
            t = [self.product(range(i, i + n), True)[1] for i in range(n)]
        else:
            t = self.triples()
        place = {s: i for i, s in enumerate(itertools.combinations(range(piece.size), piece.rank))}
        return [
            sum((-1) ** a * torque[i] * t[place[s[:a] + s[a + 1 :]]] for a, i in enumerate(s))
            for s in itertools.combinations(range(piece.size), piece.rank + 1)
        ]


def values(form, xi):
    first, second, _ = pairs(form.slopes.shape[1])
    square = (form.bends * (xi[first] * xi[second])).sum(axis=1)
    return form.value + (form.slopes * xi).sum(axis=1) + square


def forms(piece, middle, half):
    folded, torques = piece.chain.fold(middle, half), piece.torques(middle, half)
    if isinstance(piece, OneMirror):
        closure = piece.normals_apart(folded)
    else:
        closure = piece.closure(folded)
    return closure, piece.minors(folded, torques)


@pytest.mark.parametrize("name", SCENES)
def test_every_row_holds_its_values(name):
    """Corners, and points inside, of boxes of radii 1e-6 to 1: second order to within its rest, first order too."""
    piece = piece_of(ReducedVertex(SCENES[name]))
    rng, n = np.random.default_rng(0), piece.size
    for _ in range(BOXES // 2000):
        middle = rng.uniform(-math.pi, math.pi, (n, 2000))
        half = 10 ** rng.uniform(-6, 0, 2000) * rng.uniform(0.1, 1, (n, 2000))
        at_middle = Exact(piece, middle, piece.chain.sectors.tolist())
        rows = forms(piece, middle, half)
        for xi in (rng.uniform(-1, 1, middle.shape), rng.choice([-1.0, 1.0], middle.shape)):
            angles = middle + half * xi
            at = Exact(piece, angles, piece.chain.sectors.tolist())
            torque = piece.stiffness[:, None] * (angles - piece.rest[:, None])
            for form, true in zip(rows, (at.closure(at_middle), at.minors(torque)), strict=True):
                if not len(true):
                    continue
                off = np.abs(values(form, xi) - np.array(true))
                assert (off <= form.rest + 4e-16).all()
                affine = form.affine()
                first = affine.centre + (affine.slopes * xi).sum(axis=1)
                assert (np.abs(first - np.array(true)) <= affine.error + 4e-16).all()


@pytest.mark.usefixtures("fifty_digits")
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("size", [3.0, 1e-3, 1e-6])
def test_what_is_allowed_for_rounding_is_more_than_it_is(name, size):
    """At the middle itself, near the flat state and far from it, sectors with their sum exact."""
    piece = piece_of(ReducedVertex(SCENES[name]))
    rng, n = np.random.default_rng(1), piece.size
    middle = rng.uniform(-size, size, (n, 5))
    rows, chain = forms(piece, middle, 0 * middle), piece.chain
    touching = [chain.up, 0, chain.last], *(chain.closed(1, kind=kind) for kind in ("start", "end"))
    if isinstance(piece, VertexPiece):
        ways = chain.ways(3, 0)
        touching = [t for w in ways for t in (chain.gap(*w), *chain.inside(*w))]
    touching = [tuple(t) for t in touching]
    gaps = Triples(chain, touching).at(chain.fold(middle, 0 * middle))
    total = sum(map(mpf, piece.sectors))
    whole = round(float(2 * mp.pi / total)) * total / (2 * mp.pi)
    sectors = [mpf(a) / whole for a in piece.chain.sectors.tolist()]
    top = [mpf(v) for v in piece.stiffness]
    for k in range(5):
        angles = [mpf(a) for a in middle[:, k]]
        at = Exact(piece, angles, sectors, cos=mp.cos, sin=mp.sin)
        torque = [t * (a - mpf(r)) for t, a, r in zip(top, angles, piece.rest, strict=True)]
        exact = at.closure(at), at.minors(torque), at.triples(touching)
        for form, true in zip((*rows, gaps), exact, strict=True):
            for row, value in enumerate(true):
                assert abs(value - mpf(form.value[row, k])) <= mpf(form.rest[row, k])


def test_rows_turned_apart_are_the_same_rows():
    rng = np.random.default_rng(2)
    one = Quadratic(
        rng.normal(size=(3, 9)),
        rng.normal(size=(3, 4, 9)),
        rng.normal(size=(3, 10, 9)),
        np.zeros((3, 9)),
    )
    other = apart(one)
    assert np.abs((other.slopes[1] * other.slopes[2]).sum(axis=0)).max() < 1e-13
    xi = rng.uniform(-1, 1, (4, 9))
    sizes = [(values(form, xi)[1:] ** 2).sum(axis=0) for form in (one, other)]
    assert np.abs(sizes[0] - sizes[1]).max() < 1e-12


def test_products_hold_their_values():
    piece = piece_of(ReducedVertex(SCENES["degree 5"]))
    rng = np.random.default_rng(3)
    middle = rng.uniform(-math.pi, math.pi, (5, 500))
    half = 10 ** rng.uniform(-6, 0, 500) * rng.uniform(0.1, 1, (5, 500))
    form = piece.triples.at(piece.chain.fold(middle, half))
    for xi in (rng.uniform(-1, 1, middle.shape), rng.choice([-1.0, 1.0], middle.shape)):
        true = np.array(Exact(piece, middle + half * xi, piece.chain.sectors.tolist()).triples())
        off = values(form * form[::-1], xi) - true * true[::-1]
        assert (np.abs(off) <= (form * form[::-1]).rest + 4e-16).all()


@pytest.mark.parametrize("name", SCENES)
def test_rows_vanish_where_the_model_closes_and_balances(name):
    """Minors of torques and the model's own closure Jacobian are the rows, up to a factor that is the same for all."""
    model = ReducedVertex(SCENES[name])
    piece, _ = pose(model)
    x = closed_states(model.problem, np.random.default_rng(0), 40, at_limits=False)
    group, expand = model.scene.group, model.problem.expand
    x = x[[winding_number(model.scene.vertex, group, expand(y)) == 1 for y in x]]
    assert len(x) > 5
    centre = piece.rows(x.T, x.T, np.zeros(x.T.shape, dtype=int))[0].centre
    count = len(centre) - len(piece.subsets) - len(piece.twins)
    assert (np.abs(centre[:count]) < 1e-12).all()
    rows = model.problem.constraints(x)[1]
    # combinations that are independent there: the others depend on them
    turn = np.linalg.svd(rows)[0][:, :, : piece.rank]
    jacobian = turn.transpose(0, 2, 1) @ rows
    p = model.problem.parameters
    factor = np.ones(model.size)
    if isinstance(piece, Wedge):
        factor[piece.chain.variable[piece.chain.folds == 0.5]] = 0.5
    torque = p.stiffness * (x - p.rest) / factor
    ratios = []
    for row, subset in enumerate(piece.subsets.tolist()):
        columns = (jacobian / factor)[:, :, subset].transpose(0, 2, 1)
        matrix = np.concatenate([torque[:, subset, None], columns], axis=2)
        ratios.append((np.linalg.det(matrix), centre[count + row]))
    first, second = np.array(ratios).transpose(1, 0, 2)
    scale = np.abs(first).max(axis=0) / np.abs(second).max(axis=0)
    sign = np.sign((first * second).sum(axis=0))
    assert np.abs(first - sign * scale * second).max() < 1e-9 * np.abs(first).max()


def test_refusals_name_the_reason():
    from origami_nlp.errors import OptionError

    with pytest.raises(OptionError, match="fold limits"):
        pose(ReducedVertex(examples.degree6("pi/3", 1.0, contact="none")))
    cone = Scene(Vertex((math.pi / 3,) * 5, flat=False), (1,) * 5, (0,) * 5, "none", "fold-limits")
    with pytest.raises(OptionError, match="lie flat"):
        pose(ReducedVertex(cone))


def test_boxes_are_covered_by_their_middle_and_half_width():
    lower = np.random.default_rng(4).uniform(-4, 4, (3, 1000))
    upper = np.nextafter(lower, 9) + np.random.default_rng(5).choice([0, 1e-9, 1.0], (3, 1000))
    middle, half = variables(lower, upper)
    for k, i in itertools.product(range(0, 1000, 50), range(3)):
        assert mpf(middle[i, k]) - mpf(half[i, k]) <= mpf(lower[i, k])
        assert mpf(middle[i, k]) + mpf(half[i, k]) >= mpf(upper[i, k])
