"""A whole crease pattern: rigid facets, the creases between them, interior vertices, borders and holes.

Everything is measured in a reference state, which need not be flat: a crease pattern, where all fold angles are 0, or
a folded form with the angles at which it is folded.  Facets run counter-clockwise seen from the side where valleys
open; a crease is directed, with one facet on its left and one on its right.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.errors import FoldFileError, OptionError
from origami_nlp.numerics import NARROW, energy_or_zero, groups
from origami_nlp.pattern.fold_limits import Contact, Limits, read_limits
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinges_stated import (
    Hinges,
    Laws,
    energy_with_laws,
    read_hinges,
)
from origami_nlp.pattern.numbers_read import check_range, read_numbers, read_rest_angles
from origami_nlp.pattern.origami import Origami
from origami_nlp.pattern.polygons import Loop, Loops, Side, check_topology, side, sides_of

MOST_FACETS = 20_000
"""Of a pattern."""


@dataclass(frozen=True, eq=False, repr=False)
class Pattern(Origami):
    """A crease pattern of many vertices with springs at its creases.

    Attributes
    ----------
    corners
        Points of the reference state, [V, 3].
    polygons
        Corners of each convex or non-convex piece of paper, counter-clockwise.
    facet_of
        Which rigid facet each piece belongs to; pieces joined by F or J edges are one facet, [P].
    ends
        Corners from which and to which each crease runs, [n, 2].
    left, right
        Facets beside each crease, [n].
    reference
        Fold angles in which `corners` are measured [rad], [n].
    assignment
        One letter a crease.
    stiffness
        Of each crease [N m/rad], [n].
    rest
        Rest angle of each crease [rad], [n].
    file_angles
        Fold angles that a file gives [rad], nan where it does not, [n].
    numbers
        Of the creases' edges in the file, [n].
    vertices
        A `Loop` for each interior vertex.
    holes
        A `Loop` for each hole; of a tube that once round it.
    joined
        Pairs of pieces that an edge joins to one facet.
    name
        Title.
    notes
        What was found odd, and what was made of it.
    orders
        How polygons lie in the state `stated`, as FOLD's faceOrders: (f, g, 1) where f lies on the side of g's normal,
        (f, g, -1) where on the other.
    source
        What was read, as it was typed: a file, or an example; reports are titled by it.
    limits
        Fold limits of each crease [rad], pairs (low, high) within +-pi, [n, 2]; () where all are +-pi.
    laws
        A `HingeLaw` for each crease, or None for its linear spring, [n]; () where all are linear.  Where there is a law
        `stiffness` is its mean size and `rest` its lowest angle.
    generators, cell
        Of a cell that repeats in a plane, a `Loop` from a facet to its copy along either lattice vector, and of any
        cell its `Cell`; else empty, and None.
    contact
        ``"full"``: facets never cross; ``"fold-limits"``: they may.

    Examples
    --------
    >>> import origami_nlp as o
    >>> sheet = o.examples.pattern("miura", 2, 3).with_springs(stiffness=0.01, rest_angles=1.2)
    >>> sheet.assignment, round(float(sheet.energy(sheet.rest)), 12)
    ('MVVMVMV', 0.0)
    """

    PLAIN = ("pattern_to_dict", "pattern_from_dict")
    CONTACTS = ("full", "fold-limits")
    corners: np.ndarray
    polygons: tuple[tuple[int, ...], ...]
    facet_of: np.ndarray
    ends: np.ndarray
    left: np.ndarray
    right: np.ndarray
    reference: np.ndarray
    assignment: str
    stiffness: np.ndarray
    rest: np.ndarray
    file_angles: np.ndarray
    numbers: np.ndarray
    vertices: tuple[Loop, ...]
    holes: tuple[Loop, ...]
    name: str = ""
    notes: tuple[str, ...] = field(default=())
    orders: tuple[tuple[int, int, int], ...] = ()
    source: str = ""
    limits: Limits = ()
    laws: Laws = ()
    generators: tuple[Loop, ...] = ()
    cell: Any = None
    contact: Contact = "full"

    @property
    def spread(self) -> Pattern:
        """The sheet in space: of a cell that repeats with its neighbours, else itself."""
        whole: Pattern = self.cell.sheet if self.cell else self
        return whole

    @property
    def paper(self) -> Pattern:
        """Itself."""
        return self

    @property
    def facets(self) -> int:
        """Number of rigid facets."""
        return int(self.facet_of.max()) + 1

    @property
    def creases(self) -> int:
        """Number of creases n."""
        return len(self.ends)

    @cached_property
    def directions(self) -> np.ndarray:
        """Unit vectors along the creases in the reference state, [n, 3]."""
        d = self.corners[self.ends[:, 1]] - self.corners[self.ends[:, 0]]
        return d / self.lengths[:, None]

    @cached_property
    def lengths(self) -> np.ndarray:
        """Of the creases, in the units of the corners, [n]."""
        d = self.corners[self.ends[:, 1]] - self.corners[self.ends[:, 0]]
        return np.linalg.norm(d, axis=1)

    @property
    def other_sides(self) -> dict[tuple[int, int], int]:
        """Sides of polygons that are no creases, each with the number of polygons it belongs to: 1 at a border."""
        creases = set(map(tuple, self.ends.tolist()))
        sides = sides_of(self.polygons).items()
        return {side: len(many) for side, many in sides if side not in creases}

    @property
    def is_flat(self) -> bool:
        """Whether the reference state is a flat sheet."""
        return not self.reference.any()

    @property
    def lies_flat(self) -> bool:
        """Whether the reference state is a flat sheet that closes: that of a tube does not."""
        return self.is_flat and not any(hole.moved for hole in self.holes)

    @cached_property
    def stated(self) -> np.ndarray | None:
        """Fold angles of the folded state that the pattern's file describes [rad], [n]; None where it describes none.

        The reference state where that is folded; otherwise the file's fold angles, and with an order of layers, where
        angles are missing, mountains and valleys folded flat.
        """
        if not self.is_flat:
            return self.reference
        given = np.where(np.isnan(self.file_angles), math.pi * self.signs, self.file_angles)
        whole = self.orders or not np.isnan(self.file_angles).any()
        return given if whole and given.any() else None

    def with_springs(
        self,
        stiffness: float | Sequence[float] | None = None,
        rest_angles: float | Sequence[float] | None = None,
        per_length: bool = False,
    ) -> Pattern:
        """Return the same pattern with other springs.

        Parameters
        ----------
        stiffness
            Of every crease, or of each [N m/rad]; with `per_length` [N/rad], times the length of the crease.
        rest_angles
            Size of the rest angle of mountains and valleys, or the rest angle of each crease [rad].
        per_length
            Whether stiffness is per unit length.

        Returns
        -------
        Pattern
            With these springs.

        Raises
        ------
        SceneError
            If a value does not fit.
        """
        k = self.stiffness if stiffness is None else stiffness
        if per_length:
            k = np.array(read_numbers(k, "stiffness", self.creases)) * self.lengths
        phi = self.rest if rest_angles is None else rest_angles
        if np.ndim(phi) == 0:
            phi = check_number("rest_angles", phi, 0.0, math.pi) * self.signs
        return self._with_hinges(stiffness=k, rest=read_rest_angles(phi, self.creases))

    def _with_hinges(self, **changed: Any) -> Pattern:
        """Return the pattern with other stiffness, rest angles, limits or laws, all read together."""
        own = {key: getattr(self, key) for key in Hinges._fields}
        read = read_hinges(self.creases, **own | changed)
        k, rest = np.array(read.stiffness), np.array(read.rest)
        return replace(self, stiffness=k, rest=rest, limits=read.limits, laws=read.laws)

    def with_limits(self, limits: Sequence[Any], *, degrees: bool = False) -> Pattern:
        """Return the same pattern with fold limits: stops before facets meet.

        Parameters
        ----------
        limits
            One pair (low, high) for all creases, or a pair for each [rad]; () for +-pi.
        degrees
            Whether numbers are degrees.

        Returns
        -------
        Pattern
            With these limits.

        Raises
        ------
        SceneError, AngleError
            If they do not fit.
        """
        return self._with_hinges(limits=read_limits(limits, self.creases, degrees=degrees))

    def with_laws(self, laws: HingeLaw | Sequence[HingeLaw | None]) -> Pattern:
        """Return the same pattern with hinge laws in place of linear springs.

        Parameters
        ----------
        laws
            One for all creases, or one, or None, for each.

        Returns
        -------
        Pattern
            With these laws.

        Raises
        ------
        SceneError
            If one is not known between the fold limits.
        """
        each = [laws] * self.creases if isinstance(laws, HingeLaw) else laws
        return self._with_hinges(laws=tuple(each))

    def check_wide(self) -> None:
        """Raise an error where a corner of a facet is too narrow for the contact that is asked for.

        Raises
        ------
        OptionError
            With the facet, the vertex and the angle.
        """
        each = zip(self.facet_of.tolist(), self.polygons, strict=True)
        for facet, ring in each if self.contact == "full" else ():
            x = self.corners[list(ring)]
            ahead, back = np.roll(x, -1, axis=0) - x, np.roll(x, 1, axis=0) - x
            across = np.linalg.norm(np.cross(ahead, back), axis=1)
            wide = np.arctan2(across, np.einsum("ki,ki->k", ahead, back))
            narrow = int(wide.argmin())
            if wide[narrow] < NARROW:
                where = f"facet {facet + 1} is {wide[narrow]:.3g} rad wide at vertex {ring[narrow]}"
                cure = "use contact = 'fold-limits', or join it to its neighbour (assignment J)"
                raise OptionError(
                    f"{where}, narrower than the {NARROW:g} that contact needs: {cure}"
                )

    @cached_property
    def signs(self) -> np.ndarray:
        """-1 for a mountain, +1 for a valley, 0 for neither, [n]."""
        return np.array([{"M": -1.0, "V": 1.0}.get(a, 0.0) for a in self.assignment])

    def energy(self, fold_angles: np.ndarray) -> np.ndarray:
        """Elastic energy of states [J].

        Parameters
        ----------
        fold_angles
            States [..., n] [rad].

        Returns
        -------
        ndarray
            Shape [...].
        """
        energy = energy_with_laws(
            np.asarray(fold_angles, float), self.stiffness, self.rest, self.laws
        )
        return energy_or_zero(energy, self.stiffness)

    def __repr__(self) -> str:
        """Return counts; the arrays would fill pages."""
        cell, many = self.cell is not None, len(self.holes)
        holes = f", {many} hole{'s' * (many > 1)}" if many else ""
        if cell and self.cell.rolled:
            p, q = self.cell.rolled
            holes = f", round a tube by {p} and {q} copies" if p or q else ", free to curl"
        inside = f"{len(self.vertices)} {'interior ' * (not cell)}vertices{holes}"
        facets = f"{'cell of ' * cell}{self.facets} facets"
        return f"Pattern({self.name!r}: {facets}, {self.creases} creases, {inside})"


def make_pattern(
    corners: np.ndarray,
    polygons: Sequence[Sequence[int]],
    *,
    joins: Sequence[Side] = (),
    limits: dict[Side, tuple[float, float]] | None = None,
    name: str = "",
    notes: Sequence[str] = (),
    orders: Sequence[tuple[int, int, int]] = (),
    **of_sides: Any,
) -> Pattern:
    """Build a pattern from polygons that share sides.

    Parameters
    ----------
    corners
        Points of the reference state, [V, 2] or [V, 3].
    polygons
        Corners of each, all counter-clockwise seen from one side.
    joins
        Sides across which two polygons are one facet.
    limits
        Fold limits [rad] of all sides that are creases, or of none.
    name, notes, orders
        Of the pattern.
    of_sides
        By their two corners in increasing order: ``assignment`` (letters), ``fold_angles`` of the reference state
        [rad], ``numbers`` in a file, ``stiffness`` [N m/rad] (or one for all), ``rest`` angles [rad], ``file_angles``
        [rad].

    Returns
    -------
    Pattern
        With its interior vertices and holes; creases by their numbers, or by their corners.

    Raises
    ------
    FoldFileError
        If a side has more than two polygons, neighbours run in different senses, the polygons fall apart, a crease
        ends within a facet, or the surface is no sheet with holes.
    SceneError
        If stiffnesses cannot be computed with, or not together.
    """
    corners = np.asarray(corners, float)
    if corners.shape[1] == 2:
        corners = np.column_stack([corners, np.zeros(len(corners))])
    if len(polygons) > MOST_FACETS:
        raise FoldFileError(f"the pattern has {len(polygons):,} facets: at most {MOST_FACETS:,}")
    left_of: dict[tuple[int, int], int] = {}
    for p, polygon in enumerate(polygons):
        for a, b in zip([*polygon[-1:], *polygon], polygon, strict=False):
            if left_of.setdefault((a, b), p) != p:
                two = f"facets {left_of[a, b] + 1} and {p + 1}"
                raise FoldFileError(f"{two} lie on one side of the edge of vertices {a} and {b}")
    together = {side(*s) for s in joins}
    inner = sorted(s for s in left_of if s[0] < s[1] and s[::-1] in left_of)
    both = {s: (left_of[s], left_of[s[::-1]]) for s in inner}
    facet_of = groups(len(polygons), [both[s] for s in inner if s in together])
    # in the order of their numbers, if they have some, else of their corners
    order = of_sides.get("numbers") or {}
    sides = sorted((s for s in inner if s not in together), key=lambda s: (order.get(s, -1), s))
    left, right = facet_of[np.array([both[s] for s in sides], int).reshape(-1, 2)].T
    for a, b in (s for s, f, g in zip(sides, left, right, strict=True) if f == g):
        where = f"the crease between vertices {a} and {b} ends within a facet"
        raise FoldFileError(f"{where}: carry it on to a crease or the border, or make it F")
    loops = Loops(polygons, left_of, {s: c for c, s in enumerate(sides)})
    vertices, holes = loops.vertices(), loops.holes(corners)
    check_topology(facet_of, left, right, len(vertices) + len(holes))
    arrays = of_creases(sides, of_sides)
    check_range(arrays["stiffness"].tolist())
    return Pattern(
        corners,
        tuple(tuple(map(int, p)) for p in polygons),
        facet_of,
        left=left,
        right=right,
        vertices=vertices,
        holes=holes,
        name=name,
        notes=tuple(notes),
        orders=tuple((int(f), int(g), int(s)) for f, g, s in orders),
        limits=read_limits([limits[s] for s in sides], len(sides)) if limits else (),
        **arrays,
    )


def of_creases(sides: Sequence[Side], stated: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a pattern has of each crease, of values by the sides that have one, or one value for all."""
    usual = {"fold_angles": 0.0, "stiffness": 1.0, "rest": 0.0, "file_angles": math.nan}
    if unknown := stated.keys() - {*usual, "assignment", "numbers"}:
        raise TypeError(f"{min(unknown)}: sides have {', '.join(usual)}, assignment, numbers")
    letters, numbers = (stated.get(key) or {} for key in ("assignment", "numbers"))
    found: dict[str, Any] = {"ends": np.array(sides, int).reshape(-1, 2)}
    for what, default in usual.items():
        of = stated.get(what, default)
        each = [of.get(s, default) for s in sides] if isinstance(of, dict) else [of] * len(sides)
        found["reference" if what == "fold_angles" else what] = np.array(each, float)
    found["assignment"] = "".join(letters.get(s, "U") for s in sides)
    found["numbers"] = np.array([numbers.get(s, c) for c, s in enumerate(sides)], int)
    return found


