"""A crease pattern that repeats: one cell, and two lattice vectors by which its copies are moved.

Corners and sides of the cell that are a lattice vector apart are one: corners on its outline become interior vertices,
opposite sides one crease.  Two more closed walks generate all others, from a facet to its copy along either lattice
vector: of a folded sheet that is flat on the large scale they turn nothing (the product of the folds is the identity),
and their translations are the lattice vectors of the folded state.  Where all vertices close both motions commute, so
that they are screws about one axis else: left free, copies curl; p times one and q times the other, one after the
other, are the identity of a tube that is closed once round.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy as sp

from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import INPUT_TOL, PLACES, groups
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.lattice_stated import LATTICE_KEY, ROLLED_KEY
from origami_nlp.pattern.polygons import Loop, Side, area, side
from origami_nlp.pattern.sheet import Pattern, make_pattern, of_creases

SMALL = 12
"""Polygons of a cell up to which two rings of copies are looked at; one of larger cells."""
Copy = tuple[int, int]
"""Of a cell: how often either lattice vector is added."""
Key = tuple[int, int, int, int]
"""Of a side with its sense: classes of both corners, and the lattice vectors between them."""


@dataclass(frozen=True, eq=False, repr=False)
class Cell:
    """How a cell repeats.

    Attributes
    ----------
    lattice
        Both vectors in the reference state, [2, 3].
    corners
        Of the cell, [V, 3].
    polygons
        Of the cell.
    class_of
        Corners that are lattice vectors apart have one number, [V].
    offset
        Lattice vectors from the first corner of its class to each, [V, 2].
    joins
        Sides across which two polygons are one facet.
    crease
        Number of the crease of each side with its sense, by its key.
    letters
        One a crease.
    rolled
        Copies along either vector that lead once round a tube, the first positive; (0, 0): copies may curl; None: they
        stay in a plane.
    walks
        From a facet to its copy along either lattice vector.

    Examples
    --------
    >>> import origami_nlp as o
    >>> cell = o.examples.pattern("miura", 1, 1, cell=True).cell
    >>> cell.lattice.round(3).tolist(), cell.lay([(0, 0), (0, 1)])[0].facets
    ([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], 8)
    """

    lattice: np.ndarray
    corners: np.ndarray
    polygons: tuple[tuple[int, ...], ...]
    class_of: np.ndarray
    offset: np.ndarray
    joins: tuple[Side, ...]
    crease: dict[Key, int] = field(default_factory=dict)
    letters: str = ""
    rolled: Copy | None = None
    walks: tuple[Loop, ...] = ()

    @property
    def tube(self) -> Copy | None:
        """Copies once round; None where it is no tube."""
        return self.rolled if self.rolled and any(self.rolled) else None

    def around(self, copy: Copy) -> Copy:
        """Return the same copy of a tube with the least number of turns round it, a half at most."""
        if self.tube is None:
            return copy
        (i, j), (p, q) = copy, self.tube
        # along the tube's vector, half of it to either side; whole numbers
        turns = -((p * p + q * q - 2 * (i * p + j * q)) // (2 * (p * p + q * q)))
        return i - turns * p, j - turns * q

    def key(self, a: int, b: int) -> Key:
        """Return the key of the side of the cell from corner a to corner b."""
        i, j = (self.offset[b] - self.offset[a]).tolist()
        return int(self.class_of[a]), int(self.class_of[b]), i, j

    def lay(self, copies: Iterable[Copy]) -> tuple[Pattern, np.ndarray]:
        """Lay copies of the cell beside each other, as an open sheet.

        Parameters
        ----------
        copies
            Which; the corners of (0, 0) keep their numbers.

        Returns
        -------
        sheet : Pattern
            The copies one after the other, without springs.
        crease_of : numpy.ndarray
            Which crease of the cell each of its creases is a copy of, [creases of the sheet].
        """
        number: dict[tuple[int, int, int], int] = {}
        corners, polygons, joins = list[np.ndarray](), list[tuple[int, ...]](), list[Side]()
        every = list(copies)
        # corners of the cell itself come first, and facets by copies
        places = {}
        for copy in sorted(every, key=lambda c: c != (0, 0)):
            here = places[copy] = list[int]()
            for v, x in enumerate(self.corners):
                at = (int(self.class_of[v]), *(self.offset[v] + copy).tolist())
                if at not in number:
                    number[at] = len(corners)
                    corners.append(x + np.array(copy) @ self.lattice)
                here.append(number[at])
        for copy in every:
            here = places[copy]
            polygons += [tuple(here[v] for v in polygon) for polygon in self.polygons]
            joins += [side(here[a], here[b]) for a, b in self.joins]
        found = list(number)
        letters, crease_of = {}, {}
        for polygon in polygons:
            for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                (p, i, j), (q, k, m) = found[a], found[b]
                if (crease := self.crease.get((p, q, k - i, m - j))) is not None:
                    crease_of[side(a, b)] = crease
                    letters[side(a, b)] = self.letters[crease]
        sheet = make_pattern(
            np.array(corners), polygons, assignment=letters, joins=joins, numbers=crease_of
        )
        return sheet, np.array([crease_of[a, b] for a, b in sheet.ends.tolist()], int)

    @property
    def _rings(self) -> int:
        return 2 if len(self.polygons) <= SMALL else 1

    @cached_property
    def copies(self) -> tuple[Copy, ...]:
        """Those of `sheet`, in order: one that is ahead of another is so by the same lattice vectors anywhere."""
        rings = range(-self._rings, self._rings + 1)
        every = ((i, j) for i in rings for j in rings)
        return tuple(copy for copy in every if copy == self.around(copy))

    @property
    def home(self) -> int:
        """Number in `copies` of the cell itself."""
        return self.copies.index((0, 0))

    @cached_property
    def _laid(self) -> tuple[Pattern, np.ndarray]:
        return self.lay(self.copies)

    @cached_property
    def tiles(self) -> tuple[Pattern, np.ndarray]:
        """Two by two copies, or once round a tube, as an open sheet for pictures, and which crease each crease is."""
        if self.tube is None:
            return self.lay([(0, 0), (1, 0), (0, 1), (1, 1)])
        p, q = self.tube
        most = p + abs(q)
        every = ((i, j) for j in range(-most, most + 1) for i in range(-most, most + 1))
        band = 2 * max(p, abs(q))
        return self.lay(c for c in every if c == self.around(c) and 0 <= p * c[1] - q * c[0] < band)

    @property
    def sheet(self) -> Pattern:
        """The cell amid its neighbours, as an open sheet."""
        return self._laid[0]

    @property
    def crease_of(self) -> np.ndarray:
        """Which crease of the cell each crease of `sheet` is."""
        return self._laid[1]

    @cached_property
    def copy_of(self) -> np.ndarray:
        """Number in `copies` of each polygon of `sheet`, [P]."""
        return np.repeat(np.arange(len(self.copies)), len(self.polygons))


def make_cell(
    corners: np.ndarray,
    polygons: Sequence[Sequence[int]],
    lattice: Sequence[Sequence[float]] | np.ndarray,
    *,
    joins: Sequence[Side] = (),
    numbers: dict[Side, int] | None = None,
    name: str = "",
    notes: Sequence[str] = (),
    orders: Sequence[tuple[int, int, int]] = (),
    rolled: Copy | None = None,
    **of_sides: Any,
) -> Pattern:
    """Build the pattern of a cell that repeats from polygons that share sides, those of its copies among them.

    Parameters
    ----------
    corners
        Points of the flat sheet, [V, 2] or [V, 3].
    polygons
        Corners of each, all counter-clockwise; together they fill a cell of the lattice.
    lattice
        Both lattice vectors, [2, 2] or [2, 3].
    joins, numbers, name, notes, orders, of_sides
        As for `make_pattern`; of two sides that are one crease one may be left out.
    rolled
        Copies along either vector that lead once round a tube, as `check_rolled` returns them.

    Returns
    -------
    Pattern
        Its creases are those of a cell, each once; it has `generators`, or a hole where it is a tube.

    Raises
    ------
    FoldFileError
        If the sheet is not flat, the lattice vectors span nothing, sides have no counterpart, or two that are one
        crease are stated differently; and as `make_pattern`.

    Examples
    --------
    >>> from origami_nlp.pattern import make_cell
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> make_cell(square, [(0, 1, 2, 3)], [[1, 0], [0, 1]])
    Pattern('': cell of 1 facets, 2 creases, 1 vertices)
    """
    alone = make_pattern(corners, polygons, joins=joins, numbers=numbers, **of_sides)
    if not alone.is_flat or np.ptp(alone.corners[:, 2]):
        raise FoldFileError(f"{LATTICE_KEY}: state a cell as a flat crease pattern")
    if alone.holes:
        raise FoldFileError(f"{LATTICE_KEY}: a cell with holes is not modelled")
    if orders:
        raise FoldFileError(f"{LATTICE_KEY}: faceOrders of a cell are not modelled: leave them out")
    rules = _lattice(lattice, alone)
    cell = _identified(alone, rules, joins)
    facing = _facing(cell)
    given = numbers or {}
    stated = {name: dict(values) for name, values in of_sides.items() if isinstance(values, dict)}
    together = {side(*s) for s in joins}
    drawn: dict[Key, list[Side]] = {}
    for key, (_, (a, b)) in facing.items():
        if (ends := side(a, b)) not in (known := drawn.setdefault(min(key, _back(key)), [])):
            known.append(ends)
    for ends in (s for some in drawn.values() if len(some) > 1 for s in some if s in together):
        raise FoldFileError(f"side {ends} joins facets of two cells: cut the cell along creases")
    first = {
        key: min(some, key=lambda s: (given.get(s, math.inf), s))
        for key, some in drawn.items()
        if some[0] not in together
    }
    order = sorted(first, key=lambda key: (given.get(first[key], -1), first[key]))
    values = {what: _agreed(what, of, drawn, first) for what, of in stated.items()}
    crease = {}
    for k, key in enumerate(order):
        crease[key] = crease[_back(key)] = k
    sides = [first[key] for key in order]
    stops = values.pop("limits", None)
    scalars = {what: of_sides[what] for what in of_sides.keys() - values.keys() - {"limits"}}
    arrays = of_creases(sides, scalars | values | {"numbers": given})
    arrays["assignment"] = arrays["assignment"].replace("B", "U")
    cell = replace(cell, crease=crease, letters=arrays["assignment"], rolled=rolled)
    facet = alone.facet_of
    # springs of a pattern with these creases, checked and completed as any other's
    whole = replace(
        alone,
        corners=cell.corners,
        left=np.array([facet[facing[cell.key(a, b)][0]] for a, b in sides], int),
        right=np.array([facet[facing[cell.key(b, a)][0]] for a, b in sides], int),
        name=name,
        notes=tuple(notes),
        limits=(),
        cell=cell,
        **arrays,
    )
    vertices, walks = _walks(whole, cell)
    cell = replace(cell, walks=walks)
    holes = (_once_round(cell, cell.tube),) if cell.tube else ()
    generators = walks if rolled is None else ()
    whole = replace(whole, cell=cell, vertices=vertices, generators=generators, holes=holes)
    whole = whole.with_springs(whole.stiffness.tolist())
    return whole.with_limits([stops[s] for s in sides]) if stops else whole


def make_sheet(
    corners: np.ndarray,
    polygons: Sequence[Sequence[int]],
    lattice: np.ndarray | Sequence[Sequence[float]] | None,
    rolled: Copy | None,
    laws: Mapping[Side, HingeLaw | None] | None,
    **stated: Any,
) -> Pattern:
    """Build a pattern, or a cell where there is a lattice, with hinge laws by the sides that have one."""
    made = (
        make_pattern(corners, polygons, **stated)
        if lattice is None
        else make_cell(corners, polygons, lattice, rolled=rolled, **stated)
    )
    of = {frozenset(ends): law for ends, law in (laws or {}).items()}
    return made.with_laws([of.get(frozenset(s)) for s in made.ends.tolist()]) if of else made


def _back(key: Key) -> Key:
    """Return the key of the same side in the other sense."""
    a, b, i, j = key
    return b, a, -i, -j


def _lattice(lattice: Sequence[Sequence[float]] | np.ndarray, alone: Pattern) -> np.ndarray:
    """Return the lattice vectors [2, 3] that fit the area of the facets."""
    rules = np.zeros((2, 3))
    given = np.asarray(lattice, float)
    rules[:, : given.shape[1]] = given
    if rules[:, 2].any():
        raise FoldFileError(f"{LATTICE_KEY}: vectors of a flat sheet have no third component")
    span = abs(float(np.linalg.det(rules[:, :2])))
    if not span > INPUT_TOL * float((rules**2).sum()):
        raise FoldFileError(f"{LATTICE_KEY}: give two vectors that are not on one line")
    covered = sum(area(alone.corners[list(polygon), :2]) for polygon in alone.polygons)
    if abs(covered - span) > PLACES * span:
        areas = f"the vectors span an area of {span:.6g}, the facets {covered:.6g}"
        raise FoldFileError(f"{LATTICE_KEY}: {areas}: give the facets of one cell, each once")
    return rules


def _identified(alone: Pattern, rules: np.ndarray, joins: Sequence[Side]) -> Cell:
    """Find corners that are lattice vectors apart, and move them until they are so exactly."""
    x = alone.corners
    share = np.linalg.solve(rules[:, :2].T, (x[:, :2] - x[0, :2]).T).T
    near = PLACES * float(np.ptp(x, axis=0).max()) / float(np.linalg.norm(rules, axis=1).min())
    inside = np.mod(share, 1.0)
    inside[inside >= 1.0] = 0.0
    pairs = sp.spatial.cKDTree(inside, boxsize=1.0).query_pairs(near, output_type="ndarray")
    class_of = groups(len(x), pairs)
    _, first = np.unique(class_of, return_index=True)
    offset = np.round(share - share[first[class_of]]).astype(int)
    exact = x[first[class_of]] + offset @ rules
    return Cell(rules, exact, alone.polygons, class_of, offset, tuple(side(*s) for s in joins))


def _facing(cell: Cell) -> dict[Key, tuple[int, Side]]:
    """Return the polygon to the left of each side, of the cell or of a copy, each by its class, and its corners."""
    facing: dict[Key, tuple[int, Side]] = {}
    for p, polygon in enumerate(cell.polygons):
        for a, b in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            if cell.key(a, b) in facing:
                raise FoldFileError(f"{LATTICE_KEY}: facets of two copies overlap at side {a}-{b}")
            facing[cell.key(a, b)] = p, (a, b)
    for key, (_, (a, b)) in facing.items():
        if _back(key) not in facing:
            why = f"side {a}-{b} of the outline has no counterpart a lattice vector away"
            raise FoldFileError(f"{LATTICE_KEY}: {why}: give both the same vertices")
    return facing


def _agreed(
    what: str, of: dict[Side, Any], drawn: dict[Key, list[Side]], first: dict[Key, Side]
) -> dict[Side, Any]:
    """Return the value of each crease, by its first side, of sides that must not differ."""
    found = {}
    for key, ends in first.items():
        stated = [(s, of[s]) for s in drawn[key] if s in of and of[s] != "B"]
        stated = [(s, v) for s, v in stated if v == v]  # nan: not given
        for one, value in stated[:1]:
            found[ends] = value
            for other, also in stated[1:]:
                text = isinstance(value, str)
                if not (also == value if text else np.allclose(also, value, atol=PLACES)):
                    said = f"{what.replace('_', ' ')} {value} and {also}"
                    raise FoldFileError(
                        f"sides {one} and {other} are one crease: {said}, state one"
                    )
    return found


def _walks(whole: Pattern, cell: Cell) -> tuple[tuple[Loop, ...], tuple[Loop, ...]]:
    """Return the loops round the vertices of a cell, and the walks from a facet to its copies."""
    sheet, crease_of = cell.sheet, cell.crease_of
    with_sense = np.einsum("ki,ki->k", sheet.directions, whole.directions[crease_of])
    sense = np.sign(with_sense).astype(int)

    def walk(creases: Iterable[int], signs: Iterable[int], vertex: int) -> Loop:
        both = list(zip(creases, signs, strict=True))
        shifts = tuple(_shift(whole, cell, c) for c, _ in both) if vertex < 0 else ()
        of = tuple(int(crease_of[c]) for c, _ in both)
        return Loop(of, tuple(int(s * sense[c]) for c, s in both), vertex, shifts)

    _, first = np.unique(cell.class_of, return_index=True)
    around = {loop.vertex: loop for loop in sheet.vertices}
    if not set(first.tolist()) <= around.keys():
        more = f", or give {ROLLED_KEY} more copies" * bool(cell.tube)
        raise FoldFileError(f"{LATTICE_KEY}: the cell meets itself: cut it more compact{more}")
    vertices = [walk(around[v].creases, around[v].signs, v) for v in first.tolist()]
    many = len(cell.polygons)
    generators = []
    for way in ((1, 0), (0, 1)):
        end = int(sheet.facet_of[many * cell.copies.index(way)])
        steps = _path(sheet, int(sheet.facet_of[many * cell.home]), end)
        generators.append(walk([c for c, _ in steps], [s for _, s in steps], -1))
    return tuple(vertices), tuple(generators)


def _once_round(cell: Cell, tube: Copy) -> Loop:
    """Return the walk along p copies of the first vector, then q of the second."""
    steps: list[tuple[int, int, Copy]] = []
    at = [0, 0]
    for way, many in enumerate(tube):
        loop = cell.walks[way]
        one = list(zip(loop.creases, loop.signs, loop.shifts, strict=True))
        for _ in range(abs(many)):
            at[way] -= many < 0
            turn = one if many > 0 else [(c, -s, shift) for c, s, shift in reversed(one)]
            steps += [(c, s, (i + at[0], j + at[1])) for c, s, (i, j) in turn]
            at[way] += many > 0
    creases, signs, shifts = zip(*steps, strict=True)
    moved = (np.array(tube) @ cell.lattice).tolist()
    return Loop(creases, signs, -1, shifts, tuple(moved))


def _path(sheet: Pattern, start: int, end: int) -> list[tuple[int, int]]:
    """Return the creases of a shortest walk between facets, +1 where it crosses from the right to the left."""
    across = {(a, b): (c, -1) for c, (a, b) in enumerate(zip(sheet.left, sheet.right, strict=True))}
    across |= {(b, a): (c, 1) for (a, b), (c, _) in across.items()}
    rows, columns = np.array(list(across)).T
    graph = sp.sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=(sheet.facets,) * 2)
    _, before = sp.sparse.csgraph.breadth_first_order(graph, start, directed=False)
    steps = []
    while end != start:
        steps.append(across[int(before[end]), end])
        end = int(before[end])
    return steps[::-1]


def _shift(whole: Pattern, cell: Cell, crease: int) -> Copy:
    """Return by how many lattice vectors a crease of the sheet is moved from the cell's own."""
    sheet, k = cell.sheet, int(cell.crease_of[crease])
    away = sheet.corners[sheet.ends[crease]].sum(axis=0) - whole.corners[whole.ends[k]].sum(axis=0)
    i, j = np.round(np.linalg.solve(cell.lattice[:, :2].T, 0.5 * away[:2])).astype(int).tolist()
    return i, j
