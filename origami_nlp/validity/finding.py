"""Check a file: every frame as a sheet, every folded state against its crease pattern, itself and its layers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.errors import OptionError, OrigamiError
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import (
    LATTICE_KEY,
    Frame,
    Pattern,
    frame_pattern,
    frames_of,
    listed,
)
from origami_nlp.pattern_problem import PatternProblem, states_to_fold
from origami_nlp.validity.closing import check_closure, check_crossings
from origami_nlp.validity.faults import CROSSINGS, PLANES, Findings
from origami_nlp.validity.flat_folding import check_flat_folding
from origami_nlp.validity.geometry import (
    check_fold_angles,
    check_isometry,
    check_letters,
    check_sheet,
    is_same_sheet,
    measured_on,
)
from origami_nlp.validity.result import Validity
from origami_nlp.validity.stacking import check_layers

LARGEST_TOLERANCE = 0.05
"""Share of the size of a sheet by which its places may be off."""


def check(
    source: str | PathLike[str] | Pattern | Mapping[str, Any],
    *,
    frame: int | None = None,
    tolerance: float | None = None,
) -> Validity:
    """Check whether the states of a file are real: all that is wrong, where, and by how much.

    A folded form is compared with the crease pattern in the same file: lengths, then planes of faces, fold angles,
    mountains and valleys, faces that pass through each other, the order of layers.  A crease pattern that states fold
    angles is folded by them; one that states none, or full ones, is asked whether it folds flat.

    Parameters
    ----------
    source
        A file that `read_pattern` takes, ``"-"`` for standard input, the name of an example, a pattern, or the data of
        a FOLD file.
    frame
        The frame that is checked, from 0; by default all with geometry.
    tolerance
        By how much places may be off, over the longest side of what the frame holds, up to 0.05; by default what the
        digits of a folded form leave (1e-6 to 1e-4), and 1e-4 of a drawing.

    Returns
    -------
    Validity
        The verdict, every test, every fault.

    Raises
    ------
    FoldFileError
        If the file cannot be read.
    OptionError
        If an argument is not what it must be.

    Examples
    --------
    A Miura sheet on its folding motion, and a corner of it moved by 0.01:

    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_problem import state_frame, states_to_fold
    >>> sheet = o.examples.pattern("miura", 2, 2)
    >>> phi = o.find_motion(sheet).fold_angles[5]
    >>> fold = states_to_fold(sheet, [state_frame(sheet, phi, "folded")])
    >>> o.check(fold).verdict
    'valid'
    >>> fold["file_frames"][0]["vertices_coords"][0][0] += 0.01
    >>> {fault.test for fault in o.check(fold).faults}
    {'lengths as in the crease pattern'}
    """
    if tolerance is not None:
        check_number("tolerance", tolerance, 0.0, LARGEST_TOLERANCE)
    if frame is not None:
        check_whole("frame", frame, 0)
    name, frames = _read(source)
    if any(one.lattice is not None for one in frames):
        raise OptionError(f"{LATTICE_KEY}: a cell that repeats is not checked, a sheet is")
    chosen = [one for one in frames if frame in (None, one.number)]
    if not chosen:
        known = listed([one.number for one in frames], 12)
        raise OptionError(f"frame = {frame} is no frame with geometry: there is {known}")
    flat = [one for one in frames if not one.folded]
    folded = any(one.folded for one in chosen)
    seen = [Findings(one, tolerance) for one in chosen]
    for f in seen:
        if f.frame.folded:
            _check_folded(f, flat)
        else:
            _check_pattern(f, beside_folded=folded)
    kinds = tuple((one.number, "folded form" if one.folded else "crease pattern") for one in chosen)
    tests = tuple(t for f in seen for t in f.tests)
    faults = tuple(fault for f in seen for fault in f.in_order())
    notes = dict.fromkeys(note for f in seen for note in (*f.frame.notes, *f.notes))
    return Validity(name, kinds, tests, faults, tuple(notes), tuple(chosen))


def _read(source: str | PathLike[str] | Pattern | Mapping[str, Any]) -> tuple[str, list[Frame]]:
    """Return the title and the frames with geometry."""
    if isinstance(source, Pattern):
        source.check_alone("a check")
        return source.title, list(frames_of(states_to_fold(source)))
    title = source.get("file_title") if isinstance(source, Mapping) else str(source)
    return "standard input" if title == "-" else str(title or "FOLD data"), list(frames_of(source))


def _check_folded(f: Findings, flat: Sequence[Frame]) -> None:
    """Check a folded form."""
    pattern = check_sheet(f)
    mate = next((one for one in flat if is_same_sheet(f.frame, one)), None)
    as_paper = check_isometry(f, mate, bool(flat))
    sheet = None if mate is None else _sheet_of(mate, f.frame)
    measured = pattern or (None if sheet is None else measured_on(sheet, f.frame))
    if measured is None:
        f.skip("the state as a sheet of rigid facets", "its faces make no sheet", undecided=True)
        return
    check_fold_angles(f, measured)
    if not as_paper or pattern is None or f.of(PLANES):
        f.skip(CROSSINGS, "the coordinates are none of the sheet", undecided=True)
        return
    if sheet is not None and sheet.numbers.tolist() == measured.numbers.tolist():
        check_closure(f, PatternProblem(sheet), measured.reference)
    problem = PatternProblem(measured)
    if check_crossings(f, problem, measured.reference):
        check_layers(f, problem, measured.reference)


def _sheet_of(mate: Frame, folded: Frame) -> Pattern | None:
    """Return the crease pattern with the fold angles and letters of a folded form."""
    said = replace(mate, fold_angles=folded.fold_angles, assignment=folded.assignment)
    alike = np.array_equal(np.sort(mate.edges), np.sort(folded.edges))
    if not (alike and np.array_equal(mate.numbers, folded.numbers)):
        return None
    try:
        sheet = frame_pattern(said)
    except OrigamiError:
        return None  # said of that frame
    same = [{*q} for q in sheet.polygons] == [{*face} for face in folded.faces]
    return sheet if sheet.is_flat and same else None


def _check_pattern(f: Findings, beside_folded: bool) -> None:
    """Check a crease pattern: as a drawing, folded by its fold angles, or folded flat."""
    pattern = check_sheet(f)
    if pattern is None:
        if not beside_folded and not f.faults:
            check_flat_folding(f, None)
        f.skip("the pattern as a sheet of rigid facets", "its faces make no sheet", undecided=True)
        return
    stated = pattern.stated
    check_letters(f, pattern, np.zeros(pattern.creases))
    problem = PatternProblem(pattern)
    if stated is not None and not np.isin(np.abs(stated), (0.0, math.pi)).all():
        closes = check_closure(f, problem, stated, beside_folded)
        if closes is not None:
            _check_stated(f, problem, stated, closes)
            return
    if not beside_folded:
        check_flat_folding(f, problem)
        folds = all(t.status != "fault" for t in f.tests)
        if stated is not None and pattern.orders and folds:
            check_layers(f, problem, stated)


def _check_stated(f: Findings, problem: PatternProblem, stated: np.ndarray, closes: bool) -> None:
    """Check the state that a crease pattern states by fold angles."""
    if not closes:
        f.skip(CROSSINGS, "the state does not close", undecided=True)
        return
    phi, residual = problem.project(stated, np.abs(stated) == math.pi)
    if residual > CLOSURE_TOL or np.abs(phi).max(initial=0.0) > math.pi:
        why = "no closed state is near the fold angles that are stated"
        f.skip(CROSSINGS, why, undecided=True)
    elif check_crossings(f, problem, phi):
        check_layers(f, problem, phi)
