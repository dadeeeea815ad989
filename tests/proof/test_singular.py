"""Singular states stand alone: rows against 50 digits, planted critical points, and what must not be shown."""

import itertools
import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from origami_nlp import Model, Scene, Vertex, examples
from origami_nlp.numerics import SAME
from origami_nlp.programme import Kinematics
from origami_nlp.proof import isolated
from origami_nlp.proof.blow_up import Site
from origami_nlp.proof.singular import RADII

KAWASAKI, CROSS, SIXTY = (60, 80, 120, 100), (90,) * 4, (60,) * 6
PAIRS, TWIST = (50, 60, 70, 110, 70), (90, 45, 90, 135)


def scene(degrees: tuple[int, ...], seed: int, symmetry: str = "none") -> Scene:
    """Random springs on a vertex; with a symmetry, the same on each orbit."""
    rng = np.random.default_rng(seed)
    n = len(degrees)
    k, rest = np.exp(rng.uniform(-1, 1, n)), rng.uniform(-3, 3, n)
    if symmetry != "none":
        plain = Scene(Vertex.from_degrees(degrees), (1.0,) * n, (0.0,) * n, symmetry, "fold-limits")
        orbit = Model(plain).variable_of_crease
        k, rest = k[orbit], rest[orbit]
    return Scene(Vertex.from_degrees(degrees), tuple(k), tuple(rest), symmetry, "fold-limits")


def flat_foldings(model: Model) -> np.ndarray:
    """All closed states with fold angles 0 and +-pi, [K, n]."""
    x = np.array(list(itertools.product((0, 1, -1), repeat=model.size))) * math.pi
    kinematics = Kinematics(model)
    at = kinematics.fold(x)
    return x[(np.abs(kinematics.closure(at)[0]).max(axis=1) < 1e-12) & (at.sheet > 0)]


def touched(x: np.ndarray) -> list[tuple[int, ...]]:
    """All strata that a flat folding touches."""
    return list(itertools.product(*[(0, round(t)) if t else (0,) for t in x / math.pi]))


# --- the rows, against 50 digits


def product(p: list, q: list) -> list:
    a, b, c, d = p
    e, f, g, h = q
    return [
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    ]


def closing(model: Model, sectors: list, x: list) -> tuple[list, list[list]]:
    """Closure rows [m] and their derivatives [m][n] at x [n] from products of folds, by the rule of products."""
    kind, order = model.structure.kind, model.structure.order
    pi = mpmath.pi
    azimuth, turns, v = mpmath.mpf(0), [], 0
    for r, has in enumerate(model.structure.has_crease):
        azimuth = azimuth if r == 0 else azimuth + sectors[r - 1]
        last = r == len(model.structure.has_crease) - 1
        if kind == "D" and last:
            azimuth = pi / order
        if has:
            share = mpmath.mpf(1) / (4 if kind == "D" and (r == 0 or last) else 2)
            h, b = x[v] * share, [mpmath.cos(azimuth), mpmath.sin(azimuth), 0]
            fold = [mpmath.cos(h)] + [mpmath.sin(h) * e for e in b]
            slope = [-mpmath.sin(h) * share] + [mpmath.cos(h) * share * e for e in b]
            turns.append((fold, slope))
            v += 1

    def chain(which: int | None) -> list:
        q = [mpmath.mpf(1), 0, 0, 0]
        for i, (fold, slope) in enumerate(turns):
            q = product(q, slope if i == which else fold)
        return q

    def rows(q: list, dq: list | None = None) -> list:
        if kind == "C" and order == 1:
            return (dq or q)[1:]
        if kind == "C":
            end = [mpmath.cos(pi / order), 0, 0, mpmath.sin(pi / order)]
            w = product(dq or q, end)[0]
            return [w] if dq else [w - mpmath.cos(pi / order)]
        if order == 1:
            return [(dq or q)[1], (dq or q)[3]]
        normal = [0, mpmath.sin(pi / order), -mpmath.cos(pi / order), 0]

        def carried(p: list, o: list) -> list:
            return product(product(p, normal), [o[0], -o[1], -o[2], -o[3]])

        if dq is None:
            return [carried(q, q)[2] + mpmath.cos(pi / order)]
        return [carried(dq, q)[2] + carried(q, dq)[2]]

    q = chain(None)
    return rows(q), [
        list(col) for col in zip(*(rows(q, chain(i)) for i in range(len(turns))), strict=True)
    ]


