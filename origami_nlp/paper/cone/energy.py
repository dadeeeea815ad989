"""Energy of branches of a cone at elevations s = |v|: A(s) + r B(s), with k_odd = 1 and k_even = r.

Up to sign an odd crease has one of three fold angles: 2 |rho_shallow| =: P between two shallow
flaps, 2 |rho_steep| =: S between two steep ones, |rho_steep| - |rho_shallow| =: X between unlike
ones (and then it has the sign of the steep flap).  Even creases have 2 s, - at valley and + at mountain
flaps.  On a branch of direction d with p shallow and q steep flaps and 2j changes around the ring,
rest angles phi_odd and phi_even, and g = d phi_odd,

    A = 1/2 [(p - j) (P - g)^2 + (q - j) (S + g)^2 + 2j (X + g)^2]
    B = 1/2 [a (2 s + phi_even)^2 + (n - a) (2 s - phi_even)^2]      (a valley flaps of n)
    B' = 4 n (s - s_e),     s_e = -(2 a - n) phi_even / (2 n)

(up: the shallow flaps are the valleys; down: the mountains).  P, S, X and their derivatives come from the
generated closed form of the partial fold angles.  Differences of energies are formed without cancellation, so
that wells are right to rounding even at elevations of 1e-10.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.closed_forms import MIXED, SHALLOW, STEEP, cone_roots
from origami_nlp.paper.cone.classes import Branches
from origami_nlp.paper.cone.rules import Rest

SIZES = [SHALLOW, STEEP, MIXED]
TO_SIZES = np.array([2.0, -2.0, -1.0])
"""(shallow, steep, mixed) at v = s >= 0 times these are P, S, X."""
SIGNS = np.array([-1.0, 1.0, 1.0])
"""(P - g, S + g, X + g) = sizes + g * signs: shallow flaps fold towards the rest state's side, steep ones away."""

Pair = tuple[Any, Any]
"""(A, B): of the odd creases with k_odd = 1, and of the even creases with k_even = 1."""


@dataclass(frozen=True)
class BranchEnergy:
    """Energy of branches, each at its ratio, its rest state and its elevation; all broadcast against each other.

    Attributes
    ----------
    branches
        Their classes.
    rest
        Rest angles.
    ratio
        r.
    s
        |v| >= 0 [rad].
    """

    branches: Branches
    rest: Rest
    ratio: Any = 1.0
    s: Any = 0.0

    def at(self, s: Any, rows: Any = slice(None)) -> BranchEnergy:
        """Return the energy of some of the branches at other elevations."""
        return replace(self, branches=self.branches[rows], ratio=self.ratio[rows], s=s)

    @cached_property
    def sizes(self) -> tuple[np.ndarray, ...]:
        """P, S, X, and their first and second derivatives by s, [..., 3] each."""
        roots = cone_roots(self.branches.cone.degree, np.asarray(self.s, dtype=float))
        each = (roots.value, roots.first, roots.second)
        return tuple(part[..., SIZES] * TO_SIZES for part in each)

    @cached_property
    def pull(self) -> np.ndarray:
        """Rest angle of each size, up to sign, [..., 3]."""
        return np.asarray(self.branches.direction * self.rest.odd)[..., None] * SIGNS

    @property
    def stretch(self) -> np.ndarray:
        """Fold angle less rest angle, up to sign, [..., 3]."""
        return self.sizes[0] + self.pull

    def _odd(self, each: np.ndarray) -> Any:
        """Sum over the odd creases of what one of each size has, [..., 3]."""
        return (self.branches.odd_creases * each).sum(axis=-1)

    @property
    def _flaps(self) -> int:
        return self.branches.cone.flaps

    @property
    def _lowest(self) -> Any:
        """s_e."""
        return (self._flaps - 2 * self.branches.valleys) * self.rest.even / (2 * self._flaps)

    @property
    def energies(self) -> Pair:
        """(A, B)."""
        a, rest = self.branches.valleys, self.rest.even
        # even creases: -2 s at valley flaps, 2 s at mountain flaps (paper, eq. 4.4)
        even = a * (2 * self.s + rest) ** 2 + (self._flaps - a) * (2 * self.s - rest) ** 2
        return self._odd(0.5 * self.stretch**2), 0.5 * even

    @property
    def flat(self) -> Pair:
        """(A, B) of the flat state, the same for all branches."""
        return self._flaps * self.rest.odd**2 / 2, self._flaps * self.rest.even**2 / 2

    @property
    def wells(self) -> Pair:
        """(A, B) of the flat state less those at s, without cancellation."""
        # (pull^2 - (size + pull)^2) / 2, and B is a parabola about s_e
        odd = self._odd(-self.sizes[0] * (self.sizes[0] / 2 + self.pull))
        return odd, -2 * self._flaps * self.s * (self.s - 2 * self._lowest)

    @property
    def slopes(self) -> Pair:
        """(A', B'), derivatives by s = |v|."""
        odd = self._odd(self.stretch * self.sizes[1])
        return odd, 4 * self._flaps * (self.s - self._lowest)

    @property
    def curvatures(self) -> Pair:
        """(A'', B'')."""
        _, first, second = self.sizes
        odd = self._odd(self.stretch * second + first**2)
        return odd, np.full(np.shape(odd), 4.0 * self._flaps)

    def total(self, pair: Pair) -> Any:
        """A + r B of a pair."""
        return pair[0] + self.ratio * pair[1]

    @property
    def slope(self) -> Any:
        """F = A' + r B'."""
        return self.total(self.slopes)

    @property
    def curvature(self) -> Any:
        """F' = A'' + r B''."""
        return self.total(self.curvatures)

    @property
    def slope_scale(self) -> Any:
        """Size of the terms that F sums: rounding is eps of it."""
        size, first, _ = self.sizes
        even = 4 * self._flaps * (self.s + np.abs(self._lowest))
        return self.total((self._odd((size + np.abs(self.pull)) * first), even))

    @property
    def stationary_ratio(self) -> np.ndarray:
        """Return r at which s is stationary; nan where no finite r does it."""
        odd, even = self.slopes
        with np.errstate(divide="ignore", invalid="ignore"):
            r = -odd / even
        return np.where(np.isfinite(r), r, np.nan)

    @property
    def fold(self) -> Any:
        """A'' B' - A' B'': zero where r(s) is stationary, and a minimum and a maximum meet."""
        (da, db), (dda, ddb) = self.slopes, self.curvatures
        return dda * db - da * ddb

    @property
    def depth(self) -> Any:
        """(U_flat - U)/U_flat, 1 at most but for rounding; 0 where the flat state has no energy."""
        well, flat = self.total(self.wells), self.total(self.flat)
        return np.where(flat > 0, np.minimum(well / np.where(flat > 0, flat, 1.0), 1.0), 0.0)
