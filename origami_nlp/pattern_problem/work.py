"""What a load on a sheet works on: fold angles, the distance of two corners, the place of a corner.

A load t has the energy -t w(phi).  Where corners are is found by a shortest walk over facets from one that is held:
with turns about axes a_i through points o_i, brought along by the turns before them, a corner x moves by

    dx/dphi_i = a_i x (x - o_i),                d2x/dphi_i dphi_j = a_i x (a_j x (x - o_j))     (i <= j in the walk).

At closed states all walks lead to the same place.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, TypeAlias

import numpy as np

from origami_nlp.arguments import check_whole, shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import cross, rotations
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem.poses import Poses


@dataclass(frozen=True, eq=False)
class _Walk:
    """A corner seen from a facet.

    creases: crossed in order.  axes, origins: of the reference state, [k, 3], the axes with the sense of crossing.
    """

    creases: np.ndarray
    axes: np.ndarray
    origins: np.ndarray
    reference: np.ndarray
    corner: np.ndarray

    def place(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the place [3] of the corner, its first [k, 3] and second derivatives [k, k, 3]."""
        turn, shift = np.eye(3), np.zeros(3)
        axes, origins = np.zeros_like(self.axes), np.zeros_like(self.origins)
        turns = rotations(self.axes, phi[self.creases] - self.reference)
        for i, after in enumerate(turns):
            axes[i], origins[i] = turn @ self.axes[i], turn @ self.origins[i] + shift
            # motions are x -> turn x + shift; the turn about an axis through o is x -> o + r (x - o)
            shift = shift + turn @ (self.origins[i] - after @ self.origins[i])
            turn = turn @ after
        x = turn @ self.corner + shift
        first = cross(axes, x - origins)
        # a_i x (a_j x (x - o_j)) for i <= j; the earlier crease carries the later one
        second = cross(axes[:, None], np.broadcast_to(first, (len(axes), *first.shape)))
        upper = np.triu(np.ones((len(axes), len(axes)), bool))[..., None]
        second = np.where(upper, second, second.swapaxes(0, 1))
        return x, first, second


def _facets_at(pattern: Pattern, corner: int) -> list[int]:
    return [int(f) for p, f in zip(pattern.polygons, pattern.facet_of, strict=True) if corner in p]


def _walk(pattern: Pattern, held: int, corner: int) -> _Walk:
    """Return the walk from a facet to the nearest one that has the corner."""
    poses = Poses(pattern)
    # fewer turns, fewer terms; all walks agree on closed states
    path = min((poses.path(held, f) for f in _facets_at(pattern, corner)), key=len)
    creases = np.array([c for c, _ in path], int)
    senses = np.array([s for _, s in path], float)
    return _Walk(
        creases,
        senses[:, None] * pattern.directions[creases],
        pattern.corners[pattern.ends[creases, 0]],
        pattern.reference[creases],
        pattern.corners[corner],
    )


def _corner(pattern: Pattern, corner: object, name: str) -> int:
    number = check_whole(name, corner, 0, len(pattern.corners) - 1)
    if not _facets_at(pattern, number):
        raise OptionError(f"{name} = {number} is a vertex of no facet")
    return number


class _OfPattern:
    """What every load on a sheet has."""

    pattern: Pattern

    @property
    def unloaded(self) -> Pattern:
        """The sheet, with its energy without the load."""
        return self.pattern


