"""An origami vertex: its sector angles, and the crease directions they make.

Creases b_1..b_N lie in the e1-e2 plane, numbered counter-clockwise, b_1 = e1; the sector angle
alpha_i lies between b_i and b_{i+1} (the paper's conventions, section 2).  Radians.

A vertex whose sector angles do not sum to 2 pi is a cone of paper (below) or a ruffled sheet (above):
cut along b_1 it unrolls into the plane, with a gap or an overlap of `excess` there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import InitVar, dataclass, field
from functools import lru_cache

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import VertexError
from origami_nlp.io import PrettyRepr, cut
from origami_nlp.numerics import CLOSURE_TOL, INPUT_TOL, RESOLVED, ROUNDED
from origami_nlp.pattern.numbers_read import format_angle, parse_angles

MOST_SPREAD = 0.1
"""What `normalize` spreads at most over the sectors of a vertex [rad]: 5.7 degrees; more is a sector that is wrong."""
CLOSE_TO_360 = 10
"""Numbers whose sum is so close to 360 are degrees."""


@dataclass(frozen=True)
class Vertex(PrettyRepr):
    """A sheet of paper with N creases that meet at a point (paper, section 2).

    Creases b_1 .. b_N lie in the e1-e2 plane, counter-clockwise, b_1 = e1; sector alpha_i lies between b_i and b_{i+1}.

    Parameters
    ----------
    sector_angles
        The N >= 3 sector angles alpha_i in (0, pi) [rad], counter-clockwise.  Numbers, or strings such
        as ``"pi/4"``.
    flat
        Whether the sheet lies flat: the angles must sum to 2 pi (to `INPUT_TOL`).  With False they
        may sum to anything from which a closed vertex can be made, and fold angle 0 still means that
        two facets lie in one plane.
    normalize
        Spread what the angles of a flat sheet miss of 2 pi, at most `MOST_SPREAD`, over them by equal parts.
    degrees
        Whether the angles are stated in degrees; they are kept in radians.

    Attributes
    ----------
    normalized
        Change that `normalize` made to each stated angle [rad].

    Raises
    ------
    VertexError
        If the angles make no such vertex.
    AngleError
        If one is no angle.

    Examples
    --------
    >>> from origami_nlp import Vertex
    >>> vertex = Vertex(("pi/2", "pi/2", "pi/2", "pi/2"))
    >>> vertex.degree, vertex.excess, vertex.creases.shape
    (4, 0.0, (4, 3))
    """

    sector_angles: tuple[float, ...]
    flat: bool = True
    normalize: bool = field(default=False, kw_only=True, compare=False)
    degrees: InitVar[bool] = field(default=False, kw_only=True)
    normalized: float = field(default=0.0, init=False, compare=False)

    def __post_init__(self, degrees: bool) -> None:
        unit = DEGREES if degrees else RADIANS  # errors are in what was stated
        angles = parse_angles(self.sector_angles, unit.field, degrees=degrees)
        if len(angles) < 3:
            raise VertexError(f"sector_angles has {len(angles)} entries: a vertex needs 3 at least")
        for name in ("flat", "normalize"):
            if not isinstance(getattr(self, name), bool):
                raise VertexError(f"{name} = {shown(getattr(self, name))} must be true or false")
        if self.normalize and not self.flat:
            raise VertexError("normalize = true is for a flat sheet: leave out flat = false")
        total = math.fsum(angles)
        unit.check_each(angles)
        if self.flat:
            missing = 2 * math.pi - total
            if abs(missing) > (MOST_SPREAD if self.normalize else INPUT_TOL):
                raise VertexError(unit.of_sum(angles, total))
            if self.normalize:
                # equal parts: the smallest change, in the sum of squares, that makes the sum 2 pi
                object.__setattr__(self, "normalized", missing / len(angles))
                angles = tuple(a + self.normalized for a in angles)
                unit.check_each(angles)
                total = math.fsum(angles)
            if abs(total - 2 * math.pi) > ROUNDED:  # typed digits: spread what is missing evenly
                angles = tuple(a * (2 * math.pi / total) for a in angles)
        elif abs(total - 2 * math.pi) <= RESOLVED:
            raise VertexError(
                "sector_angles sum to 2 pi: the sheet lies flat, leave out flat = false"
            )
        else:
            _check_closes(angles, unit)
        object.__setattr__(self, "sector_angles", angles)

    @classmethod
    def from_degrees(
        cls, sector_angles: Sequence[float], flat: bool = True, *, normalize: bool = False
    ) -> Vertex:
        """Make a vertex from sector angles in degrees.

        Parameters
        ----------
        sector_angles
            The N sector angles [deg], counter-clockwise.
        flat, normalize
            As for `Vertex`.

        Returns
        -------
        Vertex
            The vertex, its angles in radians.

        Raises
        ------
        VertexError
            If the angles make no such vertex.
        AngleError
            If one is no number.
        """
        return cls(sector_angles, flat, normalize=normalize, degrees=True)  # type: ignore[arg-type]

    def with_angles(self, sector_angles: tuple[float, ...]) -> Vertex:
        """Return the vertex with other sector angles that sum to the same, and with its record `normalized`.

        Parameters
        ----------
        sector_angles
            Shape [N] [rad].

        Returns
        -------
        Vertex
            The vertex.
        """
        vertex = Vertex(sector_angles, self.flat)
        object.__setattr__(vertex, "normalized", self.normalized)
        return vertex

    @property
    def degree(self) -> int:
        """Number of creases N."""
        return len(self.sector_angles)

    @property
    def excess(self) -> float:
        """Sum of the sector angles less 2 pi [rad]: 0 for a flat sheet, negative for a cone."""
        return 0.0 if self.flat else math.fsum(self.sector_angles) - 2 * math.pi

    @property
    def azimuths(self) -> np.ndarray:
        """Angles [N] of the creases from e1 in the unrolled sheet, from 0 [rad]."""
        return np.concatenate([[0.0], np.cumsum(self.sector_angles)[:-1]])

    @property
    def creases(self) -> np.ndarray:
        """Unit crease directions b_i of the unrolled sheet, shape [N, 3], not writable."""
        return _creases(self.sector_angles)

    def __repr__(self) -> str:
        return self._told(cut([format_angle(a) for a in self.sector_angles]))

    def __str__(self) -> str:
        return self._told(", ".join(format_angle(a) for a in self.sector_angles))

    def _told(self, inner: str) -> str:
        bent = "" if self.flat else f", not flat: {math.degrees(self.excess):+.6g} deg"
        return f"Vertex(degree {self.degree}, sector_angles=[{inner}]{bent})"


@lru_cache(maxsize=64)
def _creases(sector_angles: tuple[float, ...]) -> np.ndarray:
    a = np.concatenate([[0.0], np.cumsum(sector_angles)[:-1]])
    out = np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], axis=1)
    out.setflags(write=False)
    return out


@dataclass(frozen=True)
class _Unit:
    """Angles of a field as a person stated them: in radians or degrees."""

    field: str
    scale: float

    def show(self, angle: float, digits: int = 6) -> str:
        """Write an angle with its unit."""
        return f"{angle * self.scale:.{digits}g} {'rad' if self.scale == 1.0 else 'deg'}"

    def check_each(self, angles: Sequence[float]) -> None:
        """Raise an error for an angle that is no sector of a vertex."""
        for i, a in enumerate(angles, start=1):
            if not 0 < a < math.pi - CLOSURE_TOL:
                raise VertexError(
                    f"{self.field}[{i}] = {self.show(a)} must be positive and below {self.show(math.pi)}: "
                    + (self.other(angles) or "split the facet with a crease")
                )

    def of_sum(self, angles: Sequence[float], total: float) -> str:
        """Describe the sum of sectors that do not add to a full turn: what is missing, and what to write."""
        missing = 2 * math.pi - total
        cure = self.other(angles) or "a sector is missing or wrong"
        if abs(missing) <= MOST_SPREAD:
            each = f"add normalize = true (each changes by {self.show(missing / len(angles), 3)})"
            cure = f"correct them, or {each}" + '; multiples are "pi/3"' * (self.scale == 1.0)
        much = f"{self.show(abs(missing), 4)} {'missing' if missing > 0 else 'too much'}"
        whole = f"{self.show(total, 9)}, not {self.show(2 * math.pi, 9)}"
        return f"{self.field} sum to {whole}: {much}; {cure}"

    def other(self, angles: Sequence[float]) -> str:
        """Say that angles are those of the other unit, if they are."""
        total = math.fsum(angles)
        if self.scale == 1.0 and (max(angles) > 2 * math.pi or abs(total - 360) <= CLOSE_TO_360):
            return "these look like degrees, which are given as sector_angles_deg (Vertex.from_degrees)"
        if self.scale != 1.0 and abs(math.degrees(total) - 2 * math.pi) <= MOST_SPREAD:
            return "these look like radians, which are given as sector_angles"
        return ""


RADIANS, DEGREES = _Unit("sector_angles", 1.0), _Unit("sector_angles_deg", math.degrees(1.0))


def _check_closes(angles: Sequence[float], unit: _Unit) -> None:
    """Refuse sides of which no closed spherical polygon can be made.

    Arcs a_i in (0, pi) close up exactly when, for every odd set S of them, sum_S a - sum_rest a <=
    (|S| - 1) pi (the spherical polygon inequalities).  The worst set of each size holds the longest.
    """
    longest, total = sorted(angles, reverse=True), math.fsum(angles)
    for size in range(1, len(angles) + 1, 2):
        chosen = math.fsum(longest[:size])
        if 2 * chosen - total > (size - 1) * math.pi + CLOSURE_TOL:
            many = f"the {size} largest sum to {unit.show(chosen)}, too much for the others"
            raise VertexError(f"{unit.field} cannot close around a vertex: {many}")
