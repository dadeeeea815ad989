"""No critical point near the flat state but, perhaps, itself: shown in ball arithmetic, without a remainder term.

All creases are free there.  With x = r u, max |u_i| = 1 and 0 < |r| <= r0 (r takes both signs, so that some u_i is +1),
the chain is written in numbers that stay finite as r -> 0: q = w + r (omega_x i + omega_y j) + r^2 zeta k, where by
Q(b, r u) = C + r s b, s = sin(r u/2)/r, J b = (-b_y, b_x), exactly

    w' = w C - r^2 s omega . b,    omega' = omega C + s (w b + r^2 zeta J b),    zeta' = zeta C + s (omega x b)_z.

The axis c = q b q* has in the plane the part P = b (1 - 2 r^2 |omega|^2 - 2 r^4 zeta^2) + 2 r^2 (w zeta J b +
(omega . b) omega), and r h out of it, h = 2 w (omega x b)_z + 2 r^2 zeta (omega . b).  Closure is omega = 0 and zeta =
0; for r != 0, det [G | C]_S = 0 is det [G | P | h]_S = 0, G_i the torque at r u_i.  All this is enclosed over r in
[-r0, r0] and boxes of u; where it has no common zero, nothing else is critical within r0.

The flat state is no minimum where a direction u has sum u_i b_i = 0, Q(u) = zeta(u) = 0 and a torque G . u != 0, and Q
is not stationary there: closed states pass through 0 along u, and in one of both senses the energy falls.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from flint import arb

from origami_nlp.proof.check_bounds import Bounds
from origami_nlp.proof.check_domains import VertexChain
from origami_nlp.proof.check_forms import (
    AROUND,
    SQUARE,
    Box,
    Form,
    add,
    cross,
    dot,
    minor,
    parts,
    scaled,
    times,
)

MOST_BOXES = 2_000
"""Boxes of u tried."""


def isolated(sheet: VertexChain, r0: float, most: int = MOST_BOXES) -> int | None:
    """Show that 0 < max |x_i| <= r0 holds no critical point with all creases free.

    Parameters
    ----------
    sheet
        The vertex.
    r0
        Radius [rad].
    most
        Boxes tried.

    Returns
    -------
    int or None
        Boxes it took; None where it could not be shown.
    """
    if not 0 < r0 < 1:
        return None
    n = sheet.count
    stack: list[Box] = [
        tuple((1.0, 1.0) if i == j else (-1.0, 1.0) for j in range(n)) for i in range(n)
    ]
    for boxes in range(1, most + 1):
        box = stack.pop()
        bounds = Bounds([j for j, (low, high) in enumerate(box) if low < high])
        bounds.add_rows(rows(sheet, box, arb(r0)))
        # not excluded: narrowed, and cut at its widest side
        if not bounds.empty:
            box = bounds.narrowed(box)
            axis = max(range(n), key=lambda j: box[j][1] - box[j][0])
            low, high = box[axis]
            middle = 0.5 * (low + high)
            if not low < middle < high:
                return None
            stack += [(*box[:axis], h, *box[axis + 1 :]) for h in ((low, middle), (middle, high))]
        if not stack:
            return boxes
    return None


def rows(sheet: VertexChain, box: Box, r0: Any) -> list[Form]:
    """Return what vanishes at a critical point r u: omega, zeta and the determinants, over a box of u."""
    n, square, half = sheet.count, SQUARE * r0 * r0, r0 / 2
    even = (1 + half.cos()) / 2 + AROUND * ((1 - half.cos()) / 2)
    # s = sin(r u / 2) / r = u / 2 times sin(h)/h, h = r u / 2, which lies in [sin(r0/2)/(r0/2), 1]
    lowest = half.sin() / half
    slope = ((1 + lowest) / 2 + AROUND * ((1 - lowest) / 2)) / 2
    w, zeta, across, up = _fixed(1), _fixed(0), _fixed(0), _fixed(0)
    axes: list[list[Form]] = []
    torques: list[Form] = []
    for i in range(n):
        x, y = sheet.flat[i]
        along = add(scaled(across, x), scaled(up, y))  # omega . b
        out = add(scaled(across, y), scaled(up, x), -1)  # (omega x b)_z
        level, bent = times(w, zeta), scaled(times(zeta, along), square)
        size = add(add(times(across, across), times(up, up)), scaled(times(zeta, zeta), square))
        shrunk = add(_fixed(1), scaled(size, 2 * square), -1)
        twice = 2 * square
        px = add(scaled(level, -y), times(along, across))
        py = add(scaled(level, x), times(along, up))
        axes.append(
            [
                add(scaled(shrunk, x), scaled(px, twice)),
                add(scaled(shrunk, y), scaled(py, twice)),
                scaled(add(times(w, out), bent), arb(2)),
            ]
        )
        middle, radius = parts(*box[i])
        u = middle, {i: radius} if radius > 0 else {}
        # r u_i is no linear form of the box: it goes into the ball
        torques.append((sheet.pull(i, AROUND * r0), {}))  # |u_i| <= 1
        s, lifted = scaled(u, slope), scaled(zeta, square)
        w, zeta, across, up = (
            add(scaled(w, even), scaled(times(s, along), square), -1),
            add(scaled(zeta, even), times(s, out)),
            add(scaled(across, even), times(s, add(scaled(w, x), scaled(lifted, y), -1))),
            add(scaled(up, even), times(s, add(scaled(w, y), scaled(lifted, x)))),
        )
    found = [across, up, zeta]
    for four in itertools.combinations(range(n), 4):
        a, b, c, d = (axes[i] for i in four)
        ab, cd = cross(a, b), cross(c, d)
        triples = [dot(b, cd), dot(a, cd), dot(ab, d), dot(ab, c)]
        found.append(minor([torques[i] for i in four], triples))
    return found


def _fixed(value: int) -> Form:
    return arb(value), {}


def falls(sheet: VertexChain) -> bool:
    """Show that the flat state is no minimum: the energy falls along an escape path from it.

    Parameters
    ----------
    sheet
        The vertex.

    Returns
    -------
    bool
        False where it was not shown.
    """
    n = sheet.count
    plane = np.array([[float(c.mid()) for c in b] for b in sheet.flat]).T
    a, b = max(
        itertools.combinations(range(n), 2),
        key=lambda p: abs(float(np.linalg.det(plane[:, list(p)]))),
    )
    others = [i for i in range(n) if i not in (a, b)]
    led = np.linalg.solve(plane[:, [a, b]], -plane[:, others])
    basis = np.zeros((n, n - 2))
    basis[[a, b]], basis[others] = led, np.eye(n - 2)
    turned = np.triu(plane[0][:, None] * plane[1] - plane[1][:, None] * plane[0], 1)
    # doubles: only where to look for directions with Q > 0 and Q < 0
    values, vectors = np.linalg.eigh(basis.T @ (turned + turned.T) @ basis)
    ups, downs = vectors[:, values > 0].T, vectors[:, values < 0].T
    starts = itertools.product(ups, [*downs, *-downs])
    return any(_falls(sheet, (a, b), others, p.tolist(), m.tolist()) for p, m in starts)


def _falls(
    sheet: VertexChain,
    led: tuple[int, int],
    others: list[int],
    start: list[float],
    end: list[float],
) -> bool:
    """Return whether G . u != 0 where Q(u) = 0 between two directions; `led` creases keep sum u_i b_i = 0."""
    u, v = (_completed(sheet, led, others, way) for way in (start, end))
    # Q(u + t (v - u)) = c + 2 b t + a t^2 changes its sign in 0 < t < 1: one root, a simple one
    uu, uv, vv = _form(sheet, u, u), _form(sheet, u, v), _form(sheet, v, v)
    a, b, c = uu - 2 * uv + vv, uv - uu, uu
    if not (c > 0 and vv < 0):
        return False
    # the root of c + 2 b t + a t^2 without cancellation: c > 0 > c + 2 b + a
    t = c / (-b + (b * b - a * c).sqrt())
    way = [x + t * (y - x) for x, y in zip(u, v, strict=True)]
    torque = sum((sheet.pull(i, arb(0)) * x for i, x in enumerate(way)), arb(0))
    return bool(abs(torque) > 0)


def _completed(
    sheet: VertexChain, led: tuple[int, int], others: list[int], free: list[float]
) -> list[Any]:
    """Return u with given entries at `others` and sum u_i b_i = 0, in balls."""
    (ax, ay), (bx, by) = (sheet.flat[i] for i in led)
    x = sum((sheet.flat[i][0] * v for i, v in zip(others, free, strict=True)), arb(0))
    y = sum((sheet.flat[i][1] * v for i, v in zip(others, free, strict=True)), arb(0))
    size = ax * by - ay * bx
    found = dict(zip(others, map(arb, free), strict=True))
    found[led[0]], found[led[1]] = (bx * y - by * x) / size, (ay * x - ax * y) / size
    return [found[i] for i in range(sheet.count)]


def _form(sheet: VertexChain, u: list[Any], v: list[Any]) -> Any:
    """Bilinear form of Q, Q(u) = sum over j < i of u_j u_i (b_j x b_i)_z."""
    total = arb(0)
    for j, i in itertools.combinations(range(sheet.count), 2):
        (ax, ay), (bx, by) = sheet.flat[j], sheet.flat[i]
        total += (ax * by - ay * bx) * (u[j] * v[i] + u[i] * v[j]) / 2
    return total
