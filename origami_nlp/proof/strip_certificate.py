"""The proof of a strip as a file: the sheet, and what is claimed over boxes of each of its curves, in plain JSON.

Schema ``origami-nlp/strip-proof/1``.  Corners, stiffness and rest angles are the doubles of the pattern.  Theta is half
the fold angle of the crease along the row that folds most, times its sign on the curve.  Each box between two ``ends``
of a curve has one of `CLAIMS`.  Nothing in a file is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

from origami_nlp.errors import CertificateError
from origami_nlp.io import Finite, from_plain, to_plain

STRIP_SCHEMA = "origami-nlp/strip-proof/1"
Claim: TypeAlias = Literal[
    "rising", "falling", "convex", "concave", "outside", "limit", "crossing", "touching", "open"
]
"""Of the energy over a box: U' > 0, U' < 0, U'' > 0, U'' < 0, all states closed, within fold limits and with contact
apart.  No state closes there; creases reach +-180 degrees; facets cross; two are apart or cross by the sign of one gap,
and U' is not 0; nothing."""


@dataclass(frozen=True)
class CertifiedTouch:
    """Two facets that meet within a box, and corners x0..x3 (facet, place in it).

    det(x1 - x0, x2 - x0, x3 - x0) has one sign where they are apart, and the other where they cross.
    """

    facets: tuple[int, int]
    corners: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class TouchingBox:
    """The touches of a box of a curve, by its number."""

    box: int
    touches: tuple[CertifiedTouch, ...]


@dataclass(frozen=True)
class CertifiedCurve:
    """One curve: signs of the folds along the row for theta > 0 [k + 1], ends of its boxes [m + 1], and claims [m]."""

    signs: tuple[Literal[-1, 1], ...]
    ends: tuple[Finite, ...]
    claims: tuple[Claim, ...]
    touches: tuple[TouchingBox, ...]


@dataclass(frozen=True)
class CertifiedMinimum:
    """A minimum: the signs of its curve, theta between two numbers, fold angles [rad] to within a radius."""

    signs: tuple[Literal[-1, 1], ...]
    theta: tuple[Finite, Finite]
    fold_angles: tuple[Finite, ...]
    radius: Finite
    touching: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class OpenInterval:
    """What is left open: fold angles [rad] between two states, and why."""

    lower: tuple[Finite, ...]
    upper: tuple[Finite, ...]
    reason: str


@dataclass(frozen=True)
class StripCertificate:
    """What the proof of a strip claims.

    Attributes
    ----------
    corners, facets, creases
        The flat sheet: points [V], corners of each facet, corners that each crease joins [n].
    stiffness, rest
        Of the creases, [n] [N m/rad] and [rad].
    contact
        Whether states in which facets cross are left out.
    row
        Creases along the row, [k + 1].
    curves
        All of them.
    minima
        All of them.
    maxima
        How many lie inside the curves.
    undecided
        What is left open.
    """

    corners: tuple[tuple[Finite, Finite], ...]
    facets: tuple[tuple[int, ...], ...]
    creases: tuple[tuple[int, int], ...]
    stiffness: tuple[Finite, ...]
    rest: tuple[Finite, ...]
    contact: bool
    row: tuple[int, ...]
    curves: tuple[CertifiedCurve, ...]
    minima: tuple[CertifiedMinimum, ...]
    maxima: int
    undecided: tuple[OpenInterval, ...]


def strip_to_dict(certificate: StripCertificate) -> dict[str, Any]:
    """Return a certificate as plain data."""
    return {"schema": STRIP_SCHEMA, **to_plain(certificate)}


def strip_from_dict(data: dict[str, Any]) -> StripCertificate:
    """Return the certificate that `strip_to_dict` wrote: well formed, nothing in it is checked."""
    own = {key: value for key, value in data.items() if key != "schema"}
    said = from_plain(StripCertificate, own, "proof", CertificateError)
    n = len(said.creases)
    sizes = [("stiffness", said.stiffness, n), ("rest", said.rest, n)]
    for i, curve in enumerate(said.curves, start=1):
        sizes.append((f"curves[{i}].signs", curve.signs, len(said.row)))
        sizes.append((f"curves[{i}].ends", curve.ends, len(curve.claims) + 1))
    for i, minimum in enumerate(said.minima, start=1):
        sizes.append((f"minima[{i}].fold_angles", minimum.fold_angles, n))
    for name, values, many in sizes:
        if len(values) != many:
            raise CertificateError(f"{name} of the proof must be {many} numbers")
    numbers = [c for row in (*said.facets, *said.creases) for c in row]
    if not numbers or not 0 <= min(numbers) <= max(numbers) < len(said.corners):
        raise CertificateError("facets and creases of the proof must be numbers of its corners")
    if not all(0 <= c < n for c in said.row):
        raise CertificateError("row of the proof must be numbers of its creases")
    if any(len(set(f)) < max(3, len(f)) for f in said.facets):
        raise CertificateError("facets of the proof must have three corners or more, each once")
    return said
