"""Branches of the cone: an assignment of valleys and mountains to its flaps, and a sign of the elevation.

A cone's n = N/2 flaps (two facets that share an even crease) are valleys (+1, V: partial fold angle rho_v >= 0) or
mountains (-1, M); a branch goes up (+1, v > 0) or down; the paper's Q(e2, v): v > 0 lowers the rim, so the tip of the
vertex stands up.  Up, valley flaps take the smaller ("shallow") partial fold angle and mountain flaps the larger
("steep") one; down, the other way round.  2^(n+1) branches leave the flat state; where they end: `cone.rules`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.closed_forms import cone_fold_angles
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.paper.cone.classes import direction_name
from origami_nlp.paper.cone.rules import SLACK, Cone, check_degree
from origami_nlp.pattern import format_angle

Flaps = tuple[int, ...]
"""One entry a flap, +1 valley or -1 mountain."""
SIGNS = {"V": 1, "M": -1}
DIRECTIONS: dict[Any, int] = {"up": 1, "down": -1, 1: 1, -1: -1}


def parse_flaps(flaps: str | Sequence[int]) -> Flaps:
    """Read an assignment of the flaps.

    Parameters
    ----------
    flaps
        Letters V and M such as "VVM" (runs may be written V2M), or +1 (valley) and -1 (mountain), one a flap.

    Returns
    -------
    tuple of int
        +1 or -1, one a flap.

    Raises
    ------
    OptionError
        If it is not an assignment.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.parse_flaps("V2M")
    (1, 1, -1)
    """
    signs: list[Any] = [None]
    if isinstance(flaps, str):
        runs = r"([VM])([1-9][0-9]{0,3})"
        letters = re.sub(runs, lambda m: m[1] * int(m[2]), flaps.strip().upper())
        signs = [SIGNS.get(letter) for letter in letters]
    elif isinstance(flaps, Sequence | np.ndarray):
        signs = list(flaps)
    if not all(isinstance(f, Real) and f in (1, -1) for f in signs):
        raise OptionError(
            f'flaps = {shown(flaps)}: write V and M, one a flap, such as "VVM", or "V2M"'
        )
    check_degree(2 * len(signs))
    return tuple(int(f) for f in signs)


def write_flaps(flaps: Flaps) -> str:
    """Write an assignment as letters V and M.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.write_flaps((1, 1, -1))
    'VVM'
    """
    return "".join("V" if f > 0 else "M" for f in flaps)


def class_of(flaps: str | Sequence[int]) -> tuple[int, int]:
    """Count (valley flaps, changes around the ring) of an assignment: its class.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.class_of((1, -1, 1, -1))
    (2, 4)
    """
    signs = parse_flaps(flaps)
    return signs.count(1), sum(a != b for a, b in zip(signs, signs[1:] + signs[:1], strict=True))


@dataclass(frozen=True)
class ConeBranch:
    """One branch of a cone: its fold angles, and where it ends.

    Attributes
    ----------
    flaps
        As `parse_flaps` reads them: +1 and -1, N/2 of them.
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
    >>> round(own.end, 4), own.cone.is_cut(own.steep).item()
    (0.5236, True)
    >>> own.fold_angles(0.3).round(3).tolist()
    [-0.946, -0.6, 0.162, -0.6, -0.946, 0.6]
    """

    flaps: Any
    direction: Any = 1
    end_rule: str = "contract"

    def __post_init__(self) -> None:
        known = isinstance(self.direction, str | Integral) and not isinstance(self.direction, bool)
        if not known or self.direction not in DIRECTIONS:
            raise OptionError(f"direction = {shown(self.direction)}: write up or down, +1 or -1")
        vars(self).update(flaps=parse_flaps(self.flaps), direction=DIRECTIONS[self.direction])
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
        if not np.isfinite(v).all():
            raise AngleError("elevation must be finite")
        for wrong, why in (
            (v * self.direction < 0, f"has elevations {'>' if self.direction > 0 else '<'}= 0"),
            (np.abs(v) > self.end + SLACK, f"ends at |elevation| = {format_angle(self.end)}"),
        ):
            if wrong.any():
                raise AngleError(f"elevation = {v[wrong].flat[0]:.6g}: the branch {self!r} {why}")
        return cone_fold_angles(self.degree, v, self.flaps).value

    def __repr__(self) -> str:
        return f"{write_flaps(self.flaps)} {direction_name(self.direction)}"
