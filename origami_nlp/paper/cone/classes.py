"""Branches of equal energy: classes of assignments, and with a direction classes of branches.

Springs that are alike on all odd, and alike on all even creases see of an assignment its number of valley flaps
and the number of changes V-M or M-V around the ring only.  So O(N^2) classes stand for all 2^(n+1) branches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np

from origami_nlp.paper.cone.flaps import class_of
from origami_nlp.paper.cone.rules import LARGEST_DEGREE, Cone, check_degree


@dataclass(frozen=True)
class AssignmentClasses:
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


@lru_cache(maxsize=8)
def assignment_classes(degree: int) -> AssignmentClasses:
    """Enumerate the classes: 0 or n valleys, else a valleys in j runs, 1 <= j <= min(a, n - a).

    There are (n/j) C(a-1, j-1) C(n-a-1, j-1) assignments with a valleys in j runs: compositions of a
    and n - a into j parts make the ring, marked at one of the j starts of a run of valleys, and the
    mark can be at n places.

    Parameters
    ----------
    degree
        N, even, 6 to 4000.

    Raises
    ------
    OptionError
        For another degree.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> classes = cone.assignment_classes(8)
    >>> list(zip(classes.valleys.tolist(), classes.changes.tolist(), classes.multiplicity))
    [(0, 0, 1), (1, 2, 4), (2, 2, 4), (2, 4, 2), (3, 2, 4), (4, 0, 1)]
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
                # (n/j) C(a-1, j-1) C(b-1, j-1) from j to j + 1: times (a - j)(b - j) / (j (j + 1)), b = n - a
                row.append(number)  # the next number is a whole one, so // is exact
                number = number * (a - j) * (n - a - j) // (j * (j + 1))
            start = len(multiplicity)
            multiplicity += row
        else:  # a valleys in j runs: as many as n - a
            start = _row_start(n, n - a)
            multiplicity += multiplicity[start : start + runs]
    return AssignmentClasses(
        degree, _frozen([*valleys, n]), _frozen([*changes, 0]), (*multiplicity, 1)
    )


def _row_start(n: int, a: int) -> int:
    """Row of the class with a valleys in one run."""
    return 1 + sum(min(b, n - b) for b in range(1, a))


def _frozen(values: list[int]) -> np.ndarray:
    array = np.array(values, dtype=np.int64)
    array.flags.writeable = False
    return array


def odd_crease_numbers(
    flaps: int, steep: np.ndarray | int, changes: np.ndarray | int
) -> np.ndarray:
    """Count the odd creases between two shallow, two steep, and two unlike flaps, shape of `steep` + (3,)."""
    j = np.asarray(changes) // 2
    # j runs of each kind: p shallow flaps have p - j neighbours alike, and 2 j neighbours differ
    return np.stack([flaps - steep - j, steep - j, 2 * j], axis=-1).astype(float)


@dataclass(frozen=True)
class EnergyClass:
    """Branches of equal energy: a valley flaps, 2j changes around the ring, and a direction.

    Attributes
    ----------
    cone
        Degree and rules.
    valleys
        Number a of valley flaps.
    changes
        Number 2j of changes between valley and mountain around the ring.
    direction
        +1 up, -1 down.
    """

    cone: Cone
    valleys: int
    changes: int
    direction: int

    @property
    def mountains(self) -> int:
        """Number of mountain flaps."""
        return self.cone.flaps - self.valleys

    @property
    def multiplicity(self) -> int:
        """Number of branches in the class, exact; see `assignment_classes`."""
        a, b, j = self.valleys, self.mountains, self.changes // 2
        return self.cone.flaps * comb(a - 1, j - 1) * comb(b - 1, j - 1) // j if j else 1

    @property
    def steep(self) -> int:
        """Number of steep flaps."""
        return self.mountains if self.direction > 0 else self.valleys

    @property
    def end(self) -> float:
        """|v| at which the branches end [rad]."""
        return float(self.cone.ends(self.steep))

    @property
    def name(self) -> str:
        """Name in the paper's way: "M2V up", or "M2V2 up (4 changes)".

        The number of changes is added where the valleys could also lie otherwise.
        """
        parts = [(letter, k) for letter, k in (("M", self.mountains), ("V", self.valleys)) if k]
        word = "".join(letter + (str(k) if k > 1 else "") for letter, k in parts)
        several = min(self.valleys, self.mountains) > 1
        more = f" ({self.changes} changes)" if several else ""
        return f"{word} {direction_name(self.direction)}{more}"


def direction_name(direction: int) -> str:
    """Word for a sign of the elevation."""
    return "up" if direction > 0 else "down"


def energy_classes(cone: Cone | int) -> list[EnergyClass]:
    """List the classes of branches of equal energy of both directions, up first, most valleys first.

    Parameters
    ----------
    cone
        A `Cone`, or its degree.

    Returns
    -------
    list of EnergyClass
        The classes.

    Raises
    ------
    OptionError
        If it is neither.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> [(c.name, c.multiplicity) for c in cone.energy_classes(6)[:4]]
    [('V3 up', 1), ('MV2 up', 3), ('M2V up', 3), ('M3 up', 1)]
    """
    cone = Cone.of(cone)
    known = assignment_classes(cone.degree)
    pairs = list(zip(known.valleys.tolist(), known.changes.tolist(), strict=True))[::-1]
    return [EnergyClass(cone, *pair, direction) for direction in (1, -1) for pair in pairs]
