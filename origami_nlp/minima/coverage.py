"""Which strata with touches a search has been on: per class how many there are, were tried, started and hit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.starts import ContactStarts, Row


@dataclass(frozen=True)
class StrataCount:
    """Strata of one class; sides of touches and signs of closed creases are not distinguished.

    Attributes
    ----------
    touches, closed
        How many touches and closed creases strata of the class have.
    listed
        How many such strata are listed (`touches` says which are not).
    tried
        On how many a state was drawn.
    started
        On how many a state was found and handed out; others are empty, or were not hit.
    hit
        On how many a minimum lies.
    """

    touches: int
    closed: int
    listed: int
    tried: int
    started: int
    hit: int

    @property
    def words(self) -> str:
        """The counts in a sentence."""
        touches = f"{self.touches} touch{'es' if self.touches > 1 else ''}"
        creases = f"{self.closed} closed crease{'s' if self.closed != 1 else ''}"
        return (
            f"{touches}, {creases}: {self.started} of {self.listed} strata started "
            f"({self.tried} tried), minima on {self.hit}"
        )


def count_strata(
    starts: ContactStarts, minima: Sequence[tuple[Iterable[Row], Iterable[int]]] = ()
) -> tuple[tuple[StrataCount, ...], int]:
    """Count strata by class.

    Parameters
    ----------
    starts
        The last answer of `contact_starts`: its counts hold those before.
    minima
        The rows (k, j) and the closed creases of each minimum with touches, 0-based.

    Returns
    -------
    counts : tuple of StrataCount
        By touches, then closed creases.
    elsewhere : int
        How many of `minima` lie on strata that are not listed.
    """
    strata = starts.strata
    _, label = np.unique(strata.label, return_inverse=True)
    size = label.max(initial=-1) + 1
    hit = np.zeros(size, bool)
    elsewhere = 0
    for rows, closed in minima:
        number = strata.numbers(rows, closed)
        hit[label[number]] = True
        elsewhere += not len(number)
    tried, started = (
        np.bincount(label, weights, size) > 0 for weights in (starts.tried, starts.started)
    )
    kind = np.zeros((size, 2), int)
    kind[label] = np.stack([strata.touches, strata.closed], axis=1)
    counts = []
    for pair in sorted({(int(t), int(c)) for t, c in kind}):
        own = (kind == pair).all(axis=1)
        sums = [int((own & what).sum()) for what in (own, tried, started, hit)]
        counts.append(StrataCount(*pair, *sums))
    return tuple(counts), elsewhere
