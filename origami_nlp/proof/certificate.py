"""What a proof says: states that are shown, and what is left; and the same as a file, in JSON that others can read.

Schema ``origami-nlp/proof/2``: what was asked (a ``scene``, the tables of a scene file, or a ``sheet``), the list, what
stays open and what is proved; all numbers are the doubles that were proved.  Nothing in a file is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.errors import CertificateError, OptionError
from origami_nlp.io import Finite, check_schema, from_plain, read_json, to_plain, write_json
from origami_nlp.pattern import Pattern, Scene, in_plane
from origami_nlp.proof.rows import Gap

SCHEMA = "origami-nlp/proof/2"
LARGEST = 1_000_000_000
"""Bytes of a file."""


@dataclass(frozen=True, eq=False)
class ProvedState:
    """A critical point that exists, and is the only one near.

    Attributes
    ----------
    fold_angles
        Of all creases, [N] [rad]; an approximation in doubles.
    radius
        None of them differs by more [rad].
    is_minimum
        True: a minimum.  False: certainly none.  None: not decided, which is left to the judge of states.
    index
        Negative eigenvalues of the reduced Hessian on the stratum; None where unclear.
    unique_radius
        There is no other critical point of the stratum within this [rad].
    stratum
        Of variables, +1 or -1 at a limit, 0 for a free one, [n]; of a vertex, as all that follows.
    moment
        Multipliers of closure in the scene's units.  Without symmetry m with k_i (x_i - rest_i) = m . c_i on free
        creases, in the frame of the facet between crease N and crease 1 (its crease 1 is e1, e3 up); with symmetry
        those of the piece's equations (`pieces`).
    pinned_signs
        Sign of s_i (G_i - m . c_i): -1 where a closed crease pushes against its limit, +1 where it would leave, 0 where
        unclear; 0 for free ones, [n].
    touches
        Gaps that are closed; full contact only.
    forces
        Multiplier of each, positive where it pushes, in the scene's units per unit of gap.
    """

    fold_angles: np.ndarray
    radius: float
    is_minimum: bool | None = True
    index: int | None = 0
    unique_radius: float = 0.0
    stratum: tuple[int, ...] = ()
    moment: tuple[float, ...] = ()
    pinned_signs: tuple[int, ...] = ()
    touches: tuple[Gap, ...] = ()
    forces: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Region:
    """Fold angles between two states [N] [rad] in which something is left, and why.

    Attributes
    ----------
    singular
        Whether closure loses rank there.
    alone
        Whether it holds one critical point at most.
    """

    lower: np.ndarray
    upper: np.ndarray
    reason: str
    singular: bool = False
    alone: bool = False


@dataclass(frozen=True)
class Proof:
    """All critical points of a vertex, or all minima of a sheet, but for what is left.

    Attributes
    ----------
    points
        What is shown, of a vertex in order of energy.
    regions
        What is left.
    boxes
        Boxes of fold angles, or intervals of curves, that were looked at.
    seconds
        Processor time that it took.
    over
        Over which states the statement ranges, in words; "": all closed states that contact admits.
    finished
        Whether no box was left when it ended.
    crossing
        Critical points within fold limits, or at touches, that full contact does not admit: left out of `points`.
    """

    points: tuple[ProvedState, ...]
    regions: tuple[Region, ...]
    boxes: int
    seconds: float
    over: str = ""
    finished: bool = True
    crossing: int = 0

    @property
    def minima(self) -> tuple[ProvedState, ...]:
        """Those that are minima for certain."""
        return tuple(p for p in self.points if p.is_minimum)

    @property
    def singular(self) -> tuple[Region, ...]:
        """Regions where closure loses rank."""
        return tuple(r for r in self.regions if r.singular)

    @property
    def undecided(self) -> tuple[Region, ...]:
        """All other regions."""
        return tuple(r for r in self.regions if not r.singular)

    @property
    def complete(self) -> bool:
        """Whether every critical point is known, and of each whether it is a minimum."""
        return not self.regions and all(p.is_minimum is not None for p in self.points)


@dataclass(frozen=True)
class ProofOptions:
    """How much a proof may look at.

    Attributes
    ----------
    boxes
        Boxes, or intervals of curves, after which it gives up: 10 million take about ten minutes.

    Raises
    ------
    OptionError
        If a field is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> vertex = o.Vertex.from_degrees((70, 80, 120, 90))
    >>> scene = o.Scene(vertex, (1, 2, 3, 2), (1, -0.5, 0.3, 0.8), "none", "fold-limits")
    >>> o.find_minima(scene, prove=o.ProofOptions(boxes=1)).completeness.status
    'not-proved'
    """

    boxes: int = 10_000_000

    def __post_init__(self) -> None:
        check_whole("boxes", self.boxes, 1)


@dataclass(frozen=True)
class StatedSheet:
    """A flat sheet with springs, the doubles of the pattern.

    Attributes
    ----------
    corners, facets, creases
        Points [V], corners of each facet, corners that each crease joins [n].
    stiffness, rest
        Of the creases, [n] [N m/rad] and [rad].
    deviation
        By how much these corners differ at most from a sheet whose equal sectors are equal exactly, and whose vertices
        fold flat if they do so nearly, which is meant [rad].
    """

    corners: tuple[tuple[Finite, Finite], ...]
    facets: tuple[tuple[int, ...], ...]
    creases: tuple[tuple[int, int], ...]
    stiffness: tuple[Finite, ...]
    rest: tuple[Finite, ...]
    deviation: Finite

    @classmethod
    def of(cls, pattern: Pattern, deviation: float) -> StatedSheet:
        """State a sheet, whose relations of sectors fail by so much at most [rad]."""
        pattern.check_plain_hinges("the certificate of a sheet")
        if len(pattern.polygons) != pattern.facets:
            raise OptionError(
                f"pattern = {pattern.title}: no certificate: a facet is of several pieces (F or J edges)"
            )
        return cls(
            corners=tuple((x, y) for x, y in in_plane(pattern).tolist()),
            facets=tuple(tuple(map(int, p)) for p in pattern.polygons),
            creases=tuple((a, b) for a, b in pattern.ends.tolist()),
            stiffness=tuple(pattern.stiffness.tolist()),
            rest=tuple(pattern.rest.tolist()),
            deviation=deviation,
        )


@dataclass(frozen=True)
class CertifiedState:
    """A minimum: fold angles [rad] to within a radius."""

    fold_angles: tuple[Finite, ...]
    radius: Finite


@dataclass(frozen=True)
class OpenRegion:
    """What is left open: fold angles [rad] between two states, and why."""

    lower: tuple[Finite, ...]
    upper: tuple[Finite, ...]
    reason: str


@dataclass(frozen=True)
class Certificate:
    """What a proof claims.

    Attributes
    ----------
    over
        Over which states, in words.
    minima
        All of them, within fold limits.
    undecided
        What is left open.
    scene, sheet
        Of what: one of them.
    """

    over: str
    minima: tuple[CertifiedState, ...]
    undecided: tuple[OpenRegion, ...]
    scene: Scene | None = field(default=None, metadata={"omit": True})
    sheet: StatedSheet | None = field(default=None, metadata={"omit": True})

    @property
    def regions(self) -> tuple[np.ndarray, np.ndarray]:
        """What is left open as arrays, low and high [K, n]."""
        n = len(self.sheet.creases) if self.sheet else self.scene.degree  # type: ignore[union-attr]
        both = [(one.lower, one.upper) for one in self.undecided]
        low, high = np.array(both).reshape(-1, 2, n).swapaxes(0, 1)
        return low, high


def write_certificate(certificate: Certificate, target: str | Path) -> None:
    """Write a certificate to a file, or ``"-"`` for standard output, whole or not at all.

    Raises
    ------
    OptionError
        If it cannot be written.
    """
    write_json({"schema": SCHEMA, **to_plain(certificate)}, target)


def read_certificate(source: str | Path) -> Certificate:
    """Read a certificate from a file, or ``"-"`` for standard input: well formed, nothing in it is checked.

    Raises
    ------
    CertificateError
        If it cannot be read or is not one.
    """
    return certificate_from_dict(read_json(source, LARGEST, "proof", CertificateError))


def certificate_from_dict(data: Any) -> Certificate:
    """Make a certificate of plain data.

    Raises
    ------
    CertificateError
        If an entry is missing or does not fit; the message names it.
    """
    check_schema(data, SCHEMA, "proof", CertificateError)
    own = {key: value for key, value in data.items() if key != "schema"}
    said = from_plain(Certificate, own, "proof", CertificateError)
    if (said.scene is None) == (said.sheet is None):
        raise CertificateError("the proof must be of a scene or of a sheet")
    n = len(said.sheet.creases) if said.sheet else said.scene.degree  # type: ignore[union-attr]
    sizes = [("minima", "fold_angles", said.minima), ("undecided", "lower", said.undecided)]
    sizes += [("undecided", "upper", said.undecided)]
    many = [
        (f"{a}[{i}].{key}", getattr(x, key)) for a, key, xs in sizes for i, x in enumerate(xs, 1)
    ]  # type: ignore[var-annotated,arg-type]
    if said.sheet:
        many += [(f"sheet.{key}", getattr(said.sheet, key)) for key in ("stiffness", "rest")]
        _check_corners(said.sheet)
    for name, values in many:
        if len(values) != n:
            raise CertificateError(f"{name} of the proof must be {n} numbers")
    return said


def _check_corners(said: StatedSheet) -> None:
    numbers = [c for row in (*said.facets, *said.creases) for c in row]
    if not numbers or not 0 <= min(numbers) <= max(numbers) < len(said.corners):
        raise CertificateError("facets and creases of the proof must be numbers of its corners")
    if any(len(set(f)) < max(3, len(f)) for f in said.facets):
        raise CertificateError("facets of the proof must have three corners or more, each once")
