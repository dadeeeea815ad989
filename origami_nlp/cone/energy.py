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

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.closed_forms import MIXED, SHALLOW, STEEP, cone_roots
from origami_nlp.cone.branches import SLACK, branch_end, is_cut, steep_end
from origami_nlp.cone.flaps import ConeClasses, check_degree, cone_classes
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.pattern import format_angle

REST_RULES = ("waterbomb", "paper")
TO_SIZES = np.array([2.0, -2.0, -1.0])
"""(shallow, steep, mixed) at v = s >= 0 times these are P, S, X."""


@dataclass(frozen=True)
class Rest:
    """Rest angles of a cone.

    odd, even: of all odd and all even creases [rad].
    elevation: v_0, signed; rule: "waterbomb" or "paper" (see `rest_state`).
    """

    degree: int
    elevation: float
    odd: float
    even: float
    rule: str = "waterbomb"


def check_rest_rule(rest: object) -> None:
    """Complain about a rule for the rest state that is none of `REST_RULES`.

    Raises
    ------
    OptionError
        With the rules there are.
    """
    if not isinstance(rest, str) or rest not in REST_RULES:
        raise OptionError(f"rest = {shown(rest)}: write {' or '.join(REST_RULES)}")


def rest_state(degree: int, elevation: float, rest: str = "waterbomb") -> Rest:
    """Return the rest angles of the waterbomb (odd creases valleys) at elevation v_0.

    rest
        "waterbomb": the state of the all-valley branch at v_0, in the paper's convention Q(e2, v):
        rho_v is the smaller root for v_0 > 0 and the larger for v_0 < 0, phi_odd = 2 rho_v,
        phi_even = -2 |v_0|.  v_0 runs from -(pi/2 - 2 pi/N) to pi/2.
        "paper": as printed in section 5, phi_odd = 2 arccos(|cos v_0 + sin a|/(1 + cos v_0 sin a)),
        phi_even = -2 v_0, |v_0| <= pi/2.  For v_0 < 0 no state has these angles (errata, s5.rest-state).

    Raises
    ------
    OptionError, AngleError
        For an unknown rule, or an elevation out of range.
    """
    check_degree(degree)
    check_rest_rule(rest)
    v = check_number("elevation", elevation)
    low = -steep_end(degree) if rest == "waterbomb" else -math.pi / 2
    if not low - SLACK <= v <= math.pi / 2 + SLACK:
        raise AngleError(
            f"elevation = {v:.9g}: the rest state must lie between {format_angle(low)} and pi/2"
            + (", where the waterbomb touches itself" if rest == "waterbomb" else "")
        )
    v = min(max(v, low), math.pi / 2)
    steep = v < 0 and rest == "waterbomb"
    size = cone_roots(degree, abs(v)).value
    odd = float(-2 * size[STEEP] if steep else 2 * size[SHALLOW])
    even = -2 * abs(v) if rest == "waterbomb" else -2 * v
    return Rest(degree, v, odd, even + 0.0, rest)


