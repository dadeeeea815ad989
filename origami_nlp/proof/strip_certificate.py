"""The proof of a strip as a file: the sheet, and what is claimed over boxes of each of its curves, in plain JSON.

Schema ``origami-nlp/strip-proof/1``.  Corners, stiffness and rest angles are the doubles of the pattern.  Theta is half
the fold angle of the crease along the row that folds most, times its sign on the curve.  Each box between two ``ends``
of a curve has one of `CLAIMS`.  Nothing in a file is evaluated.  Stops and hinge laws stand there where there are any.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from origami_nlp.errors import CertificateError
from origami_nlp.io import Finite, from_plain, to_plain
from origami_nlp.proof.sheet_certificate import (
    CertifiedState,
    OpenInterval,
    StatedSheet,
    check_sheet,
)

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
class CertifiedStop:
    """A crease that reaches a stop of its own, the upper one (1) or the lower."""

    crease: int
    side: Literal[-1, 1]


@dataclass(frozen=True)
class StatedLaw:
    """A hinge law: breaks [B + 1] [rad], and coefficients of the torque [B, 4], as `HingeLaw` has them."""

    breaks: tuple[Finite, ...]
    coefficients: tuple[tuple[Finite, ...], ...]


@dataclass(frozen=True)
class TouchingBox:
    """The touches of a box of a curve, by its number, and creases that reach stops there."""

    box: int
    touches: tuple[CertifiedTouch, ...]
    stops: tuple[CertifiedStop, ...] = field(default=(), metadata={"omit": True})


@dataclass(frozen=True)
class CertifiedCurve:
    """One curve: signs of the folds along the row for theta > 0 [k + 1], ends of its boxes [m + 1], and claims [m]."""

    signs: tuple[Literal[-1, 1], ...]
    ends: tuple[Finite, ...]
    claims: tuple[Claim, ...]
    touches: tuple[TouchingBox, ...]


@dataclass(frozen=True)
class CertifiedMinimum(CertifiedState):
    """A minimum: the signs of its curve, and theta between two numbers."""

    signs: tuple[Literal[-1, 1], ...]
    theta: tuple[Finite, Finite]
    touching: tuple[tuple[int, int], ...]
    stops: tuple[CertifiedStop, ...] = field(default=(), metadata={"omit": True})


@dataclass(frozen=True)
class StripCertificate(StatedSheet):
    """What the proof of a strip claims of a sheet.

    Attributes
    ----------
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
    limits
        Low and high fold limit of each crease [n, 2] [rad]; none where all are +-pi.
    laws
        Of each crease with a hinge law, [n]; none where all are springs.
    """

    contact: bool
    row: tuple[int, ...]
    curves: tuple[CertifiedCurve, ...]
    minima: tuple[CertifiedMinimum, ...]
    maxima: int
    undecided: tuple[OpenInterval, ...]
    limits: tuple[tuple[Finite, Finite], ...] = field(default=(), metadata={"omit": True})
    laws: tuple[StatedLaw | None, ...] = field(default=(), metadata={"omit": True})


def strip_to_dict(certificate: StripCertificate) -> dict[str, Any]:
    """Return a certificate as plain data."""
    return {"schema": STRIP_SCHEMA, **to_plain(certificate)}


def strip_from_dict(data: dict[str, Any]) -> StripCertificate:
    """Return the certificate that `strip_to_dict` wrote: well formed, nothing in it is checked."""
    own = {key: value for key, value in data.items() if key != "schema"}
    said = from_plain(StripCertificate, own, "proof", CertificateError)
    n = len(said.creases)
    sizes: list[tuple[str, Sequence[object], int]] = []
    for i, curve in enumerate(said.curves, start=1):
        sizes.append((f"curves[{i}].signs", curve.signs, len(said.row)))
        sizes.append((f"curves[{i}].ends", curve.ends, len(curve.claims) + 1))
    for name in ("limits", "laws"):
        if getattr(said, name):
            sizes.append((name, getattr(said, name), n))
    for i, law in enumerate(said.laws, start=1):
        if law is not None:
            sizes.append((f"laws[{i}].coefficients", law.coefficients, len(law.breaks) - 1))
            sizes += [(f"laws[{i}].coefficients", row, 4) for row in law.coefficients]
    check_sheet(said, said.minima, sizes)
    if not all(0 <= c < n for c in said.row):
        raise CertificateError("row of the proof must be numbers of its creases")
    return said
