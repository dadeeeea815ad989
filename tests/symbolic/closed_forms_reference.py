"""50-digit references and an independent quaternion product for the closed-form tests.

The references solve "crease k lies in its mirror plane" as an equation between vectors, take the
last fold angle from "the mirror's normal is mapped to itself", and know nothing of quaternions.
"""

from __future__ import annotations

import numpy as np
from mpmath import atan2, cos, matrix, mp, mpf, pi, sin, sqrt

DIGITS = 50


def rotation(axis, angle):
    """Rodrigues' formula in the working precision."""
    x, y, z = axis
    k = matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mp.eye(3) + sin(angle) * k + (1 - cos(angle)) * k * k


def crease(azimuth):
    return matrix([cos(azimuth), sin(azimuth), mpf(0)])


E1, E2 = matrix([1, 0, 0]), matrix([0, 1, 0])


def _dot(a, b):
    return (a.T * b)[0]


def reflection_reference(azimuths, folds):
    """(phi_1, phi_k) with both in [-pi, pi] on q = +1, or None; singular points not handled."""
    inner = mp.eye(3)
    for a, f in zip(azimuths, folds, strict=True):
        inner = inner * rotation(crease(a), f)
    c = inner * (-E1)
    t = atan2(c[1], c[2])  # c_y cos t - c_z sin t = 0
    for turn in (0, -pi, pi):
        if abs(t + turn) > pi / 2:
            continue
        half = rotation(E1, t + turn) * inner
        g = half.T * E2
        last = atan2(-g[2], g[1])  # Q(-e1, x) e2 = g
        if abs(last) <= pi / 2:
            return 2 * (t + turn), 2 * last
    return None


def wedge3_reference(n, alpha1, elevation, phi2):
    """Both solutions [(phi_1, phi_3), ..] of the D_n wedge with |phi| <= pi, and D^2."""
    b2, b3 = crease(alpha1), crease(pi / n)
    normal = matrix([sin(pi / n), -cos(pi / n), mpf(0)])
    fold = rotation(b2, phi2)
    p = fold * b3
    w = rotation(E2, elevation).T * normal
    a = w[1] * p[1] + w[2] * p[2]
    b = w[2] * p[1] - w[1] * p[2]
    c = -w[0] * p[0]
    square = a * a + b * b - c * c
    if square < 0:
        return [], square
    found = []
    for root in (sqrt(square), -sqrt(square)):
        t = atan2(b, a) + atan2(root, c)
        t -= 2 * pi * mp.nint(t / (2 * pi))
        frame = rotation(E2, elevation) * rotation(E1, t) * fold
        g = frame.T * normal  # Q(b_3, x) normal = g
        e3 = matrix([0, 0, 1])
        last = atan2(-_dot(e3, g), _dot(normal, g))
        good = abs(t) <= pi / 2 and abs(last) <= pi / 2
        found.append((2 * t, 2 * last) if good else None)
    return found, square


def cone_reference(degree, elevation):
    """(shallow, steep) partial fold angles from the quadratic in tan(rho/2), 50 digits."""
    alpha = 2 * pi / degree
    a = cos(alpha) * (1 + cos(elevation))
    b = sin(alpha) * sin(elevation)
    root = sqrt(b * b + a * cos(alpha) * (1 - cos(elevation)))
    sign = 1 if elevation > 0 else -1
    return 2 * atan2(-b + sign * root, a), 2 * atan2(-b - sign * root, a)


def loop_quaternion(azimuths, folds):
    """Product of all N crease quaternions in doubles: azimuths and folds of shape (.., N)."""
    w, x, y, z = np.ones(folds.shape[:-1]), 0.0, 0.0, 0.0
    for i in range(folds.shape[-1]):
        c, s = np.cos(folds[..., i] / 2), np.sin(folds[..., i] / 2)
        a, b = s * np.cos(azimuths[..., i]), s * np.sin(azimuths[..., i])
        w, x, y, z = (
            w * c - x * a - y * b,
            w * a + x * c - z * b,
            w * b + y * c + z * a,
            z * c + x * b - y * a,
        )
    return np.stack(np.broadcast_arrays(w, x, y, z), axis=-1)