def exact(model: Model) -> list:
    """Sector angles of the piece, which are whole multiples of half a degree, to 50 digits."""
    out = []
    for a in model.parameters.sectors:
        part = Fraction(a / math.pi).limit_denominator(360)
        assert abs(float(part) * math.pi - a) < 1e-14
        out.append(mpmath.pi * part.numerator / part.denominator)
    return out


def worst(
    model: Model, point: np.ndarray, lines: list[list[int]], seed: int
) -> tuple[float, float]:
    """Largest |row - its forms| over its error, closure and minors; the same with errors of higher order / 1e5."""
    rng, n = np.random.default_rng(seed), model.size
    free = (
        (0,) * n
        if not lines
        else tuple(
            int(all(i not in line for line in lines)) * round(point[i] / math.pi) for i in range(n)
        )
    )
    site = Site(model, point, lines, free)
    seen = [i for i, s in enumerate(free) if not s]
    with mpmath.workdps(50):
        sectors = exact(model)
        star = [mpmath.pi * round(float(t / math.pi)) for t in point]
        for line in lines:
            quarter = sum(
                float(point[i]) * (1 if i == line[0] else ratio(site, i, line[0])) for i in line
            )
            for i in line:
                star[i] = mpmath.mpf(float(point[i]))
            t = ratio(site, line[1], line[0])
            star[line[1]] = (mpmath.pi / 2 * round(quarter / (math.pi / 2)) - star[line[0]]) / t
        largest = least = 0.0
        for radius in (1e-2, 1e-4):
            rows = list(site._closure())
            minors = [k for k in site.minors if set(k.creases) <= set(seen)]
            rows += [k.row(site, radius) for k in minors]
            for r in (radius, radius / 3):
                u = np.where(np.isin(np.arange(n), seen), rng.uniform(-1, 1, n), 0.0)
                x = [
                    s + mpmath.mpf(r) * mpmath.mpf(e) for s, e in zip(star, u.tolist(), strict=True)
                ]
                value, slope = closing(model, sectors, x)
                turn = [[mpmath.mpf(e) for e in row] for row in site.turn.tolist()]
                m = len(value)
                value = [sum(a * b for a, b in zip(row, value, strict=True)) for row in turn]
                slope = [
                    [sum(row[k] * slope[k][i] for k in range(m)) for i in range(n)] for row in turn
                ]
                p = model.parameters
                torque = [
                    mpmath.mpf(float(p.stiffness[i]))
                    * (x[i] - mpmath.mpf(float(p.rest[i])))
                    / site.scale
                    for i in range(n)
                ]
                actual = [g / r if k < site.rank else 2 * g / r**2 for k, g in enumerate(value)]
                for k, row in zip(minors, rows[m:], strict=True):
                    table = mpmath.matrix(
                        [
                            [torque[i]]
                            + [slope[c][i] / (1 if c < site.rank else r) for c in range(m)]
                            for i in k.creases
                        ]
                    )
                    actual.append(mpmath.det(table) / (r if row.loose else 1))
                for row, true in zip(rows, actual, strict=True):
                    c, a, q, t, tq = row.forms
                    said = c + a @ u + u @ q @ u + r * (t @ u + u @ tq @ u)
                    miss, high = abs(float(true - said)), row.error * r**site.order
                    largest = max(largest, miss / (row.base + high))
                    least = max(least, miss / (row.base + 1e-5 * high))
    return largest, least


def ratio(site: Site, i: int, k: int) -> float:
    one, other = site.jacobian[:, i], site.jacobian[:, k]
    return float(one @ other / (other @ other))


