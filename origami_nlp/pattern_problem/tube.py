"""The tube that a cell folds to, or curls along: radius, turns and advances of its copies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State
from origami_nlp.numerics import PLACES
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.crossings import PatternCrossings
from origami_nlp.pattern_problem.lattice import Lattice
from origami_nlp.pattern_problem.screws import Screws, advance_of_a_cell, find_screws


@dataclass(frozen=True, repr=False)
class FoldedTube(ShortRepr):
    """How the copies of a cell lie round an axis.

    Attributes
    ----------
    turns
        Of a copy along either lattice vector about the axis [rad], within +-pi, that which is larger positive: a tube
        that is turned inside out advances the other way.  nan where no copy turns.
    advances
        Of either along the axis [unit of the coordinates]; nan where no copy turns.
    radius
        Mean distance of the cell's vertices from the axis; inf where no copy turns.
    radii
        The least and the largest of these distances.
    length
        By which each cell makes a closed tube longer; nan of a sheet that curls.

    Examples
    --------
    >>> import origami_nlp as o
    >>> tube = o.examples.pattern("yoshimura", 1, 1, cell=True, rolled=6)
    >>> o.find_minima(tube, effort="quick", escape=False).lattices[0]
    FoldedTube(radius 2, turns 60 and 0 deg, advances 0 and 1.02281; 0.170469 a cell)
    """

    turns: tuple[float, float]
    advances: tuple[float, float]
    radius: float
    radii: tuple[float, float]
    length: float

    def _pieces(self) -> str:
        if math.isinf(self.radius):
            return "no copy turns"
        (a, b), (s, t) = (f"{math.degrees(x):.6g}" for x in self.turns), self.advances
        whole = f"radius {self.radius:.6g}, turns {a} and {b} deg, advances {s:.6g} and {t:.6g}"
        return whole if math.isnan(self.length) else f"{whole}; {self.length:.6g} a cell"

    def __repr__(self) -> str:
        return f"FoldedTube({self._pieces()})"


class Tube:
    """Tubes that the states of a cell are, or curl along.

    Parameters
    ----------
    pattern
        A cell that is rolled up, or free to curl.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_problem import Tube
    >>> cell = o.examples.pattern("yoshimura", 1, 1, cell=True, rolled=6)
    >>> result = o.find_minima(cell, effort="quick", escape=False)
    >>> round(Tube(cell).at(result.state_of(result.minima[0])).radius, 6)
    2.0
    """

    def __init__(self, pattern: Pattern) -> None:
        if pattern.cell is None or pattern.cell.rolled is None:
            raise OptionError(
                f"pattern = {pattern!r} is no cell that is rolled up: only such a cell has an axis"
            )
        self.cell, self.crossings = pattern.cell, PatternCrossings(pattern)

    def at(self, state: State) -> FoldedTube:
        """Return the tube of a closed state."""
        screws = find_screws(self.crossings.poses, state.x)
        if screws is None:
            none = math.nan, math.nan
            return FoldedTube(none, none, math.inf, (math.inf, math.inf), math.nan)
        radii, size, tube = self._radii(screws, state.x), self.crossings.size, self.cell.tube
        (a, b), (s, t) = _whole(screws.turns, 1.0), _whole(screws.advances, size)
        length = abs(advance_of_a_cell(screws, tube)) if tube else math.nan
        ends = float(radii.min()), float(radii.max())
        return FoldedTube((a, b), (s, t), float(radii.mean()), ends, length)

    def _radii(self, screws: Screws, phi: np.ndarray) -> np.ndarray:
        """Return the distance of each vertex of the cell from the axis."""
        turn, shift = self.crossings.poses.motions(phi)
        cell, found = self.cell, []
        for v in np.unique(cell.class_of, return_index=True)[1].tolist():
            piece = next(k for k, ring in enumerate(cell.polygons) if v in ring)
            f = self.crossings.pattern.facet_of[cell.home * len(cell.polygons) + piece]
            found.append(turn[f] @ cell.corners[v] + shift[f])
        return np.asarray(np.linalg.norm(screws.seen(np.array(found))[:, :2], axis=1))


def _whole(x: np.ndarray, size: float) -> list[float]:
    """Return numbers without what rounding leaves of 0."""
    return np.where(np.abs(x) <= PLACES * size, 0.0, x).tolist()


def measured_cell(pattern: Pattern) -> Lattice | Tube:
    """Return what has the lattice of a cell's states, or the tube of one that is rolled up: `at` a state."""
    cell = pattern.cell
    return Lattice(pattern) if cell is None or cell.rolled is None else Tube(pattern)
