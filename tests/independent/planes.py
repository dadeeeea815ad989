"""Contact as a nonlinear program for IPOPT: separating planes between facets, added where they are found to cross.

Loop closure by quaternions of CasADi, elastic with a penalty since its rows depend on each other; a plane has one facet
on either side of it, the second facet carried along the shortest walk from the first.
"""

import math

import casadi as ca
import numpy as np

PENALTY = 1e8
OPTIONS = {"print_level": 0, "sb": "yes", "max_iter": 600, "tol": 1e-9, "bound_relax_factor": 0}


def product(a, b):
    real = a[0] * b[0] - ca.dot(a[1:], b[1:])
    return ca.vertcat(real, a[0] * b[1:] + b[0] * a[1:] + ca.cross(a[1:], b[1:]))


def turn(axis, angle):
    x, y, z = axis
    k = ca.DM(np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]))
    return ca.DM.eye(3) + ca.sin(angle) * k + (1 - ca.cos(angle)) * (k @ k)


def closure(pattern, x):
    rows = []
    for loop in pattern.vertices:
        q = ca.SX([1, 0, 0, 0])
        for c, s in zip(loop.creases, loop.signs, strict=True):
            axis = ca.DM(s * pattern.directions[c])
            q = product(q, ca.vertcat(ca.cos(x[c] / 2), ca.sin(x[c] / 2) * axis))
        rows.append(q[1:])
    return ca.vertcat(*rows)


def elastic(pattern):
    """Solve from a start with closure elastic and nothing else: fold angles, and what IPOPT says of it."""
    x = ca.SX.sym("x", pattern.creases)
    c = closure(pattern, x)
    w = ca.SX.sym("w", c.shape[0])
    k = ca.DM(pattern.stiffness / pattern.stiffness.mean())
    energy = 0.5 * ca.dot(k, (x - ca.DM(pattern.rest)) ** 2) + 0.5 * PENALTY * ca.dot(w, w)
    form = {"x": ca.vertcat(x, w), "f": energy, "g": c - w}
    solver = ca.nlpsol("elastic", "ipopt", form, {"print_time": False, "ipopt": OPTIONS})
    bound = np.r_[np.full(pattern.creases, math.pi), np.full(c.shape[0], np.inf)]

    def from_start(start):
        start = np.r_[start, np.zeros(c.shape[0])]
        out = solver(x0=start, lbx=-bound, ubx=bound, lbg=0, ubg=0)
        return np.array(out["x"]).ravel()[: pattern.creases], solver.stats()["return_status"]

    return from_start


def carried(sheet, x, a, b):
    """Corners of facet b seen from facet a, and those of facet a."""
    p = sheet.pattern
    r, t = ca.SX.eye(3), ca.SX.zeros(3)
    for c, s in sheet.crossings.poses.path(a, b):
        step, origin = turn(s * p.directions[c], x[c]), ca.DM(p.corners[p.ends[c, 0]])
        t, r = t + r @ (origin - step @ origin), r @ step
    one, other = (p.corners[list(p.polygons[f])] for f in (a, b))
    return one, [r @ ca.DM(y) + t for y in other]


def best_plane(one, other):
    """Plane n.x = d with the most room between corners of one, above, and the other: products of sides, and normals."""
    sides = [np.roll(y, -1, axis=0) - y for y in (one, other)]
    axes = [np.cross(e[0], e[1]) for e in sides]
    axes = np.vstack([*axes, *np.cross(sides[0][:, None], sides[1][None])])
    axes = axes[np.linalg.norm(axes, axis=1) > 1e-9]
    axes = np.vstack([axes, -axes]) / np.linalg.norm(np.vstack([axes, axes]), axis=1)[:, None]
    n = max(axes, key=lambda z: (one @ z).min() - (other @ z).max())
    return np.r_[n, 0.5 * ((one @ n).min() + (other @ n).max())]


def solve(sheet, start, rounds=8):
    """Minimise from a start until no new pair crosses; fold angles, to IPOPT's tolerance."""
    p, n = sheet.pattern, sheet.size
    x = ca.SX.sym("x", n)
    c = closure(p, x)
    w = ca.SX.sym("w", c.shape[0])
    k = ca.DM(p.stiffness / p.stiffness.mean())
    energy = 0.5 * ca.dot(k, (x - ca.DM(p.rest)) ** 2) + 0.5 * PENALTY * ca.dot(w, w)
    pairs = []
    for _ in range(rounds):
        unknowns, rows, first = [x, w], [c - w], [start, np.zeros(c.shape[0])]
        low, high = [np.zeros(c.shape[0])], [np.zeros(c.shape[0])]
        for a, b in pairs:
            plane = ca.SX.sym("plane", 4)
            one, other = carried(sheet, x, a, b)
            above = [ca.dot(plane[:3], ca.DM(y)) - plane[3] for y in one]
            below = [plane[3] - ca.dot(plane[:3], y) for y in other]
            many = len(above) + len(below)
            rows += [*above, *below, ca.dot(plane[:3], plane[:3])]
            low.append(np.r_[np.zeros(many), 1.0])
            high.append(np.r_[np.full(many, np.inf), 1.0])
            unknowns.append(plane)
            there = np.array(ca.Function("f", [x], [ca.horzcat(*other)])(start)).T
            first.append(best_plane(one, there))
        v = ca.vertcat(*unknowns)
        bound = np.r_[np.full(n, math.pi), np.full(v.shape[0] - n, np.inf)]
        form = {"x": v, "f": energy, "g": ca.vertcat(*rows)}
        solver = ca.nlpsol("planes", "ipopt", form, {"print_time": False, "ipopt": OPTIONS})
        out = solver(x0=np.concatenate(first), lbx=-bound, ubx=bound,
                     lbg=np.concatenate(low), ubg=np.concatenate(high))  # fmt: skip
        phi = np.array(out["x"]).ravel()[:n]
        new = [pair for pair in sheet.crossings.find(phi) if pair not in pairs]
        if not new:
            break
        pairs += new
    return phi
