"""Which family draws the next start: by what it led to over what it cost, and evenly."""

from __future__ import annotations

from collections.abc import Sequence

FIRST = 500
"""Counted work after which a family is judged by what it led to."""


class Shares:
    """Counted work of families, and minima that they led to first.

    Parameters
    ----------
    names
        Of the families.

    Attributes
    ----------
    work, new
        By name.  Work is counted, never timed: what is drawn hangs on no machine's speed.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self.work, self.new, self._turn = dict.fromkeys(names, 0), dict.fromkeys(names, 0), 0

    def next(self) -> str:
        """Return the family with the highest yield and the one with the least work, in turn."""
        self._turn += 1
        if self._turn % 2:
            return min(self.work, key=self.work.__getitem__)
        return max(self.work, key=lambda k: (self.new[k] + 1) / (self.work[k] + FIRST))
