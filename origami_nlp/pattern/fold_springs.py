"""What springs a frame of a FOLD file gets where it states none: which ways there are, and what is said about them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import FoldFileError
from origami_nlp.pattern.fold_file import Frame

LETTERS_ONLY = (
    "M and V without angles: creases rest at -180 and +180 degrees, so that folded flat as drawn has U = 0; "
    "--rest-angle 90 lets them rest half way"
)


def check_fold_springs(frame: Frame, stiffness: float, rest_angle: float, rest_from: Any) -> None:
    """Raise an error unless springs can be had of a frame in the way asked for; parameters as for `frame_pattern`."""
    check_number("stiffness", stiffness)
    check_number("rest_angle", rest_angle, 0.0, math.pi)
    if rest_from not in (None, "file", "measured"):
        raise FoldFileError(
            f"--rest-from = {shown(rest_from)} must be file or measured, the angles at which a folded form rests; "
            "the size for creases without an angle is --rest-angle, in degrees"
        )
    if rest_from == "measured" and not frame.folded:
        raise FoldFileError(
            f"--rest-from measured: frame {frame.number} is a crease pattern, on which no angle can be measured; "
            "--rest-angle gives the size for creases without an angle"
        )


def fold_springs(
    frame: Frame,
    edges: ArrayLike,
    measured: np.ndarray,
    stiffness: ArrayLike,
    rest_angle: float,
    rest_from: str | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Return stiffness [N m/rad] and rest angle [rad] of some edges, [n] each; other parameters as for `frame_pattern`.

    stiffness: of those for which the file states none, one or [n].
    measured: the angles at which a folded form is folded [rad], [n]; NaN where they are not known.
    """
    at = np.asarray(edges, dtype=np.intp)
    k = np.where(np.isnan(frame.stiffness[at]), stiffness, frame.stiffness[at])
    stated = (frame.rest_angles[at], frame.fold_angles[at])
    ways = {"file": stated, "measured": (measured,), None: (*stated, measured)}[rest_from]
    letters = [{"M": -rest_angle, "V": rest_angle}.get(frame.assignment[e], 0.0) for e in at]
    rest = np.full(len(at), math.nan)
    for way in (*ways, np.array(letters)):
        rest = np.where(np.isnan(rest), way, rest)
    return k, np.clip(rest, -math.pi, math.pi)


def spring_notes(
    frame: Frame,
    edges: ArrayLike,
    measured: np.ndarray,
    stiffness: ArrayLike = 1.0,
    rest_angle: float = math.pi,
    rest_from: str | None = None,
) -> list[str]:
    """Say in a line each what was asked for that no crease got, and what letters alone mean; as for `fold_springs`."""
    at = np.asarray(edges, dtype=np.intp)
    said = []
    if rest_angle != math.pi:
        one, other = (
            fold_springs(frame, at, measured, 1.0, angle, rest_from)[1] for angle in (math.pi, 0.0)
        )
        if np.array_equal(one, other):
            said.append(
                f"--rest-angle {math.degrees(rest_angle):g} is not used: each mountain and valley has an angle, stated "
                "or measured"
            )
    if (
        not (np.isscalar(stiffness) and stiffness == 1.0)
        and not np.isnan(frame.stiffness[at]).any()
    ):
        said.append("--stiffness is not used: the file states the stiffness of each crease")
    silent = (np.isnan(frame.fold_angles[at]) & np.isnan(frame.rest_angles[at])).all()
    drawn = {frame.assignment[e] for e in at} & set("MV")
    letters = drawn and (not frame.folded or rest_from == "file")
    if silent and letters and rest_angle == math.pi:
        said.append(LETTERS_ONLY)
    return said


def stated_sign(frame: Frame, edge: int) -> float:
    """Return the sign of an edge's fold: of its angle in the file, else of its letter; 0 where neither says."""
    angle = frame.fold_angles[edge]
    if angle and not math.isnan(angle):
        return math.copysign(1.0, angle)
    return {"M": -1.0, "V": 1.0}.get(frame.assignment[edge], 0.0)
