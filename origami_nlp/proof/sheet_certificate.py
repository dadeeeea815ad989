"""What certificates of patterns have in common: the sheet with its springs, states on it, and what is left open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from origami_nlp.errors import CertificateError, OptionError
from origami_nlp.io import Finite
from origami_nlp.pattern import Pattern, in_plane


@dataclass(frozen=True)
class StatedSheet:
    """A flat sheet with springs, the doubles of the pattern.

    Attributes
    ----------
    corners, facets, creases
        Points [V], corners of each facet, corners that each crease joins [n].
    stiffness, rest
        Of the creases, [n] [N m/rad] and [rad].
    """

    corners: tuple[tuple[Finite, Finite], ...]
    facets: tuple[tuple[int, ...], ...]
    creases: tuple[tuple[int, int], ...]
    stiffness: tuple[Finite, ...]
    rest: tuple[Finite, ...]


@dataclass(frozen=True)
class CertifiedState:
    """A minimum: fold angles [rad] to within a radius."""

    fold_angles: tuple[Finite, ...]
    radius: Finite


@dataclass(frozen=True)
class OpenInterval:
    """What is left open: fold angles [rad] between two states, and why."""

    lower: tuple[Finite, ...]
    upper: tuple[Finite, ...]
    reason: str


def check_sheet(
    said: StatedSheet,
    minima: Sequence[CertifiedState],
    more: Sequence[tuple[str, Sequence[object], int]] = (),
) -> None:
    """Raise an error where the sheet of a certificate is not well formed, or another of its lists.

    Raises
    ------
    CertificateError
        With the first field.
    """
    n = len(said.creases)
    sizes = [("stiffness", said.stiffness, n), ("rest", said.rest, n), *more]
    for i, minimum in enumerate(minima, start=1):
        sizes.append((f"minima[{i}].fold_angles", minimum.fold_angles, n))
    for name, values, many in sizes:
        if len(values) != many:
            raise CertificateError(f"{name} of the proof must be {many} numbers")
    numbers = [c for row in (*said.facets, *said.creases) for c in row]
    if not numbers or not 0 <= min(numbers) <= max(numbers) < len(said.corners):
        raise CertificateError("facets and creases of the proof must be numbers of its corners")
    if any(len(set(f)) < max(3, len(f)) for f in said.facets):
        raise CertificateError("facets of the proof must have three corners or more, each once")


def stated_sheet(pattern: Pattern) -> dict[str, Any]:
    """Return the fields of a certificate that are the pattern's.

    Raises
    ------
    OptionError
        If a facet is of several pieces: the check knows none.
    """
    if len(pattern.polygons) != pattern.facets:
        raise OptionError(
            f"pattern = {pattern.title}: no certificate is written where a facet is of several pieces (F or J edges)"
        )
    return {
        "corners": tuple((x, y) for x, y in in_plane(pattern).tolist()),
        "facets": tuple(tuple(map(int, p)) for p in pattern.polygons),
        "creases": tuple((a, b) for a, b in pattern.ends.tolist()),
        "stiffness": tuple(pattern.stiffness.tolist()),
        "rest": tuple(pattern.rest.tolist()),
    }
