"""Rows of wedges and periods over boxes, against rotation matrices in 50 digits, and against the model's closure."""

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

from origami_nlp import Scene
from origami_nlp.pattern import Vertex, examples
from origami_nlp.problem import Kinematics, Model, random_strata
from origami_nlp.proof.affine import variables
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.complete import pose
from tests.proof.fifty_digits import boxes, multiply, points, turn_x, turn_z, value_of

WIDTHS = [0.0, 1e-6, 1e-2, 1.0]


def scene_of(degrees, stiffness, rest, symmetry):
    vertex = Vertex.from_degrees(degrees)
    return Scene(vertex, stiffness, rest, symmetry, "fold-limits")


SCENES = {
    "D1, creases on both mirrors": examples.degree6("5*pi/12", 10.0, contact="fold-limits"),
    "D1, mirrors through facets": scene_of(
        (50, 70, 40, 70, 50, 80), (1, 2, 3, 3, 2, 1), (0.5, -1, 1, 1, -1, 0.5), "D1"
    ),
    "D2": examples.degree8("pi/12", 3.0, contact="fold-limits"),
    "D3": scene_of((35, 35, 50) * 3, (1, 2, 1) * 3, (0.7, -1.1, 0.7) * 3, "D3"),
    "C2": scene_of((40, 60, 80) * 2, (1, 2, 0.5) * 2, (0.3, -1, 2) * 2, "C2"),
    "C3": scene_of((50, 40, 30) * 3, (1, 2, 0.5) * 3, (0.3, -1, 1) * 3, "C3"),
}


pytestmark = pytest.mark.usefixtures("fifty_digits")


def exact_piece(posed, angles):
    """Frames of a wedge at every ray, before its fold, and after the last fold; and the axes."""
    sectors = list(map(mpf, posed.sectors))
    whole = mp.pi / posed.order
    sectors = [a * whole / sum(sectors) for a in sectors]
    frame, frames = mp.eye(3), []
    for r, crease in enumerate(posed.crease):
        frames.append(frame)
        if crease is not None:
            half = mpf(1) / 2 if r in (0, posed.rays - 1) else 1
            frame = frame * turn_x(half * angles[crease])
        if r < posed.rays - 1:
            frame = frame * turn_z(sectors[r])
    axes = [frames[r][:, 0] for r in posed.ray_of]
    return frames, axes, -frame[:, 1]  # the last mirror's inward normal


def triple(a, b, c):
    three = mp.matrix(3, 3)
    three[:, 0], three[:, 1], three[:, 2] = a, b, c
    return mp.det(three)


def cases(names):
    return list(itertools.product([n for n in SCENES if n[0] in names], WIDTHS))


@pytest.mark.parametrize(("name", "width"), cases("D"))
def test_wedges_hold_their_values(name, width):
    posed, _ = pose(Model(SCENES[name]))
    rng = np.random.default_rng(int(width * 1e6))
    n = posed.size
    lower, upper, pins = boxes(rng, n, width, 6)
    middle, half = variables(lower, upper)
    rows = posed.rows(lower, upper, pins)
    e2 = mp.matrix([0, 1, 0])
    k = [mpf(v) / mpf(posed.stiffness.max()) for v in posed.stiffness]
    first_view = posed.seen_first(Angles.over(lower, upper, pins))
    for b, angles, xi in points(rng, lower, upper, pins, middle, half):
        frames, axes, normal = exact_piece(posed, angles)
        torque = [k[i] * (angles[i] - mpf(posed.rest[i])) for i in range(n)]
        if posed.order == 1:
            seen = frames[posed.middle_ray].T * (e2 - normal)
            view = mp.matrix([mpf(v) for v in first_view[:, b]])
            exact = frame_along(view) * seen
            for row in range(3):
                miss = abs(exact[row] - value_of(rows.closure, row, b, xi))
                assert miss <= mpf(rows.closure.error[row, b]) + mpf(10) ** -14
        else:
            value = (e2.T * normal)[0] + mp.cos(mp.pi / posed.order)
            assert abs(value - value_of(rows.closure, 0, b, xi)) <= mpf(rows.closure.error[0, b])
        for row, creases in enumerate(posed.minor_creases):
            exact = mpf(0)
            if posed.order == 1:
                for i, (p, q) in zip(creases, ((1, 2), (0, 2), (0, 1)), strict=True):
                    a, c = creases[p], creases[q]
                    seen = e2 if c <= n - 1 - a else normal  # the mirror that the form looks at
                    sign = -1 if i == creases[1] else 1
                    value = (
                        triple(seen, axes[a], axes[c])
                        if seen is e2
                        else triple(axes[a], axes[c], seen)
                    )
                    exact += sign * torque[i] * value
            else:
                a, c = creases
                exact = torque[a] * triple(e2, axes[c], normal)
                exact -= torque[c] * triple(e2, axes[a], normal)
            miss = abs(exact - value_of(rows.critical, row, b, xi))
            assert miss <= mpf(rows.critical.error[row, b])


