"""Many states at once, each with the contacts that it holds: where descents begin, and where they end."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from origami_nlp.problem import OPEN, FoldLimits

SLOTS = 3
"""Gaps that a descent can hold at once, besides fold limits."""


@dataclass(frozen=True, eq=False)
class Samples:
    """States on their strata.

    Attributes
    ----------
    x
        Fold angles, shape [K, n] [rad].
    at_limit
        Creases held at their fold limits: -1, 0 or 1, shape [K, n].
    slots, sides
        Gaps held, as positions in `Structure.gaps` or `OPEN`, and the side on which each is open, shape [K, SLOTS].
    hold
        Whether contacts are held until the descent has converged on its stratum, shape [K].
    source
        Which kind of start it is, shape [K].
    """

    x: np.ndarray
    at_limit: np.ndarray
    slots: np.ndarray
    sides: np.ndarray
    hold: np.ndarray
    source: np.ndarray

    @classmethod
    def on(
        cls,
        x: np.ndarray,
        at_limit: np.ndarray | None = None,
        *,
        hold: bool = False,
        source: int = 0,
    ) -> Samples:
        """Make samples that hold fold limits only."""
        k = len(x)
        at_limit = np.zeros(x.shape, dtype=int) if at_limit is None else at_limit
        return cls(
            np.array(x, dtype=float),
            at_limit.astype(int),
            np.full((k, SLOTS), OPEN),
            np.ones((k, SLOTS), dtype=int),
            np.full(k, hold),
            np.full(k, source),
        )

    @classmethod
    def at_limits(cls, x: np.ndarray, limits: FoldLimits, *, hold: bool = False) -> Samples:
        """Make samples that hold the creases that are at their fold limits."""
        return cls.on(x, limits.near(x, 0.0), hold=hold)

    def __getitem__(self, which: np.ndarray) -> Samples:
        return Samples(*(getattr(self, f.name)[which] for f in fields(self)))

    def __len__(self) -> int:
        return len(self.x)


def joined(*parts: Samples) -> Samples:
    """Return samples one after the other, as a copy."""
    return Samples(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Samples)))


def put(into: Samples, where: np.ndarray, new: Samples) -> None:
    """Overwrite some samples, in place: for the copies of who works on them."""
    for f in fields(Samples):
        getattr(into, f.name)[where] = getattr(new, f.name)


@dataclass(frozen=True, eq=False)
class Ends:
    """Where descents ended.

    Attributes
    ----------
    samples
        The states with what they hold.
    converged
        Whether nothing is left to let go and no torque is left, shape [K].
    settled
        Whether the descent was stationary on the stratum where it began before its contacts were let go; where it
        did not converge afterwards, that is the state returned, shape [K].
    broken
        Whether linear algebra broke down on the way, shape [K]; then it ends where it began.
    """

    samples: Samples
    converged: np.ndarray
    settled: np.ndarray
    broken: np.ndarray
