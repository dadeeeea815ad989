"""Which rotations and mirrors of the flat sheet map creases, stiffness, rest angles, preload and limits to themselves.

The point group of a vertex is C_n or D_n (paper, section 2, "Scope of symmetry reductions").  From
a group follow the orbits of creases, which are the independent fold angles, and, for D_n, a wedge
between two neighbouring mirrors, whose rays may be creases or run through the middle of a facet.

States may wind round the axis of their symmetry more than once (`windings_of`).  The product T of the folds of
a period of C_n, or of two wedges of D_n, is repeated n times round the vertex, and the whole is a sheet of paper where
T^n = -1: T turns by w 2 pi/n, w odd, w <= n.  States of another w are on no path from those of this one: T^n = -1 has
no others in between.  Facets that must not cross leave w = 1 (docs/concepts.md).
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.arguments import check_whole, shown
from origami_nlp.errors import SceneError, SymmetryError
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import INPUT_TOL, RESOLVED, quaternion
from origami_nlp.pattern.vertex import Vertex

Elements = tuple[tuple[int, bool], ...]
"""Symmetries as (s, mirrored): crease i (0-based) goes to i + s, or to s - i if mirrored."""


@dataclass(frozen=True)
class Ray:
    """A direction of the flat sheet at the boundary of, or inside, the modelled piece.

    crease: 0-based crease on the ray, or None where a mirror runs through a facet.
    sector: angle [rad] from this ray to the next one of the piece.
    """

    crease: int | None
    sector: float


@dataclass(frozen=True, repr=False)
class Symmetry(ShortRepr):
    """A point group and the piece of the vertex that generates the rest.

    Attributes
    ----------
    kind
        ``"C"`` or ``"D"``; C with order 1 is no symmetry.
    order
        n of C_n or D_n.
    rays
        The piece, counter-clockwise.  For D_n the rays of a wedge of angle pi/n, both mirror rays
        included; for C_n the creases of one period of angle 2 pi/n (more or less in the unrolled sheet of a
        vertex that is not flat).
    orbit
        For each crease, the position in `rays` of the crease that it is an image of.
    elements
        Every element as (s, mirrored): it sends crease i (0-based) to i + s, or to s - i if mirrored.
    """

    kind: str
    order: int
    rays: tuple[Ray, ...]
    orbit: tuple[int, ...]
    elements: Elements = ((0, False),)

    @property
    def name(self) -> str:
        """``"none"``, ``"C2"``, ``"D1"`` and so on."""
        return "none" if self.is_trivial else f"{self.kind}{self.order}"

    @property
    def is_trivial(self) -> bool:
        """Whether the group is only the identity."""
        return self.kind == "C" and self.order == 1


def find_symmetry(
    vertex: Vertex,
    stiffness: Sequence[float],
    rest_angles: Sequence[Any],
    wanted: str = "auto",
    mirror: int | None = None,
    tolerance: float = INPUT_TOL,
) -> Symmetry:
    """Find the piece of the vertex for the symmetry `wanted`, or for the largest one (``"auto"``).

    rest_angles: [N], or rows of angles, [..., N], all of which must agree.

    Raises
    ------
    SymmetryError
        If `wanted` is no group, or geometry and mechanics do not share it.
    """
    shifts, mirrors = shared_symmetries(vertex, stiffness, rest_angles, tolerance)
    kind, order = _parse(wanted)
    if kind == "auto":
        kind, order = ("D", len(shifts)) if mirrors else ("C", len(shifts))
    if len(shifts) % order or (kind == "D" and not mirrors):
        largest = f"{'D' if mirrors else 'C'}{len(shifts)}"
        by = f"by springs, preload and fold limits: the largest common group is {largest}"
        raise SymmetryError(f"symmetry = {shown(wanted)} is not shared {by}")
    if kind == "D":
        return _wedge(vertex, order, mirrors, mirror, tolerance)
    if mirror is not None:
        raise SymmetryError(f"mirror = {shown(mirror)} is for symmetry = 'D<n>' alone")
    return _period(vertex, order)


def shared_symmetries(
    vertex: Vertex,
    stiffness: Sequence[float],
    rest_angles: Sequence[Any],
    tolerance: float = INPUT_TOL,
) -> tuple[list[int], list[int]]:
    """Find all rotations and mirrors that geometry and mechanics share within `tolerance`.

    Returns
    -------
    shifts
        s such that crease i -> i + s is a rotation of the sheet.
    mirrors
        s such that crease i -> s - i (0-based, modulo N) is a reflection.
    """
    n = vertex.degree
    a, k = np.array(vertex.sector_angles), np.array(stiffness)
    rest, i = np.array(rest_angles, dtype=float), np.arange(n)

    def alike(facets: np.ndarray, creases: np.ndarray) -> bool:
        f, c = facets % n, creases % n
        return bool(
            np.all(np.abs(a[f] - a) <= tolerance)
            and np.all(np.abs(k[c] - k) <= tolerance * np.maximum(k[c], k))
            and np.all(np.abs(rest[..., c] - rest) <= tolerance)
        )

    near = {s for s in range(n) if alike(i + s, i + s)}
    # those that are a group: multiples of a divisor of n, all of them within the tolerance
    step = next(g for g in range(1, n + 1) if n % g == 0 and near.issuperset(range(0, n, g)))
    return list(range(0, n, step)), [s for s in range(n) if alike(s - i - 1, s - i)]


def averaged(values: Sequence[float], elements: Elements, *, facets: bool) -> tuple[float, ...]:
    """Average values of creases (or of facets, facet i from crease i on) over the elements of a group."""
    v, n = np.array(values), len(values)
    i = np.arange(n)
    images = [v[((s - i - facets) if mirrored else (i + s)) % n] for s, mirrored in elements]
    return tuple(np.mean(images, axis=0).tolist())


def _parse(wanted: object) -> tuple[str, int]:
    match = re.fullmatch(r"([CD])([1-9]\d{0,5})", wanted) if isinstance(wanted, str) else None
    if isinstance(wanted, str) and wanted in ("auto", "none"):
        return {"auto": ("auto", 0), "none": ("C", 1)}[wanted]
    if match is None:
        raise SymmetryError(f"symmetry = {shown(wanted)} is unknown: use none, auto, C<n> or D<n>")
    return match[1], int(match[2])


def _made(kind: str, order: int, n: int, rays: Sequence[Ray], elements: Elements) -> Symmetry:
    """Return a group; of each crease the ray whose crease is one of its images."""
    place = {ray.crease: r for r, ray in enumerate(rays)}
    images = [
        [((s - i) if mirrored else (i + s)) % n for s, mirrored in elements] for i in range(n)
    ]
    orbit = tuple(next(place[j] for j in own if j in place) for own in images)
    return Symmetry(kind, order, tuple(rays), orbit, tuple(elements))


def _period(vertex: Vertex, order: int) -> Symmetry:
    period = vertex.degree // order
    rays = [Ray(i, vertex.sector_angles[i]) for i in range(period)]
    rotations = tuple((m * period, False) for m in range(order))
    return _made("C", order, vertex.degree, rays, rotations)


def _wedge(
    vertex: Vertex, order: int, mirrors: list[int], mirror: int | None, tolerance: float
) -> Symmetry:
    """Cut the wedge of D_order that starts at the wanted mirror."""
    n = vertex.degree
    step = n // order  # the rotations of the wanted group shift creases by multiples of `step`
    if mirror is not None:
        check_whole("mirror, a crease,", mirror, 1, n, SymmetryError)
        start = 2 * (mirror - 1) % n
        if start not in mirrors:
            raise SymmetryError(f"mirror = {mirror}: no shared mirror runs through this crease")
    else:
        # i -> s - i fixes crease s/2; prefer a mirror through the crease of lowest number
        def lowest(s: int) -> int:
            fixed = [j for j in range(n) if (2 * j - s) % n == 0]
            return min(fixed) if fixed else n + s

        start = min(mirrors, key=lowest)
    # The mirrors of D_order are s = start + m step.  In doubled position (crease j at 2j, middle of
    # facet j at 2j + 1) mirror s lies at s modulo n, so the wedge runs from `start` to `start + step`.
    first = next((p for p in (start, start + n) if p % 2 == 0), start)
    last = first + step
    a = vertex.sector_angles
    rays = []
    for p in range(first, last + 1):
        if p % 2 == 0 or p in (first, last):
            # half facets to the next ray: 2, or 1 to or from a mirror within a facet
            halves = min(2 - p % 2, last - p)
            rays.append(Ray(None if p % 2 else p // 2 % n, halves * a[p // 2 % n] / 2))
    total = math.fsum(ray.sector for ray in rays)
    whole = math.fsum(a)  # 2 pi unless the vertex is not flat
    assert abs(total - whole / (2 * order)) <= max(RESOLVED, n * tolerance), "wedge angle"
    elements = [(m * step, False) for m in range(order)]
    elements += [((start + m * step) % n, True) for m in range(order)]
    return _made("D", order, n, rays, tuple(elements))


def windings_of(group: Symmetry, contact: str) -> tuple[int, ...]:
    """List how often states may wind.

    Parameters
    ----------
    group
        Which they keep.
    contact
        As of a `Scene`.

    Returns
    -------
    tuple of int
        Odd numbers up to the order of the group; 1 alone where facets do not cross.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> star = Vertex(("pi/4",) * 8)
    >>> [Scene(star, (1, 2) * 4, (1,) * 8, "D4", contact).windings for contact in ("full", "fold-limits")]
    [(1,), (1, 3)]
    """
    return tuple(range(1, 2 if contact == "full" else group.order + 1, 2))


def winding_number(vertex: Vertex, group: Symmetry, fold_angles: np.ndarray) -> int:
    """Return how often a closed state winds round the axis of a group that it keeps.

    Parameters
    ----------
    vertex, group
        The vertex, and a group of it.
    fold_angles
        Of the state, [N] [rad].

    Returns
    -------
    int
        From the turn of one period; 1 without rotations.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import winding_number
    >>> scene = o.examples.degree8("pi/4")
    >>> winding_number(scene.vertex, scene.group, [0.0] * 8)
    1
    """
    if group.order == 1:
        return 1
    q: tuple[float, ...] = quaternion.IDENTITY
    for i in range(vertex.degree // group.order):
        fold, sector = 0.5 * float(fold_angles[i]), 0.5 * vertex.sector_angles[i]
        q = quaternion.multiply(q, (math.cos(fold), math.sin(fold), 0.0, 0.0))
        q = quaternion.multiply(q, (math.cos(sector), 0.0, 0.0, math.sin(sector)))
    return round(group.order * math.acos(max(-1.0, min(1.0, q[0]))) / math.pi)


def check_winding(winding: object, group: Symmetry, contact: str) -> None:
    """Raise an error for a winding, where one is asked for, that states cannot have.

    Raises
    ------
    SceneError
        With the value, and what it may be.
    """
    known = windings_of(group, contact)
    if winding is not None and (isinstance(winding, bool) or winding not in known):
        which = f"{', '.join(map(str, known))}: symmetry {group.name}, contact = {contact!r}"
        raise SceneError(f"winding = {shown(winding)} must be one of {which}")
