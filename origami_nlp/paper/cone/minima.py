"""Minima of the energy on all 2^(N/2 + 1) branches of a cone, counted exactly: at a point, and over a plane of them.

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

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.paper.cone.classes import SAFE, Branches, exact
from origami_nlp.paper.cone.energy import BranchEnergy
from origami_nlp.paper.cone.roots import minima_of
from origami_nlp.paper.cone.rules import Cone, Rest, check_ratio
from origami_nlp.pattern import format_angle

KINDS = ("interior", "contact", "cut")


MOST_ROWS = 60
"""Minima that are printed one by one."""


@dataclass(frozen=True)
class ClassMinimum:
    """A minimum of a class of branches, as it is listed; see `Branches` and `ConeMinima`."""

    valleys: int = field(metadata=shown("valleys"))
    changes: int = field(metadata=shown("changes"))
    direction: str = field(metadata=shown("way"))
    multiplicity: int | str = field(metadata=shown("branches"))
    elevation: float = field(metadata=shown("elevation", "rad", ".5g"))
    energy: float = field(metadata=shown("energy/k_odd", spec=".5g"))
    depth: float = field(metadata=shown("depth", spec=".4g"))
    kind: str = field(metadata=shown("kind"))
    multiplier: float = field(metadata=shown("multiplier", spec=".4g"))


@dataclass(frozen=True, repr=False)
class ConeMinima(ShortRepr):
    """Minima of branches, one entry a class and minimum; arrays of one length.

    Attributes
    ----------
    branches
        Class of each, with the number of branches that have this minimum.
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

    branches: Branches
    elevation: np.ndarray
    energy: np.ndarray
    depth: np.ndarray
    kind: np.ndarray
    multiplier: np.ndarray

    def __len__(self) -> int:
        return len(self.elevation)

    def count(self, kind: str) -> int:
        """Return the number of branches with a minimum of a kind, exact."""
        return int(self.branches.multiplicity[self.kind == kind].sum())


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
    minima
        One entry a class and minimum: up first, then by valleys, changes, |elevation|.
    stable_interior, stable_contact, falling_at_cut
        Numbers of minima inside their branch, pinned by contact, and of branches whose energy falls where "contract"
        cuts them and nothing touches; exact.
    undecided
        Classes with a tie: slope 0 to rounding at either end, or a double zero of it.  Their minima are counted as the
        module says.
    """

    cone: Cone
    rest: Rest
    ratio: float
    minima: ConeMinima
    undecided: Branches

    SCHEMA, READS = "origami-nlp/paper/1", False
    stable_interior = property(lambda self: self.minima.count("interior"))
    stable_contact = property(lambda self: self.minima.count("contact"))
    falling_at_cut = property(lambda self: self.minima.count("cut"))

    @property
    def branches(self) -> int:
        """Number of all branches, 2^(N/2 + 1)."""
        return self.cone.branches

    @cached_property
    def branches_with_minimum(self) -> int:
        """Number of branches with at least one minimum (a branch may have several), exact.

        One that falls at its cut has one further along.
        """
        b = self.minima.branches
        keys = zip(b.direction.tolist(), b.valleys.tolist(), b.changes.tolist(), strict=True)
        return sum(dict(zip(keys, b.multiplicity.tolist(), strict=True)).values())

    @property
    def classes(self) -> tuple[ClassMinimum, ...]:
        """One record a class and minimum."""
        m = self.minima
        each = zip(*(c.tolist() for c in [*vars(m).values()][1:]), strict=True)
        return tuple(ClassMinimum(*m.branches.described(k), *rest) for k, rest in enumerate(each))

    def report_sections(self) -> Iterator[Section]:
        """Return the numbers of branch minima, then a row for each class and minimum, deepest first."""
        cone, whole = self.cone, self.branches
        yield (
            f"cone of degree {cone.degree}, r_k = {self.ratio:g}, rest elevation "
            f"{format_angle(self.rest.elevation)} ({cone.rest}), branches end by the {cone.end} rule"
        )
        for name, number in (
            ("interior minima", self.stable_interior),
            ("minima pinned by contact", self.stable_contact),
            ("falling at their cut, where nothing touches", self.falling_at_cut),
            ("branches with a minimum", self.branches_with_minimum),
        ):
            yield f"  {name}: {number} of {whole} branches ({number * 10**8 // whole / 10**8:.6g})"
        if len(self.undecided):
            yield f"  ties to rounding on {len(self.undecided)} classes of branches"
        deepest = sorted(self.classes, key=lambda m: -m.depth)
        if deepest:
            yield record_table(deepest[:MOST_ROWS], "", narrow=True)
        if len(deepest) > MOST_ROWS:
            yield f"{len(deepest) - MOST_ROWS} more rows: -o FILE.json has all"

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data, an entry of ``classes`` for each class and minimum; numbers beyond 2^53 are text."""
        kinds = ("stable_interior", "stable_contact", "falling_at_cut")
        numbers = {kind: exact(getattr(self, kind)) for kind in kinds}
        about = {"schema": self.SCHEMA, "degree": self.cone.degree, "branches": str(self.branches)}
        return about | numbers | {"classes": [vars(m) for m in self.classes]}


