"""Minima of the energy on all 2^(N/2 + 1) branches of a cone, counted exactly.

A branch has an interior minimum where the slope F of its energy turns from falling to rising,
and a contact-pinned one at its end where the energy still falls there, with multiplier
-F(end) > 0 (the generalised force along |v| that the contact bears).  The rule "contract" cuts branches of
a single steep flap where nothing touches: where the energy falls there, no contact holds the state, and its kind
is "cut" (the branch goes on, and its minimum lies further along: the rule "contact" finds it).  All branches of a
class have the same energy, so O(N^2) classes stand for all branches; `cone.roots` isolates every zero.
The flat state, where all branches begin, is not counted.

Ties, which no rounding-error bound decides: where F(0) = 0 the flat state itself is the minimum
(F'(0) > 0 always); where F(end) = 0 and F rises to it, the end is a minimum with multiplier 0, counted
as contact (the rest state of the all-valley branch at the end of its range is of this kind).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.display import Report, Section, Table
from origami_nlp.io import ShortRepr
from origami_nlp.paper.cone.classes import EnergyClass, assignment_classes, direction_name
from origami_nlp.paper.cone.energy import SideEnergy
from origami_nlp.paper.cone.numbers import exact, number_words, share_words
from origami_nlp.paper.cone.roots import polish, slope_signs
from origami_nlp.paper.cone.rules import LARGEST_DEGREE, Cone, Rest, check_depth, check_ratio
from origami_nlp.pattern import format_angle

MOST_ROWS, MOST_TIES = 60, 8
"""Minima and ties that are printed one by one."""
SMALL = 1e-3
"""Elevations below this are written with an exponent: seven decimals would leave less than four digits [rad]."""
HEADS = ("branches", "changes", "number", "elevation [rad]", "energy/k_odd", "depth", "kind")


@dataclass(frozen=True, repr=False)
class ConeMinima(ShortRepr):
    """Minima of branches, one entry a class and minimum; arrays of one length.

    Attributes
    ----------
    valleys, changes
        The class (see `AssignmentClasses`); changes is 2j.
    direction
        +1 up, -1 down.
    multiplicity
        Number of branches that have this minimum, exact.
    elevation
        Signed, nu [rad].
    energy
        Of the springs, with k_odd = 1 and k_even = r per crease.
    depth
        (U_flat - U)/U_flat; below 0 where a minimum at contact lies higher than the flat state.
    kind
        "interior"; "contact": pinned by contact at the end of the branch; "cut": the energy falls at an end
        where nothing touches (`Cone.is_cut`).
    multiplier
        -dU/d|nu| at the end, 0 for interior minima; for "cut" no contact bears it.
    """

    valleys: np.ndarray
    changes: np.ndarray
    direction: np.ndarray
    multiplicity: tuple[int, ...]
    elevation: np.ndarray
    energy: np.ndarray
    depth: np.ndarray
    kind: np.ndarray
    multiplier: np.ndarray

    def __len__(self) -> int:
        return len(self.multiplicity)

    @property
    def interior(self) -> np.ndarray:
        """Mask of the minima inside their branch."""
        return self.kind == "interior"

    @property
    def contact(self) -> np.ndarray:
        """Mask of the minima pinned by contact."""
        return self.kind == "contact"

    def count(self, kind: str) -> int:
        """Return the number of branches with a minimum of a kind, exact."""
        pairs = zip(self.multiplicity, (self.kind == kind).tolist(), strict=True)
        return sum(number for number, own in pairs if own)

    @property
    def columns(self) -> list[Any]:
        """The arrays in order, of which the multiplicity is a tuple."""
        return [getattr(self, f.name) for f in fields(self)]

    def where(self, keep: np.ndarray) -> ConeMinima:
        """Return the minima of a mask."""
        rows = np.nonzero(keep)[0]
        numbers = tuple(self.multiplicity[k] for k in rows.tolist())
        kept: list[Any] = [numbers if isinstance(c, tuple) else c[rows] for c in self.columns]
        return ConeMinima(*kept)

    def of_class(self, valleys: int, changes: int, direction: int) -> np.ndarray:
        """Mask of the minima of one class of branches."""
        same = (self.valleys == valleys) & (self.changes == changes)
        return same & (self.direction == direction)

    def then(self, more: ConeMinima) -> ConeMinima:
        """Return these minima followed by others."""
        pairs = zip(self.columns, more.columns, strict=True)
        joined: list[Any] = [
            a + b if isinstance(a, tuple) else np.concatenate([a, b]) for a, b in pairs
        ]
        return ConeMinima(*joined)


@dataclass(frozen=True, repr=False)
class ConeCount(Report):
    """Minima of a cone, branch by branch.

    A minimum along a branch need not be stable when the vertex may leave the branch (`full_space`).

    Attributes
    ----------
    cone
        Degree and rules.
    rest
        Rest angles.
    ratio
        r_k = k_even/k_odd.
    depth
        Only minima deeper than this were kept; 0: all minima.
    minima
        One entry a class and minimum: up first, then by valleys, changes, |elevation|.
    undecided
        (valleys, changes, direction) of classes with a tie: slope 0 to rounding at either end, or a
        double zero of it.  Their minima are counted as the module says.
    """

    cone: Cone
    rest: Rest
    ratio: float
    depth: float
    minima: ConeMinima
    undecided: tuple[tuple[int, int, int], ...]

    SCHEMA, READS = "origami-nlp/paper/1", False

    @property
    def degree(self) -> int:
        """N."""
        return self.cone.degree

    @property
    def branches(self) -> int:
        """Number of all branches, 2^(N/2 + 1)."""
        return self.cone.branches

    @cached_property
    def stable_interior(self) -> int:
        """Number of minima inside their branch, exact."""
        return self.minima.count("interior")

    @cached_property
    def stable_contact(self) -> int:
        """Number of minima pinned by contact, exact."""
        return self.minima.count("contact")

    @cached_property
    def falling_at_cut(self) -> int:
        """Number of branches whose energy falls where the rule "contract" cuts them and nothing touches."""
        return self.minima.count("cut")

    @cached_property
    def branches_with_minimum(self) -> int:
        """Number of branches with at least one minimum (a branch may have several), exact.

        One that falls at its cut has one further along.
        """
        m = self.minima
        keys = zip(m.direction.tolist(), m.valleys.tolist(), m.changes.tolist(), strict=True)
        return sum(dict(zip(keys, m.multiplicity, strict=True)).values())

    def report_sections(self) -> Iterator[Section]:
        """Return the numbers of branch minima, then a row for each class and minimum, deepest first."""
        whole, end = self.branches, self.cone.end
        yield (
            f"cone of degree {self.degree}, r_k = {self.ratio:g}, rest elevation "
            f"{format_angle(self.rest.elevation)} ({self.cone.rest}), branches end by the {end} rule"
        )
        for name, number in (
            ("interior minima", self.stable_interior),
            ("minima pinned by contact", self.stable_contact),
            ("falling at their cut, where nothing touches", self.falling_at_cut),
            ("branches with a minimum", self.branches_with_minimum),
        ):
            if number or not name.startswith("falling"):
                words = f"{number_words(number)} of {number_words(whole)} branches"
                yield f"  {name}: {words} ({share_words(number, whole)})"
        if self.depth > 0:
            yield f"  counted: wells deeper than {self.depth:g} of the flat state's energy"
        for tied in self.undecided[:MOST_TIES]:
            name = EnergyClass(self.cone, *tied).name
            yield f"  tie to rounding on {name}: slope 0 at an end, or a double zero"
        if len(self.undecided) > MOST_TIES:
            yield f"  and ties on {len(self.undecided) - MOST_TIES} more classes"
        if len(self.minima):
            yield self.table()
        if len(self.minima) > MOST_ROWS:
            yield f"{len(self.minima) - MOST_ROWS} more rows: -o FILE.json has all"

    def table(self) -> Table:
        """Return one row a class and minimum, deepest first; those at an end with their multiplier."""
        m, rows = self.minima, []
        for k in np.argsort(-m.depth, kind="stable")[:MOST_ROWS].tolist():
            own = EnergyClass(self.cone, int(m.valleys[k]), int(m.changes[k]), int(m.direction[k]))
            row = (
                own.name.split(" (")[0],
                str(own.changes),
                number_words(m.multiplicity[k]),
                f"{m.elevation[k]:.7f}" if abs(m.elevation[k]) > SMALL else f"{m.elevation[k]:.3e}",
                f"{m.energy[k]:.5g}",
                f"{m.depth[k]:.4g}",
                "interior" if m.interior[k] else f"{m.kind[k]}, {m.multiplier[k]:.4g}",
            )
            rows.append(row)
        return Table(HEADS, rows, "", "lrrrrrl", framed=False, narrow=True)

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data, an entry of ``classes`` for each class and minimum; numbers beyond 2^53 are text."""
        m = self.minima
        columns = {f.name: getattr(m, f.name) for f in fields(m)}
        columns["direction"] = [direction_name(d) for d in m.direction.tolist()]
        columns["multiplicity"] = [exact(number) for number in m.multiplicity]
        lists = [c.tolist() if isinstance(c, np.ndarray) else c for c in columns.values()]
        kinds = ("stable_interior", "stable_contact", "falling_at_cut")
        return {
            "schema": self.SCHEMA,
            "degree": self.degree,
            "branches": str(self.branches),
            **{kind: exact(getattr(self, kind)) for kind in kinds},
            "classes": [dict(zip(columns, row, strict=True)) for row in zip(*lists, strict=True)],
        }


