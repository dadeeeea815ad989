"""Energy of all branches of a cone at once: k_odd A(s) + k_even B(s), s = |elevation|.

Up to sign an odd crease has one of three fold angles: 2 |rho_shallow| =: P between two shallow
flaps, 2 |rho_steep| =: S between two steep ones, |rho_steep| - |rho_shallow| =: X between unlike
ones (and then it has the sign of the steep flap).  Even creases have 2 s, - at valley and + at mountain
flaps.  On a branch of direction d with p shallow and q steep flaps and 2j changes around the ring,
rest angles phi_odd and phi_even, and g = d phi_odd,

    A = 1/2 [(p - j) (P - g)^2 + (q - j) (S + g)^2 + 2j (X + g)^2]
    B = 1/2 [a (2 s + phi_even)^2 + (n - a) (2 s - phi_even)^2]      (a valley flaps of n)
    B' = 4 n (s - s_e),     s_e = -(2 a - n) phi_even / (2 n)

(up: the shallow flaps are the valleys; down: the mountains).  With k_odd = 1 and k_even = r the slope
of the energy along a branch is F(s) = A'(s) + r B'(s).  P, S, X and their derivatives come from the
generated closed form of the partial fold angles.  Differences of energies are formed without cancellation, so
that wells are right to rounding even at elevations of 1e-10.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.closed_forms import MIXED, SHALLOW, STEEP, cone_roots
from origami_nlp.paper.cone.classes import EnergyClass, assignment_classes, odd_crease_numbers
from origami_nlp.paper.cone.rules import Cone, Rest

SIZES = [SHALLOW, STEEP, MIXED]
TO_SIZES = np.array([2.0, -2.0, -1.0])
"""(shallow, steep, mixed) at v = s >= 0 times these are P, S, X."""
SIGNS = np.array([-1.0, 1.0, 1.0])
"""(P - g, S + g, X + g) = sizes + g * signs: shallow flaps fold towards the rest state's side, steep ones away."""

Pair = tuple[Any, Any]
"""(A, B): of the odd creases with k_odd = 1, and of the even creases with k_even = 1."""


@dataclass(frozen=True)
class OddCreases:
    """One odd crease of each size P, S, X at elevations s >= 0, and what it adds to A; [..., 3] each.

    Attributes
    ----------
    size, first, second
        The fold angle's size and its derivatives by s.
    pull
        g * signs, broadcast against size.
    """

    size: np.ndarray
    first: np.ndarray
    second: np.ndarray
    pull: np.ndarray

    @classmethod
    def at(cls, degree: int, s: Any, g: Any) -> OddCreases:
        """Evaluate at s = |v| [rad] with g = direction * (odd rest angle), broadcast against each other."""
        roots = cone_roots(degree, np.asarray(s, dtype=float))
        size, first, second = (
            part[..., SIZES] * TO_SIZES for part in (roots.value, roots.first, roots.second)
        )
        return cls(size, first, second, np.asarray(g)[..., None] * SIGNS)

    @cached_property
    def stretch(self) -> np.ndarray:
        """Fold angle less rest angle, up to sign."""
        return self.size + self.pull

    @property
    def energy(self) -> np.ndarray:
        """Energy."""
        return 0.5 * self.stretch**2

    @property
    def well(self) -> np.ndarray:
        """Energy of the flat state less that at s, without cancellation."""
        # (pull^2 - (size + pull)^2) / 2
        return -self.size * (self.size / 2 + self.pull)

    @property
    def slope(self) -> np.ndarray:
        """Derivative of the energy by s."""
        return self.stretch * self.first

    @property
    def curvature(self) -> np.ndarray:
        """Second derivative of the energy by s."""
        return self.stretch * self.second + self.first**2