@pytest.mark.parametrize(
    ("degrees", "symmetry"),
    [
        (KAWASAKI, "none"),
        (CROSS, "none"),
        (SIXTY, "none"),
        ((60, 60, 60, 60, 60, 60), "D1"),
        ((45, 90, 45, 45, 90, 45), "D1"),
        ((70, 110, 70, 110), "C2"),
        ((30, 60, 60, 30, 30, 60, 60, 30), "D2"),
        ((50, 70, 50, 70, 50, 70), "D3"),
        ((50, 70, 50, 70, 50, 70), "C3"),
    ],
)
def test_rows_at_flat_foldings_hold_to_fifty_digits(
    degrees: tuple[int, ...], symmetry: str
) -> None:
    """Also that their error bounds are no empty words: a part in 1e5 of them does not hold."""
    model = Model(scene(degrees, 1, symmetry))
    states = flat_foldings(model)
    picked = states[np.linspace(0, len(states) - 1, min(5, len(states))).astype(int)]
    both = [worst(model, x, [], k) for k, x in enumerate(picked)]
    assert max(large for large, _ in both) <= 1
    assert max(small for _, small in both) > 1


@pytest.mark.parametrize("at_rest", [False, True])
def test_rows_at_flat_foldings_with_springs_at_rest_hold_to_fifty_digits(at_rest: bool) -> None:
    plain = scene(KAWASAKI, 3)
    x = flat_foldings(Model(plain))[5]
    rest = tuple(x.tolist()) if at_rest else plain.rest_angles
    model = Model(Scene(plain.vertex, plain.stiffness, rest, "none", "fold-limits"))
    rows = [
        minor.row(Site(model, x, [], (0,) * 4), 1e-3)
        for minor in Site(model, x, [], (0,) * 4).minors
    ]
    assert [row.loose for row in rows] == [at_rest] * len(rows)
    assert worst(model, x, [], 0)[0] <= 1


HANDLES = [
    (
        Scene(
            Vertex.from_degrees(CROSS),
            (1, 1.2, 0.8, 0.9),
            (0.7, -0.5, 1.1, 0.2),
            "none",
            "fold-limits",
        ),
        0,
        2,
    ),
    (examples.degree6("pi/3", 1.0, contact="fold-limits"), 1, 3),
]


def handles(plain: Scene, a: int, b: int) -> list[np.ndarray]:
    """States with creases a and b turned and in balance: the minimum of the energy on a line of closed states."""
    model = Model(plain)
    kinematics, out = Kinematics(model), []
    others = [i for i in range(model.size) if i not in (a, b)]
    for sides in itertools.product((0.0, math.pi, -math.pi), repeat=len(others)):
        for t, total in itertools.product((1, -1, 2, -2), np.arange(-4, 5) * math.pi / 2):
            line = np.tile(np.zeros(model.size), (3, 1))
            line[:, others] = sides
            line[:, a] = (0.0, 0.4, 1.0)
            line[:, b] = total - t * line[:, a]
            at = kinematics.fold(line)
            if np.abs(kinematics.closure(at)[0]).max() > 1e-12 or (at.sheet <= 0).any():
                continue
            energy = model.energies(line)
            first = np.polyfit(line[:, a], energy, 2)
            x = line[0].copy()
            x[a] = -first[1] / (2 * first[0])
            x[b] = total - t * x[a]
            pair = np.abs(x[[a, b]])
            if pair.max() < math.pi - 0.01 and pair.min() > 0.01:
                out.append(x)
    return out


@pytest.mark.parametrize(("plain", "a", "b"), HANDLES)
def test_handles_in_balance_stand_alone_on_all_their_strata(plain: Scene, a: int, b: int) -> None:
    states = handles(plain, a, b)
    assert len(states) >= 2
    model = Model(plain)
    for x in states:
        strata = [s for s in touched(np.where(np.abs(np.abs(x) - math.pi) < 1e-9, x, 0.0))]
        for s in strata:
            found = isolated(model, x + 1e-5, s)
            assert found.radius >= 1e-5, (x, s, found.reason)
            np.testing.assert_allclose(found.point, x, atol=1e-12)
        beside = x.copy()
        t = x[b]
        beside[[a, b]] += (0.05, 0.0)
        assert isolated(model, beside, strata[0]).radius == 0.0 and x[b] == t
        slope = handle_slope(model, x, a, b)
        along = x.copy()
        along[[a, b]] += (0.05, 0.05 * slope)
        lost = isolated(model, along, strata[0])
        assert lost.radius == 0.0 and "balance" in lost.reason