def count(cone: Cone | int, ratio: float, elevation: float, *, depth: float = 0.0) -> ConeCount:
    """Find and count the minima of every branch of a cone.

    Parameters
    ----------
    cone
        A `Cone`, or its degree N: even, 6 to 4000.
    ratio
        r_k = k_even/k_odd, 1e-12 to 1e12.
    elevation
        v_0 of the rest state, signed [rad]; see `Cone.at_rest`.
    depth
        Keep only minima with (U_flat - U)/U_flat > depth; 0 keeps all of them, also
        those at contact that lie higher than the flat state.

    Returns
    -------
    ConeCount
        The numbers of minima by kind, and the minima class by class.

    Raises
    ------
    OptionError, AngleError
        For values out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> found = cone.count(8, ratio=2.0, elevation=0.3)
    >>> found.branches, found.stable_interior, found.stable_contact
    (32, 16, 0)
    >>> cone.count(cone.Cone(1000, end="contact"), 2.0, 0.3).branches_with_minimum == 2**500
    True
    """
    cone = Cone.of(cone, LARGEST_DEGREE)
    ratio, depth = check_ratio(ratio), check_depth(depth)
    classes = assignment_classes(cone.degree)
    parts, undecided = [], []
    for direction in (1, -1):
        side = SideEnergy.of(cone, direction, elevation)
        found, ties = minima_of(side, np.full(len(classes), ratio))
        parts.append(_filled(side, classes.multiplicity, ratio, found))
        rows = zip(classes.valleys[ties].tolist(), classes.changes[ties].tolist(), strict=True)
        undecided += [(a, c, direction) for a, c in rows]
    minima = parts[0].then(parts[1])
    if depth > 0:
        minima = minima.where(minima.depth > depth)
    return ConeCount(cone, side.rest, ratio, depth, minima, tuple(undecided))