def crease_angles(degree: int, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return sizes (P, S, X) of the odd fold angles at s >= 0 and two derivatives, each S + (3,)."""
    roots = cone_roots(degree, s)
    order = [SHALLOW, STEEP, MIXED]
    return (
        roots.value[..., order] * TO_SIZES,
        roots.first[..., order] * TO_SIZES,
        roots.second[..., order] * TO_SIZES,
    )


@dataclass(frozen=True)
class DirectionClasses:
    """All classes of branches of one direction, with one rest state.

    Arrays have one entry a class, in the order of `classes` (see `state.cone.cone_classes`).  In
    methods, elevations s = |v| >= 0 have shape [k] and answers [m, k]; with `rows` (int array [k]) the
    k-th elevation belongs to class rows[k] and answers have shape [k].  Stiffness per crease is 1.
    """

    classes: ConeClasses
    direction: int
    rest: Rest
    end_rule: str = "contract"

    @property
    def degree(self) -> int:
        """N."""
        return self.classes.degree

    @property
    def flaps(self) -> int:
        """N / 2."""
        return self.classes.degree // 2

    @property
    def reach(self) -> float:
        """g = direction * phi_odd at rest."""
        return self.direction * self.rest.odd

    @cached_property
    def shallow(self) -> np.ndarray:
        """Number of shallow flaps."""
        a = self.classes.valleys
        return a if self.direction > 0 else self.flaps - a

    @cached_property
    def end(self) -> np.ndarray:
        """|v| at the end of the branch [rad]."""
        return branch_end(self.degree, self.flaps - self.shallow, self.end_rule)

    @cached_property
    def cut(self) -> np.ndarray:
        """Whether the branch is cut at `end`, where nothing touches."""
        return is_cut(self.flaps - self.shallow, self.end_rule)

    @cached_property
    def weights(self) -> np.ndarray:
        """Number of odd creases of the sizes P, S, X, [m, 3]."""
        j = self.classes.changes // 2
        p = self.shallow
        return np.stack([p - j, self.flaps - p - j, 2 * j], axis=1).astype(float)

    @cached_property
    def even_vertex(self) -> np.ndarray:
        """s_e: where B is least (may be negative, or past the end)."""
        return -(2 * self.classes.valleys - self.flaps) * self.rest.even / (2 * self.flaps)

    @property
    def signs(self) -> np.ndarray:
        """(P - g, S + g, X + g) = sizes + g * signs."""
        return np.array([-1.0, 1.0, 1.0])

    # -------------------------------------------------------- values

    def energies(
        self, s: np.ndarray, rows: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (A, B)."""
        size, _, _ = crease_angles(self.degree, s)
        odd = self._sum(0.5 * (size + self.reach * self.signs) ** 2, rows)
        a, rest = self._own(self.classes.valleys, rows), self.rest.even
        even = 0.5 * (a * (2 * s + rest) ** 2 + (self.flaps - a) * (2 * s - rest) ** 2)
        return odd, even

    def flat_energies(self) -> tuple[float, float]:
        """(A, B) of the flat state, the same for all classes."""
        return self.flaps * self.rest.odd**2 / 2, self.flaps * self.rest.even**2 / 2

    def wells(self, s: np.ndarray, rows: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return (A, B) of the flat state less those at s, without cancellation."""
        size, _, _ = crease_angles(self.degree, s)
        odd = self._sum(-size * (size / 2 + self.reach * self.signs), rows)
        return odd, -2 * self.flaps * s * (s - 2 * self._own(self.even_vertex, rows))

    def slopes(
        self, s: np.ndarray, rows: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (A', B'), derivatives by s = |v|."""
        size, first, _ = crease_angles(self.degree, s)
        odd = self._sum((size + self.reach * self.signs) * first, rows)
        return odd, 4 * self.flaps * (s - self._own(self.even_vertex, rows))

    def curvatures(
        self, s: np.ndarray, rows: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (A'', B'')."""
        size, first, second = crease_angles(self.degree, s)
        odd = self._sum((size + self.reach * self.signs) * second + first**2, rows)
        return odd, np.full(odd.shape, 4.0 * self.flaps)

    def slope_scale(
        self, s: np.ndarray, ratio: float, rows: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the size of the terms that F = A' + r B' sums: rounding is 1e-16 of it."""
        size, first, _ = crease_angles(self.degree, s)
        odd = self._sum((size + abs(self.reach)) * first, rows)
        return odd + ratio * 4 * self.flaps * (s + np.abs(self._own(self.even_vertex, rows)))

    def _sum(self, kinds: np.ndarray, rows: np.ndarray | None) -> np.ndarray:
        """Sum over the odd creases: kinds has shape [k, 3]."""
        if rows is None:
            return self.weights @ np.atleast_2d(kinds).T
        return np.einsum("...c,...c->...", self.weights[rows], kinds)

    def _own(self, values: np.ndarray, rows: np.ndarray | None) -> np.ndarray:
        """One value a class, shaped to go with elevations."""
        return values[:, None] if rows is None else values[rows]


def direction_classes(
    degree: int,
    elevation: float,
    *,
    direction: int,
    rest: str = "waterbomb",
    end: str = "contract",
) -> DirectionClasses:
    """Set up the classes of one direction (+1 up, -1 down) with rest elevation v_0.

    The cheap entry point for phase diagrams: `slopes` gives (A', B') of all classes at any
    elevations, and a class has a stationary point at s exactly for r = -A'(s)/B'(s).
    """
    return DirectionClasses(
        cone_classes(degree), direction, rest_state(degree, elevation, rest), end
    )