def count(cone: Cone | int, ratio: float, elevation: float) -> ConeCount:
    """Find and count the minima of every branch of a cone.

    Parameters
    ----------
    cone
        A `Cone`, or its degree N: even, 6 to 4000.
    ratio
        r_k = k_even/k_odd, 1e-12 to 1e12.
    elevation
        v_0 of the rest state, signed [rad]; see `Cone.at_rest`.

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
    branches = Branches.of(cone)
    ratio = check_ratio(ratio)
    rest = branches.cone.at_rest(elevation)
    rows, s, at_end, multiplier, ties = minima_of(branches, rest, np.full(len(branches), ratio))
    own = branches[rows]
    here = BranchEnergy(own, rest, ratio, s)
    kind = np.array(KINDS)[_kinds(own, at_end)]
    minima = ConeMinima(
        own, own.direction * s, here.total(here.energies), here.depth, kind, multiplier
    )
    return ConeCount(branches.cone, rest, ratio, minima, branches[ties])


def _kinds(branches: Branches, at_end: np.ndarray) -> np.ndarray:
    """Number the kind of each minimum, in the order of `KINDS`."""
    return np.where(at_end, np.where(branches.cone.is_cut(branches.steep), 2, 1), 0)


@dataclass(frozen=True, repr=False)
class CountMap(ShortRepr):
    """Numbers of branch minima, shape [ratios, elevations] each.

    Attributes
    ----------
    cone
        Degree and rules.
    ratios
        r = k_even/k_odd of the rows.
    elevations
        Rest elevations nu_0 of the columns [rad].
    interior, contact, cut
        By kind, see `ConeMinima`; int64 where all numbers fit, else exact Python integers (dtype object).
    """

    cone: Cone
    ratios: np.ndarray
    elevations: np.ndarray
    interior: np.ndarray
    contact: np.ndarray
    cut: np.ndarray

    @property
    def at_end(self) -> np.ndarray:
        """Minima at the end of their branch, pinned there by contact or by the cut."""
        return self.contact + self.cut

    @property
    def total(self) -> np.ndarray:
        """All minima."""
        return self.interior + self.at_end


def count_map(
    cone: Cone | int,
    ratios: Sequence[float] | np.ndarray,
    elevations: Sequence[float] | np.ndarray,
    *,
    progress: Callable[[int], None] | None = None,
) -> CountMap:
    """Count branch minima by kind at every (r_k, v_0): `count` for a plane.

    Parameters
    ----------
    cone
        A `Cone`, or its degree.
    ratios, elevations
        Values of r_k, and of v_0 [rad], in any order.
    progress
        Called with the number of columns (elevations) done.

    Returns
    -------
    CountMap
        Numbers [ratios, elevations] of each kind.

    Raises
    ------
    OptionError, AngleError
        For values out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.count_map(10, ratios=[0.02, 1.0], elevations=[-0.9, 0.3, 0.8]).total.tolist()
    [[37, 32, 32], [32, 32, 32]]
    """
    branches = Branches.of(cone)
    given = np.array([check_ratio(r, "ratios") for r in np.atleast_1d(ratios).tolist()])
    columns = np.array([check_number("elevations", v) for v in np.atleast_1d(elevations).tolist()])
    if given.ndim != 1 or columns.ndim != 1 or not given.size or not columns.size:
        raise OptionError("ratios and elevations must be lists of numbers")
    # exact however many branches there are
    numbers = branches.multiplicity
    if branches.cone.branches <= SAFE:
        numbers = numbers.astype(np.int64)
    counts = np.zeros((3, len(given), len(columns)), numbers.dtype)
    # every class at every ratio, one after the other
    every = branches[np.tile(np.arange(len(branches)), len(given))]
    each = np.repeat(given, len(branches))
    for k, elevation in enumerate(columns):
        rest = branches.cone.at_rest(elevation)
        rows, _, at_end, *_ = minima_of(every, rest, each)
        kind = _kinds(every[rows], at_end)
        for of in range(3):
            often = np.bincount(rows[kind == of], minlength=len(each))
            counts[of, :, k] = often.reshape(len(given), -1) @ numbers
        if progress:
            progress(k + 1)
    return CountMap(branches.cone, given, columns, *counts)
