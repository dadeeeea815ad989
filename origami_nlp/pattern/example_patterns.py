"""Crease patterns that people know, constructed from their geometry, as FOLD data with springs.

A pattern is a list of faces; an edge of one face only is the border, and a rule gives every other one its letter.
Unit of length: the short side of a cell.  Flat sheets seen from the side to which valleys open.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from origami_nlp.numerics import PLACES
from origami_nlp.pattern.fold_file import REST_KEY, STIFFNESS_KEY
from origami_nlp.pattern.lattice_stated import LATTICE_KEY
from origami_nlp.pattern.polygons import sides_of
from origami_nlp.pattern.scene import Scene

Face = tuple[complex, ...]
"""Corners x + iy."""
Letter = Callable[[complex, complex], str]
"""Letter of the crease between two points x + iy."""
Spring = Callable[[complex, complex], tuple[float, float]]
"""Rest angle [rad] and stiffness [N m/rad] of the crease between two points."""
SprungPattern = Callable[[int, int], tuple[list[Face], Letter, Spring]]
"""A pattern of so many rows and columns that has springs of its own."""


def to_fold(
    faces: Iterable[Face],
    letter: Letter,
    spring: Spring,
    title: str,
    lattice: Sequence[complex] = (),
) -> dict[str, Any]:
    """Return the FOLD data of a pattern.

    Parameters
    ----------
    faces
        Corners of each facet, counter-clockwise.
    letter
        Rule for the creases.
    spring
        Rule for rest angle [rad] and stiffness [N m/rad] of the crease between two points.
    title
        Of the file.
    lattice
        Both vectors by which the faces, a cell, repeat: the border is creases as well.

    Returns
    -------
    dict
        FOLD 1.1, rest angles as fold angles; rest angles and stiffness in our namespace too.
    """
    numbers: dict[tuple[int, int], int] = {}
    coords: list[complex] = []

    def number(z: complex) -> int:
        v = numbers.setdefault(_place(z), len(coords))
        coords.extend([z + 0.0] * (v == len(coords)))
        return v

    rings = [[number(z) for z in face] for face in faces]
    many = {s: len(of) for s, of in sides_of([r[1:] + r[:1] for r in rings]).items()}
    letters, sprung = list[str](), list[tuple[float | None, float | None]]()
    for (a, b), count in many.items():
        crease = count == 2 or bool(lattice)
        letters.append(letter(coords[a], coords[b]) if crease else "B")
        sprung.append(spring(coords[a], coords[b]) if crease else (None, None))
    rest = [None if phi is None else math.degrees(phi) for phi, _ in sprung]
    return {
        "file_spec": 1.1,
        "file_creator": "origami_nlp",
        "file_classes": ["singleModel"],
        "file_title": title,
        "frame_classes": ["creasePattern"],
        "frame_attributes": ["2D"],
        "vertices_coords": [[z.real, z.imag] for z in coords],
        "edges_vertices": [list(edge) for edge in many],
        "edges_assignment": letters,
        "edges_foldAngle": [phi or 0.0 for phi in rest],
        "faces_vertices": rings,
        STIFFNESS_KEY: [k for _, k in sprung],
        REST_KEY: rest,
        **({LATTICE_KEY: [[z.real, z.imag] for z in lattice]} if lattice else {}),
    }


def _place(z: complex) -> tuple[int, int]:
    """Return a point on the grid on which points are the same."""
    return round(z.real / PLACES), round(z.imag / PLACES)


# ---------------------------------------------------------------- patterns: faces, and the rule for letters


def disc(scene: Scene) -> tuple[list[Face], Letter]:
    """One vertex in the middle of a polygon; letters by the signs of the rest angles."""
    a = scene.vertex.azimuths
    rim = [complex(math.cos(v), math.sin(v)) for v in a]
    faces: list[Face] = [(0j, p, q) for p, q in zip(rim, rim[1:] + rim[:1], strict=True)]

    def letter(p: complex, q: complex) -> str:
        tip = p if abs(p) > abs(q) else q
        apart = [abs(c - tip) for c in rim]
        return "V" if scene.rest_angles[int(np.argmin(apart))] > 0 else "M"

    return faces, letter


def miura(alpha: float, rows: int, columns: int) -> tuple[list[Face], Letter]:
    """Parallelograms with acute angle alpha; straight lines along x, zigzags along y."""
    lean = 1 / math.tan(alpha)

    def at(r: int, c: int) -> complex:
        return complex(c + lean * (r % 2), r)

    faces: list[Face] = [
        (at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c))
        for r in range(rows)
        for c in range(columns)
    ]

    def letter(p: complex, q: complex) -> str:
        low = p if (p.imag, p.real) < (q.imag, q.real) else q
        r = round(low.imag)
        c = round(low.real - lean * (r % 2))
        return "MV"[(r + c) % 2] if abs(p.imag - q.imag) < 0.5 else "VM"[c % 2]

    return faces, letter


def waterbomb(rows: int, columns: int) -> tuple[list[Face], Letter]:
    """Squares of side 2 with both diagonals and one midline; every other column is moved by half a square."""
    faces: list[Face] = []
    for i in range(columns):
        for j in range(rows):
            middle = complex(2.0 * i, 2.0 * j + i % 2)
            ring = [middle + z for z in (1 - 1j, 1, 1 + 1j, -1 + 1j, -1, -1 - 1j)]
            faces += [(middle, p, q) for p, q in zip(ring, ring[1:] + ring[:1], strict=True)]

    def letter(p: complex, q: complex) -> str:
        d = q - p
        return "V" if min(abs(d.real), abs(d.imag)) > 0.5 else "M"

    return faces, letter


def yoshimura(alpha: float, rows: int, columns: int) -> tuple[list[Face], Letter]:
    """Isosceles triangles with base 2 and base angles alpha, in rows; bases are valleys."""
    height = math.tan(alpha)

    def at(r: int, c: int) -> complex:
        return complex(2.0 * c + r % 2, height * r)

    faces: list[Face] = []
    for r in range(rows):
        for c in range(columns):
            a, b, d, e = at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c)
            faces += [(a, b, d), (a, d, e)] if r % 2 else [(a, b, e), (b, d, e)]

    def letter(p: complex, q: complex) -> str:
        return "V" if abs((q - p).imag) < height / 2 else "M"

    return faces, letter


def square_twist(alpha: float) -> tuple[list[Face], Letter]:
    """A square, from each side of which a pleat leaves at the angle alpha, a mountain and a valley."""
    corner = [complex(x, y) for x, y in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    turn = complex(math.cos(alpha), -math.sin(alpha))
    out = [1.5 * (corner[(k + 1) % 4] - corner[k]) * turn for k in range(4)]

    faces: list[Face] = [tuple(corner)]
    mountains = []
    for k in range(4):
        here, there, before = corner[k], corner[(k + 1) % 4], out[k - 1]
        faces.append((here, here + out[k], there + out[k], there))
        faces.append((here, here + before, here + out[k]))
        mountains.append({here, here + out[k]})

    def letter(p: complex, q: complex) -> str:
        close = [all(min(abs(z - w) for w in one) < 0.1 for z in (p, q)) for one in mountains]
        return "M" if any(close) else "V"

    return faces, letter


def bird_base() -> tuple[list[Face], Letter]:
    """The base of the crane on a square of side 2: four rabbit ears, petals folded at two opposite corners."""
    corner = [1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j]
    r = 1 - math.tan(math.pi / 8)  # where bisectors of 22.5 degrees meet the midlines
    inner = [r * 1j, complex(-r), r * -1j, complex(r)]  # inner[k] between corners k and k + 1
    middle = 0j
    faces: list[Face] = []
    for k in range(4):
        here, before, c = inner[k], inner[k - 1], corner[k]
        faces.append((here, c, corner[(k + 1) % 4]))
        if k % 2 == 0:
            faces += [(middle, before, here), (before, c, here)]
        else:
            faces += [(middle, before, c), (middle, c, here)]

    def letter(p: complex, q: complex) -> str:
        sizes = sorted((abs(p), abs(q)))
        petal = sizes[0] > 0.1 and sizes[1] < 1.0
        half_diagonal = sizes[0] < 0.1 and sizes[1] > 1.0
        return "V" if petal or half_diagonal else "M"

    return faces, letter


def resch(rows: int, columns: int) -> tuple[list[Face], Letter]:
    """Triangles of side 1 between tucks: triangles of side 2, each cut into six by its three heights.

    Corners of a tuck are the middles of the sides of its neighbours; so triangles and tucks tile the plane.
    """
    e, f = complex(1.0, 0.0), complex(0.5, math.sqrt(0.75))

    def at(x: float, y: float) -> complex:
        return x * e + y * f

    faces: list[Face] = []
    ends: set[tuple[int, int]] = set()
    for m in range(columns):
        for n in range(rows):
            x, y = 3 * (m // 2) + m % 2 - n, m % 2 + 2 * n  # columns to and fro, rows straight up
            rim = [(x, y), (x + 1, y), (x + 2, y), (x + 1, y + 1), (x, y + 2), (x, y + 1)]
            ends |= set(rim)
            centre = at(x + 2 / 3, y + 2 / 3)
            sides = zip(rim, rim[1:] + rim[:1], strict=True)
            faces += [(centre, at(*p), at(*q)) for p, q in sides]
    for x, y in sorted((x - 1, y) for x, y in ends):
        corners = [(x + 1, y), (x + 1, y + 1), (x, y + 1)]
        if (x - y) % 3 and ends.issuperset(corners):  # else it is the middle of a tuck
            faces.append(tuple(at(*c) for c in corners))

    def letter(p: complex, q: complex) -> str:
        return "V" if abs(q - p) > 1.1 else "M"  # from the middle of a tuck to a corner: 2/sqrt(3)

    return faces, letter


def resch_cell(rows: int, columns: int) -> tuple[list[Face], Letter]:
    """The same as a cell that repeats: each triangle of side 2 with two tucks of side 1."""
    e, f = complex(1.0, 0.0), complex(0.5, math.sqrt(0.75))
    one, letter = resch(1, 1)
    # without a tuck that happens to lie between its corners
    one = [*one[:6], *((z + e, z + e + f, z + f) for z in (e, f))]
    moves = [i * (2 * f - e) + j * (e + f) for i in range(rows) for j in range(columns)]
    return [tuple(x + z for x in face) for z in moves for face in one], letter


QUAD = (0.0, 1.0, 1.25 + 0.9j, -0.1 + 0.75j)
"""Corners of the facets of a metasheet; any convex quadrilateral tiles the plane by half-turns about its sides."""
QUAD_LATTICE = QUAD[2] + QUAD[3] - QUAD[0] - QUAD[1], QUAD[1] + QUAD[2] - QUAD[0] - QUAD[3]
"""Up and along: what repeats is two rows and two columns of them."""
QUAD_REST = (-2.163, 1.77, 2.755, 0.121)
QUAD_STIFFNESS = (0.005, 0.4627, 0.1299, 0.0321)
"""Of creases along each side of it: with them a single vertex has three stable states."""


def metasheet(rows: int, columns: int) -> tuple[list[Face], Letter, Spring]:
    """A quadrilateral and its half-turns, in rows: every vertex has its four angles; springs by its sides.

    After Waitukaitis, Menaut, Chen and van Hecke, "Origami multistability", Physical Review Letters 114 (2015) 055503.
    """
    a, b, c, d = QUAD
    up, along = QUAD_LATTICE
    side: dict[tuple[int, int], int] = {}

    def at(i: int, j: int) -> complex:
        return ((a, b), (d, c))[i % 2][j % 2] + (i // 2) * up + (j // 2) * along

    faces: list[Face] = []
    for i in range(rows):
        for j in range(columns):
            ring = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j))
            faces.append(ring)
            odd = (i + j) % 2  # a half-turned one
            for k, z in enumerate(ring):
                side[_place((z + ring[(k + 1) % 4]) / 2)] = (k + 2 * odd) % 4

    def spring(p: complex, q: complex) -> tuple[float, float]:
        # to one unit of the grid, as either corner may be rounded from the other facet
        x, y = _place((p + q) / 2)
        near = [side.get((x + dx, y + dy)) for dx in (0, -1, 1) for dy in (0, -1, 1)]
        k = next(one for one in near if one is not None)
        return QUAD_REST[k], QUAD_STIFFNESS[k]

    def letter(p: complex, q: complex) -> str:
        return "M" if spring(p, q)[0] < 0 else "V"

    return faces, letter, spring


UNITS: dict[str, Callable[[float], tuple[tuple[int, int], tuple[complex, complex]]]] = {
    "miura": lambda a: ((2, 2), (2j, 2 + 0j)),
    "waterbomb": lambda a: ((1, 2), (2j, 4 + 0j)),
    "yoshimura": lambda a: ((2, 1), (2j * math.tan(a), 2 + 0j)),
    "resch": lambda a: ((1, 1), (math.sqrt(3) * 1j, 1.5 + math.sqrt(0.75) * 1j)),
    "metasheet": lambda a: ((2, 2), QUAD_LATTICE),
}
"""What repeats in a pattern: rows and columns as its function counts them; vectors up and along, by an angle."""


def sheet_to_fold(
    name: str, scene: Scene | SprungPattern, rows: int, columns: int, *, cell: bool
) -> dict[str, Any]:
    """Return the FOLD data of an example.

    Parameters
    ----------
    name
        Of the example.
    scene
        Its springs and angles, or what makes it with its springs.
    rows, columns
        Its size.
    cell
        Whether the size is that of a cell that repeats, in rows and columns of what repeats.

    Returns
    -------
    dict
        As `to_fold`.
    """
    lattice: tuple[complex, ...] = ()
    size = rows, columns
    sectors = scene.vertex.sector_angles if isinstance(scene, Scene) else (0.0,) * 4
    if cell:
        unit, (up, along) = UNITS[name](sectors[0])
        lattice = columns * along, rows * up
        size = rows * unit[0], columns * unit[1]
    if not isinstance(scene, Scene):
        return to_fold(*scene(*size), name, lattice)
    faces, letter = {
        "miura": lambda: miura(sectors[0], *size),
        "waterbomb": lambda: waterbomb(*size),
        "birdbase": bird_base,
        "squaretwist": lambda: square_twist(sectors[3]),
        "yoshimura": lambda: yoshimura(sectors[0], *size),
        "resch": lambda: (resch_cell if cell else resch)(*size),
    }.get(name, lambda: disc(scene))()
    each = zip(scene.rest_angles, scene.stiffness, strict=True)
    of = {"V" if rest > 0 else "M": (rest, k) for rest, k in each}
    return to_fold(faces, letter, lambda p, q: of[letter(p, q)], scene.label, lattice)
