"""Flaps of a cone: assignments, their classes, symmetries, and how many are different.

A cone is a uniform vertex of even degree N; its n = N/2 flaps (two facets that share an even
crease) are valleys (+1, V: partial fold angle rho_v >= 0) or mountains (-1, M).  Paper sections 4
and 5.  A *branch* is an assignment and a sign of the elevation: 2^(n+1) branches leave the flat
state.  Energies of springs that are alike on all odd, and alike on all even creases depend on the
assignment through its number of valley flaps and the number of changes V-M or M-V around the ring
only: its *class*.

Different foldings are counted up to rotation about the axis (necklaces) or up to rotation and
reflection in planes through the axis (bracelets), at a given sign of the elevation and without
swapping valleys and mountains.  Turning the sheet over swaps V with M and reverses the elevation:
it pairs (word, up) with (swapped and reversed word, down), so over both signs and up to turning over
the numbers are the same.  The paper speaks of rigid rotations (necklaces), prints the formula of
bracelets, and tabulates necklaces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import gcd
from numbers import Integral

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError

LARGEST_DEGREE = 4000
"""Largest degree whose classes are enumerated: there are (N/2)^2 / 4 of them."""
LARGEST_LISTED = 32
"""Largest degree whose different foldings are listed one by one (4,116 necklaces)."""

Flaps = tuple[int, ...]
"""One entry a flap, +1 valley or -1 mountain."""


def check_degree(degree: int, largest: int | None = None) -> int:
    """Return the degree of a cone, or complain.

    Raises
    ------
    OptionError
        Unless it is even and at least 6 (at degree 4 both partial fold angles are degenerate).
    """
    whole = isinstance(degree, Integral) and not isinstance(degree, bool)
    if not whole or degree < 6 or degree % 2:
        raise OptionError(
            f"degree = {shown(degree)}: a cone has an even number of creases >= 6 (flaps of two facets)"
        )
    if largest is not None and degree > largest:
        raise OptionError(
            f"degree = {shown(degree)}: this is done for degrees up to {largest} only"
        )
    return int(degree)


def parse_flaps(text: str | Sequence[int], degree: int | None = None) -> Flaps:
    """Read an assignment: letters V and M such as "VVM" (runs may be written V2M), or +1 and -1.

    Raises
    ------
    OptionError
        If it is not an assignment, or not one of `degree`.
    """
    if isinstance(text, str):
        flaps: list[int] = []
        number = ""
        for letter in [*text.strip().upper().replace("_", ""), " "]:
            if letter.isdigit() and letter.isascii() and flaps and len(number) < 5:
                number += letter
                continue
            if number:
                if int(number) < 1 or int(number) > LARGEST_DEGREE:
                    raise OptionError(f"flaps = {text!r}: a run of {number} flaps")
                flaps += [flaps[-1]] * (int(number) - 1)
                number = ""
            if letter in "VM":
                flaps.append(1 if letter == "V" else -1)
            elif letter != " ":
                raise OptionError(f'flaps = {text!r}: write V and M, one a flap, such as "VVM"')
    else:
        flaps = [int(f) for f in text]
        if any(f not in (1, -1) for f in flaps):
            raise OptionError("flaps must be +1 (valley) or -1 (mountain)")
    if degree is not None and len(flaps) != degree // 2:
        raise OptionError(
            f"flaps = {write_flaps(flaps)!r} has {len(flaps)} flaps, a cone of degree {degree} "
            f"has {degree // 2}"
        )
    check_degree(2 * len(flaps))
    return tuple(flaps)


def write_flaps(flaps: Sequence[int]) -> str:
    """Write an assignment as letters V and M.

    Raises
    ------
    OptionError
        Unless `flaps` are +1 and -1.
    """
    if not isinstance(flaps, Sequence) or isinstance(flaps, str) or not {*flaps} <= {1, -1}:
        raise OptionError(
            f"flaps = {shown(flaps)} must be +1 (valley) or -1 (mountain), one a flap"
        )
    return "".join("V" if f > 0 else "M" for f in flaps)


# ---------------------------------------------------------------- classes


@dataclass(frozen=True)
class ConeClasses:
    """Classes of assignments of one degree.

    Attributes
    ----------
    degree
        N.
    valleys, changes
        Number of valley flaps a, and of cyclic neighbours that differ (even: 2j), int arrays [m].
    multiplicity
        Number of assignments in each class, exact integers; they sum to 2^(N/2).
    """

    degree: int
    valleys: np.ndarray
    changes: np.ndarray
    multiplicity: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.multiplicity)

    def index(self, flaps: Sequence[int]) -> int:
        """Return the row of an assignment's class."""
        valleys, changes = class_of(flaps)
        return int(np.nonzero((self.valleys == valleys) & (self.changes == changes))[0][0])


def class_of(flaps: Sequence[int]) -> tuple[int, int]:
    """Count (valley flaps, changes around the ring) of an assignment."""
    changes = sum(flaps[i - 1] != flaps[i] for i in range(len(flaps)))
    return sum(f > 0 for f in flaps), changes


