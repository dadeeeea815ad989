"""What springs a frame of a FOLD file gets where it states none: which ways there are, and what is said about them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import FoldFileError
from origami_nlp.pattern.fold_file import Frame
from origami_nlp.pattern.fold_notes import listed

LETTERS_ONLY = "M and V without angles rest at -180 and +180 degrees; --rest-angle 90: half way"

APART = math.radians(1.0)
"""Measured and stated fold angles [rad] that differ by more are worth a word."""


@dataclass(frozen=True)
class FoldSprings:
    """Springs of creases for which a frame states none.

    Parameters
    ----------
    stiffness
        Of those for which the file gives none [N m/rad].
    rest_angle
        Size of the rest angle of mountains and valleys for which the file gives neither a rest angle nor a fold angle
        [rad]; FOLD's M and V alone mean folded flat.  Others rest at 0.
    rest_from
        What a folded form rests at: what the file says, as of a crease pattern (``"file"``), or the angles at which
        it is folded (``"measured"``).  Default: of each crease the file's angle, and the measured one where the
        file has none.
    """

    stiffness: float = 1.0
    rest_angle: float = math.pi
    rest_from: Literal["file", "measured"] | None = None

    def check(self, frame: Frame) -> None:
        """Raise an error unless springs can be had of a frame in this way."""
        check_number("stiffness", self.stiffness)
        check_number("rest_angle", self.rest_angle, 0.0, math.pi)
        if self.rest_from not in (None, "file", "measured"):
            raise FoldFileError(f"--rest-from = {shown(self.rest_from)} must be file or measured")
        if self.rest_from == "measured" and not frame.folded:
            where = f"frame {frame.number} is a crease pattern, with no angle to measure"
            raise FoldFileError(f"--rest-from measured: {where}; --rest-angle gives the size")

    def of(self, frame: Frame, edges: Any, measured: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return stiffness [N m/rad] and rest angle [rad] of some edges, [n] each.

        measured: the angles at which a folded form is folded [rad], [n]; NaN where they are not known.
        """
        at = np.asarray(edges, dtype=np.intp)
        k = np.where(np.isnan(frame.stiffness[at]), self.stiffness, frame.stiffness[at])
        stated = (frame.rest_angles[at], frame.fold_angles[at])
        ways = {"file": stated, "measured": (measured,), None: (*stated, measured)}
        sizes = {"M": -self.rest_angle, "V": self.rest_angle}
        letters = np.array([sizes.get(frame.assignment[e], 0.0) for e in at])
        rest = np.full(len(at), math.nan)
        for way in (*ways[self.rest_from], letters):
            rest = np.where(np.isnan(rest), way, rest)
        return k, np.clip(rest, -math.pi, math.pi)

    def notes(self, frame: Frame, edges: Any, measured: np.ndarray) -> list[str]:
        """Say in a line each what was asked for that no crease got, and what letters alone mean; as for `of`."""
        at = np.asarray(edges, dtype=np.intp)
        rest, flat = (
            one.of(frame, at, measured)[1] for one in (self, replace(self, rest_angle=0.0))
        )
        idle = {
            "--rest-angle": self.rest_angle != math.pi and np.array_equal(rest, flat),
            "--stiffness": self.stiffness != 1.0 and not np.isnan(frame.stiffness[at]).any(),
        }
        said = [
            f"{name} is not used: each crease has its own"
            for name, is_idle in idle.items()
            if is_idle
        ]
        silent = (np.isnan(frame.fold_angles[at]) & np.isnan(frame.rest_angles[at])).all()
        drawn = {frame.assignment[e] for e in at} & set("MV")
        letters = drawn and (not frame.folded or self.rest_from == "file")
        return said + [LETTERS_ONLY] * bool(silent and letters and self.rest_angle == math.pi)


def target_notes(frame: Frame, edges: Any, measured: np.ndarray) -> list[str]:
    """Say where the angles at which a folded form is folded are not those that its file states; as for `of`."""
    at = np.asarray(edges, dtype=np.intp)
    stated = frame.fold_angles[at]
    apart = np.nan_to_num(np.abs(measured - stated))
    if other := sorted(frame.numbers[at][apart > APART].tolist()):
        most = f"by up to {math.degrees(apart.max()):.3g} degrees"
        where = (
            f"edges_foldAngle of edges {listed(other)} are not those of the coordinates ({most})"
        )
        return [f"{where}: creases rest at those of the file; --rest-from measured: at the others"]
    silent = np.isnan(stated) & np.isnan(frame.rest_angles[at])
    drawn = {frame.assignment[e] for e in at} & set("MV")
    if drawn and silent.all() and np.abs(measured).max() < APART:
        return [
            "it lies flat, without fold angles: creases rest at 0; --rest-from file: by letters"
        ]
    return []


def stated_sign(frame: Frame, edge: int) -> float:
    """Return the sign of an edge's fold: of its angle in the file, else of its letter; 0 where neither says."""
    angle = frame.fold_angles[edge]
    if angle and not math.isnan(angle):
        return math.copysign(1.0, angle)
    return {"M": -1.0, "V": 1.0}.get(frame.assignment[edge], 0.0)
