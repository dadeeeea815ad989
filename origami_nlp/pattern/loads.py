"""Dead loads: forces that keep size and direction while facets move, seen from one facet that is fixed.

The load moves with its point; the energy is U - sum f . p.  A moment vector that keeps its direction has no energy
(round a closed loop of rotations its work is not zero), and is refused: two opposite forces make a couple that has one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_whole, shown
from origami_nlp.errors import SceneError
from origami_nlp.pattern.numbers_read import format_angle, parse_angle, read_list

LARGEST_FORCE = 1e100
"""Force [N], torque [N m] and distance [m], in any unit: products of them must not overflow."""


@dataclass(frozen=True)
class Load:
    """One load: a force at a point of a facet or on a crease.

    Attributes
    ----------
    force
        (x, y, z) [N], in the frame of the fixed facet (`Scene.fixed_facet`): x along its first crease, which has
        the facet's number, z its normal on the side from which creases are numbered counter-clockwise.
    facet
        Number (1-based) of the facet that carries the point; facet i lies between creases i and i + 1.
    point
        Distance from the vertex [m], and angle from the facet's first crease [rad].
    crease
        Number (1-based) of the crease that carries the force, in place of facet and point.
    distance
        Of the point on the crease from the vertex [m].

    Examples
    --------
    >>> from origami_nlp import Load
    >>> Load(crease=3, distance=0.2, force=(0, 0, -1)).words
    'force (0, 0, -1) N at crease 3, 0.2 m from the vertex'
    """

    force: tuple[float, float, float] | None = None
    facet: int | None = None
    point: tuple[float, float] | None = None
    crease: int | None = None
    distance: float | None = None

    def __post_init__(self) -> None:
        given = {f.name for f in fields(self) if getattr(self, f.name) is not None}
        if given not in ({"crease", "distance", "force"}, {"facet", "point", "force"}):
            ways = "crease, distance and force; or facet, point = [distance, angle] and force"
            raise SceneError(f"a load has {', '.join(sorted(given)) or 'nothing'}: give {ways}")
        wrong = f"force = {shown(self.force)} of a load must be a list of 3 numbers"
        force = read_list(self.force, wrong, 3)
        object.__setattr__(self, "force", tuple(_number("force", f) for f in force))
        if self.point is not None:
            wrong = f"point = {shown(self.point)} of a load must be a list of 2 numbers"
            far, angle = read_list(self.point, wrong, 2)
            at = _number("point", far), parse_angle(angle, "the angle of point")
            object.__setattr__(self, "point", at)
        else:
            object.__setattr__(self, "distance", _number("distance", self.distance))
        if self.place[0] <= 0:
            raise SceneError(f"distance = {self.place[0]:g} from the vertex must be above 0 [m]")

    @property
    def place(self) -> tuple[float, float]:
        """Distance from the vertex [m], and angle from the first crease of its facet [rad]."""
        return self.point if self.point is not None else (self.distance or 0.0, 0.0)

    @property
    def number(self) -> int:
        """Of its crease, or facet (1-based)."""
        return self.crease or self.facet or 0

    @property
    def words(self) -> str:
        """What it is."""
        assert self.force is not None
        far, angle = self.place
        head = f"force ({', '.join(f'{v:g}' for v in self.force)}) N at "
        if self.crease is not None:
            return f"{head}crease {self.crease}, {far:g} m from the vertex"
        return f"{head}facet {self.facet}, {far:g} m from the vertex, {format_angle(angle)} from crease {self.facet}"

    def to_dict(self) -> dict[str, Any]:
        """Return it as a table of a scene file."""
        named = ((f.name, getattr(self, f.name)) for f in fields(self))
        return {k: list(v) if isinstance(v, tuple) else v for k, v in named if v is not None}


def read_loads(values: object, sector_angles: Sequence[float]) -> tuple[Load, ...]:
    """Read loads, or tables that state them, of a vertex.

    Raises
    ------
    SceneError
        If one is no load, or its crease, facet or point is not there.
    """
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Sequence):
        raise SceneError(f"loads = {shown(values)} must be a list of loads")
    out = []
    for i, value in enumerate(values, start=1):
        if isinstance(value, Mapping):
            known = [f.name for f in fields(Load)]
            if unknown := value.keys() - set(known):
                take = f"a load takes {', '.join(known)}; a torque on a crease is preload"
                raise SceneError(f"loads[{i}]: unknown key {min(unknown)!r}; {take}")
            value = Load(**value)
        if not isinstance(value, Load):
            raise SceneError(f"loads[{i}] = {shown(value)} must be a Load")
        what = "facet" if value.facet is not None else "crease"
        check_whole(f"loads[{i}]: {what}", value.number, 1, len(sector_angles), SceneError)
        if value.facet is not None and not 0 <= value.place[1] <= sector_angles[value.facet - 1]:
            span = f"0 to {format_angle(sector_angles[value.facet - 1])}"
            at = f"loads[{i}]: point angle {format_angle(value.place[1])}"
            raise SceneError(f"{at} is not within facet {value.facet}, {span}")
        out.append(value)
    return tuple(out)


def _number(name: str, value: object) -> float:
    return check_number(f"{name} of a load", value, -LARGEST_FORCE, LARGEST_FORCE, SceneError)


@dataclass(frozen=True, eq=False)
class DeadLoads:
    """Forces at points of facets, and their energy at states of all N fold angles.

    Attributes
    ----------
    held
        Facet that is held, 0-based.
    facets
        Facets of the points, 0-based, [L].
    points
        In the plane of the facet, x along its first crease, [L, 2] [m].
    forces
        In the frame of the fixed facet, [L, 3] [N], or over the scale of a problem.
    """

    held: int
    facets: tuple[int, ...]
    points: np.ndarray
    forces: np.ndarray

    @property
    def vector(self) -> np.ndarray:
        """Points and forces in the order in which compiled functions take them, shape [5 L]."""
        return np.hstack([self.points, self.forces]).ravel()

    def moved(self, change: DeadLoads, s: float) -> DeadLoads:
        """Return these loads with s times the points and forces of `change` added."""
        points, forces = self.points + s * change.points, self.forces + s * change.forces
        return replace(self, points=points, forces=forces)

    def divided(self, by: float) -> DeadLoads:
        """Return points and forces over a number; inf leaves nothing of them."""
        return replace(self, points=self.points / by, forces=self.forces / by)

    def times(self, factor: float) -> DeadLoads:
        """Return the same loads with `factor` times the forces."""
        return replace(self, forces=factor * self.forces)

    def _each(self, sectors: np.ndarray) -> Iterator[tuple[list[int], np.ndarray, np.ndarray, Any]]:
        """Go through the forces: creases from the held facet on, axes and point unfolded, and the force."""
        n = len(sectors)
        for facet, (x, y), force in zip(self.facets, self.points, self.forces, strict=True):
            turns = [(self.held + 1 + i) % n for i in range((facet - self.held) % n)]
            azimuth = np.cumsum([0.0, *(sectors[c - 1] for c in turns)])
            c, s = np.cos(azimuth), np.sin(azimuth)
            point = np.array([c[-1] * x - s[-1] * y, s[-1] * x + c[-1] * y, 0.0])
            yield turns, np.column_stack([c, s, 0 * c])[1:], point, force

    def _folded(self, sectors: np.ndarray, x: np.ndarray) -> Iterator[tuple[Any, ...]]:
        """Go through loads at states [..., N]: the creases between, their axes [..., k, 3], the point, the force."""
        for turns, axes, point, force in self._each(sectors):
            v = np.vstack([axes, point]) + np.zeros((*x.shape[:-1], 1, 1))
            spins = _spins(axes)
            for i in reversed(range(len(turns))):
                v[..., i + 1 :, :] = _turned(v[..., i + 1 :, :], spins[i], x[..., turns[i], None])
            yield turns, v[..., :-1, :], v[..., -1, :], force

    def energy(self, sectors: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return - sum f . p at states [..., N], shape [...]."""
        return -sum(
            (p @ force for *_, p, force in self._folded(sectors, x)), np.zeros(x.shape[:-1])
        )

    def energy_change(self, sectors: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the energy at y less that at x [..., N], without cancellation, shape [...]."""
        total = np.zeros(x.shape[:-1])
        for turns, axes, point, force in self._each(sectors):
            moved, p = np.zeros((*x.shape[:-1], 3)), point
            for c, spin in zip(reversed(turns), _spins(axes)[::-1], strict=True):
                # R(y) p - R(x) p = 2 sin((y - x) / 2) a x R((x + y) / 2) p: no difference of large numbers
                middle = _turned(p, spin, 0.5 * (x[..., c] + y[..., c])) @ spin
                step = 2 * np.sin(0.5 * (y[..., c, None] - x[..., c, None])) * middle
                moved, p = _turned(moved, spin, x[..., c]) + step, _turned(p, spin, y[..., c])
            total = total - moved @ force
        return total

    def drift(self, sectors: np.ndarray, x: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return how the gradient changes with a change of `vector`, [N]: it is linear in points, and in forces."""
        table = change[: len(self.vector)].reshape(-1, 5)
        points = replace(self, points=table[:, :2])
        forces = replace(self, forces=table[:, 2:])
        return points.gradient(sectors, x) + forces.gradient(sectors, x)

    def gradient(self, sectors: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the gradient of the energy, [..., N]: -f . (a x p), a the axis of a crease between."""
        out = np.zeros_like(x)
        for turns, axes, p, force in self._folded(sectors, x):
            out[..., turns] -= np.cross(axes, p[..., None, :]) @ force
        return out

    def hessian(self, sectors: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the Hessian of the energy, [..., N, N]: -f . (a x (b x p)), a nearer to the fixed facet than b."""
        out = np.zeros((*x.shape, x.shape[-1]))
        for turns, axes, p, force in self._folded(sectors, x):
            bent = np.cross(force, axes) @ np.cross(axes, p[..., None, :]).swapaxes(-1, -2)
            upper = np.triu(bent)
            both = upper + np.triu(bent, 1).swapaxes(-1, -2)
            out[..., np.array(turns, int)[:, None], turns] -= both
        return out


def _spins(axes: np.ndarray) -> np.ndarray:
    """Return the matrices [k, 3, 3] with a x v = `v @ spin` for unit axes a, [k, 3]."""
    return np.cross(axes[:, None], np.eye(3))


def _turned(v: np.ndarray, spin: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Return vectors [..., 3] turned by angles [...] about the axis whose cross product is `v @ spin`."""
    across = v @ spin
    return v + np.sin(angle)[..., None] * across + (1 - np.cos(angle))[..., None] * (across @ spin)


def dead_loads(loads: Sequence[Load], fixed_facet: int | None) -> DeadLoads | None:
    """Return the forces among loads; None where there are none.

    Parameters
    ----------
    loads
        The forces.
    fixed_facet
        Facet in whose frame forces are given, counted from 1.

    Returns
    -------
    DeadLoads or None
        Points [m] and forces [N] in the frame of the fixed facet; None without loads, or without that facet.
    """
    if not loads or fixed_facet is None:
        return None
    places = [load.place for load in loads]
    points = np.array([(far * math.cos(turn), far * math.sin(turn)) for far, turn in places])
    facets = tuple(load.number - 1 for load in loads)
    return DeadLoads(fixed_facet - 1, facets, points, np.array([load.force for load in loads]))