def in_plane(pattern: Pattern) -> np.ndarray:
    """Return the corners of a flat sheet in its plane.

    Parameters
    ----------
    pattern
        Its reference state is flat (`Pattern.is_flat`).

    Returns
    -------
    numpy.ndarray
        Corners, [V, 2]: x and y as they are where z is one number; else turned, so that facets run counter-clockwise.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import in_plane
    >>> in_plane(o.examples.pattern("miura", 2, 2))[0].tolist()
    [0.0, 0.0]
    """
    x = pattern.corners
    if not np.ptp(x[:, 2]):
        return x[:, :2]
    x = x - x[0]
    area = sum(np.cross(np.roll(x[[*p]], 1, axis=0), x[[*p]]).sum(axis=0) for p in pattern.polygons)
    normal = area / np.linalg.norm(area)
    # the longest side of a facet is known best
    ends = np.array([(p[i - 1], v) for p in pattern.polygons for i, v in enumerate(p)])
    sides = x[ends[:, 1]] - x[ends[:, 0]]
    one = sides[np.linalg.norm(sides, axis=1).argmax()]
    one = one - (one @ normal) * normal
    one /= np.linalg.norm(one)
    return np.stack([x @ one, x @ np.cross(normal, one)], axis=1)


def laid_flat(pattern: Pattern) -> Pattern:
    """Return a flat sheet with its corners in a plane z = constant.

    Parameters
    ----------
    pattern
        Any pattern.

    Returns
    -------
    Pattern
        The sheet laid in its plane; the pattern itself if it lies so, or if it is not flat.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import laid_flat
    >>> sheet = o.examples.pattern("miura", 2, 2)
    >>> laid_flat(sheet) is sheet
    True
    """
    if not pattern.is_flat or not np.ptp(pattern.corners[:, 2]):
        return pattern
    corners = np.column_stack([in_plane(pattern), np.zeros(len(pattern.corners))])
    return replace(pattern, corners=corners)
