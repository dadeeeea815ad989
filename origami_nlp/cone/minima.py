"""Minima of the energy on all 2^(N/2 + 1) branches of a cone, counted exactly.

A branch has an interior minimum where the slope F of its energy turns from falling to rising,
and a contact-pinned one at its end where the energy still falls there, with multiplier
-F(end) > 0 (the generalised force along |v| that the contact bears).  The rule "contract" cuts branches of
a single steep flap where nothing touches: where the energy falls there, no contact holds the state, and its kind
is "cut" (the branch goes on, and its minimum lies further along: `end` = "contact" finds it).  All branches of a class
have the same energy, so O(N^2) classes stand for all branches; `cone_roots` isolates every zero.
The flat state, where all branches begin, is not counted.

Ties, which no rounding-error bound decides: where F(0) = 0 the flat state itself is the minimum
(F'(0) > 0 always); where F(end) = 0 and F rises to it, the end is a minimum with multiplier 0, counted
as contact (the rest state of the all-valley branch at the end of its range is of this kind).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.cone.energy import DirectionClasses, Rest, rest_state
from origami_nlp.cone.flaps import LARGEST_DEGREE, check_degree, cone_classes
from origami_nlp.cone.roots import polish, slope_signs
from origami_nlp.errors import OptionError


@dataclass(frozen=True)
class BranchMinima:
    """Minima of branches, one entry a class and minimum; arrays of one length.

    Attributes
    ----------
    valleys, changes
        The class (see `state.cone.ConeClasses`); changes is 2j.
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
        where nothing touches (`model.cone.is_cut`).
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

    def where(self, keep: np.ndarray) -> BranchMinima:
        """Return the minima of a mask."""
        rows = np.nonzero(keep)[0]
        multiplicity = tuple(self.multiplicity[k] for k in rows.tolist())
        return BranchMinima(
            self.valleys[rows],
            self.changes[rows],
            self.direction[rows],
            multiplicity,
            self.elevation[rows],
            self.energy[rows],
            self.depth[rows],
            self.kind[rows],
            self.multiplier[rows],
        )


