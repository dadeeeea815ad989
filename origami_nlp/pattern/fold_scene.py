"""Vertices of a FOLD file as scenes: one, or all."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type, check_whole, shown
from origami_nlp.errors import FoldFileError, OptionError
from origami_nlp.numerics import NOISE
from origami_nlp.pattern.crease_pattern import FoldVertex, fold_vertices, make_vertex
from origami_nlp.pattern.fold_file import LOADS_KEY, Frame, read_fold
from origami_nlp.pattern.fold_limits import Contact
from origami_nlp.pattern.fold_notes import listed
from origami_nlp.pattern.fold_springs import FoldSprings
from origami_nlp.pattern.scene import Scene


def _to_stderr(note: str) -> None:
    print(f"note: {note}", file=sys.stderr)


def read_fold_scene(
    source: str | Path,
    vertex: int | None = None,
    *,
    frame: int | None = None,
    on_note: Callable[[str], object] = _to_stderr,
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
    on_note
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
    >>> o.read_fold_scene(path, on_note=lambda note: None).degree
    6
    """
    (chosen,) = read_fold(source, "first" if frame is None else frame)
    return scene_at(chosen, vertex, on_note=on_note, **options)


def scene_at(
    frame: Frame,
    number: int | FoldVertex | None = None,
    *,
    on_note: Callable[[str], object] = lambda note: None,
    symmetry: str = "auto",
    contact: Contact = "full",
    **springs: Any,
) -> Scene:
    """Make a scene of one interior vertex of a frame.

    Parameters
    ----------
    frame
        Of `read_fold`.
    number
        Of the vertex, from 0, as in the file; or one of `fold_vertices`; by default the only one that can be analysed.
    on_note
        Told what is odd, and what was assumed.
    symmetry, contact
        As for `Scene`.
    springs
        Of creases for which the file states none: `FoldSprings`, stiffness, rest_angle, rest_from.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    FoldFileError
        If the vertex is not there, or cannot be analysed, or `rest_from` asks for what the frame does not have.
    SceneError, SymmetryError
        If a value does not fit the vertex.
    """
    check_type("frame", frame, Frame)
    found, notes = ((), ()) if isinstance(number, FoldVertex) else fold_vertices(frame)
    v = number if isinstance(number, FoldVertex) else _vertex_at(frame, number, found, notes)
    asked = FoldSprings(**springs)
    asked.check(frame)
    if v.reason:
        raise FoldFileError(f"vertex {v.number} cannot be analysed: {v.reason}")
    at = np.searchsorted(frame.numbers, v.edges)
    k, rest = asked.of(frame, at, np.array(v.fold_angles))
    if frame.loads and len(fold_vertices(frame)[0]) > 1:
        raise FoldFileError(
            f"{LOADS_KEY} are for one vertex, the frame has several: leave them out"
        )
    if not all(isinstance(load, Mapping) for load in frame.loads):
        raise FoldFileError(f"{LOADS_KEY} must be a list of objects, as [[loads]] of a scene file")
    loads: dict[str, Any] = {"loads": frame.loads} if frame.loads else {}
    if frame.loads and frame.fixed_facet is not None:
        loads["fixed_facet"] = frame.fixed_facet
    made = Scene(
        make_vertex(v.sector_angles),
        tuple(k.tolist()),
        tuple(rest.tolist()),
        symmetry,
        contact,
        name=f"{frame.title or 'FOLD'}, vertex {v.number}",
        symmetry_tolerance=NOISE,
        source=f"{frame.source}, vertex {v.number}" if frame.source else "",
        preload=tuple(np.nan_to_num(frame.preload[at]).tolist()),
        limits=() if frame.limits is None else tuple(map(tuple, frame.limits[at].tolist())),
        laws=tuple(frame.laws[e] for e in at) if frame.laws else (),
        **loads,
    )
    said = asked.notes(frame, at, np.array(v.fold_angles))
    for note in (*frame.notes, *notes, *(f"vertex {v.number}: {n}" for n in v.notes), *said):
        on_note(note)
    return made


def _vertex_at(
    frame: Frame, number: int | None, found: Sequence[FoldVertex], notes: Sequence[str]
) -> FoldVertex:
    """Return the interior vertex of that number, or the only one that can be analysed."""
    why = "" if found else "".join(f"; {note}" for note in notes)
    if number is not None:
        check_whole("number", number, 0)
    here = [v for v in found if (v.number == number if number is not None else not v.reason)]
    if len(here) == 1:
        return here[0]
    some = listed([v.number for v in (here or found)], 12) or "none"
    if number is None:
        many = f"{len(here)} interior vertices can be analysed ({some})"
        raise OptionError(f"--vertex is needed: {many}; origami-nlp inspect lists them{why}")
    there = f"interior vertex with creases of frame {frame.number}: there are {some}{why}"
    raise FoldFileError(f"--vertex {shown(number)} is no {there}")
