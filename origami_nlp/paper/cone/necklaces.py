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

import numpy as np

from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.paper.cone.classes import exact
from origami_nlp.paper.cone.rules import check_degree

LARGEST_LISTED = 32
"""Largest degree whose different foldings are listed one by one (4,116 necklaces)."""


@dataclass(frozen=True)
class Folding:
    """One assignment of those that differ by rotation (or by rotation and reflection).

    Attributes
    ----------
    flaps
        The representative, alphabetically last (valleys first), such as "VVM".
    symmetry
        Of the folded cone at any elevation but 0, "D2" ...: rotations that keep the assignment make C_m, with a
        reflection D_m.  Nothing else keeps it: what turns it over reverses the elevation.
    copies
        Number of assignments it stands for.
    chiral
        Whether its mirror image is a different necklace.
    """

    flaps: str = field(metadata=shown("flaps"))
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
    >>> [(f.flaps, f.symmetry, f.copies) for f in cone.foldings(6)]
    [('VVV', 'D3', 1), ('VVM', 'D1', 3), ('VMM', 'D1', 3), ('MMM', 'D3', 1)]
    >>> len(cone.foldings(12)), len(cone.foldings(12, mirrors_differ=False))
    (14, 13)
    """
    n = check_degree(degree, LARGEST_LISTED) // 2
    # words as numbers, a bit a flap, valleys 1: the alphabetically last of its images is the largest
    words = np.arange(1 << n)
    back = np.sum([(words >> k & 1) << (n - 1 - k) for k in range(n)], axis=0)
    turned, mirrored = (
        np.array([(w << k | w >> (n - k)) & ((1 << n) - 1) for k in range(n)])
        for w in (words, back)
    )
    last = turned.max(axis=0)
    if not mirrors_differ:
        last = np.maximum(last, mirrored.max(axis=0))
    found = []
    for word in np.flatnonzero(last == words)[::-1].tolist():
        fixed, chiral = int((turned[:, word] == word).sum()), word not in mirrored[:, word]
        copies = n // fixed * (2 if chiral and not mirrors_differ else 1)
        letters = f"{word:0{n}b}".translate({ord("1"): "V", ord("0"): "M"})
        found.append(Folding(letters, f"{'DC'[chiral]}{fixed}", copies, chiral))
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
    # Burnside over the 2 n elements of D_n: bracelets, eq. 4.6
    kept = n * ((1 << n // 2) + (1 << (n + 2) // 2)) // 2
    if n % 2:
        kept = n << (n + 1) // 2
    return (n * turned + kept) // (2 * n)


@dataclass(frozen=True, repr=False)
class Foldings(Report):
    """How many foldings of a cone differ, and which.

    Attributes
    ----------
    degree
        N.
    assignments, necklaces, bracelets
        Numbers at one elevation: of all, of those that differ by more than a rotation, by more than rotation and
        reflection; as text beyond 2^53.
    necklace_list, bracelet_list
        One by one; empty where they are not listed.
    """

    degree: int
    assignments: str
    necklaces: int | str
    bracelets: int | str
    necklace_list: tuple[Folding, ...] = ()
    bracelet_list: tuple[Folding, ...] = ()

    SCHEMA, READS, ROWS = "origami-nlp/paper/1", False, "necklace_list"

    @classmethod
    def of(cls, degree: int, listed: bool) -> Foldings:
        """Count the foldings of a degree, and list them (up to `LARGEST_LISTED`)."""
        check_degree(degree, LARGEST_LISTED if listed else None)
        one, two = (exact(number_of_foldings(degree, mirrors_differ=m)) for m in (True, False))
        each = (tuple(foldings(degree, mirrors_differ=m)) for m in (True, False) if listed)
        return cls(degree, str(1 << degree // 2), one, two, *each)

    def report_sections(self) -> Iterator[Section]:
        """Return the numbers, and a row for each folding."""
        yield (
            f"cone of degree {self.degree}: {self.assignments} assignments at an elevation, "
            f"{self.necklaces} up to rotation (necklaces), {self.bracelets} up to rotation and reflection (bracelets)"
        )
        if self.necklace_list:
            yield record_table(self.necklace_list, "")