@dataclass(frozen=True)
class ConeCount:
    """Minima of a cone, branch by branch.

    A minimum along a branch need not be stable when the vertex may leave the branch (`judge.cone_full_space`).

    Attributes
    ----------
    rest
        Degree and rest angles.
    ratio
        r_k = k_even/k_odd.
    depth
        Only minima deeper than this were kept; 0: all minima.
    minima
        One entry a class and minimum: up first, then by valleys, changes, |elevation|.
    stable_interior, stable_contact
        Numbers of branch minima inside, and pinned by contact, exact.
    falling_at_cut
        Number of branches whose energy falls where the rule "contract" cuts them and nothing touches (kind "cut").
    branches_with_minimum
        Number of branches with at least one minimum (a branch may have several); one that falls at its cut
        has one further along.
    undecided
        (valleys, changes, direction) of classes with a tie: slope 0 to rounding at either end, or a
        double zero of it.  Their minima are counted as the module says.
    """

    rest: Rest
    ratio: float
    depth: float
    end_rule: str
    minima: BranchMinima
    stable_interior: int
    stable_contact: int
    falling_at_cut: int
    branches_with_minimum: int
    undecided: tuple[tuple[int, int, int], ...]

    @property
    def degree(self) -> int:
        """N."""
        return self.rest.degree

    @property
    def branches(self) -> int:
        """Number of all branches, 2^(N/2 + 1)."""
        return 1 << (self.degree // 2 + 1)

    def __repr__(self) -> str:
        return (
            f"ConeCount(degree {self.degree}, ratio {self.ratio:g}, elevation "
            f"{self.rest.elevation:g}: {self.stable_interior} interior and {self.stable_contact} "
            f"contact-pinned minima, {self.falling_at_cut} falling at their cut, on {self.branches} "
            "branches)"
        )


def branch_minima(
    degree: int,
    ratio: float,
    elevation: float,
    *,
    rest: str = "waterbomb",
    depth: float = 0.0,
    end: str = "contract",
) -> ConeCount:
    """Find the minima of every branch of a cone.

    Parameters
    ----------
    degree
        N, even, 6 to 4000.
    ratio
        r_k = k_even/k_odd > 0.
    elevation
        v_0 of the rest state, signed [rad]; see `cone_energy.rest_state` for `rest`.
    depth
        Keep only minima with (U_flat - U)/U_flat > depth; 0 (or less) keeps all of them, also
        those at contact that lie higher than the flat state.
    end
        Where branches with a single steep flap end, see `model.cone.branch_end`.

    Raises
    ------
    OptionError, AngleError
        For values out of range.
    """
    check_degree(degree, LARGEST_DEGREE)
    ratio, depth = check_ratio(ratio), check_depth(depth)
    state = rest_state(degree, elevation, rest)
    classes = cone_classes(degree)
    parts, undecided = [], []
    for direction in (1, -1):
        branches = DirectionClasses(classes, direction, state, end)
        found, ties = _direction_minima(branches, ratio)
        parts.append(found)
        rows = zip(classes.valleys[ties].tolist(), classes.changes[ties].tolist(), strict=True)
        undecided += [(a, c, direction) for a, c in rows]
    minima = _join(parts)
    if depth > 0:
        minima = minima.where(minima.depth > depth)
    interior, contact, cut = (minima.count(kind) for kind in ("interior", "contact", "cut"))
    having, last = 0, None
    keys = zip(
        minima.direction.tolist(), minima.valleys.tolist(), minima.changes.tolist(), strict=True
    )
    for number, key in zip(minima.multiplicity, keys, strict=True):
        having += number if key != last else 0
        last = key
    known = tuple(undecided)
    return ConeCount(state, ratio, depth, end, minima, interior, contact, cut, having, known)


def _direction_minima(branches: DirectionClasses, ratio: float) -> tuple[BranchMinima, np.ndarray]:
    """Minima of all classes of one direction, and rows of the classes with ties."""
    if branches.rest.odd == 0 and branches.rest.even == 0:  # flat at rest: all branches climb
        none = np.zeros(0, dtype=np.int64)
        return _entries(branches, ratio, none, none.astype(float), none == 1, none * 1.0), none
    signs = slope_signs(branches, ratio)
    inside = polish(branches, ratio, signs)
    tied = np.nonzero(signs.end == 0)[0]
    bend, even = branches.curvatures(branches.end[tied], tied)
    pinned = np.union1d(np.nonzero(signs.end < 0)[0], tied[bend + ratio * even > 0])
    rows = np.concatenate([signs.rows, pinned])
    s = np.concatenate([inside, branches.end[pinned]])
    at_end = np.concatenate([np.zeros(len(inside), bool), np.ones(len(pinned), bool)])
    multiplier = np.concatenate([np.zeros(len(inside)), np.maximum(-signs.end[pinned], 0.0)])
    order = np.lexsort((s, rows))
    found = _entries(branches, ratio, rows[order], s[order], at_end[order], multiplier[order])
    ties = np.concatenate([np.nonzero(signs.start == 0)[0], tied, signs.undecided])
    return found, np.unique(ties)


def _entries(
    branches: DirectionClasses,
    ratio: float,
    rows: np.ndarray,
    s: np.ndarray,
    at_end: np.ndarray,
    multiplier: np.ndarray,
) -> BranchMinima:
    """Fill in energies, depths and kinds of minima at s of classes `rows`."""
    odd, even = branches.energies(s, rows)
    well_odd, well_even = branches.wells(s, rows)
    flat_odd, flat_even = branches.flat_energies()
    flat = flat_odd + ratio * flat_even
    classes = branches.classes
    end_kind = np.where(branches.cut[rows], "cut", "contact")
    return BranchMinima(
        classes.valleys[rows],
        classes.changes[rows],
        np.full(len(rows), branches.direction),
        tuple(classes.multiplicity[k] for k in rows.tolist()),
        branches.direction * s,
        odd + ratio * even,
        np.minimum((well_odd + ratio * well_even) / flat, 1.0) if flat else np.zeros(len(rows)),
        np.where(at_end, end_kind, "interior"),
        multiplier,
    )


def _join(parts: list[BranchMinima]) -> BranchMinima:
    up, down = parts
    return BranchMinima(
        np.concatenate([up.valleys, down.valleys]),
        np.concatenate([up.changes, down.changes]),
        np.concatenate([up.direction, down.direction]),
        up.multiplicity + down.multiplicity,
        np.concatenate([up.elevation, down.elevation]),
        np.concatenate([up.energy, down.energy]),
        np.concatenate([up.depth, down.depth]),
        np.concatenate([up.kind, down.kind]),
        np.concatenate([up.multiplier, down.multiplier]),
    )


def check_ratio(ratio: float, field: str = "ratio") -> float:
    """Return a stiffness ratio, or complain.

    Raises
    ------
    OptionError
        Unless it is a finite number between 1e-12 and 1e12 (beyond, one kind of spring is rounding).
    """
    return check_number(field, ratio, 1e-12, 1e12)


def check_depth(depth: float) -> float:
    """Return a well depth, or complain.

    Raises
    ------
    OptionError
        Unless it is a number of [0, 1): U >= 0, so no well is deeper than 1.
    """
    value = check_number("depth", depth)
    if not 0 <= value < 1:
        raise OptionError(
            f"depth = {depth!r}: write a share of the flat state's energy, 0 <= depth < 1"
        )
    return value
