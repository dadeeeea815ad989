"""States in turn as a film for slides, by matplotlib alone: turned round, and folded along paths where some are stored.

Nothing is shown between two stored states: what is not stored might not close, or cross itself.  A state from which no
path leads to the next one is turned only, and the caption says so.
"""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from origami_nlp.arguments import check_path, check_type
from origami_nlp.display.bodies import Content, FoldedBody, Trajectory
from origami_nlp.display.interactive import kept_states
from origami_nlp.display.pose import Pose
from origami_nlp.display.text import label_text
from origami_nlp.errors import OptionError
from origami_nlp.io import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FRAMES = 24
"""Of one turn."""
HELD = 5
"""Frames for which a state, and the end of a path, stand still."""
MOST_STEPS = 40
"""States of a path that are shown."""
RATE, DPI, SIDE = 10, 100, 4.2
"""Frames a second, dots an inch, and width of the picture [in]."""
ROOM = 1.25
"""Around what is seen, with its numbers."""


class FilmFrame(NamedTuple):
    """One picture of a film.

    Attributes
    ----------
    state
        The state.
    view
        How it is turned, as `Keyframe.view`.
    middle, reach
        Centre [3] and half the width of what is seen.
    caption
        Under it.
    """

    state: FoldedBody
    view: np.ndarray
    middle: np.ndarray
    reach: float
    caption: str


def check_animation(target: str | os.PathLike[str]) -> None:
    """Raise, before any work, an error for a film that could not be written.

    Parameters
    ----------
    target
        The file, ``.gif`` or ``.mp4``.

    Raises
    ------
    OptionError
        If it ends in neither, or in ``.mp4`` where there is no ffmpeg.
    """
    ending = Path(target).suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise OptionError(f"animation = {str(target)!r}: the name must end in .gif, .mp4")
    if ending == ".mp4" and shutil.which("ffmpeg") is None:
        raise OptionError(
            f"animation = {str(target)!r}: .mp4 needs ffmpeg, which is not on PATH: use .gif"
        )


def write_animation(content: Content, target: str | os.PathLike[str]) -> None:
    """Write the states of a vertex in turn as a film.

    Parameters
    ----------
    content
        Of one vertex.
    target
        The file, ``.gif`` or ``.mp4`` (by ffmpeg), written whole or not at all.

    Raises
    ------
    OptionError
        If there is no state, the body is no single vertex, ffmpeg fails, or the file cannot be written.
    """
    check_type("content", content, Content)
    check_path("target", target)
    check_animation(target)
    if not content.body.sectors:
        raise OptionError("a film shows a single vertex, not a sheet")
    shots = list(film(content))
    if not shots:
        raise OptionError(f"animation = {str(target)!r}: there is no state to show")
    from matplotlib.animation import FFMpegWriter, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIDE, SIDE + 0.7), dpi=DPI, facecolor="white")
    ending = Path(target).suffix.lower()
    writer = PillowWriter(RATE) if ending == ".gif" else FFMpegWriter(RATE)
    with tempfile.TemporaryDirectory() as folder:
        film_file = os.path.join(folder, f"film{ending}")
        try:
            with writer.saving(figure, film_file, DPI):
                for shot in shots:
                    draw_shot(figure, content.title, shot)
                    writer.grab_frame()
        except (subprocess.CalledProcessError, BrokenPipeError) as error:
            said = (getattr(error, "stderr", "") or "it ended early").strip().splitlines()[-1]
            raise OptionError(
                f"animation = {str(target)!r}: ffmpeg failed ({said}): use .gif"
            ) from None
        write_whole(target, Path(film_file).read_bytes())


def film(content: Content) -> Iterator[FilmFrame]:
    """Return the pictures of a film: each state turned round once, then what its paths are.

    Parameters
    ----------
    content
        States and paths.

    Yields
    ------
    FilmFrame
        In order.  Each state is one that is stored.
    """
    count = len(content.stations)
    for k, station in enumerate(content.stations):
        state = station.folded
        paths = [t for t in content.tracks if t.start == k and t.end == k + 1]
        paths = paths or [t for t in content.tracks if t.start == k and _descends(t)]
        on = (
            "" if paths or k == count - 1 else "\nno stored path from here to the next: turned only"
        )
        words = f"state {station.title}{on}"
        seen = _around([state])
        for angle in np.linspace(0.0, 2 * math.pi, FRAMES, endpoint=False):
            yield FilmFrame(state, _about_up(angle) @ station.view, *seen, words)
        yield from [FilmFrame(state, station.view, *seen, words)] * HELD
        for track in paths[:1]:
            yield from _along(track, station.view)
    if not count:
        for track in content.tracks:
            yield from _along(track, track.view)


def _along(track: Trajectory, view: np.ndarray) -> Iterator[FilmFrame]:
    states = [track.states[n] for n in kept_states(track, MOST_STEPS)]
    seen = _around(states)
    for state in [*states, *states[-1:] * HELD]:
        yield FilmFrame(state, view, *seen, f"{track.title}\nU = {state.energy:.6g} J")


def _around(states: list[FoldedBody]) -> tuple[np.ndarray, float]:
    """Return centre and half the width of a picture that holds all states however they are turned."""
    corners = np.vstack([state.corners for state in states])
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return middle, ROOM * float(np.linalg.norm(corners - middle, axis=1).max())


def _descends(track: Trajectory) -> bool:
    """Whether the energy falls all along a path."""
    return bool((np.diff([state.energy for state in track.states]) < 0).all())


def _about_up(angle: float) -> np.ndarray:
    """Return the turn of the picture's frame about its own upright axis, [3, 3]."""
    s, c = math.sin(angle), math.cos(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def draw_shot(figure: Figure, title: str, shot: FilmFrame) -> None:
    """Draw one picture of a film into an empty or used matplotlib Figure.

    Parameters
    ----------
    figure
        Is cleared first.
    title
        Above it.
    shot
        The picture.
    """
    from origami_nlp.display.drawing import draw_pose, label_places

    figure.clear()
    state, turn = shot.state, shot.view
    creases = (state.corners[1:] - state.corners[0]) @ turn.T
    after = np.roll(creases, -1, axis=0)
    normals = np.cross(creases, after)
    sines = np.linalg.norm(normals, axis=1)
    pose = Pose(creases, normals / sines[:, None], state.shifts @ turn.T)
    high = SIDE / (SIDE + 0.7)
    axes = figure.add_axes((0.0, 1 - high, 1.0, high))
    low = ((shot.middle - state.corners[0]) @ turn.T)[:2] - shot.reach
    places = label_places(pose)
    draw_pose(axes, pose, places, state.fold_angles, low, 2 * shot.reach, 10.0)
    figure.text(0.03, 0.985, label_text(title), fontsize=9, weight="bold", va="top")
    figure.text(0.03, 0.13, label_text(shot.caption), fontsize=8, va="top")
