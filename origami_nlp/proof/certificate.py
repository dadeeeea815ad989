"""A proof as a file: what was asked, the list, what stays open and what is proved, in JSON that others can read.

Schema ``origami-nlp/proof/2``: a ``scene``, the tables of a scene file, or a ``sheet``; all numbers are the doubles
that were proved.  Nothing in a file is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.errors import CertificateError, OptionError
from origami_nlp.io import Finite, check_schema, from_plain, read_json, to_plain, write_json
from origami_nlp.pattern import Pattern, Scene, in_plane
from origami_nlp.proof.complete import prove_each
from origami_nlp.proof.reduced import ReducedVertex
from origami_nlp.proof.sheet_proof import as_sheet, prove_sheet

SCHEMA = "origami-nlp/proof/2"
LARGEST = 1_000_000_000
"""Bytes of a file."""


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


def certify(origami: Scene | Pattern, boxes: int) -> Certificate:
    """Prove the list of an origami within fold limits, in the form that is written to a file.

    Parameters
    ----------
    origami
        A scene, or a sheet of which `why_no_sheet` says nothing.
    boxes
        That a proof may take.

    Returns
    -------
    Certificate
        Of all windings of a scene.

    Raises
    ------
    OptionError
        If facets may touch, a facet is of several pieces, or a sheet has stops or hinge laws: the check knows none.
    """
    if isinstance(origami, Scene):
        if origami.contact == "full":
            raise OptionError(
                "a certificate names no touches of facets: it is for contact = 'fold-limits'"
            )
        proof = prove_each([ReducedVertex(one) for one in origami.of_each_winding], boxes=boxes)
        stated: dict[str, Any] = {"scene": origami}
    else:
        stated = {"sheet": _stated(origami)}
        proof = prove_sheet(origami, boxes=boxes)
    return Certificate(
        proof.over or "all closed states within fold limits",
        tuple(CertifiedState(tuple(m.fold_angles.tolist()), m.radius) for m in proof.minima),
        tuple(
            OpenRegion(tuple(r.lower.tolist()), tuple(r.upper.tolist()), r.reason)
            for r in proof.regions
        ),
        **stated,
    )


def _stated(pattern: Pattern) -> StatedSheet:
    pattern.check_plain_hinges("the certificate of a sheet")
    if len(pattern.polygons) != pattern.facets:
        raise OptionError(
            f"pattern = {pattern.title}: no certificate is written where a facet is of several pieces (F or J edges)"
        )
    sheet, _ = as_sheet(pattern)
    return StatedSheet(
        corners=tuple((x, y) for x, y in in_plane(pattern).tolist()),
        facets=tuple(tuple(map(int, p)) for p in pattern.polygons),
        creases=tuple((a, b) for a, b in pattern.ends.tolist()),
        stiffness=tuple(pattern.stiffness.tolist()),
        rest=tuple(pattern.rest.tolist()),
        deviation=sheet.deviation if sheet else 0.0,
    )


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
