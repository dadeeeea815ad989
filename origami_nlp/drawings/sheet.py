"""A drawing as one planar graph: the smallest tolerance at which it is whole, strays and sheets, and its outline.

No fixed tolerance does: of drawings that people publish some state their corners to twelve digits, some to a thousandth
of the sheet, and at a larger tolerance than needed small facets vanish.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.drawings.lines import DrawingOptions, Lines
from origami_nlp.drawings.noding import Noded, node
from origami_nlp.errors import DrawingError
from origami_nlp.numerics import INPUT_TOL, groups, last_place

RUNGS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3)
"""Shares of the sheet within which ends are joined, tried in this order."""
RESOLVES = 10.0
"""Tolerances that the shortest edge is longer than."""
CHAINED = 2.0
"""Tolerances by which an end may move: one that moves farther has been joined to others along a chain of ends."""
COARSE = 1e-3
"""Share of the sheet under which a last decimal place is rounding: whole numbers on a small grid are exact."""
NAMED = 3
"""Places that a note names; the others are counted."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """A drawing as a planar graph, y upwards.

    Attributes
    ----------
    points
        Vertices, [V, 2].
    edges
        [E, 2] vertices; where mountain lies on valley, both.
    letters
        One an edge, as in FOLD.
    angles
        Fold angles [deg], valley positive, [E]; NaN where none is stated.
    error
        How far vertices may be off: the largest distance over which ends were joined, or their last decimal place.
    tolerance
        Share of the sheet within which ends were joined.
    title, length_unit, y_down
        As of `Lines`.
    notes
        What was left out, repaired and taken, one line each.
    """

    points: np.ndarray = field(repr=False)
    edges: np.ndarray = field(repr=False)
    letters: tuple[str, ...] = field(repr=False)
    angles: np.ndarray = field(repr=False)
    error: float
    tolerance: float
    title: str = ""
    length_unit: str = ""
    y_down: bool = False
    notes: tuple[str, ...] = ()


def make_drawing(lines: Lines, options: DrawingOptions, name: str) -> Drawing:
    """Make a planar graph of lines, and say what was done.

    Parameters
    ----------
    lines
        As read.
    options
        `tolerance` and `part` of them.
    name
        Of the file, for complaints.

    Returns
    -------
    Drawing
        Of all its sheets, or of the one asked for.

    Raises
    ------
    DrawingError
        If the lines have no extent, or there is no such part.

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> ends = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    >>> square = Lines(np.append(ends, [[[0, 0], [1, 1.00005]]], axis=0), tuple("BBBBM"), np.full(5, np.nan), False)
    >>> made = make_drawing(square, DrawingOptions(), "it")
    >>> len(made.points), len(made.edges), made.tolerance
    (4, 5, 0.0001)
    """
    size = float(np.ptp(lines.ends.reshape(-1, 2), axis=0).max())
    if size < 1 / 1e50:  # as in FOLD
        raise DrawingError(f"{name}: all its lines lie in one point")
    stated = "B" in lines.letters
    best: tuple[tuple[int, bool], float, Noded, Planar] | None = None
    for rung in RUNGS if options.tolerance is None else (options.tolerance,):
        noded = node(lines.ends, lines.letters, lines.angles, rung * size)
        if not len(noded.edges):
            continue
        found = planar(noded.points, noded.edges)
        faults = _loose(noded, found).size + (_open(noded, found).size if stated else 0)
        if noded.moved > CHAINED * rung * size:
            faults = len(noded.edges) + 2 * len(lines.ends)
        a, b = noded.points[noded.edges].transpose(1, 0, 2)
        stubs = bool((np.linalg.norm(b - a, axis=1) < RESOLVES * rung * size).any())
        if best is None or (faults, stubs) < best[0]:
            best = ((faults, stubs), rung, noded, found)
        if not (faults or stubs):
            break
    if best is None:
        raise DrawingError(f"{name}: its lines are shorter than the tolerance")
    (faults, _), rung, noded, found = best
    how = "as asked"
    if options.tolerance is None:
        how = "the best, but at none is it whole" if faults else "the smallest at which it is whole"
    keep, more = _sheets(lines, noded, found, options.part, name)
    notes = [*lines.notes, *_repairs(noded, rung, size, how), *more]
    loose = np.intersect1d(_loose(noded, found), noded.edges[keep])
    if len(loose):
        where = _places(lines, noded.points[loose])
        notes.append(f"{len(loose)} ends hang loose: {where}; --tolerance joins them from farther")
    letters, border = np.array(noded.letters), found.outer & keep
    if not stated and np.isin(noded.edges[border], loose).any():
        notes.append(
            "no border is drawn, and creases end in the open: add the outline of the paper"
        )
    elif not stated:
        taken = border & (letters != "C")
        letters[taken] = "B"
        notes.append(f"no border is drawn: the outline, {int(taken.sum())} edges, is taken for it")
    elif (letters[keep] == "B").all() and options.part is None:
        notes.append("all lines are borders: --colour 'black=U' says which are folds")
    twice = noded.clashes[::2] if keep.any() else ()
    if twice:
        where = _places(lines, noded.points[noded.edges[[*twice]]].mean(axis=1))
        notes.append(f"{len(twice)} lines are drawn twice, with other letters or angles: {where}")
    place = last_place(lines.ends)
    error = max(noded.moved * (noded.moved > INPUT_TOL * size), place * (place < COARSE * size))
    used, edges = np.unique(noded.edges[keep], return_inverse=True)
    drawn = noded.points[used], edges.reshape(-1, 2), tuple(letters[keep].tolist())
    first = *drawn, noded.angles[keep], error, rung
    return Drawing(*first, lines.title, lines.length_unit, lines.y_down, tuple(notes))


def _loose(noded: Noded, found: Planar) -> np.ndarray:
    """Return the vertices at which an edge of a sheet ends in the open."""
    sheet = found.faces[found.component] > 0
    ends = np.unique(noded.edges[sheet])
    return ends[found.degree[ends] == 1] if len(ends) else np.flatnonzero(found.degree == 1)


def _open(noded: Noded, found: Planar) -> np.ndarray:
    """Return the edges outside that are no border, of components that enclose something."""
    folds = ~np.isin(np.array(noded.letters), ("B", "C"))
    return np.flatnonzero(found.outer & folds & (found.faces[found.component] > 0))


def _repairs(noded: Noded, rung: float, size: float, how: str) -> list[str]:
    """Say what joining and splitting did; where nothing was to be done, nothing."""
    moved = noded.moved > INPUT_TOL * size
    counts = noded.repairs | {"ends joined": noded.repairs["ends joined"] * moved}
    said = [f"{many} {what}" for what, many in counts.items() if many]
    if not said:
        return []
    move = f", the largest move {noded.moved:.2g}" if counts["ends joined"] else ""
    return [f"tolerance {rung:g} of the sheet ({rung * size:.3g}), {how}: {', '.join(said)}{move}"]


def _sheets(
    lines: Lines, noded: Noded, found: Planar, part: int | None, name: str
) -> tuple[np.ndarray, list[str]]:
    """Return which edges to keep: those of sheets, or of one of them; strays are left out."""
    component, points = found.component, noded.points
    whole = found.faces > 0
    if not whole.any():
        if part not in (None, 1):
            raise DrawingError(f"{name} has no part {part}: it encloses nothing")
        return np.ones(len(component), bool), []
    notes = []
    stray = ~whole[component]
    if stray.any():
        where = _places(lines, points[noded.edges[stray][:, 0]])
        notes.append(f"{int(stray.sum())} strays, joined to no sheet, left out: {where}")
    sheets = []
    for one in np.flatnonzero(whole):
        own = points[noded.edges[component == one].ravel()]
        low, high = own.min(axis=0), own.max(axis=0)
        sheets.append(((-round(float(np.prod(high - low)), 9), *low), one, (low + high) / 2))
    sheets.sort(key=lambda sheet: sheet[0])
    if len(sheets) > 1:
        where = _places(lines, [middle for *_, middle in sheets])
        chosen = "--part takes one" if part is None else f"part {part} is taken"
        notes.append(f"{len(sheets)} separate sheets {where}: {chosen}")
    if part is None:
        return ~stray, notes
    if part > len(sheets):
        raise DrawingError(f"{name} has no part {part}: it has {len(sheets)}")
    return component == sheets[part - 1][1], notes


def _places(lines: Lines, points: Sequence[np.ndarray] | np.ndarray) -> str:
    first = ", ".join(lines.place(p) for p in points[:NAMED])
    return f"at {first}" + (", ..." if len(points) > NAMED else "")


@dataclass(frozen=True, eq=False)
class Planar:
    """What a drawing encloses.

    Attributes
    ----------
    degree
        How many edges end at each vertex, [V].
    component
        Of each edge, numbered from 0, [E].
    faces
        Of each component, how many it encloses.
    outer
        Whether an edge lies on the outside of its component, [E].
    """

    degree: np.ndarray
    component: np.ndarray
    faces: np.ndarray
    outer: np.ndarray


def half_edges(points: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return both senses of edges [m, 2], and what follows each round the face on its left.

    Parameters
    ----------
    points
        In the plane, [V, 2].
    edges
        Each once.

    Returns
    -------
    tuple of numpy.ndarray
        Where each half-edge begins and ends, edges in their order and then turned back, and the next one, [2 m].
    """
    m = len(edges)
    tail, head = np.concatenate([edges, edges[:, ::-1]]).T
    d = points[head] - points[tail]
    order = np.lexsort((np.arctan2(d[:, 1], d[:, 0]), tail))
    place = np.argsort(order)
    begin, end = (np.searchsorted(tail[order], head, side) for side in ("left", "right"))
    # at its end clockwise from where one came: the face stays on the left
    here = place[(np.arange(2 * m) + m) % (2 * m)] - 1
    return tail, head, order[np.where(here < begin, end - 1, here)]