def handle_slope(model: Model, x: np.ndarray, a: int, b: int) -> float:
    """How b turns with a where the pair stays closed."""
    kinematics = Kinematics(model)
    jacobian = kinematics.closure(kinematics.fold(x[None]))[1][0]
    return -float(jacobian[:, a] @ jacobian[:, b] / (jacobian[:, b] @ jacobian[:, b]))


@pytest.mark.parametrize(("plain", "a", "b"), HANDLES)
def test_rows_at_handles_hold_to_fifty_digits(plain: Scene, a: int, b: int) -> None:
    model = Model(plain)
    both = [
        worst(model, np.array(isolated(model, x, touched(0 * x)[0]).point), [[a, b]], 0)
        for x in handles(plain, a, b)
    ]
    assert max(large for large, _ in both) <= 1
    assert max(small for _, small in both) > 1


# --- what is shown


@pytest.mark.parametrize("degrees", [KAWASAKI, CROSS, PAIRS, TWIST])
def test_flat_foldings_with_random_springs_stand_alone_on_every_stratum(
    degrees: tuple[int, ...],
) -> None:
    model = Model(scene(degrees, 0))
    radii = [isolated(model, x, s).radius for x in flat_foldings(model) for s in touched(x)]
    assert len(radii) > 10
    assert min(radii) >= 1e-3


@pytest.mark.parametrize("alpha", examples.DEGREE6_ALPHAS)
@pytest.mark.parametrize("ratio", examples.RATIOS)
def test_flat_foldings_of_the_panels_stand_alone(alpha: str, ratio: float) -> None:
    model = Model(examples.degree6(alpha, ratio, contact="fold-limits"))
    found = [isolated(model, x, s) for x in flat_foldings(model) for s in touched(x)]
    assert len(found) > 100
    assert min(f.radius for f in found) >= 1e-5
    assert {f.core for f in found} <= {0.0, SAME}


def test_units_and_the_start_of_the_labels_do_not_matter() -> None:
    plain = scene(KAWASAKI, 0)
    model, x = Model(plain), flat_foldings(Model(plain))[3]
    vertex = Vertex.from_degrees(KAWASAKI[1:] + KAWASAKI[:1])
    turned = Model(
        Scene(
            vertex,
            tuple(1e6 * np.roll(plain.stiffness, -1)),
            tuple(np.roll(plain.rest_angles, -1)),
            "none",
            "fold-limits",
        )
    )
    for s in touched(x):
        other = isolated(turned, np.roll(x, -1), tuple(np.roll(s, -1)))
        assert isolated(model, x, s).radius == other.radius > 0


# --- what must not be shown


def planted(
    seed: int, degrees: tuple[int, ...]
) -> tuple[Model, np.ndarray, tuple[int, ...], float] | None:
    """Springs for which a state beside a flat folding is critical: model, folding, stratum, distance."""
    rng = np.random.default_rng(seed)
    plain = Scene(
        Vertex.from_degrees(degrees),
        (1,) * len(degrees),
        (0,) * len(degrees),
        "none",
        "fold-limits",
    )
    model = Model(plain)
    kinematics, states, n = Kinematics(model), flat_foldings(model), model.size
    x = states[rng.integers(len(states))]
    s = np.rint(x / math.pi) * (rng.random(n) < 0.4)
    free = s == 0
    if free.sum() < 4:
        return None
    u = rng.uniform(-1, 1, n) * free
    u = np.where(x == 0, u, -np.abs(u) * np.sign(x))
    y = x + 10 ** rng.uniform(-4, -2.3) * u
    for _ in range(50):
        value, jacobian = kinematics.closure(kinematics.fold(y[None]))
        y[free] -= np.linalg.lstsq(jacobian[0][:, free], value[0], rcond=1e-9)[0]
    value, jacobian = kinematics.closure(kinematics.fold(y[None]))
    away = float(np.abs(y - x).max())
    if np.abs(value).max() > 1e-15 or not 1e-5 < away < 9e-3 or np.abs(y).max() > math.pi:
        return None
    k, torque = np.exp(rng.uniform(-1, 1, n)), jacobian[0].T @ rng.normal(size=3)
    torque *= rng.uniform(0.1, 1) / np.abs(torque / k).max()
    rest = np.where(free, y - torque / k, rng.uniform(-3, 3, n))
    if np.abs(rest).max() > math.pi:
        return None
    final = Model(Scene(plain.vertex, tuple(k), tuple(rest), "none", "fold-limits"))
    return final, x, tuple(s.astype(int).tolist()), away


