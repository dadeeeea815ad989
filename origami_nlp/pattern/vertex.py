"""An origami vertex: its sector angles, and the crease directions they make.

Creases b_1..b_N lie in the e1-e2 plane, numbered counter-clockwise, b_1 = e1; the sector angle
alpha_i lies between b_i and b_{i+1} (the paper's conventions, section 2).  Radians.

A vertex whose sector angles do not sum to 2 pi is a cone of paper (below) or a ruffled sheet (above):
cut along b_1 it unrolls into the plane, with a gap or an overlap of `excess` there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import VertexError
from origami_nlp.io import PrettyRepr, cut
from origami_nlp.numerics import CLOSURE_TOL, INPUT_TOL, PLACES, RESOLVED, ROUNDED
from origami_nlp.pattern.angles import format_angle, parse_angles


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

    def __post_init__(self) -> None:
        angles = parse_angles(self.sector_angles, "sector_angles")
        if len(angles) < 3:
            raise VertexError(
                f"sector_angles has {len(angles)} entries: a vertex needs at least 3 creases"
            )
        if not isinstance(self.flat, bool):
            raise VertexError(f"flat = {shown(self.flat)} must be true or false")
        for i, a in enumerate(angles, start=1):
            if a <= 0:
                raise VertexError(f"sector_angles[{i}] = {a:.6g} must be positive")
            if a >= math.pi - CLOSURE_TOL:
                raise VertexError(
                    f"sector_angles[{i}] = {a:.6g} must be below pi: "
                    "split the facet with a crease, or leave the vertex flat"
                )
        total = math.fsum(angles)
        if self.flat:
            if abs(total - 2 * math.pi) > INPUT_TOL:
                raise VertexError(
                    f"sector_angles sum to {total:.12g} = {total / math.pi:.9g} pi, not 2 pi: correct "
                    f'them, write exact multiples such as "pi/3", or state flat = false for paper '
                    f"that does not lie flat"
                )
            if abs(total - 2 * math.pi) > ROUNDED:  # typed digits: spread what is missing evenly
                angles = tuple(a * (2 * math.pi / total) for a in angles)
        elif abs(total - 2 * math.pi) <= RESOLVED:
            raise VertexError(
                f"sector_angles sum to 2 pi within {RESOLVED:g} rad: this sheet lies flat, leave out flat = false"
            )
        else:
            _check_closes(angles)
        object.__setattr__(self, "sector_angles", angles)

    @classmethod
    def from_degrees(cls, sector_angles: Sequence[float], flat: bool = True) -> Vertex:
        """Make a vertex from sector angles in degrees.

        Parameters
        ----------
        sector_angles
            The N sector angles [deg], counter-clockwise.
        flat
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
        return cls(parse_angles(sector_angles, "sector_angles_deg", degrees=True), flat)

    @classmethod
    def from_directions(cls, directions: object) -> Vertex:
        """Make a flat vertex from crease directions; the first becomes e1.

        Parameters
        ----------
        directions
            Shape [N, 2], counter-clockwise; lengths are ignored.

        Returns
        -------
        Vertex
            The vertex.

        Raises
        ------
        VertexError
            If a direction is zero or not finite, or they are not in counter-clockwise order.
        """
        try:
            d = np.asarray(directions, dtype=float)
        except (TypeError, ValueError, OverflowError):
            raise VertexError("directions must be an [N, 2] array of numbers") from None
        if d.ndim != 2 or d.shape[1] != 2:
            raise VertexError(f"directions has shape {d.shape}, not [N, 2]")
        bad = ~np.isfinite(d).all(axis=1) | (np.hypot(d[:, 0], d[:, 1]) == 0)
        if bad.any():
            i = int(np.argmax(bad)) + 1
            raise VertexError(f"directions[{i}] = {d[i - 1].tolist()} is not a direction")
        azimuth = np.arctan2(d[:, 1], d[:, 0])
        sectors = np.mod(np.roll(azimuth, -1) - azimuth, 2 * math.pi)
        # counter-clockwise, directions go round once; in another order the steps sum to a multiple of 2 pi
        if abs(math.fsum(sectors) - 2 * math.pi) > PLACES:
            raise VertexError("directions are not in counter-clockwise order: sort them by azimuth")
        return cls(tuple(sectors.tolist()))

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


def _check_closes(angles: Sequence[float]) -> None:
    """Refuse sides of which no closed spherical polygon can be made.

    Arcs a_i in (0, pi) close up exactly when, for every odd set S of them, sum_S a - sum_rest a <=
    (|S| - 1) pi (the spherical polygon inequalities).  The worst set of each size holds the longest.
    """
    longest = sorted(angles, reverse=True)
    total = math.fsum(angles)
    for size in range(1, len(angles) + 1, 2):
        chosen = math.fsum(longest[:size])
        if 2 * chosen - total > (size - 1) * math.pi + CLOSURE_TOL:
            what = (
                f"the largest, {longest[0]:.6g}, is more than all the others together"
                if size == 1
                else f"the {size} largest sum to {chosen:.6g}: too much for the others to bring back"
            )
            raise VertexError(f"sector_angles cannot close around a vertex: {what}")
