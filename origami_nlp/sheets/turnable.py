"""Sheets to be turned in space: states, and the folding motion under a slider."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.facets import Crossings
from origami_nlp.pattern import Pattern
from origami_nlp.sheets.drawing import sheet_view
from origami_nlp.sheets.motion import Motion
from origami_nlp.sheets.result import SheetResult
from origami_nlp.show import Body, Content, Crease, Folded, Piece, Station, Track

LONG = 0.8
"""Mean length of a crease on a page, whose lines are as wide as for a vertex with creases of length 1."""


def sheet_poser(
    pattern: Pattern,
) -> tuple[Body, Callable[[np.ndarray], Folded], Callable[[np.ndarray], np.ndarray]]:
    """Return a sheet as a body, and what puts its states into space and says from where they are seen.

    Parameters
    ----------
    pattern
        The sheet.

    Returns
    -------
    tuple
        The body; functions of fold angles [n] [rad].
    """
    crossings = Crossings(pattern)
    parts = [tuple(dict.fromkeys(piece)) for piece in crossings.pieces.tolist()]
    left = {(q[i - 1], v): k for k, q in enumerate(parts) for i, v in enumerate(q)}
    creases = tuple(Crease(a, b, left[b, a], left[a, b]) for a, b in pattern.ends.tolist())
    scale = LONG / float(pattern.lengths.mean() if pattern.creases else crossings.size)

    def folded(phi: np.ndarray) -> Folded:
        phi = np.asarray(phi, float)
        x = np.nan_to_num(crossings.poses.corners(phi))
        middle = x[crossings.pieces.ravel()].mean(axis=0)
        shifts = np.zeros((len(parts), 3))
        return Folded((x - middle) * scale, phi, float(pattern.energy(phi)), shifts)

    def view(phi: np.ndarray) -> np.ndarray:
        return sheet_view(crossings.poses.polygons(np.asarray(phi, float)))

    return Body(tuple(parts), creases), folded, view


def sheet_content(
    pattern: Pattern,
    states: Sequence[tuple[str, np.ndarray, Sequence[str]]],
    motion: Motion | None = None,
    pieces: Sequence[Piece] = (),
) -> Content:
    """Return states of a sheet, and its motion, as what `show.TurnedPage` shows.

    Parameters
    ----------
    pattern
        The sheet.
    states
        Title, fold angles [n] [rad] and lines to say of each.
    motion
        Of `find_motion`, if there is one.
    pieces
        Tables and lines below.

    Returns
    -------
    Content
        The page's content.
    """
    body, folded, view = sheet_poser(pattern)
    stations = tuple(
        Station(title, folded(phi), view(phi), (), tuple(lines)) for title, phi, lines in states
    )
    tracks: tuple[Track, ...] = ()
    if motion is not None:
        tracks = (
            Track(
                "folding motion",
                motion.arc,
                "along the motion [rad]",
                tuple(folded(phi) for phi in motion.fold_angles),
                view(motion.fold_angles[len(motion.fold_angles) // 2]),
            ),
        )
    return Content(pattern.name or "pattern", body, stations, tracks, pieces=tuple(pieces))


def turn_found(found: SheetResult) -> Content:
    """Return the stable states that a search has found, for a page that can be turned.

    Parameters
    ----------
    found
        Of `find_minima`.

    Returns
    -------
    Content
        The page's content.

    Raises
    ------
    OptionError
        If there is no stable state.
    """
    if not found.minima:
        raise OptionError("no stable state was found: there is nothing to turn")
    states = [(s.title(k), s.phi, s.lines()) for k, s in enumerate(found.minima, start=1)]
    return sheet_content(found.pattern, states, None, tuple(found.told()))


def turn_motion(motion: Motion) -> Content:
    """Return a folding motion, for a page that can be turned.

    Parameters
    ----------
    motion
        Of `find_motion`.

    Returns
    -------
    Content
        The page's content.
    """
    end = (f"end: {motion.end}", motion.fold_angles[-1], ())
    return sheet_content(motion.pattern, [end], motion, tuple(motion.told()))
