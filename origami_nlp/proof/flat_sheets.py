"""Flat sheets of vertices of degree four, as all their proofs read them: directions of creases, exactly.

A sheet that is turned in space is laid into its plane first: to rounding, which is reported.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.rows import UNIT

Vector = tuple[Fraction, Fraction]


@dataclass(frozen=True, kw_only=True)
class SheetProof:
    """What is proved of a sheet, of any kind.

    Attributes
    ----------
    curves
        Curves of closed states.
    minima
        On them and beside them, each once: fold angles [n] [rad] to within a radius.
    maxima
        How many maxima of the energy lie inside the curves.
    undecided
        What is left open: between which fold angles [n], [n], and why.
    deviation
        By how much sectors of the sheet differ from those that are meant, at most [rad].
    moved
        By how much laying the sheet into the plane moved a crease, at most [rad]; 0 where it lies there.
    boxes, seconds
        Boxes of theta, and the processor time that they took.
    contact
        Whether states in which facets cross are left out, and minima that touching facets hold are listed.
    """

    curves: int
    minima: Sequence[SheetMinimum]
    maxima: int
    undecided: tuple[tuple[np.ndarray, np.ndarray, str], ...]
    deviation: float
    moved: float
    boxes: int
    seconds: float
    contact: bool = False

    @property
    def over(self) -> str:
        """Over which states the statement ranges, in words."""
        facets = ", and facets are apart, touch or cross over intervals of them" * self.contact
        exactly = f"; {self.meant}, as the file's are to {self.deviation:.2g} rad"
        laid = f"; laid into its plane to {self.moved:.2g} rad" * bool(self.moved)
        return f"all closed states within fold limits {self.states}{facets}{exactly * bool(self.deviation)}{laid}"

    @property
    def states(self) -> str:
        """Where all closed states are, in words."""
        raise NotImplementedError

    meant = ""
    """Of which sheet this is proved, where sectors of the file deviate."""


@dataclass(frozen=True)
class SheetMinimum:
    """A minimum of the energy of a sheet.

    Attributes
    ----------
    fold_angles
        [n] [rad]; those of meshes that are 0 or +-pi are so exactly.
    radius
        None of the fold angles differs by more [rad].
    """

    fold_angles: np.ndarray
    radius: float


class VertexRound(NamedTuple):
    """A vertex, its creases in order round it, and where they go from it."""

    vertex: int
    creases: tuple[int, ...]
    directions: list[Vector]

    @property
    def sense(self) -> int:
        """1 where the creases run counter-clockwise in the plane."""
        return 1 if cross(*self.directions[:2]) > 0 else -1

    def turned(self, at: int) -> VertexRound:
        """Return it with its creases from the one at a place."""
        u = self.directions
        return VertexRound(self.vertex, self.creases[at:] + self.creases[:at], u[at:] + u[:at])


class SheetInPlane(NamedTuple):
    """A sheet in its plane: the pattern, its vertices, and by how much laying it there moved a crease at most [rad]."""

    pattern: Pattern
    rounds: list[VertexRound]
    moved: float


def flat_sheet(pattern: Pattern) -> tuple[SheetInPlane | None, str]:
    """Return a sheet of vertices of degree four, or None and why a pattern is none."""
    if not pattern.is_flat:
        return None, "the reference state is not flat"
    if pattern.cell:
        return None, "it is a cell that repeats"
    if pattern.holes or not pattern.vertices:
        return None, "the pattern has a hole" if pattern.holes else "no vertex is inside"
    flat, moved = laid_flat(pattern), 0.0
    if flat is not pattern:
        shortest = float(pattern.lengths.min())
        away = pattern.corners - pattern.corners.mean(axis=0)
        # of all corners, in any direction: the least singular value is no less than the distance from a plane
        off = float(np.linalg.svd(away, compute_uv=False)[-1])
        if off > CLOSURE_TOL * shortest:
            return None, "the corners of the flat state are not in one plane"
        size = float(np.abs(pattern.corners).max())
        moved = (off + 32 * UNIT * size) / shortest
    rounds = []
    for v in pattern.vertices:
        if len(v.creases) != 4:
            return None, f"vertex {v.vertex} has not four creases"
        u = directions(flat, v.vertex, v.creases)
        turns = [cross(u[i], u[(i + 1) % 4]) for i in range(4)]
        if min(turns) <= 0 <= max(turns):
            return None, f"vertex {v.vertex} has a sector of 180 degrees or more"
        rounds.append(VertexRound(v.vertex, v.creases, u))
    return SheetInPlane(flat, rounds, moved), ""


def directions(pattern: Pattern, vertex: int, creases: Sequence[int]) -> list[Vector]:
    """Return where creases of a vertex go from it, exactly."""
    place = pattern.corners[:, :2].tolist()
    away = [int(pattern.ends[c].sum()) - vertex for c in creases]
    (x, y) = map(Fraction, place[vertex])
    return [(Fraction(place[w][0]) - x, Fraction(place[w][1]) - y) for w in away]


def cross(a: Vector, b: Vector) -> Fraction:
    """Return a x b."""
    return a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Fraction:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1]


def sector(a: Vector, b: Vector) -> Vector:
    """Return the direction of a complex number whose argument is the sector between directions, below 180 degrees."""
    return dot(a, b), abs(cross(a, b))


def between(a: Vector, b: Vector) -> float:
    """Return the angle between directions [rad], exactly 0 where they are parallel; infinite from 90 degrees."""
    return off_line(a, (-b[0], -b[1]))


def off_line(a: Vector, b: Vector) -> float:
    """Return the angle by which directions miss 180 degrees [rad]; infinite from 90 degrees."""
    along = dot(a, b)
    return float(abs(cross(a, b)) / -along) if along < 0 else math.inf


def sector_sum(u: Sequence[Vector]) -> float:
    """Return by how much the first and third sector miss 180 degrees [rad]."""
    (x, y), (z, w) = ((dot(u[i], u[i + 1]), cross(u[i], u[i + 1])) for i in (0, 2))
    real, imaginary = x * z - y * w, x * w + y * z
    return float(abs(imaginary) / -real) if real < 0 else math.pi
