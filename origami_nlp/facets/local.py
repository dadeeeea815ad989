"""A pattern at one state: values and first derivatives, gaps only where they are asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.facets.touches import Placed, Touch
from origami_nlp.programme import Contact, Local


@dataclass(frozen=True, eq=False)
class PatternLocal(Local):
    """Values and first derivatives at one state of a pattern; gaps, over a length, once they are asked for."""

    placed: Callable[[np.ndarray], Placed]
    touch: Callable[[Contact], Touch]
    length: float
    known: dict[Contact, tuple[float, np.ndarray]]

    def openings(self, contacts: Sequence[Contact]) -> tuple[np.ndarray, np.ndarray]:
        """How far contacts are open (>= 0 where they are), [r], and the gradients of that, [r, n]."""
        values, slopes = np.zeros(len(contacts)), np.zeros((len(contacts), len(self.x)))
        for r, contact in enumerate(contacts):
            if contact.is_limit:
                values[r] = math.pi - contact.side * self.x[contact.index]
                slopes[r, contact.index] = -contact.side
            else:
                if contact not in self.known:
                    touch, place = self.touch(contact), self.placed(self.x)
                    self.known[contact] = (
                        touch.gap(place) / self.length,
                        touch.row(place) / self.length,
                    )
                values[r], slopes[r] = self.known[contact]
        return values, slopes
