"""States that a pattern itself gives: of its file, its reference, and what mountains, valleys and springs ask for."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.starts.family import Listed


class Given(Listed):
    """Fold angles that a pattern itself gives.

    Parameters
    ----------
    pattern
        With its springs.
    """

    name = "starts that the pattern gives"
    sentence = "what the file states, mountains and valleys folded, rest angles"

    def __init__(self, pattern: Pattern) -> None:
        self.size = pattern.creases
        self._pattern = pattern

    def states(self) -> Iterator[np.ndarray]:
        """Yield them, none closed yet."""
        pattern = self._pattern
        if not np.isnan(pattern.file_angles).any():
            yield pattern.file_angles
        if pattern.reference.any():
            yield pattern.reference
        if pattern.signs.any():
            yield from (0.4 * pattern.signs, 1.0 * pattern.signs)
        if pattern.rest.any():
            yield from (0.3 * pattern.rest, pattern.rest)
