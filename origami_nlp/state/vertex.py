"""A flat origami vertex: its sector angles, and the crease directions they make.

Creases b_1..b_N lie in the e1-e2 plane, numbered counter-clockwise, b_1 = e1; the sector angle
alpha_i lies between b_i and b_{i+1} (the paper's conventions, section 2).  Radians.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import VertexError
from origami_nlp.state.angles import format_angle, parse_angles

SUM_TOLERANCE = 1e-9
"""Largest |sum of sector angles - 2 pi| [rad] that is taken for rounding and spread evenly."""


@dataclass(frozen=True)
class Vertex:
    """A flat sheet with N creases that meet at a point.

    Parameters
    ----------
    sector_angles
        The N >= 4 sector angles alpha_i in (0, pi) [rad], counter-clockwise; they sum to 2 pi.
        Numbers, or strings such as ``"pi/4"``.

    Raises
    ------
    VertexError
        If the angles do not make a flat vertex that can fold; `AngleError` if one is no angle.
    """

    sector_angles: tuple[float, ...]

    def __post_init__(self) -> None:
        angles = parse_angles(self.sector_angles, "sector_angles")
        if len(angles) < 4:
            raise VertexError(
                f"sector_angles has {len(angles)} entries: a rigid vertex needs at least 4 to fold"
            )
        for i, a in enumerate(angles, start=1):
            if a <= 0:
                raise VertexError(f"sector_angles[{i}] = {a:.6g} must be positive")
            if a >= math.pi - 1e-12:
                raise VertexError(
                    f"sector_angles[{i}] = {a:.6g} must be below pi: "
                    "split the facet with a crease, or leave the vertex flat"
                )
        total = math.fsum(angles)
        if abs(total - 2 * math.pi) > SUM_TOLERANCE:
            raise VertexError(
                f"sector_angles sum to {total:.12g} = {total / math.pi:.9g} pi, not 2 pi (flat "
                f'sheets only): correct them, or write exact multiples such as "pi/3"'
            )
        if abs(total - 2 * math.pi) > 1e-14:  # typed digits: spread what is missing evenly
            angles = tuple(a * (2 * math.pi / total) for a in angles)
        object.__setattr__(self, "sector_angles", angles)

    @classmethod
    def from_degrees(cls, sector_angles: Sequence[float]) -> Vertex:
        """Make a vertex from sector angles in degrees."""
        return cls(parse_angles(sector_angles, "sector_angles_deg", degrees=True))

    @classmethod
    def from_directions(cls, directions: object) -> Vertex:
        """Make a vertex from crease directions, shape [N, 2], counter-clockwise.

        The first direction becomes e1; lengths are ignored.

        Raises
        ------
        VertexError
            If a direction is zero or not finite, or they are not in counter-clockwise order.
        """
        try:
            d = np.asarray(directions, dtype=float)
        except (TypeError, ValueError):
            raise VertexError("directions must be an [N, 2] array of numbers") from None
        if d.ndim != 2 or d.shape[1] != 2:
            raise VertexError(f"directions has shape {d.shape}, not [N, 2]")
        bad = ~np.isfinite(d).all(axis=1) | (np.hypot(d[:, 0], d[:, 1]) == 0)
        if bad.any():
            i = int(np.argmax(bad)) + 1
            raise VertexError(f"directions[{i}] = {d[i - 1].tolist()} is not a direction")
        azimuth = np.arctan2(d[:, 1], d[:, 0])
        sectors = np.mod(np.roll(azimuth, -1) - azimuth, 2 * math.pi)
        if abs(math.fsum(sectors) - 2 * math.pi) > 1e-6:
            raise VertexError("directions are not in counter-clockwise order: sort them by azimuth")
        return cls(tuple(sectors.tolist()))

    @property
    def degree(self) -> int:
        """Number of creases N."""
        return len(self.sector_angles)

    @property
    def azimuths(self) -> np.ndarray:
        """Angles [N] of the creases from e1, in [0, 2 pi) [rad]."""
        return np.concatenate([[0.0], np.cumsum(self.sector_angles)[:-1]])

    @property
    def creases(self) -> np.ndarray:
        """Unit crease directions b_i of the flat sheet, shape [N, 3]."""
        a = self.azimuths
        return np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], axis=1)

    def __repr__(self) -> str:
        inner = ", ".join(format_angle(a) for a in self.sector_angles)
        return f"Vertex(degree {self.degree}, sector_angles=[{inner}])"
