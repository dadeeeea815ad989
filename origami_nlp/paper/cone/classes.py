"""Branches of equal energy: springs see of a branch its valley flaps, its changes around the ring, and its direction.

Springs that are alike on all odd, and alike on all even creases see no more of an assignment than its number of valley
flaps and the number of changes V-M or M-V around the ring.  So O(N^2) classes stand for all 2^(n+1) branches.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from origami_nlp.paper.cone.rules import LARGEST_DEGREE, Cone

SAFE = 2**53
"""Largest integer that JSON readers do not round."""


@dataclass(frozen=True)
class Branches:
    """Classes of branches of equal energy, an entry each: a valley flaps, 2j changes around the ring, a direction.

    Attributes
    ----------
    cone
        Degree and rules.
    valleys, changes
        Number of valley flaps a, and of cyclic neighbours that differ (even: 2j).
    direction
        +1 up, -1 down.
    multiplicity
        Number of branches in each class, exact Python integers; they sum to 2^(N/2 + 1).

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> every = cone.Branches.of(6)
    >>> [(every.name(k), every.multiplicity[k]) for k in range(4)]
    [('M3 up', 1), ('M2V up', 3), ('MV2 up', 3), ('V3 up', 1)]
    """

    cone: Cone
    valleys: np.ndarray
    changes: np.ndarray
    direction: np.ndarray
    multiplicity: np.ndarray

    @classmethod
    def of(cls, cone: Cone | int) -> Branches:
        """List the classes of a `Cone`, or of its degree (up to 4000): up first, then by valleys and changes.

        Raises
        ------
        OptionError
            For another degree.
        """
        cone = Cone.of(cone, LARGEST_DEGREE)
        valleys, changes, multiplicity = (np.tile(c, 2) for c in _assignments(cone.flaps))
        direction = np.repeat([1, -1], len(valleys) // 2)
        return cls(cone, valleys, changes, direction, multiplicity)

    def __len__(self) -> int:
        return len(self.valleys)

    def __getitem__(self, rows: Any) -> Branches:
        columns = (self.valleys, self.changes, self.direction, self.multiplicity)
        return Branches(self.cone, *(c[rows] for c in columns))

    def of_class(self, valleys: int, changes: int, direction: int) -> np.ndarray:
        """Mask of the entries of one class."""
        same = (self.valleys == valleys) & (self.changes == changes)
        return np.asarray(same & (self.direction == direction))

    @property
    def mountains(self) -> np.ndarray:
        """Number of mountain flaps."""
        return self.cone.flaps - self.valleys

    @property
    def steep(self) -> np.ndarray:
        """Number of steep flaps: mountains up, valleys down."""
        return np.where(self.direction > 0, self.mountains, self.valleys)

    @property
    def end(self) -> np.ndarray:
        """|v| at which the branches end [rad]."""
        return self.cone.ends(self.steep)

    @property
    def odd_creases(self) -> np.ndarray:
        """Number of odd creases between two shallow, two steep, and two unlike flaps, shape + (3,)."""
        j = self.changes // 2
        # j runs of each kind: p shallow flaps have p - j neighbours alike, and 2 j neighbours differ
        counts = [self.cone.flaps - self.steep - j, self.steep - j, 2 * j]
        return np.stack(counts, axis=-1).astype(float)

    def described(self, row: int) -> tuple[int, int, str, int | str]:
        """Return valleys, changes, direction and multiplicity of a class, as JSON carries them."""
        way = direction_name(self.direction[row])
        return int(self.valleys[row]), int(self.changes[row]), way, exact(self.multiplicity[row])

    def name(self, row: int) -> str:
        """Name a class in the paper's way: "M2V up"."""
        pairs = (("M", int(self.mountains[row])), ("V", int(self.valleys[row])))
        word = "".join(letter + (str(k) if k > 1 else "") for letter, k in pairs if k)
        return f"{word} {direction_name(self.direction[row])}"


@lru_cache(maxsize=8)
def _assignments(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Valleys, changes and multiplicity: 0 or n valleys, else a valleys in j runs, 1 <= j <= min(a, n - a).

    There are (n/j) C(a-1, j-1) C(n-a-1, j-1) assignments with a valleys in j runs: compositions of a
    and n - a into j parts make the ring, marked at one of the j starts of a run of valleys, and the
    mark can be at n places.
    """
    rows = [(0, 0, 1)]
    for a in range(1, n):
        number = n
        for j in range(1, min(a, n - a) + 1):
            rows.append((a, 2 * j, number))
            # from j to j + 1: times (a - j)(b - j) / (j (j + 1)), b = n - a, a whole number again
            number = number * (a - j) * (n - a - j) // (j * (j + 1))
    valleys, changes, multiplicity = zip(*rows, (n, 0, 1), strict=True)
    return np.array(valleys), np.array(changes), np.array(multiplicity, dtype=object)


def exact(number: int) -> int | str:
    """Return an integer as JSON carries it without rounding: as text beyond `SAFE`."""
    return number if number <= SAFE else str(number)


def direction_name(direction: int) -> str:
    """Word for a sign of the elevation."""
    return "up" if direction > 0 else "down"
