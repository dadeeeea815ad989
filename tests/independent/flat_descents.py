"""Sheets pushed out of the flat state at random, and let go down: from points and facets alone, without contact.

Closure round a vertex is the product of rotations about its creases; steps go down the gradient along its kernel and
are closed again by Gauss and Newton.  Flat velocities are those of each vertex, one mode a vertex, that agree on shared
creases.
"""

from itertools import product

import numpy as np


class Sheet:
    """Creases of a flat sheet; ends: numbers of corners of each, in the order that is asked for."""

    def __init__(self, corners, ends):
        self.ends = [tuple(e) for e in ends]
        self.corners = np.asarray(corners, float)[:, :2]
        inside = [v for v in range(len(self.corners)) if sum(v in e for e in self.ends) >= 4]
        self.rings = []
        for v in inside:
            around = [(k, a + b - v) for k, (a, b) in enumerate(self.ends) if v in (a, b)]
            u = np.array([self.corners[w] - self.corners[v] for _, w in around])
            order = np.argsort(np.arctan2(u[:, 1], u[:, 0]))
            u = (u / np.linalg.norm(u, axis=1)[:, None])[order]
            self.rings.append(([around[i][0] for i in order], np.c_[u, np.zeros(len(u))]))

    def closure(self, phi):
        values, rows = [], []
        for creases, axes in self.rings:
            turn, moved = np.eye(3), []
            for k, u in zip(creases, axes, strict=True):
                moved.append(turn @ u)
                x = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
                turn = turn @ (np.eye(3) + np.sin(phi[k]) * x + (1 - np.cos(phi[k])) * x @ x)
            values += [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
            row = np.zeros((3, len(phi)))
            row[:, creases] = 2 * np.array(moved).T
            rows.append(row)
        return np.array(values), np.vstack(rows)

    def closed(self, phi, far=0.1):
        """Close by Levenberg and Marquardt; None where that leads further away [rad]."""
        begun = phi
        for _ in range(100):
            value, rows = self.closure(phi)
            size = float(np.abs(value).max())
            if size < 1e-13:
                break
            u, s, vt = np.linalg.svd(rows, full_matrices=False)
            phi = phi - vt.T @ (s / (s**2 + size**1.5) * (u.T @ value))
        return phi if size < 1e-10 and np.linalg.norm(phi - begun) < far else None

    def descend(self, phi, stiffness, load):
        """Go down U - load . phi with U = sum stiffness phi^2 / 2 from a closed state; None where it is lost."""

        def energy(x):
            return float((stiffness * x**2).sum() / 2 - load @ x)

        step = 0.1
        for _ in range(3_000):
            g = stiffness * phi - load
            rows = self.closure(phi)[1]
            _, values, vt = np.linalg.svd(rows)
            free = vt[(values > 1e-5).sum() :]  # at the flat state more is free than moves
            g = free.T @ (free @ g)
            if np.linalg.norm(g) < 1e-10:
                return phi
            scale = min(step / stiffness.mean(), 0.05 / np.abs(g).max())
            new = self.closed(phi - scale * g)
            if new is not None and energy(new) < energy(phi):
                phi, step = new, min(1.3 * step, 1.0)
            else:
                step *= 0.5
                if step < 1e-9:
                    return phi
        return phi

    def modes(self):
        """Flat velocities of each vertex of degree four: two lines in its four creases."""
        found = []
        for _, u in self.rings:
            null = np.linalg.svd(u[:, :2].T)[2][2:]
            area = np.triu(u[:, None, 0] * u[None, :, 1] - u[:, None, 1] * u[None, :, 0], 1)
            form = null @ (area + area.T) @ null.T
            # (s, t) with s^2 f00 + 2 s t f01 + t^2 f11 = 0
            angle = np.arctan2(2 * form[0, 1], form[0, 0] - form[1, 1]) / 2
            c, s = np.cos(angle), np.sin(angle)
            axes = np.array([[c, s], [-s, c]])
            big, small = (float(a @ form @ a) for a in axes)
            lean = np.sqrt(-big / small)
            found.append([(axes[0] + sign * lean * axes[1]) @ null for sign in (1, -1)])
        return found

    def velocities(self):
        """Bases of flat velocities, one for each choice of modes that leaves any: [n, k] each."""
        n, modes, out = len(self.ends), self.modes(), []
        for choice in product(range(2), repeat=len(self.rings)):
            rows = []
            for (creases, _), both, which in zip(self.rings, modes, choice, strict=True):
                v = both[which] / np.linalg.norm(both[which])
                row = np.zeros((4, n))
                row[:, creases] = np.eye(4) - np.outer(v, v)
                rows.append(row)
            _, values, vt = np.linalg.svd(np.vstack(rows))
            rank = int((values > 1e-9).sum())
            if rank < n:
                out.append(vt[rank:].T)
        out.sort(key=lambda b: -b.shape[1])
        kept = []
        for b in out:
            if not any(np.abs(b - c @ (c.T @ b)).max() < 1e-9 for c in kept):
                kept.append(b)
        return kept
