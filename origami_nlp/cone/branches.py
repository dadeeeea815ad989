"""Branches of the cone: where they end, fold angles on them, and what touches at the end.

A branch is an assignment of the flaps and a sign of the elevation (+1 "up", v > 0; -1 "down"; the
paper's Q(e2, v): v > 0 lowers the rim, so the tip of the vertex stands up).  Up, valley flaps take
the smaller ("shallow") partial fold angle and mountain flaps the larger ("steep") one; down, the
other way round.  So a branch is known by its flaps and by which of them are steep.

Ends.  At |v| = pi/2 - 2 pi/N every steep partial fold angle is pi/2: neighbouring steep flaps close
onto each other, and the even creases of all steep flaps stand on the axis, so that steep flaps meet
there tip to tip, neighbours or not.  With two or more steep flaps this is contact.  A single steep flap has
nothing to touch on the axis and can go on: with an even number of flaps to pi/2, where it lies on the
flap opposite, with an odd number until its even crease meets the odd crease opposite, at
cos v = tan(pi/N).  Without steep flaps the odd creases meet on the axis at pi/2.  Derived here;
`tests/cone/test_kinematics.py` compares with the examination of embeddings.  The rule "contract" (the default)
cuts the branches of a single steep flap at pi/2 - 2 pi/N as well, where nothing touches (`is_cut`); "contact"
follows them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.closed_forms import cone_fold_angles
from origami_nlp.cone.flaps import (
    Flaps,
    check_degree,
    class_of,
    parse_flaps,
    symmetry_of,
    write_flaps,
)
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.pattern import Vertex, format_angle

UP, DOWN = 1, -1
END_RULES = ("contract", "contact")
SLACK = 4e-15
"""Elevations this little past an end are taken for the end: pi/6 and pi/2 - pi/3 differ in rounding [rad]."""


def steep_end(degree: int) -> float:
    """|v| where every steep partial fold angle is pi/2: pi/2 - 2 pi/N."""
    return math.pi * (check_degree(degree) - 4) / (2 * degree)


def lone_end(degree: int) -> float:
    """|v| where a branch with a single steep flap touches."""
    if check_degree(degree) % 4 == 0:
        return math.pi / 2
    return math.acos(math.tan(math.pi / degree))


def branch_end(degree: int, steep: Any, end: str = "contract") -> np.ndarray:
    """|v| at which branches with `steep` steep flaps end, shape of `steep` [rad].

    Raises
    ------
    OptionError
        If `end` is neither "contract" nor "contact".
    """
    if not isinstance(end, str) or end not in END_RULES:
        raise OptionError(f"end = {shown(end)}: write {' or '.join(END_RULES)}")
    count = np.asarray(steep)
    lone = lone_end(degree) if end == "contact" else steep_end(degree)
    return np.select([count == 0, count == 1], [math.pi / 2, lone], steep_end(degree))


def is_cut(steep: Any, end: str = "contract") -> np.ndarray:
    """Whether branches with `steep` steep flaps are cut where nothing touches, shape of `steep`.

    True for a single steep flap under the rule "contract": the branch goes on past `branch_end`.
    """
    return (np.asarray(steep) == 1) & (end == "contract")


@dataclass(frozen=True)
class ConeBranch:
    """One branch of a cone.

    flaps: assignment, +1 valley and -1 mountain.
    direction: sign of the elevation, +1 up or -1 down.
    end_rule: see `branch_end`.
    """

    flaps: Flaps
    direction: int
    end_rule: str = "contract"

    def __post_init__(self) -> None:
        object.__setattr__(self, "flaps", parse_flaps(self.flaps))
        if self.direction not in (UP, DOWN):
            raise OptionError(f"direction = {self.direction!r}: up is +1, down is -1")
        branch_end(self.degree, 0, self.end_rule)  # complains about an unknown rule

    @property
    def degree(self) -> int:
        """Number of creases N."""
        return 2 * len(self.flaps)

    @property
    def steep(self) -> int:
        """Number of flaps with the larger partial fold angle."""
        return sum(f != self.direction for f in self.flaps)

    @property
    def end(self) -> float:
        """|v| at which the branch ends [rad]."""
        return float(branch_end(self.degree, self.steep, self.end_rule))

    @property
    def end_text(self) -> str:
        """What happens at the end of the branch, in words."""
        if self.steep == 0:
            return "all odd creases meet on the axis"
        if self.steep > 1:
            return "steep flaps meet on the axis"
        if self.end_rule == "contract":
            return "the even crease of the steep flap stands on the axis (no contact yet)"
        if self.degree % 4 == 0:
            return "folded flat, the steep flap on the flap opposite"
        return "the even crease of the steep flap meets the odd crease opposite"

    @property
    def symmetry(self) -> str:
        """Symmetry of its states, "D3" or "C1" for example."""
        return symmetry_of(self.flaps)

    @property
    def vertex(self) -> Vertex:
        """The flat sheet."""
        return Vertex((2 * math.pi / self.degree,) * self.degree)

    def fold_angles(self, elevation: Any) -> np.ndarray:
        """Fold angles of all creases, shape S + (N,) for elevations of shape S [rad].

        elevation: signed as the branch (0 is the flat state).

        Raises
        ------
        AngleError
            On the wrong side of the flat state, and past the end of the branch, where facets would
            pass through each other: no other root is followed.
        """
        v = np.asarray(elevation, dtype=float)
        if not np.all(np.isfinite(v)):
            raise AngleError("elevation must be finite")
        if np.any(v * self.direction < 0):
            raise AngleError(
                f"elevation = {float(v[v * self.direction < 0].flat[0]):.6g}: the branch {self!r} has "
                f"elevations {'>' if self.direction > 0 else '<'}= 0"
            )
        if np.any(np.abs(v) > self.end + SLACK):
            raise AngleError(
                f"elevation = {float(v.flat[np.argmax(np.abs(v))]):.6g} is past the end of the branch "
                f"{self!r} at |elevation| = {format_angle(self.end)}: {self.end_text}"
            )
        return cone_fold_angles(self.degree, v, self.flaps).value

    def __repr__(self) -> str:
        word = write_flaps(self.flaps)
        return f"{word if len(word) <= 24 else word[:21] + '...'} {direction_name(self.direction)}"


def direction_name(direction: int) -> str:
    """Word for a sign of the elevation."""
    return "up" if direction > 0 else "down"


def class_label(valleys: int, changes: int, degree: int, direction: int) -> str:
    """Name a class of branches in the paper's way: "M2V up", or "M2V2 up (4 changes)".

    The number of changes is added where the valleys could also lie otherwise.
    """
    n = degree // 2
    parts = [(letter, k) for letter, k in (("M", n - valleys), ("V", valleys)) if k]
    word = "".join(letter + (str(k) if k > 1 else "") for letter, k in parts)
    several = min(valleys, n - valleys) > 1
    more = f" ({changes} changes)" if several else ""
    return f"{word} {direction_name(direction)}{more}"


def branch_label(flaps: Sequence[int], direction: int) -> str:
    """Name the class of a branch, see `class_label`."""
    valleys, changes = class_of(flaps)
    return class_label(valleys, changes, 2 * len(flaps), direction)