@dataclass(frozen=True)
class SideEnergy:
    """Energy of classes of branches of one direction, with one rest state.

    Attributes
    ----------
    cone
        Degree and rules.
    valleys, changes
        Of the classes, [m].
    direction
        +1 up, -1 down.
    rest
        Rest angles; arrays of them only where `at` takes a single row.
    """

    cone: Cone
    valleys: np.ndarray
    changes: np.ndarray
    direction: int
    rest: Rest

    @classmethod
    def of(cls, cone: Cone | int, direction: int, elevation: float) -> SideEnergy:
        """Set up all classes of one direction at one rest elevation.

        `at` gives (A', B') of all classes at any elevations, and a class has a stationary point at s exactly
        for r = -A'(s)/B'(s).

        Parameters
        ----------
        cone
            A `Cone`, or its degree.
        direction
            +1 up, -1 down.
        elevation
            v_0 of the rest state, signed [rad].

        Raises
        ------
        OptionError, AngleError
            If the degree or the rest elevation is out of range.

        Examples
        --------
        >>> from origami_nlp.paper import cone
        >>> odd, even = cone.SideEnergy.of(6, +1, 0.3).at([0.1, 0.2]).slopes
        >>> odd.shape, even.shape
        ((4, 2), (4, 2))
        """
        cone = Cone.of(cone)
        known = assignment_classes(cone.degree)
        return cls(cone, known.valleys, known.changes, direction, cone.at_rest(elevation))

    @property
    def flaps(self) -> int:
        """N / 2."""
        return self.cone.flaps

    @property
    def reach(self) -> Any:
        """g: the odd rest angle, seen along the direction."""
        return self.direction * self.rest.odd

    @cached_property
    def steep(self) -> np.ndarray:
        """Number of steep flaps, [m]."""
        return self.flaps - self.valleys if self.direction > 0 else self.valleys

    @cached_property
    def end(self) -> np.ndarray:
        """|v| at which the branches end, [m] [rad]."""
        return self.cone.ends(self.steep)

    @cached_property
    def cut(self) -> np.ndarray:
        """Whether the branches are cut at `end`, where nothing touches, [m]."""
        return self.cone.is_cut(self.steep)

    @cached_property
    def weights(self) -> np.ndarray:
        """Number of odd creases of the sizes P, S, X, [m, 3]."""
        return odd_crease_numbers(self.flaps, self.steep, self.changes)

    @cached_property
    def excess(self) -> np.ndarray:
        """Valley flaps less mountain flaps, 2a - n, [m]."""
        return 2 * self.valleys - self.flaps

    def only(self, rows: np.ndarray) -> SideEnergy:
        """Return some of the classes."""
        return SideEnergy(
            self.cone, self.valleys[rows], self.changes[rows], self.direction, self.rest
        )

    def by_end(self) -> Iterator[tuple[float, np.ndarray]]:
        """Yield every end [rad] with the rows of the classes that end there."""
        for end in np.unique(self.end):
            yield float(end), np.nonzero(self.end == end)[0]

    def at(self, s: Any, rows: Any = None) -> EnergyAt:
        """Evaluate at elevations s = |v| >= 0 [rad].

        s of shape [k] gives answers [m, k]; with `rows` (int array [k]) the k-th elevation belongs to class rows[k]
        and answers have shape [k]; with one row, s and the rest angles are broadcast.
        """
        s = np.asarray(s, dtype=float)
        return EnergyAt(self, s, rows, OddCreases.at(self.cone.degree, s, self.reach))


