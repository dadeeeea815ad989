"""The lattice of a folded cell that repeats: its vectors with first and second derivatives, and how it gives way.

The walk from a facet to its copy along a lattice vector a turns nothing where the cell closes, and moves the copy by
t: the vector of the folded state is a + t.  A force F along it does the work F L, L its length.  A state that F holds
gives way along v with H v = grad L on what closure and contacts leave free, H the Hessian of the Lagrangian of U - F L:
the stiffness is dF/dL = 1 / (grad L . v), Poisson's ratio - e / (grad L . v / L) with e the strain across the vector in
the plane of both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State
from origami_nlp.numerics import CARRIES, INDEPENDENT, INSIDE, RANK, cross
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.closure import Closure
from origami_nlp.problem import Contact


@dataclass(frozen=True, repr=False)
class FoldedLattice(ShortRepr):
    """The lattice of a folded cell, and how it gives way to a force along either vector, the other one free.

    Attributes
    ----------
    vectors
        Both, in the frame of the cell's first facet [unit of the coordinates].
    lengths
        Of both.
    angle
        Between them [rad]; nan where one has no length.
    area
        Of a cell.
    poisson
        Poisson's ratio under a force along either vector: contraction across it, in the plane of both, over extension
        along it; nan where it does not give way.
    stiffness
        Force along either vector by its extension, of one cell [N m over the square of the coordinates' unit: N/m if
        that is a metre]; inf where it does not give way, nan where that is not known.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.pattern("miura", 1, 1, cell=True), effort="quick", escape=False)
    >>> result.lattices[0]
    FoldedLattice(1.64219 x 1.83185 at 90 deg, Poisson's ratios -0.589 and -1.7, stiffnesses 0.686 and 1.59)
    """

    vectors: tuple[tuple[float, ...], ...]
    lengths: tuple[float, ...]
    angle: float
    area: float
    poisson: tuple[float, ...]
    stiffness: tuple[float, ...]

    def _pieces(self) -> str:
        (a, b), (p, q), (k, m) = self.lengths, self.poisson, self.stiffness
        return (
            f"{a:.6g} x {b:.6g} at {math.degrees(self.angle):.6g} deg, Poisson's ratios {p:.3g} and {q:.3g}, "
            f"stiffnesses {k:.3g} and {m:.3g}"
        )

    def __repr__(self) -> str:
        return f"FoldedLattice({self._pieces()})"


class Lattice:
    """Lattice vectors of the states of a cell.

    Parameters
    ----------
    pattern
        A cell that repeats.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import Lattice
    >>> Lattice(o.examples.pattern("miura", 1, 1, cell=True)).vectors(np.zeros(8)).tolist()
    [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]
    """

    def __init__(self, pattern: Pattern) -> None:
        if pattern.cell is None or pattern.cell.rolled is not None:
            raise OptionError(
                f"pattern = {pattern!r} is no cell that repeats in a plane: only such a cell has a lattice"
            )
        self.cell, self.pattern = pattern.cell, pattern
        # walks along it move by translations, as those round holes would
        moved = replace(pattern, vertices=(), generators=(), holes=pattern.generators)
        self._walks = Closure(moved)

    def vectors(self, phi: np.ndarray) -> np.ndarray:
        """Return both lattice vectors at a closed state [n], [2, 3]."""
        moved = self._walks.values(phi).reshape(2, 6)[:, 3:] * self._walks.size
        return np.asarray(self.cell.lattice + moved)

    def slopes(self, phi: np.ndarray) -> np.ndarray:
        """Return their derivatives by the fold angles, [2, 3, n]."""
        rows = self._walks(phi)[1].reshape(2, 6, -1)[:, 3:]
        return np.asarray(rows * self._walks.size)

    def length_bends(self, phi: np.ndarray, k: int) -> np.ndarray:
        """Return the second derivatives of the length of one of them, [n, n]."""
        x, d = self.vectors(phi)[k], self.slopes(phi)[k]
        size = float(np.linalg.norm(x))
        weights = np.zeros((2, 6))
        weights[k, 3:] = x / size * self._walks.size
        bent = self._walks.hessian(phi, weights.ravel())
        along = x @ d / size
        whole = bent if isinstance(bent, np.ndarray) else bent.toarray()
        return np.asarray(whole + (d.T @ d - np.outer(along, along)) / size)

    def at(self, state: State) -> FoldedLattice:
        """Return the lattice of a closed state, and how it gives way.

        Parameters
        ----------
        state
            Held by its springs and contacts that push; or with one degree of freedom, held by the force.
        """
        phi = state.x
        x, d = self.vectors(phi), self.slopes(phi)
        size = np.linalg.norm(x, axis=1)
        normal = cross(x[0], x[1])
        area = float(np.linalg.norm(normal))
        per = [x[k] @ d[k] / size[k] for k in range(2)]
        # d|a x b| = n . (da x b + a x db)
        unit = normal / area if area else normal
        wide = unit @ (cross(d[0].T, x[1]) + cross(x[0], d[1].T)).T
        held = self._held(state)
        poisson, stiffness = [math.nan] * 2, [math.nan] * 2
        for k in range(2 if held is not None and area else 0):
            assert held is not None
            way = self._gives_way(state, held, per, k)
            if way is None:
                continue
            along = float(per[k] @ way)
            if not along:
                stiffness[k] = math.inf
                continue
            stiffness[k] = 1 / along
            # of the area the part that is not along the vector
            poisson[k] = float(1.0 - wide @ way / area * size[k] / along)
        angle = (
            math.atan2(area, float(x[0] @ x[1])) if size.min() > INSIDE * size.max() else math.nan
        )
        vectors = tuple(map(tuple, x.tolist()))
        lengths = tuple(size.tolist())
        return FoldedLattice(vectors, lengths, angle, area, tuple(poisson), tuple(stiffness))

    @staticmethod
    def _held(state: State) -> tuple[Contact, ...] | None:
        """Return the contacts that stay closed under a small force; None where that depends on its sign."""
        closed = state.contacts
        if closed.branches or not state.regular:
            return None
        held = closed.base
        return held if not held or (state.on(held).forces > CARRIES).all() else None

    def _gives_way(
        self, state: State, held: tuple[Contact, ...], per: list[np.ndarray], k: int
    ) -> np.ndarray | None:
        """Return how fold angles change by a force along vector k, [n]; None where that is not known."""
        on, scale = state.on(held), state.problem.scale
        z = on.tangent
        if not z.shape[1]:
            return np.zeros(len(state.x))
        pull, push = z.T @ per[k], z.T @ state.gradient
        load = float(pull @ push) / max(float(pull @ pull), RANK**2)  # over scale
        balance = np.abs(push - load * pull).max() <= INDEPENDENT * max(
            np.abs(state.gradient).max(), 1.0
        )
        if not balance:
            return None
        if np.abs(pull).max() <= INDEPENDENT * float(np.linalg.norm(self.cell.lattice)):
            return np.zeros(len(state.x))
        rows = on.jacobian
        force = state.gradient - load * per[k]
        multipliers = np.linalg.lstsq(rows.T, force, rcond=None)[0]
        h = on.hessian_with(multipliers) - load * self.length_bends(state.x, k)
        inside = z.T @ h @ z
        if np.linalg.cond(inside) > 1 / INDEPENDENT:
            return None
        return np.asarray(z @ np.linalg.solve(inside, pull)) / scale
