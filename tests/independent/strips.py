"""Strips of any number of vertices of degree four in closed form: all closed states, all wells; no code of the package.

Round a vertex with sectors a_i from crease i to crease i + 1, the diagonal between creases 2 and 4 is a side of two
spherical triangles, and where the sectors sum to 360 degrees the two laws of cosines say

    sin(phi_3/2) = +-r sin(phi_1/2),    r^2 = sin a_1 sin a_4 / (sin a_2 sin a_3).

So the creases between vertices in a row obey sin(phi_i/2) = s_i rho_i sin theta with signs s_i: 2^k curves through the
flat state for k vertices, and no other closed states.  The other two folds of a vertex are arguments of products of
z_A = sin a_1 cos a_4 + cos a_1 sin a_4 cos phi_1 + i sin a_4 sin phi_1 and the like.
"""

import math
from collections.abc import Iterator
from itertools import product

import numpy as np
from scipy.optimize import brentq

from tests.independent.rigid import Rigid
from tests.independent.trigonometry import sectors


class Strip:
    """A pattern of vertices of degree four in a row."""

    def __init__(self, pattern) -> None:
        self.pattern, self.n = pattern, pattern.creases
        ends = [tuple(e) for e in pattern.ends.tolist()]
        count = np.bincount(pattern.ends.ravel(), minlength=len(pattern.corners))
        inside = np.flatnonzero(count == 4).tolist()
        shared = {v: [e for e in ends if v in e and set(e) <= set(inside)] for v in inside}
        at = next(v for v in inside if len(shared[v]) <= 1)  # an end of the row
        self.around = []  # of each vertex: sectors from the crease towards the one before, and creases
        before = None
        while at is not None:
            others = [x for e in ends if at in e for x in e if x != at]
            away = pattern.corners[others] - pattern.corners[at]
            azimuth = dict(zip(others, np.arctan2(away[:, 1], away[:, 0]), strict=True))
            following = next((x for e in shared[at] for x in e if x not in (at, before)), None)
            if before is None and following is None:  # one vertex: any two opposite creases
                start = others[0]
            elif before is None:  # opposite the next one
                ring = sorted(others, key=lambda x: (azimuth[x] - azimuth[following]) % math.tau)
                start = ring[2]
            else:
                start = before
            ring = sorted(others, key=lambda x: (azimuth[x] - azimuth[start]) % math.tau)
            creases = [ends.index(tuple(sorted((at, x)))) for x in ring]
            self.around.append((sectors(pattern.corners, at, ring), creases))
            before, at = at, following
        ratios = []
        for (a1, a2, a3, a4), _ in self.around:
            q = math.sin(a1) * math.sin(a4) / (math.sin(a2) * math.sin(a3))
            assert q > 0  # no sector beyond 180 degrees
            ratios.append(math.sqrt(q))
        rho = np.cumprod([1.0, *ratios])
        self.rho = rho / rho.max()

    def at(self, signs: tuple[int, ...], theta: float) -> tuple[np.ndarray, np.ndarray]:
        """Fold angles [n] and their derivatives over theta; signs of the ratios, one a vertex."""
        whole = np.cumprod([1, *signs]) * self.rho
        along = 2 * np.arcsin(whole * math.sin(theta))
        inner = math.cos(theta) ** 2 + (1 - whole**2) * math.sin(theta) ** 2
        speed = 2 * whole * math.cos(theta) / np.sqrt(inner)
        phi, rate = np.zeros(self.n), np.zeros(self.n)
        for k, ((a1, a2, a3, a4), (c1, c2, c3, c4)) in enumerate(self.around):
            (p1, d1), (p3, d3) = zip(along[k : k + 2], speed[k : k + 2], strict=True)
            phi[[c1, c3]], rate[[c1, c3]] = (p1, p3), (d1, d3)
            for crease, (b, c, d, e) in ((c2, (a1, a4, a2, a3)), (c4, (a4, a1, a3, a2))):
                z, dz = _corner(b, c, p1, d1)
                w, dw = _corner(d, e, p3, d3)
                phi[crease] = np.angle(-np.conj(z * w))
                rate[crease] = -(dz / z + dw / w).imag
        return phi, rate

    def slope(self, signs: tuple[int, ...], theta: float) -> float:
        """Derivative of the energy."""
        phi, rate = self.at(signs, theta)
        return float(self.pattern.stiffness * (phi - self.pattern.rest) @ rate)

    def wells(self, samples: int = 80) -> Iterator[np.ndarray]:
        """Minima of the energy inside the curves, [n] each: a scan that is geometric beside the flat state."""
        grid = np.unique(
            np.r_[np.geomspace(1e-9, 0.1, samples), np.linspace(0.1, math.pi / 2 - 1e-9, samples)]
        )
        for signs in product((1, -1), repeat=len(self.around)):
            for side in (1.0, -1.0):
                before, last, prior = 0.0, np.zeros(self.n), 0.0
                for theta in (side * grid).tolist():
                    phi, _ = self.at(signs, theta)
                    if np.abs(phi - last).max() > math.pi:
                        break  # a crease across has passed its limit
                    here = side * self.slope(signs, theta)
                    if before < 0 <= here:
                        x = brentq(lambda t, s=signs: self.slope(s, t), prior, theta, xtol=1e-18)
                        yield self.at(signs, x)[0]
                    before, last, prior = here, phi, theta


