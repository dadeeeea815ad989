"""What is asked about: a cone with its two rules, the angles at which it rests, and checks of every argument.

A cone is a uniform vertex of even degree N whose odd creases keep one elevation (paper, sections 4 and 5).  Two
rules are not settled by its geometry, and the paper's printed ones differ from what paper does:

rest  what the rest elevation v_0 means.
      "waterbomb": the state of the all-valley branch at v_0, in the paper's convention Q(e2, v): rho_v is the
      smaller root for v_0 > 0 and the larger for v_0 < 0, phi_odd = 2 rho_v, phi_even = -2 |v_0|.
      "paper": as printed in section 5, phi_odd = 2 arccos(|cos v_0 + sin a|/(1 + cos v_0 sin a)),
      phi_even = -2 v_0.  For v_0 < 0 no state has these angles (errata, s5.rest-state).
end   where branches with a single steep flap end, see below.

Ends.  At |v| = pi/2 - 2 pi/N every steep partial fold angle is pi/2: neighbouring steep flaps close
onto each other, and the even creases of all steep flaps stand on the axis, so that steep flaps meet
there tip to tip, neighbours or not.  With two or more steep flaps this is contact.  A single steep flap has
nothing to touch on the axis and can go on: with an even number of flaps to pi/2, where it lies on the
flap opposite, with an odd number until its even crease meets the odd crease opposite, at
cos v = tan(pi/N).  Without steep flaps the odd creases meet on the axis at pi/2.  Derived here;
`tests/paper/cone/test_kinematics.py` compares with the examination of embeddings.  The rule "contract" (the default)
cuts the branches of a single steep flap at pi/2 - 2 pi/N as well, where nothing touches (`Cone.is_cut`); "contact"
follows them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_whole, shown
from origami_nlp.closed_forms import SHALLOW, STEEP, cone_roots
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.pattern import format_angle

REST_RULES = ("waterbomb", "paper")
END_RULES = ("contract", "contact")
LARGEST_DEGREE = 4000
"""Largest degree whose classes are enumerated: there are (N/2)^2 / 4 of them."""
EXTREME_RATIO = 1e12
"""Largest stiffness ratio, and one over the smallest: beyond, one kind of spring is lost in the rounding of the
other (1e-16 of it) before four digits of it are left."""
SLACK = 4e-15
"""Elevations this little past an end are taken for the end [rad]: pi/6 and pi/2 - pi/3 differ in rounding.  An end
is a difference of two angles up to pi/2, each with a few roundings of eps * pi/2 = 3.5e-16: about ten of them."""


def check_degree(degree: object, largest: int | None = None) -> int:
    """Return the degree of a cone, or raise an error.

    Parameters
    ----------
    degree
        What a user gave.
    largest
        That the degree may be, if there is a bound.

    Returns
    -------
    int
        The degree.

    Raises
    ------
    OptionError
        Unless it is even and at least 6 (at degree 4 both partial fold angles are degenerate).
    """
    whole = check_whole("degree", degree, 6, largest)
    if whole % 2:
        raise OptionError(
            f"degree = {whole}: a cone has an even number of creases (two facets a flap)"
        )
    return whole


def check_ratio(ratio: float, field: str = "ratio") -> float:
    """Return a stiffness ratio k_even/k_odd, or raise an error.

    Parameters
    ----------
    ratio
        What a user gave.
    field
        How the message calls it.

    Returns
    -------
    float
        The ratio.

    Raises
    ------
    OptionError
        Unless it is a finite number between 1e-12 and 1e12 (beyond, one kind of spring is rounding).
    """
    return check_number(field, ratio, 1 / EXTREME_RATIO, EXTREME_RATIO)


def _check_rule(name: str, value: object, rules: tuple[str, ...]) -> None:
    if not isinstance(value, str) or value not in rules:
        raise OptionError(f"{name} = {shown(value)}: write {' or '.join(rules)}")


@dataclass(frozen=True)
class Rest:
    """Rest angles of a cone.

    Attributes
    ----------
    elevation
        v_0, signed [rad].
    odd, even
        Of all odd and all even creases.  Numbers, or arrays that are broadcast [rad].
    """

    elevation: Any
    odd: Any
    even: Any


@dataclass(frozen=True)
class Cone:
    """A cone, and the rules by which it rests and its branches end.

    Functions of this room take a `Cone`, or a degree N that stands for ``Cone(N)``.

    Parameters
    ----------
    degree
        Number N of creases: even, at least 6.
    rest
        What a rest elevation means: "waterbomb" (a state of the cone) or "paper" (as printed in section 5).
    end
        Where branches with a single steep flap end: "contract" (cut at pi/2 - 2 pi/N, where nothing touches)
        or "contact" (where it touches).

    Raises
    ------
    OptionError
        If the degree is odd, below 6 or no integer, or a rule is unknown.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> eight = cone.Cone(8, end="contact")
    >>> eight.flaps, eight.branches
    (4, 32)
    >>> eight.ends([0, 1, 2]).round(4).tolist()
    [1.5708, 1.5708, 0.7854]
    """

    degree: int
    rest: str = "waterbomb"
    end: str = "contract"

    def __post_init__(self) -> None:
        object.__setattr__(self, "degree", check_degree(self.degree))
        _check_rule("rest", self.rest, REST_RULES)
        _check_rule("end", self.end, END_RULES)

    @classmethod
    def of(cls, cone: Cone | int, largest: int | None = None) -> Cone:
        """Return a cone as it is, and for a degree the cone with the default rules.

        Raises
        ------
        OptionError
            If it is neither, or of a degree above `largest`.
        """
        found = cone if isinstance(cone, Cone) else cls(cone)
        check_degree(found.degree, largest)
        return found

    @property
    def flaps(self) -> int:
        """Number of flaps, n = N/2."""
        return self.degree // 2

    @property
    def branches(self) -> int:
        """Number of branches, 2^(n + 1): an assignment of n flaps and a sign of the elevation."""
        return 1 << (self.flaps + 1)

    @property
    def steep_end(self) -> float:
        """|v| where every steep partial fold angle is pi/2: pi/2 - 2 pi/N [rad]."""
        return math.pi * (self.degree - 4) / (2 * self.degree)

    @property
    def lone_end(self) -> float:
        """|v| where a branch with a single steep flap touches [rad]."""
        if self.flaps % 2 == 0:
            return math.pi / 2
        return math.acos(math.tan(math.pi / self.degree))

    def ends(self, steep: Any) -> np.ndarray:
        """|v| at which branches with `steep` steep flaps end, shape of `steep` [rad]."""
        count = np.asarray(steep)
        lone = self.lone_end if self.end == "contact" else self.steep_end
        return np.select([count == 0, count == 1], [math.pi / 2, lone], self.steep_end)

    def is_cut(self, steep: Any) -> np.ndarray:
        """Whether branches with `steep` steep flaps are cut where nothing touches, shape of `steep`.

        True for a single steep flap under the rule "contract": the branch goes on past its end.
        """
        return (np.asarray(steep) == 1) & (self.end == "contract")

    @property
    def rest_range(self) -> tuple[float, float]:
        """Rest elevations (low, high) before contact; for the printed formula the paper's range [rad]."""
        contact = self.steep_end
        return (-contact, math.pi / 2) if self.rest == "waterbomb" else (-math.pi / 2, contact)

    def rest_angles(self, elevation: Any) -> tuple[np.ndarray, np.ndarray]:
        """Rest angles (odd, even) at signed rest elevations v_0 of any shape, not checked [rad]."""
        v = np.asarray(elevation, dtype=float)
        size = cone_roots(self.degree, np.abs(v)).value
        if self.rest == "paper":
            # the printed arccos is the shallow root at |v_0|, whatever the sign of v_0
            return 2 * size[..., SHALLOW], -2 * v + 0.0
        return 2 * np.where(v >= 0, size[..., SHALLOW], -size[..., STEEP]), -2 * np.abs(v) + 0.0

    def at_rest(self, elevation: float) -> Rest:
        """Return the rest angles at one rest elevation v_0 [rad].

        By the rule "waterbomb" v_0 runs from -(pi/2 - 2 pi/N) to pi/2, by "paper" from -pi/2 to pi/2.

        Raises
        ------
        OptionError, AngleError
            If the elevation is no number, or out of range.

        Examples
        --------
        >>> from origami_nlp.paper import cone
        >>> rest = cone.Cone(6).at_rest(0.3)
        >>> round(rest.odd, 6), rest.even
        (0.161898, -0.6)
        """
        v = check_number("elevation", elevation)
        waterbomb = self.rest == "waterbomb"
        low = -self.steep_end if waterbomb else -math.pi / 2
        if not low - SLACK <= v <= math.pi / 2 + SLACK:
            raise AngleError(
                f"elevation = {v:.9g}: the rest state must lie between {format_angle(low)} and pi/2"
                + (", where the waterbomb touches itself" if waterbomb else "")
            )
        v = min(max(v, low), math.pi / 2)
        odd, even = self.rest_angles(v)
        return Rest(v, float(odd), float(even))