def frame_along(normal):
    """The frame in which the difference of the normals is given: the first axis along one of them."""
    from origami_nlp.proof.mirror_domains import frame_of

    at = np.array([[float(v)] for v in normal])
    return mp.matrix(frame_of(at)[:, :, 0].tolist())


@pytest.mark.parametrize(("name", "width"), cases("C"))
def test_periods_hold_their_values(name, width):
    posed, _ = pose(Model(SCENES[name]))
    rng = np.random.default_rng(int(width * 1e6))
    n = posed.size
    lower, upper, pins = boxes(rng, n, width, 6)
    middle, half = variables(lower, upper)
    rows = posed.rows(lower, upper, pins)
    sectors = list(map(mpf, posed.sectors))
    sectors = [a * 2 * mp.pi / posed.order / sum(sectors) for a in sectors]
    k = [mpf(v) / mpf(posed.stiffness.max()) for v in posed.stiffness]
    for b, angles, xi in points(rng, lower, upper, pins, middle, half):
        first = product(angles, sectors, 0)
        value = first[0] - mp.cos(mp.pi / posed.order)
        assert abs(value - value_of(rows.closure, 0, b, xi)) <= mpf(rows.closure.error[0, b])
        slope = [product(angles, sectors, i)[1] for i in range(n)]
        torque = [k[i] * (angles[i] - mpf(posed.rest[i])) for i in range(n)]
        for row, (i, j) in enumerate(posed.minor_creases):
            exact = torque[i] * slope[j] - torque[j] * slope[i]
            miss = abs(exact - value_of(rows.critical, row, b, xi))
            assert miss <= mpf(rows.critical.error[row, b])


def product(angles, sectors, start):
    """Quaternion of a period read from a crease on: scalar, x, y, z."""
    n = len(angles)
    q = [mpf(1), mpf(0), mpf(0), mpf(0)]
    for i in range(start, start + n):
        for angle, axis in ((angles[i % n], 1), (sectors[i % n], 3)):
            c, s = mp.cos(angle / 2), mp.sin(angle / 2)
            p = [c, mpf(0), mpf(0), mpf(0)]
            p[axis] = s
            q = multiply(q, p)
    return q


@pytest.mark.parametrize("name", SCENES)
def test_rows_vanish_where_the_model_closes_and_balances(name):
    """Minors of torques and the model's own closure Jacobian are the rows, up to a factor that is the same for all."""
    model = Model(SCENES[name])
    posed, _ = pose(model)
    kinematics = Kinematics(model)
    x = random_strata(model, np.random.default_rng(0), 40, closed=0)
    assert len(x) > 5
    rows = posed.rows(x.T, x.T, np.zeros(x.T.shape, dtype=int))
    assert (np.abs(rows.closure.centre) < 1e-12).all()
    jacobian = kinematics.closure(kinematics.fold(x))[1]
    p = model.parameters
    on_mirror = np.zeros(model.size, dtype=bool)
    if model.structure.kind == "D":
        on_mirror[[posed.crease[r] for r in (0, -1) if posed.crease[r] is not None]] = True
    factor = np.where(on_mirror, 0.5, 1.0)
    torque = p.stiffness * (x - p.rest) / factor
    ratios = []
    for row, creases in enumerate(posed.minor_creases):
        c = list(creases)
        matrix = np.concatenate(
            [torque[:, c, None], (jacobian / factor)[:, :, c].transpose(0, 2, 1)], axis=2
        )
        ratios.append((np.linalg.det(matrix), rows.critical.centre[row]))
    first, second = np.array(ratios).transpose(1, 0, 2)
    # the same factor for all rows of a state: first = factor(state) * second
    scale = np.abs(first).max(axis=0) / np.abs(second).max(axis=0)
    sign = np.sign((first * second).sum(axis=0))
    assert np.abs(first - sign * scale * second).max() < 1e-9 * np.abs(first).max()
    assert np.ptp(scale) < 1e-9 * scale.max() or model.structure.kind == "C"


def test_refusals_name_the_reason():
    from origami_nlp.errors import OptionError

    with pytest.raises(OptionError, match="contact"):
        pose(Model(examples.degree6("pi/3", 1.0)))
    cone = Scene(Vertex((math.pi / 3,) * 5, flat=False), (1,) * 5, (0,) * 5, "none", "fold-limits")
    with pytest.raises(OptionError, match="not flat"):
        pose(Model(cone))
