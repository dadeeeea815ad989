"""Do fold angles close round every vertex and hole, and do faces pass through each other there."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import NOISE, PLACES, quaternion
from origami_nlp.pattern import Loop, Pattern, listed
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.validity.faults import CLOSES, CROSSINGS, MILLI, Findings
from origami_nlp.validity.geometry import is_coarse


def check_closure(
    f: Findings, problem: PatternProblem, phi: np.ndarray, beside_folded: bool = False
) -> bool | None:
    """Check that fold angles [n] close round every vertex and hole; whether they do, None where at no vertex.

    Springs are driven to such angles, and whether a state was meant is not known, unless it stands beside.
    """
    p, begin = problem.pattern, 0
    values = problem.closure.values(phi)
    digits = math.radians(MILLI) if is_coarse(phi) else PLACES
    open_ = []
    for loop in (*p.vertices, *p.holes):
        own = values[begin : begin + (3 if loop.vertex >= 0 else 6)]
        begin += len(own)
        if np.linalg.norm(own) > 0.5 * digits * len(loop.creases) + NOISE * 0.1:
            open_.append((loop, 2 * math.asin(min(float(np.linalg.norm(own[:3])), 1.0)), own[3:]))
    if p.vertices and sum(loop.vertex >= 0 for loop, *_ in open_) == len(p.vertices):
        why = "fold angles close round no vertex: targets of springs"
        f.skip(CLOSES, why if beside_folded else f"{why}, or no state", undecided=not beside_folded)
        return None
    for loop, miss, shift in open_:
        text = f"fold angles do not close: {math.degrees(miss):.3g} degrees are left"
        apart = f", and ends are {np.linalg.norm(shift):.1e} of the sheet apart" * bool(len(shift))
        _fault(f, p, loop, text + apart, miss)
    if not open_ and not problem.closure.lifts_to_one(phi):
        for loop in (loop for loop in p.vertices if _turn(p, loop, phi) < 0):
            text = "folds turn the sheet over once more than paper allows (q = -1): a mountain and a valley are"
            _fault(f, p, loop, f"{text} exchanged")
    return f.settle(CLOSES, f"{len(p.vertices)} vertices, {len(p.holes)} holes")


def _fault(f: Findings, p: Pattern, loop: Loop, text: str, size: float | None = None) -> None:
    vertices = [loop.vertex] if loop.vertex >= 0 else []
    where = f"round vertex {loop.vertex}" if vertices else "round a hole"
    edges = p.numbers[list(loop.creases)].tolist()
    f.fault(CLOSES, f"{where} {text}", size, vertices=vertices, edges=edges)


def _turn(p: Pattern, loop: Loop, phi: np.ndarray) -> float:
    """Return the first entry of the quaternion of all folds round a vertex."""
    q = quaternion.IDENTITY
    for c, sign in zip(loop.creases, loop.signs, strict=True):
        half = 0.5 * float(phi[c])
        fold = quaternion.fold(math.cos(half), math.sin(half), sign * p.directions[c])
        q = quaternion.multiply(q, fold)
    return float(q[0])


def check_crossings(f: Findings, problem: PatternProblem, phi: np.ndarray) -> bool:
    """Check that no faces pass through each other; whether that is so."""
    for a, b, deep, at in problem.crossings.measure(phi):
        if deep > f.lengths():
            words = face_words(f, problem.pattern, a, b)
            share = f"{deep / problem.crossings.size:.2g} of the sheet deep"
            faces = [a, b] if f.frame.faces else []
            text = f"{words} pass through each other, {share}"
            f.fault(CROSSINGS, text, deep, faces=faces, place=at)
    return f.settle(CROSSINGS, f"{len(problem.pattern.polygons)} faces")


def face_words(f: Findings, p: Pattern, *which: int) -> str:
    """Name polygons: faces of the file by their numbers, others by their vertices."""
    s = "s" * (len(which) > 1)
    if f.frame.faces:
        return f"face{s} {listed(which)}"
    return f"the face{s} at vertices {', '.join('-'.join(map(str, p.polygons[k])) for k in which)}"
