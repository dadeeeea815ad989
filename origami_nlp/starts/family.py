"""What every family of starts offers to a search, of a vertex or of a pattern."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import islice
from typing import Any, ClassVar

import numpy as np

from origami_nlp.starts.batch_states import Samples


class StartFamily(ABC):
    """Starts of one kind, of the problem that it is made for.

    Attributes
    ----------
    name
        In the account of a search.
    sentence
        Where its starts lie.
    """

    name: ClassVar[str]
    sentence: ClassVar[str]

    def __init__(self, model: Any) -> None:
        self._model = model

    @abstractmethod
    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Return the next starts, each with the contacts that it holds.

        Parameters
        ----------
        rng
            Of all that is random in them: the same generator gives the same starts.
        many
            How many are wanted.

        Returns
        -------
        Samples
            As many, or fewer where there are no more; of touches at first some more, on strata that are hard to hit.
        """


class Listed(StartFamily):
    """A family without chance: its states in their order, each once; `size` is the number of their fold angles."""

    def __init__(self, model: Any) -> None:
        super().__init__(model)
        self.size = model.size

    @abstractmethod
    def states(self) -> Iterable[np.ndarray]:
        """List its states [n] [rad]."""

    @cached_property
    def _left(self) -> Iterator[np.ndarray]:
        return iter(self.states())

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Return the next of its states, that hold no contact; see `StartFamily.draw`."""
        some = list(islice(self._left, many))
        return Samples.on(np.array(some).reshape(len(some), self.size))
