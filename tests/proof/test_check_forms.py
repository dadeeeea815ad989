"""Forms of the check hold what 50 digits say, in random boxes; what they exclude is not there."""

import itertools
import math

import numpy as np
import pytest
from flint import arb, ctx

from origami_nlp.proof import check_bounds, check_forms as f
from origami_nlp.proof.check_bounds import States
from origami_nlp.proof.check_domains import VertexChain
from tests.proof.balls import at, closed_states, exactly, holds, scene, sheet_of
from tests.proof.chains_mp import axes, mp, mpf, quaternion

UP = math.nextafter(math.pi, 4)


pytestmark = pytest.mark.usefixtures("bits_64")


def random_box(rng, degree):
    """A box within the limits, of widths from 1e-9 to 2 pi, and the pins of some creases."""
    pins = [int(s) for s in rng.choice([0, 0, 0, 1, -1], degree)]
    ends = []
    for s in pins:
        a, b = sorted(rng.uniform(-UP, UP, 2))
        if rng.random() < 0.7:
            b = min(UP, a + 10 ** rng.uniform(-9, 0))
        ends.append((s * math.pi,) * 2 if s else (float(a), float(b)))
    return tuple(ends), pins


def random_point(rng, box, pins):
    """50 digits of a point, ends of the box included, and its xi as balls."""
    x, xi = [], {}
    for j, ((a, b), s) in enumerate(zip(box, pins, strict=True)):
        t = [0.0, 1.0, rng.random()][rng.integers(3)]
        v = mpf(a) if t == 0 else mpf(b) if t == 1 else mpf(a) + (mpf(b) - mpf(a)) * mpf(t)
        x.append(s * mp.pi if s else v)
        if not s:
            m, r = f.parts(a, b)
            with ctx.workprec(200):
                xi[j] = (exactly(v) - m) / r if r > 0 else arb(0)
            assert abs(xi[j]).lower() <= 1
    return x, xi


@pytest.mark.parametrize("degree", [4, 5, 6])
def test_closure_holds_what_50_digits_say(degree):
    s, rng = scene(degree, degree), np.random.default_rng(degree)
    sheet, n, h = sheet_of(s), degree, (degree + 1) // 2
    sectors = s.vertex.sector_angles
    for _ in range(25):
        box, pins = random_box(rng, degree)
        terms, _ = sheet.closure(box, pins)
        for _ in range(3):
            x, xi = random_point(rng, box, pins)
            pad = [mpf(0)] * (n - h)
            w, v = quaternion(sectors, x[:h] + pad)
            back, u = quaternion(sectors, [mpf(0)] * h + x[h:])
            wanted = [w - back, *(a + b for a, b in zip(v, u, strict=True))]
            for r in range(4):
                total = sum(
                    (
                        column[r, 0] * math.prod((xi[j] for j in xi if mask >> j & 1), start=arb(1))
                        for mask, column in terms.items()
                    ),
                    arb(0),
                )
                assert holds(total, wanted[r])


def states_in_50_digits(s, rng, pins, count):
    """Closed states with some creases pinned, of so many random starts."""
    sectors = np.array(s.vertex.sector_angles)
    near = closed_states(s, rng.uniform(-3, 3, (count, s.degree)), pins)
    for start in near[(np.abs(near) <= np.pi).all(axis=1)]:
        moved = [int(i) for i in rng.permutation(np.flatnonzero(np.array(pins) == 0))[:3]]
        x = [p * mp.pi if p else mpf(v) for p, v in zip(pins, start, strict=True)]
        axis = np.array([[float(v) for v in axes(sectors, start)[i]] for i in moved])
        if np.linalg.cond(axis) > 1e3:
            continue
        for _ in range(4):  # Newton with the slopes of doubles: 12 digits a step
            v = np.array([float(a * mpf(10) ** 40) for a in quaternion(sectors, x)[1]])
            for i, d in zip(moved, np.linalg.solve(axis.T, 2 * v), strict=True):
                x[i] -= mpf(d) / mpf(10) ** 40
        assert max(map(abs, quaternion(sectors, x)[1])) < 1e-45
        yield x


@pytest.mark.parametrize("degree", [4, 5])
def test_no_closed_state_is_excluded_or_cut_off(degree):
    s, rng = scene(degree, 10 + degree), np.random.default_rng(degree)
    sheet, seen = sheet_of(s), 0
    pins = [0] * degree
    states = list(states_in_50_digits(s, rng, pins, 30))
    for i in range(degree):
        pinned = [int(i == j) for j in range(degree)]
        states += states_in_50_digits(s, rng, pinned, 5)
    for x in states:
        pins = [int(v == mp.pi) for v in x]
        seen += 1
        for exponent in (0, -2, -4, -8):
            reach = 10 ** (exponent + rng.uniform(-1, 0, (degree, 2)))
            box = tuple(
                (max(-UP, float(v) - float(a)), min(UP, float(v) + float(b)))
                for v, (a, b) in zip(x, reach, strict=True)
            )
            combined = States(sheet, box, pins)
            assert not combined.empty
            new = combined.narrowed(box)
            for j in combined.known:
                assert box[j][0] <= new[j][0] <= x[j] <= new[j][1] <= box[j][1]
                kept = (float(x[j]) + 1e-3 * (box[j][1] - float(x[j])), box[j][1])
                if kept[0] > x[j]:  # what is cut off holds the state
                    assert (box[j][0], kept[0]) in combined.beyond(j, box[j], kept)
    assert seen > 15


