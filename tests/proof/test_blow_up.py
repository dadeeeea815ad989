"""Closure, minors and twins near singular states: the forms and their errors, against 50 digits."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from origami_nlp import Scene, examples
from origami_nlp.problem import Model
from origami_nlp.proof import isolated
from origami_nlp.proof.blow_up import Site, rows_of
from tests.proof.fifty_digits import multiply
from tests.proof.singular_scenes import (
    CROSS,
    HANDLES,
    KAWASAKI,
    SIXTY,
    flat_foldings,
    handles,
    scene,
    touched,
)


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
            q = multiply(q, slope if i == which else fold)
        return q

    def rows(q: list, dq: list | None = None) -> list:
        if kind == "C" and order == 1:
            return (dq or q)[1:]
        if kind == "C":
            end = [mpmath.cos(pi / order), 0, 0, mpmath.sin(pi / order)]
            w = multiply(dq or q, end)[0]
            return [w] if dq else [w - mpmath.cos(pi / order)]
        if order == 1:
            return [(dq or q)[1], (dq or q)[3]]
        normal = [0, mpmath.sin(pi / order), -mpmath.cos(pi / order), 0]

        def carried(p: list, o: list) -> list:
            return multiply(multiply(p, normal), [o[0], -o[1], -o[2], -o[3]])

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
    model: Model,
    point: np.ndarray,
    lines: list[list[int]],
    seed: int,
    free: tuple[int, ...] | None = None,
) -> tuple[float, float]:
    """Largest |row - its forms| over its error, closure and minors; the same with errors of higher order / 1e5."""
    rng, n = np.random.default_rng(seed), model.size
    if free is None:
        turned = [i for line in lines for i in line]
        free = tuple(
            round(t) if lines and i not in turned else 0 for i, t in enumerate(point / math.pi)
        )
    site = Site(model, point, lines, free)
    seen = [i for i, s in enumerate(free) if not s]
    with mpmath.workdps(50):
        sectors = exact(model)
        star = [mpmath.pi * round(float(t / math.pi)) for t in point]
        for line in lines:
            t = [ratio(site, i, line[0]) for i in line]
            total = sum(a * point[i] for a, i in zip(t, line, strict=True))
            for i in line:
                star[i] = mpmath.mpf(float(point[i]))
            others = sum(a * star[i] for a, i in zip(t[:-1], line[:-1], strict=True))
            star[line[-1]] = (mpmath.pi / 2 * round(total / (math.pi / 2)) - others) / t[-1]
        largest = least = 0.0
        for radius in (1e-2, 1e-4):
            rows = list(site._closure())
            minors = [k for k in site.minors if set(k.creases) <= set(seen)]
            rows += rows_of(minors, site, radius)
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
    site = Site(model, x, [], (0,) * 4)
    rows = rows_of(site.minors, site, 1e-3)
    assert [row.loose for row in rows] == [at_rest] * len(rows)
    assert worst(model, x, [], 0)[0] <= 1


@pytest.mark.parametrize(("plain", "a", "b"), HANDLES)
def test_rows_at_handles_hold_to_fifty_digits(plain: Scene, a: int, b: int) -> None:
    model = Model(plain)
    both = [
        worst(model, np.array(isolated(model, x, touched(0 * x)[0]).point), [[a, b]], 0)
        for x in handles(plain, a, b)
    ]
    assert max(large for large, _ in both) <= 1
    assert max(small for _, small in both) > 1


@pytest.mark.parametrize("ratio", examples.RATIOS)
def test_rows_at_right_angles_hold_to_fifty_digits(ratio: float) -> None:
    model = Model(examples.degree6("pi/3", ratio, contact="fold-limits"))
    x = np.array([-1.0, 0.5, 1.0, 0.0]) * math.pi
    assert worst(model, x, [[1]], 0, (-1, 0, 0, 0))[0] <= 1
