"""Branches of the cone: fold angles on them, and what touches where they end.

A branch is an assignment of the flaps and a sign of the elevation (+1 "up", v > 0; -1 "down"; the
paper's Q(e2, v): v > 0 lowers the rim, so the tip of the vertex stands up).  Up, valley flaps take
the smaller ("shallow") partial fold angle and mountain flaps the larger ("steep") one; down, the
other way round.  So a branch is known by its flaps and by which of them are steep.  Where it ends: `cone.rules`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral
from typing import Any

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.closed_forms import cone_fold_angles
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.paper.cone.classes import direction_name
from origami_nlp.paper.cone.flaps import Flaps, parse_flaps, write_flaps
from origami_nlp.paper.cone.rules import SLACK, Cone
from origami_nlp.pattern import format_angle


@dataclass(frozen=True)
class ConeBranch:
    """One branch of a cone: its fold angles, where it ends, and what touches there.

    Attributes
    ----------
    flaps
        Valleys and mountains around the ring: "VVM", "V2M", or +1 and -1, one a flap; N/2 of them.
    direction
        Sign of the elevation: +1 or "up", -1 or "down".
    end_rule
        Where a branch with a single steep flap ends, see `Cone`.

    Raises
    ------
    OptionError
        If there is no such branch.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> own = cone.ConeBranch("VVM", "up")
    >>> round(own.end, 4), own.end_text
    (0.5236, 'the even crease of the steep flap stands on the axis (no contact yet)')
    >>> own.fold_angles(0.3).round(3).tolist()
    [-0.946, -0.6, 0.162, -0.6, -0.946, 0.6]
    """

    flaps: Flaps
    direction: int
    end_rule: str = "contract"

    def __init__(
        self, flaps: str | Sequence[int], direction: int | str = 1, end_rule: str = "contract"
    ) -> None:
        known = isinstance(direction, str | Integral) and not isinstance(direction, bool)
        sign = {"up": 1, "down": -1, 1: 1, -1: -1}.get(direction) if known else None
        if sign is None:
            raise OptionError(f"direction = {shown(direction)}: write up or down, +1 or -1")
        vars(self).update(flaps=parse_flaps(flaps), direction=sign, end_rule=end_rule)
        _ = self.cone  # raises an error for an unknown rule

    @property
    def cone(self) -> Cone:
        """The cone it is a branch of."""
        return Cone(self.degree, end=self.end_rule)

    @property
    def degree(self) -> int:
        """Number of creases N."""
        return 2 * len(self.flaps)

    @property
    def steep(self) -> int:
        """Number of flaps with the larger partial fold angle."""
        # up: mountains are steep, down: valleys (paper, eq. 4.3; its modulus holds for |v| <= pi/2 - alpha only:
        # docs/validation/errata.md)
        return sum(f != self.direction for f in self.flaps)

    @property
    def end(self) -> float:
        """|v| at which the branch ends [rad]."""
        return float(self.cone.ends(self.steep))

    @property
    def end_text(self) -> str:
        """What happens at the end of the branch, in words."""
        if self.steep == 0:
            return "all odd creases meet on the axis"
        if self.steep > 1:
            return "steep flaps meet on the axis"
        if self.end_rule == "contract":
            return "the even crease of the steep flap stands on the axis (no contact yet)"
        # opposite an even crease lies an even crease where N / 2 is even, else an odd one
        if self.degree % 4 == 0:
            return "folded flat, the steep flap on the flap opposite"
        return "the even crease of the steep flap meets the odd crease opposite"

    def fold_angles(self, elevation: Any) -> np.ndarray:
        """Fold angles of all creases, shape S + (N,) for elevations of shape S [rad].

        elevation: signed as the branch (0 is the flat state).

        Raises
        ------
        AngleError
            On the wrong side of the flat state, and past the end of the branch, where facets would
            intersect: no other root is followed.
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
        return f"{write_flaps(self.flaps)} {direction_name(self.direction)}"
