"""Hinge laws of the variables of a problem: energies, torques and stiffness of those that are no linear springs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.pattern import HingeLaw

FEWEST_CELLS = 64
"""Of a law, in which its pieces are found."""
PIECE = 6
"""Numbers of a piece: where it begins, and coefficients of its energy from the fourth power down."""
AT_BREAK = 1e-9
"""Fold angles so near to a break of a law [rad] are at it: Newton ends there to less."""


@dataclass(frozen=True, eq=False)
class HingeLaws:
    """Laws in place of linear springs.

    Attributes
    ----------
    laws
        Of the n variables; None where a linear spring is.
    weight
        How often each counts: creases that a variable stands for, times the factor of `HingeLaw.origin`, over
        the problem's scale; 0 where there is none, [n].
    shift
        By which each is shifted, [n] [rad].
    """

    laws: tuple[HingeLaw | None, ...]
    weight: np.ndarray
    shift: np.ndarray

    @staticmethod
    def of(laws: Sequence[HingeLaw | None], counts: np.ndarray | float) -> HingeLaws:
        """Return laws of variables; counts: creases that each variable stands for, over a scale, [n] or one number."""
        origins = [(None, 0.0, 0.0) if law is None else law.origin for law in laws]
        base, factor, shift = zip(*origins, strict=True)
        return HingeLaws(base, counts * np.array(factor), np.array(shift))

    @property
    def vector(self) -> np.ndarray:
        """Weights and shifts, [2 n]."""
        return np.concatenate([self.weight, self.shift])

    def along(self, change: HingeLaws, s: float) -> HingeLaws:
        """Return laws with s times a change: of the logarithm of weights, and of shifts."""
        return replace(
            self,
            weight=self.weight * np.exp(s * change.weight),
            shift=self.shift + s * change.shift,
        )

    def towards(self, other: HingeLaws, length: float) -> HingeLaws:
        """Return the change (`along`) that makes laws another one's over a length; 0 where no law is."""
        none = self.weight == 0
        ratio = np.where(none, 1.0, other.weight) / np.where(none, 1.0, self.weight)
        return replace(
            self, weight=np.log(ratio) / length, shift=(other.shift - self.shift) / length
        )

    def made(self, scale: float) -> tuple[HingeLaw | None, ...]:
        """Return the laws with their weights times a scale, shifted."""
        known: dict[tuple[int, float, float], HingeLaw] = {}
        out: list[HingeLaw | None] = []
        for law, w, by in zip(self.laws, self.weight.tolist(), self.shift.tolist(), strict=True):
            key = id(law), w, by
            if law is not None and key not in known:
                known[key] = law.times(w * scale).shifted(by)
            out.append(known.get(key))
        return tuple(out)

    def drift(self, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return how torques [n] change with a change of weights and shifts, [2 n] (`vector`)."""
        weight, shift = change.reshape(2, -1)
        unit = replace(self, weight=(self.weight != 0).astype(float))
        return weight * unit.torque(x) - shift * self.slope(x)

    def times(self, share: float) -> HingeLaws:
        """Return the same laws over another scale."""
        return replace(self, weight=share * self.weight)

    def linear(self, stiffness: np.ndarray) -> np.ndarray:
        """Return stiffnesses [..., n] with 0 where a law is in place of the spring."""
        return np.where(self.weight > 0, 0.0, stiffness)

    @cached_property
    def _each(self) -> list[tuple[HingeLaw, np.ndarray]]:
        """Different laws, with the variables that have them."""
        of: dict[int, tuple[HingeLaw, list[int]]] = {}
        for v, law in enumerate(self.laws):
            if law is not None:
                of.setdefault(id(law), (law, []))[1].append(v)
        return [(law, np.array(variables)) for law, variables in of.values()]

    def tables(self) -> dict[str, np.ndarray]:
        """Return what compiled descents read: of each variable its law, -1 for none; of each law its pieces, and cells
        of equal width that say on which piece a fold angle is."""
        law, at = np.full(len(self.laws), -1), []
        pieces, grids, cells = [np.zeros((0, 6))], [np.zeros((0, 3))], [np.zeros(0, dtype=int)]
        for number, (own, variables) in enumerate(self._each):
            law[variables] = number
            breaks, c = own.energy_pieces
            low, high, many = breaks[1], breaks[-2], max(FEWEST_CELLS, 2 * c.shape[1])
            cell = (
                np.searchsorted(breaks, np.linspace(low, high, many, endpoint=False), "right") - 1
            )
            at.append([sum(map(len, pieces)), c.shape[1], sum(map(len, cells)), many])
            pieces.append(np.concatenate([breaks[None, :-1], c]).T)
            grids.append(np.array([[low, high, many / (high - low)]]))
            cells.append(cell)
        return {
            "laws": np.array(bool(at)),
            "law": law,
            "law_weight": self.weight,
            "law_shift": self.shift,
            "law_at": np.array(at, dtype=int),
            "law_piece": np.concatenate(pieces),
            "law_grid": np.concatenate(grids),
            "law_cell": np.concatenate(cells),
        }

    def pieces_at(self, x: np.ndarray) -> np.ndarray:
        """Return the pieces on which the hinges of states [..., n] are, [..., 6 n]: what compiled functions take."""
        out, x = np.zeros((*x.shape, PIECE)), x - self.shift
        for law, variables in self._each:
            breaks, c = law.energy_pieces
            piece = np.searchsorted(breaks[1:-1], x[..., variables], "right")
            out[..., variables, 0], out[..., variables, 1:] = breaks[piece], c.T[piece]
        return out.reshape(*x.shape[:-1], -1)

    def energy(self, x: np.ndarray) -> np.ndarray:
        """Energy of states [..., n], [...]."""
        x = x - self.shift
        return np.sum([law.energy(x[..., v]) @ self.weight[v] for law, v in self._each], axis=0)

    def change(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Energy of y less that of x, [...]."""
        x, y = x - self.shift, y - self.shift
        return np.sum(
            [law.change(x[..., v], y[..., v]) @ self.weight[v] for law, v in self._each], axis=0
        )

    def torque(self, x: np.ndarray) -> np.ndarray:
        """Torques [..., n]; 0 where there is no law."""
        out, x = np.zeros(x.shape), x - self.shift
        for law, v in self._each:
            out[..., v] = self.weight[v] * law.torque(x[..., v])
        return out

    def slope(self, x: np.ndarray) -> np.ndarray:
        """Derivatives of the torques [..., n], at a break the smaller of both sides; 0 where there is no law.

        A state from which energy rises on one side of a break alone is no strict minimum.
        """
        out, x = np.zeros(x.shape), x - self.shift
        for law, v in self._each:
            slope, breaks = law.slope(x[..., v]), np.array(law.breaks)
            left, right = x[..., v] - AT_BREAK, x[..., v] + AT_BREAK
            beside = np.searchsorted(breaks, left) != np.searchsorted(breaks, right)
            if beside.any():
                least = np.minimum(law.slope(left), law.slope(right))
                slope = np.where(beside, least, slope)
            out[..., v] = self.weight[v] * slope
        return out
