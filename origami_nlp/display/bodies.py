"""What a reader can turn in space, as plain data: folded states, and paths between them.

Nothing here knows where states come from: a room fills a `Content` from its own result, and `view_content` writes it as
a page.  A `Body` may be a single vertex or a whole sheet: corners, facets between them, creases.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from origami_nlp.display.table import Section


class Crease(NamedTuple):
    """A crease of a body; all numbers from 0.

    Attributes
    ----------
    start, end
        Its corners.
    right, left
        The facets beside it, seen from the upper side of the paper, walking from start to end: folding by phi (valley
        positive) turns the left one up.
    """

    start: int
    end: int
    right: int
    left: int


@dataclass(frozen=True)
class Body:
    """What is folded.

    Attributes
    ----------
    facets
        Corners of each, from 0, counterclockwise seen from the upper side of the paper; convex.
    creases
        In the order of the fold angles.
    """

    facets: tuple[tuple[int, ...], ...]
    creases: tuple[Crease, ...]


@dataclass(frozen=True)
class FoldedBody:
    """A body in space.

    Attributes
    ----------
    corners
        Shape [V, 3].
    fold_angles
        Shape [C] [rad].
    energy
        In the scene's units.
    shifts
        Displacement of each facet in the picture, [F, 3], where facets lie on each other; zero elsewhere.
    """

    corners: np.ndarray
    fold_angles: np.ndarray
    energy: float
    shifts: np.ndarray


@dataclass(frozen=True)
class Mark:
    """A contact, to be marked on a state.

    Attributes
    ----------
    label
        Short, beside the mark.
    loaded
        Whether it pushes; else it only touches.
    creases, facets
        Where, from 0; the label stands at the first of them.
    """

    label: str
    loaded: bool
    creases: tuple[int, ...] = ()
    facets: tuple[int, ...] = ()


@dataclass(frozen=True)
class Keyframe:
    """A state that a reader can choose.

    Attributes
    ----------
    title
        Its name in a list.
    folded
        The state.
    view
        Rows: right, up, towards the viewer, in the frame of the corners, [3, 3].
    marks
        Its contacts.
    lines
        What is known of it: angles, certificate, residuals.
    """

    title: str
    folded: FoldedBody
    view: np.ndarray
    marks: tuple[Mark, ...] = ()
    lines: tuple[str, ...] = ()


@dataclass(frozen=True)
class Trajectory:
    """A path of states, in order; any path: a descent, over a pass, along a load.

    Attributes
    ----------
    title
        Its name in a list.
    parameter
        Shape [M], increasing or decreasing.
    label
        What the parameter is, with its unit.
    states
        M of them; each is a state by itself, and nothing is shown between two.
    view
        As in `Keyframe`.
    start
        Station (from 0) where it starts, or None.
    """

    title: str
    parameter: np.ndarray
    label: str
    states: tuple[FoldedBody, ...]
    view: np.ndarray
    start: int | None = None


@dataclass(frozen=True)
class Content:
    """All that a page shows of one result.

    Attributes
    ----------
    title
        Of the page.
    body
        What is folded.
    stations
        States, in order.
    tracks
        Paths, in order.
    pieces
        Tables and lines of the text report.
    steps
        What is known of every state on the paths.
    """

    title: str
    body: Body
    stations: tuple[Keyframe, ...]
    tracks: tuple[Trajectory, ...] = ()
    pieces: tuple[Section, ...] = field(default=(), repr=False)
    steps: str = ""
