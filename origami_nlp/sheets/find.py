"""Finds the stable states of a sheet: curves traced where one freedom is left, descents from starts elsewhere."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.numerics import CLOSES, RESOLVED, SAME
from origami_nlp.pattern import Pattern
from origami_nlp.sheets.branches import Branches, list_branches
from origami_nlp.sheets.curve import STEP, Curve, follow_curve, tangents, wells
from origami_nlp.sheets.descent import descend
from origami_nlp.sheets.judgement import judge
from origami_nlp.sheets.pinned import find_pinned, judge_pinned
from origami_nlp.sheets.result import SheetResult, SheetSearch
from origami_nlp.sheets.sheet import Sheet
from origami_nlp.sheets.state import SheetState

OUT = 0.2
"""First step out of the flat state, of the longest fold angle [rad]."""
MOST_TRACED = 250
"""Creases up to which curves are traced; descents beyond."""
MOST_CURVES = 64
"""That are traced."""
ON_CURVE = 1e-6
"""A state this close to a curve is on it [rad]."""


@dataclass(eq=False)
class _Tally:
    """What a search has met so far."""

    starts: int = 0
    open: int = 0
    flat: int = 0
    unfinished: int = 0
    judged: list[SheetState] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)
    outside: int = 0

    def add(self, state: SheetState) -> None:
        """Keep a state, once."""
        if state.verdict == "no state":
            self.open += 1
        elif not any(
            np.abs(state.fold_angles - s.fold_angles).max() <= 10 * SAME for s in self.judged
        ):
            self.judged.append(state)


def find_states(
    pattern: Pattern, starts: int = 40, seed: int = 0, contact: bool = True
) -> SheetResult:
    """Find the stable states of a pattern.

    Parameters
    ----------
    pattern
        With its springs.
    starts
        Random starts, beside those that the pattern itself gives.
    seed
        Of the random starts.
    contact
        Whether facets must not cross; without, only fold limits count.

    Returns
    -------
    SheetResult
        Minima with their certificates, what could not be decided, and what was enumerated, sampled, and ended open.

    Raises
    ------
    OptionError
        If `starts` or `seed` is no count.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_states(o.examples.pattern("metasheet", 2, 3), starts=4)
    >>> all(state.closure_residual < 1e-12 for state in found.minima)
    True
    """
    starts, seed = check_whole("starts", starts, 0), check_whole("seed", seed, 0)
    sheet, tally = Sheet(pattern), _Tally()
    branches = list_branches(pattern)
    if pattern.is_flat:
        tally.add(judge(sheet, np.zeros(pattern.creases), contact))
    known = len(branches.lines)
    for k, start in enumerate(_starts(sheet, branches, starts, np.random.default_rng(seed))):
        tally.starts += 1
        phi, residual = sheet.project(np.clip(start, -math.pi, math.pi))
        if residual > CLOSES or not sheet.closure.on_sheet(phi) or np.abs(phi).max() > math.pi:
            tally.open += 1
        elif pattern.is_flat and np.abs(phi).max() < RESOLVED**0.5:
            tally.flat += 1
        else:
            _explore(sheet, phi, tally, k >= known, contact)
    return SheetResult(
        pattern, tuple(sorted(tally.judged, key=lambda s: s.energy)), _search(branches, tally)
    )


def _search(branches: Branches, tally: _Tally) -> SheetSearch:
    """Sum up what was done."""
    return SheetSearch(
        tally.starts,
        tally.open,
        tally.flat,
        tally.unfinished,
        len(branches.lines),
        len(branches.families),
        branches.reason,
        len(tally.curves),
        sum(c.complete for c in tally.curves),
        tally.outside,
    )


def _starts(
    sheet: Sheet, branches: Branches, count: int, rng: np.random.Generator
) -> Iterator[np.ndarray]:
    """Yield fold angles [n] to be closed: what is enumerated, what the file says, what is drawn."""
    pattern = sheet.pattern
    for d in branches.lines:
        yield OUT * d / np.abs(d).max()
    for basis in branches.families:
        for _ in range(2):
            d = basis @ rng.normal(size=basis.shape[1])
            yield from (OUT * d / np.abs(d).max(), -OUT * d / np.abs(d).max())
    for d in branches.lines:  # the other way, should a walk not have come through the flat state
        yield -OUT * d / np.abs(d).max()
    if not np.isnan(pattern.file_angles).any():
        yield pattern.file_angles
    if pattern.reference.any():
        yield pattern.reference
    if pattern.signs.any():
        yield from (0.4 * pattern.signs, 1.0 * pattern.signs)
    if pattern.rest.any():
        yield from (0.3 * pattern.rest, pattern.rest)
    for k in range(count):
        if k % 2 or not pattern.is_flat:
            size = rng.uniform(0.3, math.pi)
            yield rng.uniform(-size, size, pattern.creases)
        else:
            yield _grown(sheet, rng)


def _grown(sheet: Sheet, rng: np.random.Generator) -> np.ndarray:
    """Grow a state out of the flat one by steps along what closure leaves free: for patterns with many freedoms."""
    phi, residual = sheet.project(rng.uniform(-0.3, 0.3, sheet.size))
    way = phi
    for _ in range(int(rng.integers(0, 8))):
        way = sheet.along(phi, way + 0.5 * rng.normal(size=sheet.size) * np.abs(way).max())
        size = float(np.abs(way).max())
        if residual > CLOSES or size < RESOLVED:
            break
        new, residual = sheet.project(phi + 0.3 * way / size)
        if residual > CLOSES or np.abs(new).max() > math.pi or not sheet.closure.on_sheet(new):
            break
        phi = new
    return phi


def _explore(sheet: Sheet, phi: np.ndarray, tally: _Tally, drawn: bool, contact: bool) -> None:
    """Trace the curve of a closed state, or go downhill from it, and judge what is found."""
    if sheet.size <= MOST_TRACED and len(tally.curves) < MOST_CURVES:
        z = tangents(sheet, phi)
        if z.shape[1] == 1:
            if not any(_on(sheet, c, phi) for c in tally.curves):
                tally.outside += drawn
                _trace(sheet, phi, z[:, 0], tally, contact)
            return
    end = descend(sheet, phi)
    if not end.arrived:
        tally.unfinished += 1
        return
    tally.add(judge(sheet, end.phi, contact))


def _trace(sheet: Sheet, phi: np.ndarray, along: np.ndarray, tally: _Tally, contact: bool) -> None:
    """Trace a curve; its wells are polished and judged, and so are states that touching facets hold."""
    curve = follow_curve(sheet, phi, along)
    tally.curves.append(curve)
    for well, _ in wells(sheet, curve):
        end = descend(sheet, well)
        if not end.arrived:
            tally.unfinished += 1
            continue
        tally.add(judge(sheet, end.phi, contact))
    if contact:
        for pinned in find_pinned(sheet, curve):
            if pinned.falls:
                tally.add(judge_pinned(sheet, pinned))


def _on(sheet: Sheet, curve: Curve, phi: np.ndarray) -> bool:
    """Tell whether a closed state is on a curve: the curve's state closest to it is found by Newton."""
    distance = np.linalg.norm(curve.phi - phi, axis=1)
    i = int(distance.argmin())
    if distance[i] > 2 * STEP * math.sqrt(sheet.size):
        return False
    here = curve.phi[i]
    for _ in range(4):
        here, residual = sheet.project(here + sheet.along(here, phi - here))
        if residual > CLOSES:
            return False
    return bool(np.abs(here - phi).max() < ON_CURVE)
