"""Newton on a piece's stationarity conditions with 50 digits: closure, contacts and multipliers.

The same conditions as `search_stationary`, written again in mpmath.  First derivatives are analytic
(the axis of each fold); their derivative is a central difference with 100 working digits and steps
of 1e-35, so that it has more digits than are asked for.
"""

from __future__ import annotations

from fractions import Fraction

import mpmath as mp
import numpy as np

from tests.independent.search_manifold import Piece
from tests.independent.search_stationary import Contact

DIGITS = 50


def _exact(angle: float) -> mp.mpf:
    """A sector or rest angle as the rational multiple of pi that it stands for."""
    share = Fraction(angle / float(np.pi)).limit_denominator(720)
    assert abs(float(share) * np.pi - angle) < 1e-15
    return mp.pi * share.numerator / share.denominator


def _cross(a: list, b: list) -> list:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _fold(chain: list, x: list) -> tuple[list[list], list]:
    a, b, c = ([mp.mpf(int(i == j)) for i in range(3)] for j in range(3))
    creases = []
    for i, angle in enumerate(x):
        t = angle / 2 if i in (0, len(x) - 1) else angle
        creases.append(a)
        co, si = mp.cos(t), mp.sin(t)
        b, c = (
            [co * p + si * q for p, q in zip(b, c, strict=True)],
            [co * q - si * p for p, q in zip(b, c, strict=True)],
        )
        if i < len(chain):
            co, si = mp.cos(chain[i]), mp.sin(chain[i])
            a, b = (
                [co * p + si * q for p, q in zip(a, b, strict=True)],
                [co * q - si * p for p, q in zip(a, b, strict=True)],
            )
    return creases, b


def _constraints(
    piece: Piece, chain: list, held: tuple[Contact, ...], x: list
) -> tuple[list, list]:
    """Values and gradients of closure and of the openings of the held contacts."""
    n = piece.size
    creases, image = _fold(chain, x)
    weight = [mp.mpf(1) / 2 if i in (0, n - 1) else mp.mpf(1) for i in range(n)]
    slopes = [_cross(c, image) for c in creases]
    rows = [0, 2] if piece.half else [1]
    values = [image[r] for r in rows]
    gradients = [[w * s[r] for w, s in zip(weight, slopes, strict=True)] for r in rows]
    for kind, v, side in held:
        if kind == "limit":
            values.append(mp.pi - side * x[v])
            gradients.append([mp.mpf(-side if i == v else 0) for i in range(n)])
        elif kind == "axis":
            if v == 0:
                value, slope = -image[0], [-s[0] for s in slopes]
            else:
                value, slope = creases[-1][1], [_cross(c, creases[-1])[1] for c in creases]
            root = mp.sqrt(1 - value**2)
            values.append(mp.asin(value))
            gradients.append([w * s / root for w, s in zip(weight, slope, strict=True)])
        else:  # "plane": crease c_4 off the plane of facet 1
            normal = [t / mp.sin(chain[0]) for t in _cross(creases[0], creases[1])]
            value = sum(p * q for p, q in zip(normal, creases[-1], strict=True))
            # c_1 and c_2 do not move with later folds; c_4 turns about every crease
            slope = []
            for i, c in enumerate(creases):
                moved = _cross(c, creases[-1])
                total = sum(p * q for p, q in zip(normal, moved, strict=True))
                if i == 0:  # the whole half turns about c_1, the plane with it
                    turned = _cross(c, normal)
                    total += sum(p * q for p, q in zip(turned, creases[-1], strict=True))
                slope.append(side * total / mp.sqrt(1 - value**2))
            values.append(side * mp.asin(value))
            gradients.append([w * s for w, s in zip(weight, slope, strict=True)])
    return values, gradients


def solve_exactly(
    piece: Piece, x: np.ndarray, held: tuple[Contact, ...]
) -> tuple[list[mp.mpf], list[mp.mpf], mp.mpf]:
    """Return fold angles, contact multipliers, and the residual, from a state x [n] near by."""
    n = piece.size
    with mp.workdps(2 * DIGITS):
        chain = [_exact(a) for a in piece.chain.tolist()]
        rest = [_exact(a) for a in piece.rest.tolist()]
        k = [mp.mpf(v) for v in piece.stiffness.tolist()]
        y = [mp.mpf(v) for v in x.tolist()]
        _, a = _constraints(piece, chain, held, y)
        pull = [kv * (xv - rv) for kv, xv, rv in zip(k, y, rest, strict=True)]
        lam = np.linalg.lstsq(np.array(a, float).T, np.array(pull, float), rcond=None)[0]
        z = y + [mp.mpf(v) for v in lam.tolist()]
        m = len(a)

        def conditions(z: list) -> list:
            c, a = _constraints(piece, chain, held, z[:n])
            force = [
                k[i] * (z[i] - rest[i]) - sum(a[j][i] * z[n + j] for j in range(m))
                for i in range(n)
            ]
            return force + c

        step = mp.mpf(10) ** -35
        residual = mp.inf
        for _ in range(12):
            f = conditions(z)
            residual = max(abs(v) for v in f)
            if residual < mp.mpf(10) ** -DIGITS:
                break
            jac = mp.matrix(n + m, n + m)
            for j in range(n + m):
                up, down = list(z), list(z)
                up[j] += step
                down[j] -= step
                for i, (p, q) in enumerate(zip(conditions(up), conditions(down), strict=True)):
                    jac[i, j] = (p - q) / (2 * step)
            move = mp.lu_solve(jac, mp.matrix(f))
            z = [v - move[i] for i, v in enumerate(z)]
        return z[:n], z[n + m - len(held) :], residual