@dataclass(frozen=True)
class EnergyAt:
    """The energies (A, B) of classes at elevations, see `SideEnergy.at`; stiffness per crease is 1."""

    side: SideEnergy
    s: np.ndarray
    rows: Any
    creases: OddCreases

    def _odd(self, each: np.ndarray) -> Any:
        """Sum over the odd creases: `each` has shape [..., 3]."""
        if self.rows is None:
            return self.side.weights @ np.atleast_2d(each).T
        return np.einsum("...c,...c->...", self.side.weights[self.rows], each)

    def _own(self, values: np.ndarray) -> Any:
        """One value a class, shaped to go with elevations."""
        return values[:, None] if self.rows is None else values[self.rows]

    @property
    def _vertex(self) -> Any:
        """s_e; from the rest angle here, which may be an array."""
        return -self._own(self.side.excess) * self.side.rest.even / (2 * self.side.flaps)

    @property
    def energies(self) -> Pair:
        """(A, B)."""
        s, n, rest = self.s, self.side.flaps, self.side.rest.even
        a = self._own(self.side.valleys)
        # even creases: -2 s at valley flaps, 2 s at mountain flaps (paper, eq. 4.4)
        even = 0.5 * (a * (2 * s + rest) ** 2 + (n - a) * (2 * s - rest) ** 2)
        return self._odd(self.creases.energy), even

    @property
    def flat(self) -> Pair:
        """(A, B) of the flat state, the same for all classes."""
        n, rest = self.side.flaps, self.side.rest
        return n * rest.odd**2 / 2, n * rest.even**2 / 2

    @cached_property
    def wells(self) -> Pair:
        """(A, B) of the flat state less those at s, without cancellation."""
        # B is a parabola about s_e: B(0) - B(s) = 2 n (s_e^2 - (s - s_e)^2)
        even = -2 * self.side.flaps * self.s * (self.s - 2 * self._vertex)
        return self._odd(self.creases.well), even

    @cached_property
    def slopes(self) -> Pair:
        """(A', B'), derivatives by s = |v|."""
        return self._odd(self.creases.slope), 4 * self.side.flaps * (self.s - self._vertex)

    @cached_property
    def curvatures(self) -> Pair:
        """(A'', B'')."""
        odd = self._odd(self.creases.curvature)
        return odd, np.full(np.shape(odd), 4.0 * self.side.flaps)

    def slope(self, ratio: Any) -> Any:
        """F = A' + r B'."""
        odd, even = self.slopes
        return odd + ratio * even

    def curvature(self, ratio: Any) -> Any:
        """F' = A'' + r B''."""
        odd, even = self.curvatures
        return odd + ratio * even

    def slope_scale(self, ratio: Any) -> Any:
        """Size of the terms that F = A' + r B' sums: rounding is eps of it."""
        c = self.creases
        odd = self._odd((c.size + np.abs(c.pull)) * c.first)
        return odd + ratio * 4 * self.side.flaps * (self.s + np.abs(self._vertex))

    @property
    def ratio(self) -> np.ndarray:
        """Return r at which s is stationary; nan where no finite r does it."""
        return finite_quotient(*self.slopes)

    @property
    def fold(self) -> Any:
        """A'' B' - A' B'': zero where r(s) is stationary."""
        (da, db), (dda, ddb) = self.slopes, self.curvatures
        # r(s) = -A'/B' has r' = 0 where A'' B' = A' B'': a minimum and a maximum meet
        return dda * db - da * ddb

    def depth(self, ratio: Any) -> Any:
        """(U_flat - U)/U_flat at a ratio; nan where there is none."""
        well, flat = self.wells, self.flat
        return (well[0] + ratio * well[1]) / (flat[0] + ratio * flat[1])


def finite_quotient(odd: Any, even: Any) -> np.ndarray:
    """Return r with odd + r even = 0; nan where no finite r does it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        r = -odd / even
    # B' = 0: no ratio, or any
    return np.where(np.isfinite(r), r, np.nan)


def class_energy(branches: EnergyClass, t: Any, elevation: Any) -> EnergyAt:
    """Evaluate the energy of one class of branches.

    Parameters
    ----------
    branches
        The class.
    t
        |v| >= 0 [rad].
    elevation
        Rest elevation v_0, signed [rad], broadcast against `t`.

    Returns
    -------
    EnergyAt
        Energy and its derivatives by t, per k_odd.
    """
    nu = np.asarray(elevation, dtype=float)
    own = np.array([branches.valleys]), np.array([branches.changes])
    rest = Rest(nu, *branches.cone.rest_angles(nu))
    return SideEnergy(branches.cone, *own, branches.direction, rest).at(t, 0)