def plants() -> list[tuple[Model, np.ndarray, tuple[int, ...], float]]:
    tried = [planted(seed, d) for d in (KAWASAKI, CROSS, PAIRS) for seed in range(40)]
    tried += [planted(seed, SIXTY) for seed in range(8)]
    return [p for p in tried if p is not None]


def test_a_planted_critical_point_is_never_inside_the_radius() -> None:
    found = [(isolated(model, x, s), away) for model, x, s, away in plants()]
    assert len(found) >= 20
    for what, away in found:
        assert what.radius < away
    assert sum(what.radius > 0 for what, _ in found) >= len(found) // 3


def test_without_their_errors_rows_would_exclude_planted_critical_points(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = Site.forms

    def careless(self: Site, strata: list, radius: float):
        forms, loose = whole(self, strata, radius)
        forms.error[:], forms.tilt_linear[:], forms.tilt_quadratic[:] = 0, 0, 0
        return forms, loose

    monkeypatch.setattr(Site, "forms", careless)
    found = [(isolated(model, x, s), away) for model, x, s, away in plants()]
    assert any(what.radius >= away for what, away in found)


def test_branches_pass_through_flat_foldings_and_only_the_minors_exclude_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = Model(scene(KAWASAKI, 0))
    states = flat_foldings(model)
    assert min(isolated(model, x, (0, 0, 0, 0)).radius for x in states) > 0
    monkeypatch.setattr(Site, "_minors", lambda self: iter(()))
    bare = Model(scene(KAWASAKI, 0))
    found = [isolated(bare, x, (0, 0, 0, 0)) for x in states]
    lost = [f.reason for f in found if not f.radius]
    assert len(lost) >= 4 and all("along u" in why for why in lost)
    # with one crease held nothing moves: closure alone
    for x in states[np.abs(states[:, 0]) > 0]:
        assert isolated(bare, x, (round(x[0] / math.pi), 0, 0, 0)).radius > 0


@pytest.mark.parametrize("miss", [1e-6, 1e-5])
def test_a_vertex_that_nearly_folds_flat_has_no_such_state(miss: float) -> None:
    sectors = np.radians(KAWASAKI) + np.array([miss, 0, 0, -miss])
    exact_model, plain = Model(scene(KAWASAKI, 0)), scene(KAWASAKI, 0)
    near = Model(
        Scene(Vertex(tuple(sectors)), plain.stiffness, plain.rest_angles, "none", "fold-limits")
    )
    x = flat_foldings(exact_model)[-1]
    found = isolated(near, x, (0, 0, 0, 0))
    assert found.radius == 0.0 and "closes" in found.reason


def test_a_vertex_within_rounding_of_one_that_folds_flat_is_that_one() -> None:
    sectors = np.radians(KAWASAKI) + np.array([1e-10, 0, 0, -1e-10])
    plain = scene(KAWASAKI, 0)
    made = Scene(Vertex(tuple(sectors)), plain.stiffness, plain.rest_angles, "none", "fold-limits")
    assert made.relations.moved > 0  # the scene said so
    x = flat_foldings(Model(made))[-1]
    assert isolated(Model(made), x, (0, 0, 0, 0)).radius in RADII


def test_a_state_off_its_stratum_is_refused() -> None:
    model = Model(scene(KAWASAKI, 0))
    x = flat_foldings(model)[-1]
    wrong = tuple(-round(t) for t in x / math.pi)
    assert "stratum" in isolated(model, x, wrong).reason
    assert isolated(model, x, wrong).radius == 0.0
    assert isolated(model, (0.5, 0.7, 0.1, 0.3), (0, 0, 0, 0)).radius == 0.0