@lru_cache(maxsize=8)
def cone_classes(degree: int) -> ConeClasses:
    """Enumerate the classes: 0 or n valleys, else a valleys in j runs, 1 <= j <= min(a, n - a).

    There are (n/j) C(a-1, j-1) C(n-a-1, j-1) assignments with a valleys in j runs: compositions of a
    and n - a into j parts make the ring, marked at one of the j starts of a run of valleys, and the
    mark can be at n places.
    """
    n = check_degree(degree, LARGEST_DEGREE) // 2
    valleys, changes, multiplicity = [0], [0], [1]
    for a in range(1, n):
        runs = min(a, n - a)
        valleys += [a] * runs
        changes += range(2, 2 * runs + 1, 2)
        if a <= n - a:
            number, row = n, []
            for j in range(1, runs + 1):
                row.append(number)  # the next number is a whole one, so // is exact
                number = number * (a - j) * (n - a - j) // (j * (j + 1))
            start = len(multiplicity)
            multiplicity += row
        else:  # a valleys in j runs: as many as n - a
            start = _row_start(n, n - a)
            multiplicity += multiplicity[start : start + runs]
    return ConeClasses(
        degree,
        _frozen([*valleys, n]),
        _frozen([*changes, 0]),
        (*multiplicity, 1),
    )


def _row_start(n: int, a: int) -> int:
    """Contact of the class with a valleys in one run."""
    return 1 + sum(min(b, n - b) for b in range(1, a))


def _frozen(values: list[int]) -> np.ndarray:
    array = np.array(values, dtype=np.int64)
    array.flags.writeable = False
    return array


# ---------------------------------------------------------------- symmetry, different foldings


def symmetry_of(flaps: Sequence[int]) -> str:
    """Name the symmetry of the folded cone at any elevation but 0: "D3", "C2", "C1" ...

    Rotations about the axis that keep the assignment make C_m; with a reflection in a plane through
    the axis (through even or odd creases) it is D_m.  Nothing else can keep a folded cone: what turns
    it over reverses the elevation, and odd creases are never alike even ones.
    """
    word = tuple(flaps)
    turns = sum(word[k:] + word[:k] == word for k in range(len(word)))
    back = word[::-1]
    mirrored = any(back[k:] + back[:k] == word for k in range(len(word)))
    return f"{'D' if mirrored else 'C'}{turns}"


@dataclass(frozen=True)
class Folding:
    """One assignment of those that differ by rotation (or by rotation and reflection).

    flaps: the representative, alphabetically last (valleys first).
    symmetry: of the folded cone, "D2" ...
    copies: number of assignments it stands for.
    chiral: whether its mirror image is a different necklace.
    """

    flaps: Flaps
    symmetry: str
    copies: int
    chiral: bool


def necklaces(degree: int) -> list[Folding]:
    """List the assignments that differ by more than a rotation, valleys first."""
    n = check_degree(degree, LARGEST_LISTED) // 2
    found = []
    for word in _necklace_words(n):
        flaps = tuple(1 - 2 * letter for letter in word)
        symmetry = symmetry_of(flaps)
        copies = n // int(symmetry[1:])
        found.append(Folding(flaps, symmetry, copies, symmetry[0] == "C"))
    return found


def bracelets(degree: int) -> list[Folding]:
    """List the assignments that differ by more than rotations and reflections, valleys first."""
    found = []
    for folding in necklaces(degree):
        back = folding.flaps[::-1]
        if folding.flaps == max(folding.flaps, _standard(back)):
            copies = folding.copies * (2 if folding.chiral else 1)
            found.append(Folding(folding.flaps, folding.symmetry, copies, folding.chiral))
    return found


def _standard(flaps: Flaps) -> Flaps:
    """Rotate an assignment to its alphabetically last form."""
    return max(flaps[k:] + flaps[:k] for k in range(len(flaps)))


def _necklace_words(n: int) -> Iterator[tuple[int, ...]]:
    """Words of 0 and 1, smallest of their rotations, in alphabetical order.

    Fredricksen, Kessler, Maiorana: the prenecklaces in order; a prenecklace of period p that divides n
    is a necklace.
    """
    word = [0] * n
    yield tuple(word)
    while True:
        last = n - 1
        while last >= 0 and word[last] == 1:
            last -= 1
        if last < 0:
            return
        word[last] = 1
        period = last + 1
        for k in range(period, n):
            word[k] = word[k - period]
        if n % period == 0:
            yield tuple(word)


def necklace_number(degree: int) -> int:
    """Count assignments up to rotation, exactly: (1/n) sum over d | n of psi(d) 2^(n/d)."""
    n = check_degree(degree) // 2
    return sum(_totient(d) << (n // d) for d in range(1, n + 1) if n % d == 0) // n


def bracelet_number(degree: int) -> int:
    """Count assignments up to rotation and reflection, exactly (Burnside; the paper's formula).

    The n reflections keep 2^((n+1)/2) words each for odd n; for even n half of them 2^(n/2) and half
    of them 2^(n/2 + 1).
    """
    n = check_degree(degree) // 2
    if n % 2:
        kept = n << ((n + 1) // 2)
    else:
        kept = (n // 2) * ((1 << (n // 2)) + (1 << (n // 2 + 1)))
    return (n * necklace_number(degree) + kept) // (2 * n)


def _totient(d: int) -> int:
    return sum(gcd(k, d) == 1 for k in range(1, d + 1))
