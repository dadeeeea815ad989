"""What states that are listed, without chance, offer to a search."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import ClassVar

import numpy as np

from origami_nlp.problem import Model


class Listed(ABC):
    """States of one kind, in their order, each once.

    Parameters
    ----------
    model
        Whose states they are.

    Attributes
    ----------
    name
        In the account of a search.
    sentence
        Where they lie.
    """

    name: ClassVar[str]
    sentence: ClassVar[str]

    def __init__(self, model: Model) -> None:
        self._model = model

    @abstractmethod
    def states(self) -> Iterable[np.ndarray]:
        """List them, [n] [rad] each."""