@pytest.mark.parametrize("degree", [4, 5, 6])
def test_minors_hold_what_50_digits_say_of_closed_states(degree):
    s, rng = scene(degree, 20 + degree), np.random.default_rng(degree)
    sheet, seen = sheet_of(s), 0
    sectors, sets = s.vertex.sector_angles, list(itertools.combinations(range(degree), 4))
    for pinned in (None, 0, degree - 2):
        pins = [int(i == pinned) for i in range(degree)]
        for x in states_in_50_digits(s, rng, pins, 20):
            true, torque = axes(sectors, x), [
                mpf(k) * (a - mpf(b))
                for k, a, b in zip(s.stiffness, x, s.rest_angles, strict=True)
            ]  # fmt: skip
            for exponent in (0, -3, -9):
                reach = 10 ** (exponent + rng.uniform(-1, 0, (degree, 2)))
                box = tuple(
                    (max(-UP, float(v) - float(a)), min(UP, float(v) + float(b)))
                    for v, (a, b) in zip(x, reach, strict=True)
                )
                xi = {}
                for j in (j for j in range(degree) if not pins[j]):
                    m, r = f.parts(*box[j])
                    with ctx.workprec(200):
                        xi[j] = (exactly(x[j]) - m) / r
                for four in sets:
                    if any(pins[i] for i in four):
                        continue
                    seen += 1
                    wanted = mp.det(mp.matrix([[torque[i], *true[i]] for i in four]))
                    assert holds(at(next(sheet.minors([four], box, pins)), xi), wanted)
    assert seen > 20


def test_any_combination_of_rows_may_be_suggested():
    """Suggestions are in doubles and untrusted: nonsense excludes nothing that is there."""
    s, rng = scene(4, 3), np.random.default_rng(1)
    sheet, pins = sheet_of(s), [0] * 4
    x = next(states_in_50_digits(s, rng, pins, 20))
    box = tuple((float(v) - 0.1, float(v) + 0.07) for v in x)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check_bounds, "suggestions", lambda *_: rng.normal(size=(50, 4)).tolist())
        combined = States(sheet, box, pins)
    assert not combined.empty
    assert all(a <= v <= b for (a, b), v in zip(combined.narrowed(box), x, strict=True))


TWINS = [
    ("cross", (math.pi / 2,) * 4),
    ("two alike", (1.0, 1.0, 2.0, 2 * math.pi - 4.0)),
    ("three", (2.0, 0.5, math.pi - 1.5, math.pi / 2, math.pi / 2 - 1.0)),
]


@pytest.mark.parametrize("sectors", [t[1] for t in TWINS], ids=[t[0] for t in TWINS])
def test_twins_are_the_creases_whose_axes_coincide(sectors):
    rng, n = np.random.default_rng(0), len(sectors)
    sheet = VertexChain(sectors, (1.0,) * n, (0.0,) * n)
    found = 0
    for pins in itertools.product((0, 1, -1), repeat=n):
        for a, b in itertools.permutations([i for i in range(n) if not pins[i]], 2):
            between = [(a + k) % n for k in range(1, (b - a) % n)]
            if not all(pins[i] for i in between):
                continue
            x = [p * mp.pi if p else mpf(rng.uniform(-3, 3)) for p in pins]
            # from the facet before crease a: all between a and b are pinned
            turned = sectors[a:] + sectors[:a]
            c = axes(turned, x[a:] + x[:a])
            first, second = c[0], c[(b - a) % n]
            near = [
                sg
                for sg in (1, -1)
                if all(abs(p - sg * q) < 1e-14 for p, q in zip(first, second, strict=True))
            ]
            said = sheet.twin(a, b, pins)
            if near:
                found += 1
                assert said == near[0]
            elif (shorter := [(b + k) % n for k in range(1, (a - b) % n)]) and not all(
                pins[i] for i in shorter
            ):
                assert said is None
    assert found > 0


def test_a_generic_vertex_has_no_twins():
    sheet = sheet_of(scene(5, 0))
    for pins in itertools.product((0, 1), repeat=5):
        free = [i for i in range(5) if not pins[i]]
        assert all(sheet.twin(a, b, pins) is None for a, b in itertools.permutations(free, 2))
