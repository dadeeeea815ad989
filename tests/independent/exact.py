"""Second look at a suspicious neighbour with 40 digits, where touching and crossing are unmistakable."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import mpmath as mp
import numpy as np

from tests.independent.arcs import crossing_margin, nearest_touch
from tests.independent.layering import stackable, stackable_with

DIGITS = 40
TOUCH = 1e-22
"""Distance below which features touch; states are closed to 1e-35."""


def fold_exactly(sectors, phi):
    """Return creases and the axes of the product of all folds, as lists of three numbers."""
    rows = []
    x, y, z = ([mp.mpf(int(i == k)) for k in range(3)] for i in range(3))
    for a, f in zip(sectors, phi, strict=True):
        rows.append(x)
        y, z = _turn(y, z, f)
        x, y = _turn(x, y, a)
    return rows, (x, y, z)


def _turn(u, v, angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return [c * p + s * q for p, q in zip(u, v, strict=True)], [
        c * q - s * p for p, q in zip(u, v, strict=True)
    ]


def _exact(angle):
    """Return a sector angle, taken for a rational multiple of pi where it is one to rounding."""
    share = Fraction(angle / math.pi).limit_denominator(720)
    if abs(float(share) * math.pi - angle) <= 4e-16:
        return mp.mpf(share.numerator) / share.denominator * mp.pi
    return mp.mpf(angle)


def _close(p, sectors, x, held):
    """Newton onto closure in high precision: minimum-norm steps from a state closed to 1e-14."""
    n = p.size
    for _ in range(4):
        creases, (a, b, c) = fold_exactly(sectors, [x[v] for v in p.orbit])
        r = mp.matrix([(b[2] - c[1]) / 2, (c[0] - a[2]) / 2, (a[1] - b[0]) / 2])
        if mp.norm(r) < mp.mpf(10) ** (-35):
            return x, creases
        jac = np.zeros((3, n))
        for i, v in enumerate(p.orbit):
            if not held[v]:
                jac[:, v] += [float(creases[i][k]) for k in range(3)]
        inverse = np.linalg.pinv(jac, rcond=1e-9)
        for _ in range(12):  # chords with a fixed pseudo-inverse, well conditioned at this distance
            step = mp.matrix(inverse.tolist()) * r
            x = [xv - step[v] for v, xv in enumerate(x)]
            creases, (a, b, c) = fold_exactly(sectors, [x[v] for v in p.orbit])
            r = mp.matrix([(b[2] - c[1]) / 2, (c[0] - a[2]) / 2, (a[1] - b[0]) / 2])
            if mp.norm(r) < mp.mpf(10) ** (-35):
                return x, creases
    return None, None


def exact_state(p, y, held):
    """Close state y [n] in high precision and tell whether it is admissible (full contact)."""
    with mp.workdps(DIGITS):
        sectors = [_exact(a) for a in p.sectors.tolist()]
        sectors = [a * 2 * mp.pi / mp.fsum(sectors) for a in sectors]
        x = [mp.sign(v) * mp.pi if h else mp.mpf(v) for v, h in zip(y.tolist(), held, strict=True)]
        x, creases = _close(p, sectors, x, held)
        if x is None:
            return None, False
        slack = mp.mpf(10) ** -30
        if p.contact != "none" and any(abs(v) > mp.pi + slack for v in x):
            return x, False
        if p.contact != "full":
            return x, True
        ok = embedded(creases, [float(x[v]) for v in p.orbit])
        return x, ok


def embedded(creases, phi, maps=()):
    """Return whether a closed state has no crossings and layers with all symmetries `maps`."""
    n = len(creases)
    double = np.array([[float(v) for v in c] for c in creases])[None]
    if nearest_touch(double)[0] > 1e-9:  # then double precision knows every sign
        return bool(crossing_margin(double)[0] <= 0)
    creases = [mp.matrix(c) for c in creases]

    def det(a, b, c):
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    # shallower ones touch: their layers decide
    for i in range(n):
        for j in range(i + 2, n):
            if (i, j) == (0, n - 1):
                continue
            a, b, c, d = creases[i], creases[(i + 1) % n], creases[j], creases[(j + 1) % n]
            s = (det(a, b, d), -det(a, b, c), det(c, d, a), -det(c, d, b))
            if min(s) > TOUCH or max(s) < -TOUCH:
                return False
    label, *key = _combinatorics(creases, phi, det)
    return stackable_with(*key, label, maps) if maps else stackable(*key)


def _combinatorics(creases, phi, det):
    """`layering.combinatorics` with touching decided in high precision.

    Features that do not touch are moved apart in the double-precision copy only by labels: the walk
    is built from exact incidences.
    """
    n = len(creases)
    label = list(range(n))
    for k in range(n):
        for m in range(k):
            if mp.norm(creases[k] - creases[m]) <= TOUCH:
                label[k] = label[m]
                break
    nodes = sorted(set(label))
    walk, turns = [], []
    for i in range(n):
        a, b = creases[i], creases[(i + 1) % n]
        ab = sum(a[k] * b[k] for k in range(3))
        tangent = b - a * ab
        tangent = tangent / mp.norm(tangent)
        length = mp.acos(ab)
        stops = [(mp.mpf(0), label[i]), (length, label[(i + 1) % n])]
        for w in nodes:
            if w in (label[i], label[(i + 1) % n]):
                continue
            if abs(det(a, tangent, creases[w])) > TOUCH:
                continue
            s = mp.atan2(
                sum(creases[w][k] * tangent[k] for k in range(3)),
                sum(creases[w][k] * a[k] for k in range(3)),
            )
            if 0 < s < length:
                stops.append((s, w))
        stops.sort()
        walk += [(u[1], v[1]) for u, v in itertools.pairwise(stops)]
        turns += [i] + [-1] * (len(stops) - 2)
    sides = []
    for s, (start, crease) in enumerate(zip(walk, turns, strict=True)):
        back = walk[s - 1][0] == start[1]
        sides.append(int(np.sign(phi[crease])) if back and crease >= 0 else 0)
    around = []
    for w in range(n):
        near = sorted({v for u, v in walk if u == w} | {u for u, v in walk if v == w})
        c = creases[w]
        e = mp.matrix([0, 0, 0])
        e[min(range(3), key=lambda k: abs(c[k]))] = 1
        e = e - c * (c[0] * e[0] + c[1] * e[1] + c[2] * e[2])
        e = e / mp.norm(e)
        f = mp.matrix(
            [c[1] * e[2] - c[2] * e[1], c[2] * e[0] - c[0] * e[2], c[0] * e[1] - c[1] * e[0]]
        )
        near.sort(
            key=lambda v: mp.atan2(
                sum(creases[v][k] * f[k] for k in range(3)),
                sum(creases[v][k] * e[k] for k in range(3)),
            )
        )
        around.append(tuple(near))
    return tuple(label), tuple(walk), tuple(sides), tuple(around)


def lower_after_all(p, x, y, held) -> bool:
    """Return whether y, a neighbour of x, is admissible and lower also with 40 digits."""
    limits = np.pi - np.abs(x) <= 1e-9
    held_y = np.asarray(held, dtype=bool)
    exact, ok = exact_state(p, y, held_y)
    if not ok:
        return False
    # the reference is x itself, closed in high precision with its reached limits exact
    base, _ = exact_state(p, x, limits)
    if base is None:
        base, _ = exact_state(p, x, np.zeros(p.size, dtype=bool))
    if base is None:
        base = [mp.mpf(float(v)) for v in x]
    with mp.workdps(DIGITS):

        def energy(z):
            return sum(
                mp.mpf(float(k)) * (z[v] - mp.mpf(float(r))) ** 2 / 2
                for k, v, r in zip(p.stiffness, p.orbit, p.rest, strict=True)
            )

        change = energy(exact) - energy(base)
        distance = mp.sqrt(sum((a - b) ** 2 for a, b in zip(exact, base, strict=True)))
        torque = float(np.abs(p.torques(x)).sum())
        # a minimum is known to a stationarity residual of 1e-15 or so, which moves U by it times the distance
        return bool(change < -1e-14 * torque * distance)