class Found(NamedTuple):
    """Minima on branches: classes `rows`, elevations s, which are at an end, and -F there."""

    rows: np.ndarray
    s: np.ndarray
    at_end: np.ndarray
    multiplier: np.ndarray


def minima_of(side: SideEnergy, ratio: np.ndarray) -> tuple[Found, np.ndarray]:
    """Find the minima of all classes of one direction, each at its ratio [m], and the rows of those with ties."""
    if side.rest.odd == 0 and side.rest.even == 0:  # flat at rest: all branches climb
        none = np.zeros(0, dtype=np.int64)
        return Found(none, none * 1.0, none == 1, none * 1.0), none
    signs = slope_signs(side, ratio)
    inside = polish(side, ratio, signs)
    # F(end) = 0 but for rounding: what F does before it decides
    tied = np.nonzero(signs.end == 0)[0]
    bend = side.at(side.end[tied], tied).curvature(ratio[tied])
    # the energy falls to the end, or is level there and curves up: the end is a minimum of the closed branch
    pinned = np.union1d(np.nonzero(signs.end < 0)[0], tied[bend > 0])
    rows = np.concatenate([signs.rows, pinned])
    s = np.concatenate([inside, side.end[pinned]])
    at_end = np.concatenate([np.zeros(len(inside), bool), np.ones(len(pinned), bool)])
    multiplier = np.concatenate([np.zeros(len(inside)), np.maximum(-signs.end[pinned], 0.0)])
    order = np.lexsort((s, rows))
    ties = np.concatenate([np.nonzero(signs.start == 0)[0], tied, signs.undecided])
    return Found(*(each[order] for each in (rows, s, at_end, multiplier))), np.unique(ties)


def _filled(
    side: SideEnergy, multiplicity: tuple[int, ...], ratio: float, found: Found
) -> ConeMinima:
    """Fill in energies, depths and kinds of minima."""
    rows, s, at_end, multiplier = found
    here = side.at(s, rows)
    odd, even = here.energies
    flat = here.flat[0] + ratio * here.flat[1]
    return ConeMinima(
        side.valleys[rows],
        side.changes[rows],
        np.full(len(rows), side.direction),
        tuple(multiplicity[k] for k in rows.tolist()),
        side.direction * s,
        odd + ratio * even,
        np.minimum(here.depth(ratio), 1.0) if flat else np.zeros(len(rows)),
        np.where(at_end, np.where(side.cut[rows], "cut", "contact"), "interior"),
        multiplier,
    )