def planar(points: np.ndarray, edges: np.ndarray) -> Planar:
    """Walk round all faces of a drawing whose edges meet at vertices only.

    Parameters
    ----------
    points
        [V, 2].
    edges
        [E, 2] vertices; twice the same counts once more in `degree` only.

    Returns
    -------
    Planar
        Its faces.

    Examples
    --------
    >>> import numpy as np
    >>> made = planar(np.array([[0, 0], [1, 0], [0, 1], [3, 3.0]]), np.array([[0, 1], [1, 2], [0, 2], [1, 3]]))
    >>> made.degree.tolist(), made.faces.tolist(), made.outer.all()
    ([2, 3, 2, 1], [1], np.True_)
    """
    once, back = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    m = len(once)
    tail, head, after = half_edges(points, once)
    walk = groups(2 * m, np.column_stack([np.arange(2 * m), after]))
    names, component = np.unique(groups(len(points), once)[once[:, 0]], return_inverse=True)
    middle = points.mean(axis=0) if len(points) else np.zeros(2)
    p, q = points[tail] - middle, points[head] - middle
    area = np.bincount(walk, weights=p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    # of each component the walk outside: of the least signed area
    of_walk = np.empty(len(area), int)
    of_walk[walk] = np.tile(component, 2)
    least = np.lexsort((area, of_walk))
    outside = least[np.diff(of_walk[least], prepend=-1) > 0]
    faces = np.bincount(of_walk, minlength=len(names)) - 1
    left, right = np.isin(walk, outside).reshape(2, m)
    outer = left | right
    degree = np.bincount(edges.ravel(), minlength=len(points))
    return Planar(degree, component[back.ravel()], faces, outer[back.ravel()])
