"""Bars and hinges: the common way to compute folded sheets, with facets that stretch and bend a little.

Facets are cut into triangles; sides are bars, creases torsional springs, diagonals stiff ones (N4B5 of Filipov, Liu,
Tachi, Schenk and Paulino, International Journal of Solids and Structures 124 (2017) 26-45).  All energies are over the
mean stiffness of the creases.  The stiffer bars and diagonals, the closer to rigid facets and the harder to solve.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import minimize

from benchmarks.pattern_problems import PatternTask
from origami_nlp.numerics import cross


class Bars:
    """The bar-and-hinge model of a pattern.

    Parameters
    ----------
    problem
        Pattern and springs.

    Attributes
    ----------
    creases
        Hinges that are creases come first, in the pattern's order: so many.
    """

    def __init__(self, problem: PatternTask) -> None:
        p = problem.pattern
        left: dict[tuple[int, int], int] = {}
        for polygon in p.polygons:
            for i in range(1, len(polygon) - 1):
                a, b, c = polygon[0], polygon[i], polygon[i + 1]
                left |= {(a, b): c, (b, c): a, (c, a): b}
        creases = [(int(a), int(b)) for a, b in p.ends]
        known = {tuple(sorted(e)) for e in creases}
        inner = [e for e in left if e[0] < e[1] and e[::-1] in left and e not in known]
        hinges = [*creases, *inner]
        self.creases = len(creases)
        self.hinges = np.array([(a, b, left[a, b], left[b, a]) for a, b in hinges], int)
        self.bars = np.array(sorted({(min(e), max(e)) for e in left}), int)
        self.lengths = np.linalg.norm(
            p.corners[self.bars[:, 1]] - p.corners[self.bars[:, 0]], axis=1
        )
        self.soft = p.stiffness / p.stiffness.mean()
        self.rest = np.concatenate([p.rest, np.zeros(len(inner))])
        self.start = problem.sheet.crossings.poses.corners(problem.start)

    def angles(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return fold angles of all hinges [H] and their gradients by their four corners [H, 4, 3]; corners [V, 3]."""
        a, b, c, d = (x[self.hinges[:, k]] for k in range(4))
        along = b - a
        length = np.linalg.norm(along, axis=1)
        e = along / length[:, None]
        left, right = cross(along, c - a), cross(d - a, along)
        size = np.linalg.norm(left, axis=1), np.linalg.norm(right, axis=1)
        left, right = left / size[0][:, None], right / size[1][:, None]
        phi = np.arctan2((cross(right, left) * e).sum(axis=1), (left * right).sum(axis=1))
        # lifting a far corner by h turns its triangle by h over its height; the rest moves against it
        up, down = left * (length / size[0])[:, None], right * (length / size[1])[:, None]
        at_c = (((c - a) * e).sum(axis=1) / length)[:, None]
        at_d = (((d - a) * e).sum(axis=1) / length)[:, None]
        ends = -(1 - at_c) * up - (1 - at_d) * down, -at_c * up - at_d * down
        return phi, np.stack([*ends, up, down], axis=1)

    def energy(self, x: np.ndarray, stiff: float) -> tuple[float, np.ndarray]:
        """Return the energy of corners [V * 3], and its gradient; stiffness of bars and diagonals over the creases'."""
        corners = x.reshape(-1, 3)
        k = np.full(len(self.hinges), stiff)
        k[: self.creases] = self.soft
        phi, slopes = self.angles(corners)
        torque = k * (phi - self.rest)
        way = corners[self.bars[:, 1]] - corners[self.bars[:, 0]]
        length = np.linalg.norm(way, axis=1)
        strain = length / self.lengths - 1
        pull = (stiff * strain / self.lengths / length)[:, None] * way
        parts = np.concatenate([(torque[:, None, None] * slopes).reshape(-1, 3), -pull, pull])
        where = np.concatenate([self.hinges.ravel(), self.bars[:, 0], self.bars[:, 1]])
        gradient = np.column_stack(
            [np.bincount(where, parts[:, i], len(corners)) for i in range(3)]
        )
        energy = 0.5 * float(torque @ (phi - self.rest) + stiff * strain @ strain)
        return energy, gradient.ravel()

    def softness(self, x: np.ndarray) -> float:
        """Return how far from rigid: the largest strain of a bar, or fold of a diagonal [rad]."""
        phi, _ = self.angles(x)
        length = np.linalg.norm(x[self.bars[:, 1]] - x[self.bars[:, 0]], axis=1)
        bent = float(np.abs(phi[self.creases :]).max(initial=0.0))
        return max(bent, float(np.abs(length / self.lengths - 1).max()))


STIFF = (1e3, 1e4, 1e5, 1e6)
"""Of bars and diagonals over the mean of the creases, one after the other; softer ones let a metasheet snap through."""
AT_REST = 1e-6
"""Largest force over the mean stiffness of the creases and unit of length at which bars rest."""
STEPS = 20_000
"""Of L-BFGS for each."""


def relax(bars: Bars, chunk: int = 500) -> Iterator[tuple[np.ndarray, float, str]]:
    """Relax with ever stiffer bars, each from where the softer ones came to rest.

    Parameters
    ----------
    bars
        The model.
    chunk
        Steps of L-BFGS after which the caller may stop.

    Yields
    ------
    phi : numpy.ndarray
        Fold angles of the creases [rad], [n].
    softness : float
        Of `Bars.softness`.
    status : str
        The stiffness that came to rest, or ``""`` in between.
    """
    x = bars.start.ravel().copy()
    for stiff in STIFF:
        done = 0
        while done < STEPS:
            found = minimize(
                bars.energy, x, args=(stiff,), jac=True, method="L-BFGS-B",
                options={"maxcor": 30, "maxiter": chunk, "maxfun": 2 * chunk, "ftol": 0.0, "gtol": AT_REST},
            )  # fmt: skip
            x, done = found.x, done + max(int(found.nit), 1)
            rests = found.status != 1
            phi, _ = bars.angles(x.reshape(-1, 3))
            word = f"bars of {stiff:.0e}" if rests else ""
            yield phi[: bars.creases], bars.softness(x.reshape(-1, 3)), word
            if rests:
                break
