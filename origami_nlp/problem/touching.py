"""Which contacts are closed at a state, and what one is called.

Fold limits are one contact each.  Two facets that touch are kept apart by either of several pieces of geometry: the
other facet stays on one side of the plane of the first, or the first on one side of the plane of the second.  Each
choice is a *piece*: the contacts it closes at this state.  Where only one is possible, the feasible set near the state
is smooth; where several are, it is their union.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from operator import or_

from origami_nlp.problem.contact import Contact

MOST_LISTED = 256
"""Pieces of the feasible set that are listed one by one."""


@dataclass(frozen=True)
class ClosedContacts:
    """Closed contacts at a state.

    base: rows that always hold.
    branches: for each touching facet pair its possible sets of rows.
    implied: rows that only describe a base row again (crease k lies on a facet because the crease
        between them is folded flat), with that base row.
    complete: whether the pieces are the feasible set beside the state, to first order; else they hold more than it, so
        that a minimum of them is one, and that a state is not a minimum is shown by a lower state alone.
    """

    base: tuple[Contact, ...]
    branches: tuple[tuple[tuple[Contact, ...], ...], ...]
    implied: tuple[tuple[Contact, Contact], ...]
    complete: bool = True

    @property
    def few(self) -> bool:
        """Whether the pieces that meet are few enough to be listed."""
        return math.prod(len(b) for b in self.branches) <= MOST_LISTED

    def combinations(self) -> list[tuple[Contact, ...]] | None:
        """Return every choice of branches as one set of rows, or None where they are too many to be listed.

        A choice whose rows include those of another describes a part of it and is left out.
        """
        if not self.few:
            return None
        bit: dict[Contact, int] = {}
        sets: dict[int, tuple[tuple[Contact, ...], ...]] = {self._said(self.base, bit): ()}
        for branch in self.branches:  # rows as bits; of choices that say the same the first
            before, sets = sets, {}
            said = [(option, self._said(option, bit)) for option in branch]
            for held, choice in before.items():
                for option, rows in said:
                    sets.setdefault(held | rows, (*choice, option))
        return [
            tuple(dict.fromkeys((*self.base, *itertools.chain.from_iterable(choice))))
            for held, choice in sets.items()
            if not any(other & held == other and other != held for other in sets)
        ]

    @staticmethod
    def _said(rows: Iterable[Contact], bit: dict[Contact, int]) -> int:
        """Return rows as bits, which they get as they come."""
        return functools.reduce(or_, (bit.setdefault(c, 1 << len(bit)) for c in rows), 0)


@dataclass(frozen=True)
class ContactWords:
    """Who touches in a contact.

    type: ``fold-limit``; of a vertex ``facet-pair``; of a sheet ``vertex-face``,
    ``edge-edge`` or ``face-face``.
    creases: 1-based, all images under the symmetry included for creases at a fold limit.
    facets: 1-based; a facet pair names its two facets, a touch in a pattern that of the face first.
    text: the contact in words.
    corners: of a touch in a pattern, 1-based: the corner that is on a face and three of the face, or two ends of each
    side.
    side: of facets face to face, as in faceOrders of a FOLD file: +1 where the second one lies on the side of the first
    one's normal, -1 where it lies on the other; else 0.
    place: of facets face to face, the point of the second one at which the force acts, in the sheet's reference state.
    """

    type: str
    creases: tuple[int, ...]
    facets: tuple[int, ...]
    text: str
    corners: tuple[int, ...] = ()
    side: int = 0
    place: tuple[float, ...] = ()