def _corner(b: float, c: float, phi: float, rate: float) -> tuple[complex, complex]:
    """z of two sectors with a fold between them, and its derivative."""
    z = complex(
        math.sin(b) * math.cos(c) + math.cos(b) * math.sin(c) * math.cos(phi),
        math.sin(c) * math.sin(phi),
    )
    dz = math.sin(c) * complex(-math.cos(b) * math.sin(phi), math.cos(phi))
    return z, rate * dz


class StripInContact:
    """Stable states of a strip whose facets must not cross, by a scan of its curves: to the width of a last step."""

    def __init__(self, pattern) -> None:
        self.strip, self.rigid = Strip(pattern), Rigid(pattern)
        polygons = [set(p) for p in pattern.polygons]
        every = range(len(polygons))
        self.pairs = [
            (a, b) for a in every for b in every if a < b and not polygons[a] & polygons[b]
        ]

    def crosses(self, states: np.ndarray) -> np.ndarray:
        """Whether a side of a facet passes through a triangle of another, [S] for states [S, n]."""
        placed = [self.rigid.polygons(phi) for phi in states]
        facets = [np.array([p[k] for p in placed]) for k in range(len(placed[0]))]
        found = np.zeros(len(states), bool)
        for a, b in self.pairs:
            for one, other in ((facets[a], facets[b]), (facets[b], facets[a])):
                for i in range(one.shape[1]):
                    p, q = one[:, i - 1], one[:, i]
                    for j in range(1, other.shape[1] - 1):
                        found |= _pierces(p, q, other[:, 0], other[:, j], other[:, j + 1])
        return found

    def wells(self, samples: int = 400) -> Iterator[tuple[np.ndarray, bool]]:
        """Minima, [n] each, and whether facets that touch hold them."""
        grid = np.unique(
            np.r_[np.geomspace(1e-6, 0.1, 40), np.linspace(0.1, math.pi / 2 - 1e-9, samples)]
        )
        for signs in product((1, -1), repeat=len(self.strip.around)):
            for side in (1.0, -1.0):
                states = np.array([self.strip.at(signs, side * t)[0] for t in grid])
                jumps = np.flatnonzero(np.abs(np.diff(states, axis=0)).max(axis=1) > math.pi)
                end = int(jumps[0]) + 1 if len(jumps) else len(grid)
                free = ~self.crosses(states[:end])
                slopes = np.array([side * self.strip.slope(signs, side * t) for t in grid[:end]])
                for i in range(end - 1):
                    if free[i] and free[i + 1] and slopes[i] < 0 <= slopes[i + 1]:
                        root = brentq(
                            lambda t, s=signs, d=side: self.strip.slope(s, d * t),
                            grid[i],
                            grid[i + 1],
                        )
                        yield self.strip.at(signs, side * root)[0], False
                    elif (
                        free[i] != free[i + 1]
                        and slopes[i] * slopes[i + 1] > 0
                        and (slopes[i] < 0) == free[i]
                    ):
                        low, high = grid[i], grid[i + 1]
                        for _ in range(40):
                            middle = 0.5 * (low + high)
                            phi = self.strip.at(signs, side * middle)[0]
                            if self.crosses(phi[None])[0] == free[i]:
                                high = middle
                            else:
                                low = middle
                        yield self.strip.at(signs, side * low)[0], True


def _pierces(p, q, a, b, c) -> np.ndarray:
    """Whether segments p q pass through triangles a b c inside, for points [S, 3]."""

    def volume(x, y, z, w):
        return np.einsum("si,si->s", np.cross(y - x, z - x), w - x)

    one, two = volume(a, b, c, p), volume(a, b, c, q)
    turns = [volume(p, q, *pair) for pair in ((a, b), (b, c), (c, a))]
    alike = np.all([t > 0 for t in turns], axis=0) | np.all([t < 0 for t in turns], axis=0)
    return (one * two < 0) & alike
