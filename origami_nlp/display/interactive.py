"""An interactive page: states in space, paths with a slider and their energy, the tables.

One file of HTML with its scripts inside: it opens without a network, in a browser or in a cell of Jupyter.  What moves
is `page/page.js`, what it looks like `page/page.html`; three.js draws the paper and Observable Plot the energies
(`page/libraries.js`).
"""

from __future__ import annotations

import json
import math
import os
from abc import ABC, abstractmethod
from dataclasses import asdict
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from origami_nlp.arguments import check_path
from origami_nlp.display.bodies import Content, FoldedBody, Keyframe, Trajectory
from origami_nlp.display.table import pieces_html
from origami_nlp.io import write_whole


class InteractivePage:
    """A result as a page that can be turned.

    Attributes
    ----------
    content
        What is shown.
    """

    def __init__(self, content: Content) -> None:
        self.content = content

    def __repr__(self) -> str:
        return (
            f"InteractivePage({self.content.title}: last line of a cell in Jupyter, or .save(file))"
        )

    def _repr_html_(self) -> str:
        # a frame of its own: several pages in one notebook do not meet
        look, page = "width:100%;height:900px;border:0", interactive_page(self.content)
        return f'<iframe style="{look}" srcdoc="{escape(page)}"></iframe>'

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page as one file that needs no network.

        Parameters
        ----------
        path
            The file.

        Raises
        ------
        OptionError
            If it cannot be written.
        """
        check_path("path", path)
        write_whole(path, interactive_page(self.content).encode())


class Viewable(ABC):
    """A result that can be turned in space: a class says `view_content`, the rest follows."""

    @abstractmethod
    def view_content(self) -> Content:
        """Return what there is to see, as plain data."""

    def view(self) -> InteractivePage:
        """Return the interactive page of the result; the last line of a cell of Jupyter shows it.

        Returns
        -------
        InteractivePage
            Its `save` writes it as one file that needs no network.
        """
        return InteractivePage(self.view_content())


def interactive_page(content: Content) -> str:
    """Return a result as one page of HTML that needs no network.

    Parameters
    ----------
    content
        What is shown.

    Returns
    -------
    str
        The page.
    """
    here = files("origami_nlp.display") / "page"
    data = json.dumps(page_data(content), allow_nan=False, separators=(",", ":"))
    parts = {
        "TITLE": escape(content.title),
        "TABLES": pieces_html(content.pieces),
        "DATA": data.replace("<", "\\u003c"),  # no text of a user ends the script
        "SCRIPT": (here / "page.js").read_text("utf-8"),
        "LIBRARIES": (here / "libraries.min.js").read_text("utf-8"),
    }
    page, *rest = (here / "page.html").read_text("utf-8").split("{{")
    for piece in rest:  # put together, not replaced in turn: what is put in is not looked at again
        name, tail = piece.split("}}", 1)
        page += parts[name] + tail
    return page


def page_data(content: Content) -> dict[str, Any]:
    """Return what the script of a page reads, as plain JSON data.

    Parameters
    ----------
    content
        What is shown.

    Returns
    -------
    dict
        nan is None; states to 15 decimals, paths thinned and to 6.
    """
    tracks = content.tracks
    width = max((s.corners.size for t in tracks for s in t.states[:1]), default=1)
    # at most 55,000 coordinates of states on paths, about nine bytes each: longer paths are thinned
    most = max(12, min(90, 55_000 // (width * max(len(tracks), 1))))
    creases = [crease._asdict() for crease in content.body.creases]
    return {
        "title": content.title,
        "steps": content.steps,
        "body": {**vars(content.body), "creases": creases},
        "stations": [_station(station) for station in content.stations],
        "tracks": [_track(track, kept_states(track, most)) for track in tracks],
    }


def _plain(array: np.ndarray, digits: int) -> list[Any]:
    """Return rounded numbers, None for nan and inf."""
    x = np.asarray(array, dtype=float)
    listed: list[Any] = np.where(np.isfinite(x), np.round(x, digits) + 0.0, np.array(None)).tolist()
    return listed


def _folded(state: FoldedBody, digits: int) -> dict[str, Any]:
    places = {"corners": _plain(state.corners, digits), "angles": _plain(state.fold_angles, digits)}
    return {**places, "shifts": _plain(state.shifts, 4) if state.shifts.any() else None}


def _station(station: Keyframe) -> dict[str, Any]:
    return {
        "title": station.title,
        **_folded(station.folded, 15),
        "energy": station.folded.energy,
        "view": _plain(station.view, 6),
        "marks": [asdict(mark) for mark in station.marks],
        "lines": station.lines,
    }


def _track(track: Trajectory, kept: np.ndarray) -> dict[str, Any]:
    label, unit = track.label, 1.0
    if label.endswith("[rad]"):
        label, unit = label.removesuffix("[rad]") + "[deg]", math.degrees(1)
    return {
        "title": track.title,
        "label": label,
        "of": len(track.states),
        "parameter": (track.parameter[kept] * unit).tolist(),
        "states": [_folded(track.states[k], 6) for k in kept],
        "energy": [track.states[k].energy for k in kept],
        "view": _plain(track.view, 6),
        "start": track.start,
    }


def kept_states(track: Trajectory, most: int) -> np.ndarray:
    """Choose states of a path that has too many.

    Parameters
    ----------
    track
        The path.
    most
        About how many to keep; both ends and the highest state are kept in any case.

    Returns
    -------
    numpy.ndarray
        Their numbers, in order.
    """
    many = len(track.states)
    top = int(np.argmax([state.energy for state in track.states]))
    even = np.linspace(0, many - 1, min(many, most)).round().astype(int)
    return np.unique([*even.tolist(), top])
