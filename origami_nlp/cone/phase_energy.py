"""Energy of one class of cone branches over many rest states at once, for phase boundaries.

The sums of `judge.cone_energy` for one class, broadcast over elevations t = |v| and rest elevations
nu_0 together: with the sizes (P, S, X) of the odd fold angles, their numbers w, signs g and
G = direction * R, rest angles (R, E), and m = 2a - n,

    A = q + G s + n R^2/2,  q = sum w size^2/2,  s = sum w g size      (k_odd = 1)
    B = 2 n t^2 + 2 m E t + n E^2/2
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.closed_forms import SHALLOW, STEEP, cone_roots
from origami_nlp.cone.branches import branch_end, steep_end
from origami_nlp.cone.energy import check_rest_rule, crease_angles
from origami_nlp.cone.flaps import cone_classes

SIGNS = np.array([-1.0, 1.0, 1.0])
"""Of P, S and X in s: shallow flaps fold towards the rest state's side, steep ones away from it."""


@dataclass(frozen=True)
class BranchClass:
    """One class of branches: a valley flaps, 2j changes around the ring, direction +1 up or -1 down.

    multiplicity: number of branches in it (exact).  end: |v| at their end [rad].
    """

    degree: int
    valleys: int
    changes: int
    direction: int
    multiplicity: int
    end: float

    @property
    def flaps(self) -> int:
        """N / 2."""
        return self.degree // 2

    @property
    def excess(self) -> int:
        """Valley flaps less mountain flaps, 2a - n."""
        return 2 * self.valleys - self.flaps

    @property
    def counts(self) -> np.ndarray:
        """Number of odd creases of the sizes P, S, X."""
        j = self.changes // 2
        shallow = self.valleys if self.direction > 0 else self.flaps - self.valleys
        return np.array([shallow - j, self.flaps - shallow - j, 2.0 * j])

    @property
    def label(self) -> str:
        r"""Label in the paper's manner, for matplotlib: ``$M_{2}V\uparrow$``.

        Words with more than one run of each kind: alternating ones are written out, the others carry
        the number of runs as a superscript, ``$(M_{3}V_{3})^{2}$``.
        """
        a, b, j = self.valleys, self.flaps - self.valleys, self.changes // 2
        arrow = r"\uparrow" if self.direction > 0 else r"\downarrow"
        word = _power("M", b) + _power("V", a)
        if j > 1 and a == b == j:
            word = "MV" * j if j == 2 else f"(MV)_{{{j}}}"
        elif j > 1:
            word = f"({word})^{{{j}}}"
        return f"${word}{arrow}$"


def _power(letter: str, count: int) -> str:
    return "" if count == 0 else letter if count == 1 else f"{letter}_{{{count}}}"


def branch_classes(degree: int, end: str = "contract") -> list[BranchClass]:
    """List the classes of both directions, up first, most valleys first."""
    classes = cone_classes(degree)
    found = []
    for direction in (1, -1):
        for k in reversed(range(len(classes))):
            a, changes = int(classes.valleys[k]), int(classes.changes[k])
            steep = degree // 2 - a if direction > 0 else a
            where = float(branch_end(degree, steep, end))
            multiplicity = classes.multiplicity[k]
            found.append(BranchClass(degree, a, changes, direction, multiplicity, where))
    return found


def rest_angles(degree: int, rest_elevation: Any, rule: str = "waterbomb") -> tuple[Any, Any]:
    """Rest angles (odd, even) at signed elevations nu_0 of any shape; see `cone_energy.rest_state`."""
    check_rest_rule(rule)
    nu = np.asarray(rest_elevation, dtype=float)
    roots = cone_roots(degree, np.abs(nu)).value
    if rule == "paper":
        return 2 * roots[..., SHALLOW], -2 * nu
    return 2 * np.where(nu >= 0, roots[..., SHALLOW], -roots[..., STEEP]), -2 * np.abs(nu)


def rest_range(degree: int, rule: str = "waterbomb") -> tuple[float, float]:
    """Return rest elevations (low, high) before contact; for the printed formula the paper's range."""
    check_rest_rule(rule)
    contact = steep_end(degree)
    return (-contact, math.pi / 2) if rule == "waterbomb" else (-math.pi / 2, contact)


@dataclass(frozen=True)
class ClassEnergy:
    """A, B and their derivatives by t at elevations t and rest elevations nu_0 (broadcast).

    a_flat, b_flat: of the flat state.  a_well, b_well: A and B of the flat state less those at t,
    formed without cancellation.
    """

    da: np.ndarray
    dda: np.ndarray
    db: np.ndarray
    ddb: float
    a_flat: np.ndarray
    b_flat: np.ndarray
    a_well: np.ndarray
    b_well: np.ndarray

    @property
    def a(self) -> np.ndarray:
        """Energy of the odd creases for k_odd = 1."""
        return self.a_flat - self.a_well

    @property
    def b(self) -> np.ndarray:
        """Energy of the even creases for k_even = 1."""
        return self.b_flat - self.b_well

    @property
    def ratio(self) -> np.ndarray:
        """Return r at which t is stationary; nan where no finite r does it."""
        with np.errstate(divide="ignore", invalid="ignore"):
            r = -self.da / self.db
        return np.where(np.isfinite(r), r, np.nan)

    @property
    def fold(self) -> np.ndarray:
        """A'' B' - A' B'': zero where r(t) is stationary."""
        return self.dda * self.db - self.da * self.ddb

    def depth(self, ratio: np.ndarray) -> np.ndarray:
        """(U_flat - U)/U_flat at a ratio; nan where there is none."""
        return (self.a_well + ratio * self.b_well) / (self.a_flat + ratio * self.b_flat)

    def ratio_of_depth(self, depth: float) -> np.ndarray:
        """Return r at which the state has the relative depth, stationary or not; nan if none."""
        over_a, over_b = self.a_well - depth * self.a_flat, self.b_well - depth * self.b_flat
        with np.errstate(divide="ignore", invalid="ignore"):
            r = -over_a / over_b
        return np.where(np.isfinite(r), r, np.nan)

    def depth_gap(self, depth: float) -> np.ndarray:
        """Zero where a stationary point has the relative depth (times -B', so that it is smooth)."""
        over_a = self.a_well - depth * self.a_flat
        return (self.b_well - depth * self.b_flat) * self.da - over_a * self.db


def class_energy(branches: BranchClass, t: Any, nu: Any, rule: str = "waterbomb") -> ClassEnergy:
    """Evaluate a class at t = |v| >= 0 and nu_0 (broadcast against each other) [rad]."""
    t, nu = np.asarray(t, dtype=float), np.asarray(nu, dtype=float)
    odd, even = rest_angles(branches.degree, nu, rule)
    size, first, second = crease_angles(branches.degree, t)
    w, n = branches.counts, branches.flaps
    reach = branches.direction * odd
    even_slope = 2 * branches.excess * even
    return ClassEnergy(
        da=(size * first) @ w + reach * (first @ (w * SIGNS)),
        dda=(first**2 + size * second) @ w + reach * (second @ (w * SIGNS)),
        db=4 * n * t + even_slope,
        ddb=4.0 * n,
        a_flat=n * odd**2 / 2,
        b_flat=n * even**2 / 2,
        a_well=-(size**2 / 2 @ w) - reach * (size @ (w * SIGNS)),
        b_well=-2 * n * t**2 - even_slope * t,
    )
