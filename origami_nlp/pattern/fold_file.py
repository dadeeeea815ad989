"""FOLD 1.x files: read as data, every frame in full, with a diagnosis of what is odd in them.

A FOLD file holds a crease pattern or a folded form: vertices, edges with assignment (M, V, B, F, U, C, J),
fold angles in degrees, valley positive.  We also read ``edges_origaminlp:stiffness`` [N m/rad] and
``edges_origaminlp:restAngle`` [deg], ``edges_origaminlp:preload`` [N m], ``edges_origaminlp:limits`` [deg] (FOLD lets
programs add keys with a namespace).  Vertices, edges and frames are numbered from 0, as in the file.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.drawings import (
    ERROR_KEY,
    DrawingOptions,
    drawing_kind,
    drawing_to_fold,
    read_drawing,
)
from origami_nlp.errors import FoldFileError, OrigamiError
from origami_nlp.io import parse_json, printable, read_limited
from origami_nlp.numerics import INPUT_TOL, last_place
from origami_nlp.pattern.fold_limits import limit_angles, read_limits
from origami_nlp.pattern.fold_notes import compare_signs, flattened, listed, note_small, once
from origami_nlp.pattern.hinges_stated import LAW_KEY, LAWS_KEY, Laws, edge_laws
from origami_nlp.pattern.lattice_stated import LATTICE_KEY, ROLLED_KEY, check_rolled
from origami_nlp.pattern.polygons import sides_of

LARGEST = 50_000_000
"""Bytes; the largest published crease patterns are a few MB."""
MOST_ELEMENTS = 2_000_000
"""Vertices and edges of all frames together, those that they inherit included, where all are read."""
STIFFNESS_KEY = "edges_origaminlp:stiffness"
REST_KEY, LIMITS_KEY = "edges_origaminlp:restAngle", "edges_origaminlp:limits"
PRELOAD_KEY = "edges_origaminlp:preload"
LOADS_KEY, FIXED_KEY = "origaminlp:loads", "origaminlp:fixedFacet"
FOLDS = "MVUF"
"""Assignments of edges about which the sheet may fold (F: flat, joined again unless facets need it)."""
_ANGLE = -180.0 * (1 + INPUT_TOL), 180.0 * (1 + INPUT_TOL)
_EDGE_NUMBERS = {
    "edges_foldAngle": _ANGLE,
    REST_KEY: _ANGLE,
    STIFFNESS_KEY: (math.ulp(0.0), math.inf),
    PRELOAD_KEY: (-math.inf, math.inf),
}
"""Least and largest of each number of edges."""
_LEGACY = {"edges_foldAngles": "edges_foldAngle", "edges_assignments": "edges_assignment"}
_READ = (
    *"vertices_coords edges_vertices faces_vertices faceOrders edges_assignment edges_foldAngle".split(),
    *(*_LEGACY, STIFFNESS_KEY, REST_KEY, PRELOAD_KEY, LIMITS_KEY, LOADS_KEY, FIXED_KEY, ERROR_KEY),
    *f"{LAW_KEY} {LAWS_KEY} {LATTICE_KEY} {ROLLED_KEY} frame_classes frame_unit frame_title file_title".split(),
)


@dataclass(frozen=True)
class Frame:
    """One frame of a FOLD file, inherited keys included.

    Attributes
    ----------
    number
        0 for the file itself, then its ``file_frames``.
    title
        Of the frame, or of the file.
    coords
        [V, 3]; a flat crease pattern lies in the plane z = 0, seen from the side where valleys open.
    folded
        Whether the coordinates are those of a folded form.
    edges
        [E, 2] vertices, each pair once.
    numbers
        [E] numbers of the edges in the file.
    assignment
        One letter an edge, ``?`` where none is given.
    fold_angles, rest_angles
        [E] [rad]; NaN where not given.
    stiffness
        [E] [N m/rad]; NaN where not given.
    preload
        [E] torque [N m] beside that of the rest angle; NaN where not given.
    faces
        Vertices of each face; empty where none are given.
    face_orders
        (f, g, s): face f lies on the side of the normal of face g (s = 1), or on the other (s = -1).
    conflicts
        Edges (positions in `edges`) that the file states twice in different ways.
    notes
        What is odd in the frame, one line each.
    unit
        The last decimal place of the coordinates in the file, or ``origaminlp:coordinateError`` where that is larger; 0
        where they are whole doubles.
    loads, fixed_facet
        Forces on its one vertex, each a table as in a scene file, and the facet that is fixed; as the file states them.
    source
        What was read, as it was typed.
    length_unit
        ``frame_unit``: of the coordinates; "" where the file states none.
    y_down
        Whether the file's own y points down: places are named as they are in the file.
    error
        ``origaminlp:coordinateError``: how far vertices may be off; 0 where the file does not say.
    lattice
        ``origaminlp:lattice``: vectors by which the frame, a cell, repeats, [2, 2] or [2, 3]; None where it does not.
    rolled
        ``origaminlp:rolled``: copies of a cell once round a tube; (0, 0): they may curl; None: they stay in a plane.
    limits
        Fold limits (low, high), [E, 2] [rad], +-pi where not given; None where the file gives none.
    laws
        Hinge law of each edge, None for a linear spring; () where the file gives none.
    """

    number: int
    title: str
    coords: np.ndarray = field(repr=False)
    folded: bool
    edges: np.ndarray = field(repr=False)
    numbers: np.ndarray = field(repr=False)
    assignment: tuple[str, ...] = field(repr=False)
    fold_angles: np.ndarray = field(repr=False)
    rest_angles: np.ndarray = field(repr=False)
    stiffness: np.ndarray = field(repr=False)
    preload: np.ndarray = field(repr=False)
    faces: tuple[tuple[int, ...], ...] = field(repr=False)
    face_orders: tuple[tuple[int, int, int], ...] = ()
    conflicts: frozenset[int] = frozenset()
    notes: tuple[str, ...] = ()
    loads: tuple[Any, ...] = ()
    fixed_facet: Any = None
    unit: float = 0.0
    source: str = ""
    length_unit: str = ""
    y_down: bool = False
    limits: np.ndarray | None = field(default=None, repr=False)
    laws: Laws = field(default=(), repr=False)
    error: float = 0.0
    lattice: np.ndarray | None = None
    rolled: tuple[int, int] | None = None

    @cached_property
    def edge_of(self) -> dict[tuple[int, int], int]:
        """Position in `edges` of the edge between two vertices, in increasing order."""
        return {(min(pair), max(pair)): e for e, pair in enumerate(self.edges.tolist())}

    def is_sprung(self, edge: int) -> bool:
        """Return whether the file states a spring of an edge."""
        springs = self.stiffness[edge], self.rest_angles[edge], self.preload[edge]
        return not np.isnan(springs).all()

    def place(self, vertex: int) -> str:
        """Return where a vertex is, as the file has it."""
        x, y = self.coords[vertex, :2] * [1.0, -1.0 if self.y_down else 1.0] + 0.0
        return f"({x:.6g}, {y:.6g})"


def read_fold(
    source: str | Path,
    frame: int | Literal["first"] | None = None,
    drawing: DrawingOptions | None = None,
) -> tuple[Frame, ...]:
    """Read the frames of a FOLD file that have geometry, or the one of a drawing (SVG, .cp, .opx, DXF).

    Parameters
    ----------
    source
        The file, or ``"-"`` for standard input.
    frame
        Read only this one, numbered as in `Frame`, or the ``"first"`` with geometry; others are not looked at.
    drawing
        What is known of a drawing beside it.

    Returns
    -------
    tuple of Frame
        In the order of the file.

    Raises
    ------
    FoldFileError
        If the file cannot be read, is no JSON, an array is not what FOLD says it is, or there is no such frame.
    OptionError
        If `source` is no path.
    """
    text = read_limited(source, LARGEST, "FOLD", FoldFileError)
    name = "standard input" if str(source) == "-" else str(source)
    return parse_fold(text, frame, source=name, drawing=drawing)


def parse_fold(
    text: str | bytes | Mapping[str, Any],
    frame: int | Literal["first"] | None = None,
    *,
    source: str = "",
    drawing: DrawingOptions | None = None,
) -> tuple[Frame, ...]:
    """Read the frames with geometry from the text of a FOLD file, or the one frame of a drawing.

    Parameters
    ----------
    text
        JSON, or what an SVG, .cp, .opx or DXF file holds; or FOLD data as a dict, with arrays of NumPy if wanted.
    frame
        As for `read_fold`.
    source
        Where the text is from, as it was typed; its ending says which format it has.
    drawing
        What is known of a drawing beside it.

    Returns
    -------
    tuple of Frame
        In the order of the text.

    Raises
    ------
    FoldFileError
        If the text is no JSON, an array is not what FOLD says it is, or there is no such frame.

    Examples
    --------
    >>> from origami_nlp.pattern import fold_vertices, parse_fold
    >>> text = '''{"vertices_coords": [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]],
    ...     "edges_vertices": [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]],
    ...     "edges_assignment": ["M", "V", "V", "V", "B", "B", "B", "B"]}'''
    >>> (frame,) = parse_fold(text)
    >>> (vertex,), notes = fold_vertices(frame)
    >>> vertex.degree, vertex.assignment, vertex.maekawa
    (4, 'MVVV', 0)
    """
    name = f"FOLD file {source!r}" if source else "FOLD file"
    if isinstance(text, Mapping):
        try:
            text = json.dumps(dict(text), default=lambda array: array.tolist())
        except (AttributeError, TypeError, ValueError, RecursionError) as error:
            raise FoldFileError(f"FOLD dict: {error}: give lists, numbers, strings") from None
    raw = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    kind, y_down, said = drawing_kind(source, raw), False, tuple[str, ...]()
    data: Any
    if kind is not None:
        made = read_drawing(raw, kind, repr(source) if source else "the drawing", drawing)
        data, said, y_down = drawing_to_fold(made), made.notes, made.y_down
    elif drawing is not None:
        raise FoldFileError(f"{source!r} is a FOLD file: the options of drawings are not for it")
    elif raw.lstrip().startswith(b"<"):
        raise FoldFileError(f"{name} is XML: save it as .fold, .svg, .cp, .opx or .dxf")
    else:
        data = parse_json(text, name, FoldFileError)
    if not isinstance(data, Mapping):
        raise FoldFileError(f"{name} must be a JSON object: vertices_coords, edges_vertices, ...")
    full = _inherited([data, *_list(data.get("file_frames", []), "file_frames")])
    there = [number for number, keys in enumerate(full) if "vertices_coords" in keys]
    if not there:
        only = printable(", ".join(sorted(map(str, data))[:6]) or "nothing")
        raise FoldFileError(f"{name} has no frame with vertices_coords, only {only}")
    wanted = there if frame is None else there[:1] if frame == "first" else [frame]
    if not {*wanted} <= {*there}:
        raise FoldFileError(f"--frame {frame} has no geometry: there is {listed(there, 12)}")
    keys = ("vertices_coords", "edges_vertices")
    lists = (full[number].get(key) for number in wanted for key in keys)
    if len(wanted) > 1 and sum(len(one) for one in lists if isinstance(one, list)) > MOST_ELEMENTS:
        raise FoldFileError(
            f"file_frames hold more than {MOST_ELEMENTS} vertices and edges: --frame"
        )
    others = f"{len(there)} frames have geometry: frame {there[0]} is read, --frame takes another"
    more = (others,) if frame == "first" and len(there) > 1 else ()
    found = (_frame(full[number], number) for number in wanted)
    return tuple(
        replace(one, source=source, notes=(*said, *one.notes, *more), y_down=y_down)
        for one in found
    )


def _inherited(raw: list[Any]) -> list[dict[str, Any]]:
    """Return what each frame states that is read, with what it inherits."""
    full: list[dict[str, Any]] = [{} for _ in raw]
    known = set[int]()
    for number, one in enumerate(raw):
        if not isinstance(one, Mapping):
            raise FoldFileError(f"file_frames[{number - 1}] must be an object")
    for number in range(len(raw)):
        chain, here = list[int](), number  # from a frame up to one whose keys are known
        while here not in known:
            chain.append(here)
            if not here or raw[here].get("frame_inherit") is not True:
                break
            parent = raw[here].get("frame_parent", 0)
            if not _is_index(parent, len(raw)) or parent in chain:
                where = f"file_frames[{here - 1}].frame_parent = {shown(parent)}"
                raise FoldFileError(f"{where} must be another frame, 0 to {len(raw) - 1}")
            here = parent
        above = full[here] if here not in chain else {}
        for one in reversed(chain):
            above = full[one] = above | {key: raw[one][key] for key in _READ if key in raw[one]}
            known.add(one)
    return full


def _frame(data: dict[str, Any], number: int) -> Frame:
    notes: list[str] = []
    for old, new in _LEGACY.items():
        if old in data:
            raise FoldFileError(f"{old} is of FOLD 1.0: name it {new}, fold angles in degrees")
    coords, wide = _coords(data["vertices_coords"])
    error = check_number(ERROR_KEY, data.get(ERROR_KEY) or 0.0, error=FoldFileError)
    n = len(coords)
    faces = _faces(data.get("faces_vertices"), n)
    pairs = _edges(data.get("edges_vertices"), faces, n, notes)
    m = len(pairs)
    letters = _assignment(data.get("edges_assignment"), m)
    angles, rest, stiffness, preload = (_edge_numbers(data, key, m) for key in _EDGE_NUMBERS)
    note_small(angles, notes)
    angles = np.radians(angles)
    keep, conflicts = once(pairs, letters, angles, notes)
    place = {int(e): k for k, e in enumerate(keep)}
    compare_signs(letters, angles, notes)
    classes = data.get("frame_classes", [])
    folded = isinstance(classes, list) and "foldedForm" in classes
    if wide:
        coords, folded = flattened(coords, faces, folded, notes)
    title = data.get("frame_title", data.get("file_title", ""))
    return Frame(
        number,
        title.encode(errors="replace").decode() if isinstance(title, str) else "",
        coords,
        folded,
        pairs[keep],
        keep,
        tuple(letters[k] for k in keep),
        angles[keep],
        np.radians(rest[keep]),
        stiffness[keep],
        preload[keep],
        faces,
        _face_orders(data.get("faceOrders"), len(faces)),
        frozenset(place[k] for k in conflicts),
        tuple(notes),
        tuple(_list(data.get(LOADS_KEY) or [], LOADS_KEY)),
        data.get(FIXED_KEY),
        max(last_place(coords), error),
        length_unit=str(data.get("frame_unit", "")),
        error=error,
        limits=_limits(data.get(LIMITS_KEY), m, keep),
        lattice=_lattice(data.get(LATTICE_KEY)),
        rolled=check_rolled(data.get(ROLLED_KEY)),
        laws=edge_laws(data, m, keep),
    )


# ---------------------------------------------------------------- arrays, each checked


def _list(value: object, name: str) -> list[Any]:
    if not isinstance(value, list):
        raise FoldFileError(f"{name} = {shown(value)} must be an array")
    return value


def _is_index(value: object, count: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < count


def _rows(
    value: object, name: str, fits: Callable[[list[Any]], bool], what: str
) -> list[list[Any]]:
    """Return the rows of an array, each a list that fits; none of null."""
    rows = [] if value is None else _list(value, name)
    for i, row in enumerate(rows):
        if not isinstance(row, list) or not fits(row):
            raise FoldFileError(f"{name}[{i}] = {shown(row)} must be {what}")
    return rows


def _coords(value: object, name: str = "vertices_coords") -> tuple[np.ndarray, bool]:
    """Return points in space, and whether a third coordinate was given."""
    rows = _rows(value, name, lambda r: len(r) in (2, 3), "[x, y] or [x, y, z]")
    out = np.zeros((len(rows), 3))
    for i, row in enumerate(rows):
        for k, v in enumerate(row):
            out[i, k] = check_number(f"{name}[{i}]", v, -1e50, 1e50, FoldFileError)
    if not len(out):
        raise FoldFileError(f"{name} is empty: no geometry to analyse")
    if 0.0 < np.ptp(out, axis=0).max() < 1 / 1e50:
        raise FoldFileError(f"{name} span less than 1e-50: rescale the pattern")
    return out, any(len(row) == 3 for row in rows)


def _lattice(value: object) -> np.ndarray | None:
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != 2:
        raise FoldFileError(f"{LATTICE_KEY} = {shown(value)} must be two vectors")
    return _coords(value, LATTICE_KEY)[0]


def _limits(value: object, count: int, keep: np.ndarray) -> np.ndarray | None:
    """Read fold limits [deg] of some edges: a pair each, or null for +-180; None where there are none."""
    if value is None:
        return None
    pairs = [[-180.0, 180.0] if p is None else p for p in _of_edges(value, LIMITS_KEY, count)]
    try:
        return limit_angles(read_limits(pairs, count, degrees=True), count).T[keep]
    except OrigamiError as error:
        raise FoldFileError(f"{LIMITS_KEY}: {error}") from None


def _faces(value: object, count: int) -> tuple[tuple[int, ...], ...]:
    def fits(row: list[Any]) -> bool:
        return len(row) >= 3 and all(_is_index(v, count) for v in row)

    what = f"three or more vertices, 0 to {count - 1}"
    return tuple(map(tuple, _rows(value, "faces_vertices", fits, what)))


def _face_orders(value: object, count: int) -> tuple[tuple[int, int, int], ...]:
    """Read [f, g, s]; pairs whose order is not known (0 or null) are left out."""

    def fits(row: list[Any]) -> bool:
        faces = len(row) == 3 and all(_is_index(f, count) for f in row[:2]) and row[0] != row[1]
        return faces and row[2] in (1, -1, 0, None) and not isinstance(row[2], bool)

    of = f"0 to {count - 1}" if count else "but faces_vertices is missing"
    what = f"[f, g, s], f and g two faces, {of}, and s 1, -1 or 0"
    rows = _rows(value, "faceOrders", fits, what)
    return tuple((f, g, int(s)) for f, g, s in rows if s)


def _edges(
    value: object, faces: tuple[tuple[int, ...], ...], count: int, notes: list[str]
) -> np.ndarray:
    """Return pairs of vertices; where there are none, the sides of the faces."""
    if value is None:
        if not faces:
            raise FoldFileError("edges_vertices is missing: a vertex needs its creases")
        notes.append("edges_vertices is missing: edges are the sides of the faces, all unassigned")
        return np.array(sorted(sides_of(faces)))

    def fits(row: list[Any]) -> bool:
        return len(row) == 2 and row[0] != row[1] and all(_is_index(v, count) for v in row)

    what = f"two different vertices, 0 to {count - 1}"
    return np.array(_rows(value, "edges_vertices", fits, what), dtype=int).reshape(-1, 2)


def _of_edges(value: object, name: str, count: int) -> list[Any]:
    """Return an entry for each edge, null where the key is missing."""
    values = [None] * count if value is None else _list(value, name)
    if len(values) != count:
        raise FoldFileError(f"{name} has {len(values)} entries: give one for each of {count} edges")
    return values


def _assignment(value: object, count: int) -> list[str]:
    out = []
    for e, letter in enumerate(_of_edges(value, "edges_assignment", count)):
        if letter is not None and not (isinstance(letter, str) and letter.upper() in [*"MVBFUCJ"]):
            raise FoldFileError(f"edges_assignment[{e}] = {shown(letter)} must be one of MVBFUCJ")
        out.append((letter or "?").upper())
    return out


def _edge_numbers(data: Mapping[str, Any], name: str, count: int) -> np.ndarray:
    """Read a number of each edge as it is in the file; NaN where there is none."""
    low, high = _EDGE_NUMBERS[name]
    out = np.full(count, math.nan)
    for e, value in enumerate(_of_edges(data.get(name), name, count)):
        if value is not None:
            out[e] = check_number(f"{name}[{e}]", value, low, high, FoldFileError)
    return out