class _OfPlaces(_OfPattern):
    """A load on the place of a corner, as a walk over facets carries it; `_at`: what it works on, and derivatives."""

    unit: ClassVar[str] = "N"
    creases: ClassVar[tuple[int, ...]] = ()

    @cached_property
    def _walk(self) -> _Walk:
        raise NotImplementedError

    def _at(self, phi: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        raise NotImplementedError

    def conjugate(self, phi: np.ndarray) -> np.ndarray:
        """Return what the load works on, of states [..., n]."""
        flat = np.reshape(phi, (-1, self.pattern.creases))
        return np.reshape([self._at(x)[0] for x in flat], np.shape(phi)[:-1])

    def gradient(self, phi: np.ndarray) -> np.ndarray:
        """Return its derivative, [n]."""
        out = np.zeros(len(phi))
        out[self._walk.creases] = self._at(phi)[1]
        return out

    def hessian(self, phi: np.ndarray) -> np.ndarray | None:
        """Return its second derivative, [n, n]."""
        out = np.zeros((len(phi), len(phi)))
        out[np.ix_(self._walk.creases, self._walk.creases)] = self._at(phi)[2]
        return out


@dataclass(frozen=True, eq=False)
class Torque(_OfPattern):
    """A torque t on each of some creases, towards valley > 0.

    Attributes
    ----------
    pattern
        The sheet.
    creases
        Numbers (1-based).
    shares
        What each of them gets of t; none: all of it.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.pattern_problem import Torque
    >>> torque = Torque(o.examples.pattern("miura", 2, 2), (1, 3), (1.0, -0.5))
    >>> torque.name, float(torque.conjugate(np.array([0.2, 0.0, 0.4, 0.0])))
    ('torque on creases 1, 3 (shares 1, -0.5)', 0.0)
    """

    pattern: Pattern
    creases: tuple[int, ...]
    shares: tuple[float, ...] = ()
    unit: ClassVar[str] = "N m"

    def __post_init__(self) -> None:
        if not self.creases:
            raise OptionError("creases is empty: name one crease or more, 1-based")
        for c in self.creases:
            check_whole("crease", c, 1, self.pattern.creases)
        if len(set(self.creases)) < len(self.creases):
            raise OptionError(f"creases = {shown(self.creases)} names a crease twice")
        if self.shares and len(self.shares) != len(self.creases):
            raise OptionError(f"shares = {shown(self.shares)} must be one for each crease, or none")
        if self.shares and not (np.isfinite(self.shares).all() and any(self.shares)):
            raise OptionError(f"shares = {shown(self.shares)} must be numbers, not all of them 0")

    @property
    def name(self) -> str:
        """What t is."""
        numbers = ", ".join(map(str, self.creases))
        if self.shares:
            shares = ", ".join(f"{share:.6g}" for share in self.shares)
            return f"torque on creases {numbers} (shares {shares})"
        one = len(self.creases) == 1
        return f"torque on crease {numbers}" if one else f"torque on each of creases {numbers}"

    @property
    def coordinate(self) -> str:
        """What it works on, with its unit."""
        if self.shares:
            return "fold angles of creases, times their shares of the torque [rad]"
        one = len(self.creases) == 1
        return (
            f"fold angle of crease {self.creases[0]} [rad]"
            if one
            else "sum of their fold angles [rad]"
        )

    @property
    def arm(self) -> float:
        """Size of the derivative of what it works on."""
        return 1.0

    @cached_property
    def _share(self) -> np.ndarray:
        out = np.zeros(self.pattern.creases)
        out[np.array(self.creases) - 1] = self.shares or 1.0
        return out

    def conjugate(self, phi: np.ndarray) -> np.ndarray:
        """Return the sum of the fold angles, each times its share, of states [..., n]."""
        return np.asarray(phi) @ self._share

    def gradient(self, phi: np.ndarray) -> np.ndarray:
        """Return its derivative, [n]."""
        return self._share

    def hessian(self, phi: np.ndarray) -> np.ndarray | None:
        """Return its second derivative; None where it is zero."""
        return None

    def loaded(self, t: float) -> Pattern:
        """Return the pattern whose springs are wound by the torque; to laws it is added."""
        p = self.pattern
        if p.laws:
            laws = [
                law and law.plus(-t * by)
                for law, by in zip(p.laws, self._share.tolist(), strict=True)
            ]
            linear = np.array([law is None for law in laws])
            moved = replace(p, rest=p.rest + np.where(linear, t * self._share / p.stiffness, 0.0))
            return moved.with_laws(laws)
        # U - t phi has the torque k (phi - phi0) - t: the rest angle moves by t / k
        return replace(p, rest=p.rest + t * self._share / p.stiffness)


@dataclass(frozen=True, eq=False)
class Pull(_OfPlaces):
    """Forces t that pull two corners apart along the line between them; t < 0 pushes them together.

    Attributes
    ----------
    pattern
        The sheet.
    corners
        Numbers of two vertices, from 0 as in the file.
    """

    pattern: Pattern
    corners: tuple[int, int]

    def __post_init__(self) -> None:
        a, b = (_corner(self.pattern, c, "pull") for c in self.corners)
        if set(_facets_at(self.pattern, a)) & set(_facets_at(self.pattern, b)):
            raise OptionError(
                f"pull = {a}, {b}: these are corners of one facet, their distance is fixed"
            )

    @property
    def name(self) -> str:
        """What t is."""
        return f"force that pulls vertices {self.corners[0]} and {self.corners[1]} apart"

    @property
    def coordinate(self) -> str:
        """What it works on, with its unit."""
        return "distance of the two vertices [m]"

    @property
    def arm(self) -> float:
        """Length that turns forces into torques."""
        return float(self.pattern.lengths.mean())

    @cached_property
    def _walk(self) -> _Walk:
        a, b = self.corners
        walks = [_walk(self.pattern, f, b) for f in _facets_at(self.pattern, a)]
        return min(walks, key=lambda w: len(w.creases))

    def _at(self, phi: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        x, first, second = self._walk.place(phi)
        apart = x - self.pattern.corners[self.corners[0]]
        far = float(np.linalg.norm(apart))
        # d|x| = e . dx, and |x|'' = (x' . x' - (x' . e)^2) / |x| + x'' . e with e = x / |x|
        along = first @ apart / far
        return far, along, (first @ first.T - np.outer(along, along)) / far + second @ apart / far


@dataclass(frozen=True, eq=False)
class DeadForce(_OfPlaces):
    """A force of size t on a corner, of fixed direction seen from a facet that is fixed.

    Attributes
    ----------
    pattern
        The sheet.
    corner
        Number of a vertex, from 0 as in the file.
    direction
        In the frame of the reference state; its length multiplies t.
    fixed_facet
        Number (1-based) of the facet that is fixed where it is in the reference state.
    """

    pattern: Pattern
    corner: int
    direction: tuple[float, float, float]
    fixed_facet: int

    def __post_init__(self) -> None:
        _corner(self.pattern, self.corner, "force")
        check_whole("fixed facet", self.fixed_facet, 1, self.pattern.facets)
        if self.fixed_facet - 1 in _facets_at(self.pattern, self.corner):
            raise OptionError(
                f"force: vertex {self.corner} is a corner of the fixed facet {self.fixed_facet}: fix another one"
            )
        f = np.array(self.direction, float)
        if f.shape != (3,) or not np.isfinite(f).all() or not f.any():
            raise OptionError(
                f"force: direction {shown(self.direction)} must be three numbers, not all 0"
            )

    @property
    def name(self) -> str:
        """What t is."""
        f = ", ".join(f"{v:g}" for v in self.direction)
        return f"force along ({f}) on vertex {self.corner}, facet {self.fixed_facet} fixed"

    @property
    def coordinate(self) -> str:
        """What it works on, with its unit."""
        return f"place of vertex {self.corner} along the force [m]"

    @property
    def arm(self) -> float:
        """Length that turns forces into torques."""
        return float(self.pattern.lengths.mean() * np.linalg.norm(self.direction))

    @cached_property
    def _walk(self) -> _Walk:
        return _walk(self.pattern, self.fixed_facet - 1, self.corner)

    def _at(self, phi: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        x, first, second = self._walk.place(phi)
        way = np.array(self.direction)
        return float(x @ way), first @ way, second @ way


Work: TypeAlias = Torque | Pull | DeadForce
"""What drives a load path of a sheet."""


@dataclass(frozen=True, eq=False)
class Worked:
    """The load t on what it works on as a term of the energy, -t w(phi): dead loads of a pattern (`Parameters.dead`).

    Attributes
    ----------
    work
        What the load works on.
    t
        The load, over the scale of the problem.
    """

    work: Work
    t: float

    @property
    def vector(self) -> np.ndarray:
        """The load, [1]."""
        return np.array([self.t])

    def times(self, factor: float) -> Worked:
        """Return `factor` times the load."""
        return replace(self, t=factor * self.t)

    def divided(self, by: float) -> Worked:
        """Return the load over a number; inf leaves nothing of it."""
        return replace(self, t=self.t / by)

    def moved(self, change: Worked, s: float) -> Worked:
        """Return the load with s times another one added."""
        return replace(self, t=self.t + s * change.t)

    def energy(self, sectors: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the energy of states [..., n], shape [...]."""
        return -self.t * self.work.conjugate(x)

    def energy_change(self, sectors: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the energy at y less that at x, [...]."""
        return -self.t * (self.work.conjugate(y) - self.work.conjugate(x))

    def drift(self, sectors: np.ndarray, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return how the gradient changes with a change of `vector`, [n]."""
        return -change[0] * self.work.gradient(x)

    def gradient(self, sectors: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the gradient of the energy at a state [n], same shape."""
        return -self.t * self.work.gradient(x)

    def hessian(self, sectors: np.ndarray, x: np.ndarray) -> np.ndarray | None:
        """Return its Hessian, [n, n]; None where that is zero."""
        bent = self.work.hessian(x)
        return None if bent is None else -self.t * bent
