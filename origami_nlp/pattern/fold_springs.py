"""What springs a frame of a FOLD file gets where it states none: which ways there are, and what is said about them."""

from __future__ import annotations

import math
from typing import Any

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import FoldFileError
from origami_nlp.pattern.fold_file import Frame

LETTERS_ONLY = (
    "M and V without angles: creases rest at -180 and +180 degrees, so that folded flat as drawn has U = 0; "
    "--rest-angle 90 lets them rest half way"
)


def check_fold_springs(frame: Frame, stiffness: float, rest_angle: float, rest_angles: Any) -> None:
    """Complain unless springs can be had of a frame in the way asked for; parameters as for `frame_pattern`."""
    check_number("stiffness", stiffness)
    check_number("rest_angle", rest_angle, 0.0, math.pi)
    if rest_angles not in (None, "file", "measured"):
        raise FoldFileError(
            f"--rest-angles = {shown(rest_angles)} must be file or measured, the angles at which a folded form rests; "
            "the size for creases without an angle is --rest-angle, in degrees"
        )
    if rest_angles == "measured" and not frame.folded:
        raise FoldFileError(
            f"--rest-angles measured: frame {frame.number} is a crease pattern, on which no angle can be measured; "
            "--rest-angle gives the size for creases without an angle"
        )
