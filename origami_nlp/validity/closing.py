"""Do fold angles close round every vertex and hole, and do faces pass through each other there."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.numerics import NOISE, PLACES, quaternion
from origami_nlp.pattern import Loop, Pattern
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.validity.faults import MILLI, Findings

CROSSINGS = "no faces pass through each other"


def check_closure(
    f: Findings, problem: PatternProblem, phi: np.ndarray, beside_folded: bool = False
) -> bool | None:
    """Check that fold angles [n] close round every vertex and hole; whether they do, None where at no vertex.

    Springs are driven to such angles, and whether a state was meant is not known, unless it stands beside.
    """
    p, name = problem.pattern, "closes round vertices and holes"
    values = problem.closure.values(phi)
    digits = math.radians(MILLI) if _is_coarse(phi) else PLACES
    most = [0.5 * digits * len(loop.creases) + NOISE * 0.1 for loop in (*p.vertices, *p.holes)]
    for k, loop in enumerate(p.vertices):
        miss = float(np.linalg.norm(values[3 * k : 3 * k + 3]))
        if miss > most[k]:
            f.fault(
                name,
                f"round vertex {loop.vertex} fold angles do not close: {_angle(miss)} are left",
                vertices=[loop.vertex],
                edges=p.numbers[list(loop.creases)].tolist(),
                size=2 * math.asin(min(miss, 1.0)),
                unit="rad",
            )
    if p.vertices and len(f.of(name)) == len(p.vertices):
        f.faults = [one for one in f.faults if one.test != name]
        why = "fold angles close round no vertex: targets of springs"
        f.skip(name, why if beside_folded else f"{why}, or no state", undecided=not beside_folded)
        return None
    begin = 3 * len(p.vertices)
    for k, loop in enumerate(p.holes):
        six = values[begin + 6 * k : begin + 6 * k + 6]
        miss = float(np.linalg.norm(six))
        if miss > most[len(p.vertices) + k]:
            turn = float(np.linalg.norm(six[:3]))
            f.fault(
                name,
                f"round a hole fold angles do not close: {_angle(turn)} are left, and ends are "
                f"{np.linalg.norm(six[3:]):.1e} of the sheet apart",
                edges=p.numbers[list(loop.creases)].tolist(),
                size=2 * math.asin(min(turn, 1.0)),
                unit="rad",
            )
    if not f.of(name) and not problem.closure.lifts_to_one(phi):
        for loop in p.vertices:
            if _turn(p, loop, phi) < 0:
                f.fault(
                    name,
                    f"round vertex {loop.vertex} folds turn the sheet over once more than paper allows (q = -1): a "
                    "mountain and a valley are exchanged",
                    vertices=[loop.vertex],
                    edges=p.numbers[list(loop.creases)].tolist(),
                )
    return f.settle(name, f"{len(p.vertices)} vertices, {len(p.holes)} holes")


def _turn(p: Pattern, loop: Loop, phi: np.ndarray) -> float:
    """Return the first entry of the quaternion of all folds round a vertex."""
    q = quaternion.IDENTITY
    for c, sign in zip(loop.creases, loop.signs, strict=True):
        half = 0.5 * float(phi[c])
        q = quaternion.multiply(
            q, quaternion.fold(math.cos(half), math.sin(half), sign * p.directions[c])
        )
    return float(q[0])


def check_crossings(f: Findings, problem: PatternProblem, phi: np.ndarray) -> bool:
    """Check that no faces pass through each other; whether that is so."""
    name, size = CROSSINGS, problem.crossings.size
    for a, b, deep, at in problem.crossings.measure(phi):
        if deep > f.lengths():
            f.fault(
                name,
                f"{face_words(f, problem.pattern, a, b)} pass through each other, {deep / size:.2g} of the sheet "
                "deep",
                vertices=[],
                faces=[a, b] if f.frame.faces else [],
                place=at,
                size=deep,
                unit="length",
            )
    return f.settle(name, f"{len(problem.pattern.polygons)} faces")


def face_words(f: Findings, p: Pattern, *which: int) -> str:
    """Name polygons: faces of the file by their numbers, others by their vertices."""
    if f.frame.faces:
        names = [str(k) for k in which]
        what = "faces" if len(names) > 1 else "face"
    else:
        names = ["-".join(map(str, p.polygons[k])) for k in which]
        what = "the faces at vertices" if len(names) > 1 else "the face at vertices"
    return f"{what} {listed_words(names)}"


def listed_words(names: list[str]) -> str:
    """Join names by commas and an 'and'."""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + f" and {names[-1]}"


def _is_coarse(phi: np.ndarray) -> bool:
    milli = np.degrees(phi) / MILLI
    return bool((np.abs(milli - np.round(milli)) <= PLACES).all())


def _angle(miss: float) -> str:
    return f"{math.degrees(2 * math.asin(min(miss, 1.0))):.3g} degrees"
