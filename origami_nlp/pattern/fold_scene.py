"""One vertex of a FOLD file as a scene."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from origami_nlp.errors import OptionError
from origami_nlp.pattern.crease_pattern import fold_vertices, scene_at
from origami_nlp.pattern.fold_file import read_fold
from origami_nlp.pattern.scene import Scene


def _to_stderr(note: str) -> None:
    print(f"note: {note}", file=sys.stderr)


def read_fold_scene(
    source: str | Path,
    vertex: int | None = None,
    frame: int | None = None,
    *,
    tell: Callable[[str], object] = _to_stderr,
    **options: Any,
) -> Scene:
    """Read one vertex of a FOLD file as a scene.

    Parameters
    ----------
    source
        FOLD file, or ``"-"`` for standard input.
    vertex
        Which, numbered from 0 as in the file; by default the only one that can be analysed.
    frame
        Which, from 0; by default the first.
    tell
        Called with each note on what is odd in the file and what was assumed; by default they go to standard error.
    options
        Symmetry, contact, stiffness and rest angles, as `scene_at` takes them.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    FoldFileError
        If the file is no FOLD file, or the vertex is not there or cannot be analysed.
    OptionError
        If no vertex is given, and not exactly one can be analysed.

    Examples
    --------
    >>> import os, tempfile, origami_nlp as o
    >>> path = os.path.join(tempfile.mkdtemp(), "states.fold")
    >>> o.write_fold(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> o.read_fold_scene(path, tell=lambda note: None).degree
    6
    """
    (chosen,) = read_fold(source, "first" if frame is None else frame)
    found, notes = fold_vertices(chosen)
    if vertex is None:
        good = [v.number for v in found if not v.reason]
        if len(good) != 1:
            some = f" ({', '.join(map(str, good[:12]))}{', ...' if len(good) > 12 else ''})"
            why = "".join(f"; {note}" for note in notes) if not found else ""
            raise OptionError(
                f"--vertex is needed: {len(good)} interior vertices can be analysed"
                f"{some if good else ''}; origami-nlp vertices lists them{why}"
            )
        vertex = good[0]
    scene = scene_at(chosen, vertex, **options)
    here = next(v for v in found if v.number == vertex)
    for note in (*chosen.notes, *notes, *(f"vertex {vertex}: {note}" for note in here.notes)):
        tell(note)
    return scene
