"""Symmetries of folded cones, and how many foldings are different.

Different foldings are counted up to rotation about the axis (necklaces) or up to rotation and
reflection in planes through the axis (bracelets), at a given sign of the elevation and without
swapping valleys and mountains.  Turning the sheet over swaps V with M and reverses the elevation:
it pairs (word, up) with (swapped and reversed word, down), so over both signs and up to turning over
the numbers are the same.  The paper speaks of rigid rotations (necklaces), prints the formula of
bracelets, and tabulates necklaces.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import gcd
from typing import Any

import numpy as np

from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.paper.cone.flaps import Flaps, symmetry_of, write_flaps
from origami_nlp.paper.cone.numbers import exact, number_words
from origami_nlp.paper.cone.rules import check_degree

LARGEST_LISTED = 32
"""Largest degree whose different foldings are listed one by one (4,116 necklaces)."""


@dataclass(frozen=True)
class Folding:
    """One assignment of those that differ by rotation (or by rotation and reflection).

    Attributes
    ----------
    flaps
        The representative, alphabetically last (valleys first).
    symmetry
        Of the folded cone, "D2" ...
    copies
        Number of assignments it stands for.
    chiral
        Whether its mirror image is a different necklace.
    """

    flaps: Flaps = field(metadata=shown("flaps", spec=lambda f: "V" if f > 0 else "M", between=""))
    symmetry: str = field(metadata=shown("symmetry"))
    copies: int = field(metadata=shown("copies"))
    chiral: bool = field(metadata=shown("mirror image differs"))


def foldings(degree: int, *, mirrors_differ: bool = True) -> list[Folding]:
    """List the different foldings of a cone, valleys first.

    Parameters
    ----------
    degree
        N, even, 6 to `LARGEST_LISTED`.
    mirrors_differ
        Whether a folding and its mirror image are two: true, assignments up to rotation are listed (necklaces);
        false, up to rotation and reflection (bracelets).

    Returns
    -------
    list of Folding
        One of each, with its symmetry and the number of assignments it stands for.

    Raises
    ------
    OptionError
        For another degree.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> [(cone.write_flaps(f.flaps), f.symmetry, f.copies) for f in cone.foldings(6)]
    [('VVV', 'D3', 1), ('VVM', 'D1', 3), ('VMM', 'D1', 3), ('MMM', 'D3', 1)]
    >>> len(cone.foldings(12)), len(cone.foldings(12, mirrors_differ=False))
    (14, 13)
    """
    n = check_degree(degree, LARGEST_LISTED) // 2
    # words as numbers, a bit a flap, valleys 1: the alphabetically last of its images is the largest
    words = np.arange(1 << n)
    back = np.sum([(words >> k & 1) << (n - 1 - k) for k in range(n)], axis=0)
    images = [words] if mirrors_differ else [words, back]
    turned = [(w << k | w >> (n - k)) & ((1 << n) - 1) for w in images for k in range(n)]
    found = []
    for word in np.flatnonzero(np.max(turned, axis=0) == words)[::-1].tolist():
        flaps = tuple(1 if word >> k & 1 else -1 for k in reversed(range(n)))
        symmetry = symmetry_of(flaps)
        chiral = symmetry[0] == "C"
        copies = n // int(symmetry[1:]) * (2 if chiral and not mirrors_differ else 1)
        found.append(Folding(flaps, symmetry, copies, chiral))
    return found


def number_of_foldings(degree: int, *, mirrors_differ: bool = True) -> int:
    """Count the different foldings of a cone exactly, for any degree.

    Up to rotation there are (1/n) sum over k of 2^gcd(k, n), k = 1, ..., n.  The n reflections keep 2^((n+1)/2) words
    each for odd n; for even n half of them 2^(n/2) and half of them 2^(n/2 + 1) (Burnside; the paper's formula).

    Parameters
    ----------
    degree
        N, even, at least 6.
    mirrors_differ
        See `foldings`.

    Returns
    -------
    int
        Exact, however large.

    Raises
    ------
    OptionError
        For another degree.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.number_of_foldings(30), cone.number_of_foldings(30, mirrors_differ=False)
    (2192, 1224)
    """
    n = check_degree(degree) // 2
    # necklaces, as the paper's table lists them; its eq. 4.6 counts bracelets (docs/validation/errata.md)
    turned = sum(1 << gcd(k, n) for k in range(n)) // n
    if mirrors_differ:
        return turned
    if n % 2:
        kept = n << ((n + 1) // 2)
    else:
        kept = (n // 2) * ((1 << (n // 2)) + (1 << (n // 2 + 1)))
    # Burnside over the 2 n elements of D_n: bracelets, eq. 4.6
    return (n * turned + kept) // (2 * n)


@dataclass(frozen=True, repr=False)
class Foldings(Report):
    """How many foldings of a cone differ, and which.

    Attributes
    ----------
    degree
        N.
    listed
        Whether they are listed one by one.
    """

    degree: int
    listed: bool

    SCHEMA, READS = "origami-nlp/paper/1", False

    def __post_init__(self) -> None:
        check_degree(self.degree, LARGEST_LISTED if self.listed else None)

    def report_sections(self) -> Iterator[Section]:
        """Return the numbers, and a row for each folding."""
        turned, mirrored = (
            number_of_foldings(self.degree, mirrors_differ=m) for m in (True, False)
        )
        yield (
            f"cone of degree {self.degree}: {number_words(1 << (self.degree // 2))} assignments at an elevation, "
            f"of which differ\n  by more than a rotation (necklaces): {number_words(turned)}\n"
            f"  by more than rotation and reflection (bracelets): {number_words(mirrored)}\n"
            "valleys and mountains are not swapped; with both signs of the elevation, turning the sheet over "
            "leaves the same numbers"
        )
        if self.listed:
            yield record_table(foldings(self.degree), "")

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data; numbers beyond 2^53 are text."""
        kinds = {"necklace": True, "bracelet": False}
        data: dict[str, Any] = {"schema": self.SCHEMA, "degree": self.degree}
        data["assignments"] = str(1 << (self.degree // 2))
        for kind, differ in kinds.items():
            data[f"{kind}s"] = exact(number_of_foldings(self.degree, mirrors_differ=differ))
        for kind, differ in kinds.items() if self.listed else ():
            data[f"{kind}_list"] = [
                vars(f) | {"flaps": write_flaps(f.flaps)}
                for f in foldings(self.degree, mirrors_differ=differ)
            ]
        return data
