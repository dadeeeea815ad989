"""Symmetric states with two degrees of freedom as folded half-chains, in coordinates that have no blow-up point.

Between two neighbouring mirrors the creases of a symmetric vertex are a chain of arcs on the unit sphere; its ends
lie on the mirrors.  All but the last crease are placed freely; the last one is at distance a (its sector angle) from
the one before it, P, and on the last mirror, whose inward normal is n: with y = P . n the sine of P's height over the
mirror, it lies on either side of P's foot, at the distance delta with cos a = sqrt(1 - y^2) cos delta.  So every
closed state is (base point, leaf):

- D_1, degree 6: base (phi_1, phi_2), P = c_3;
- D_n, n >= 2, three creases in the wedge: base (upsilon, phi_1), the elevation (paper's sign) and fold angle of
  crease 1, P = c_2.

The two leaves meet where delta = 0 (or pi), that is |y| = sin a.  The paper's charts have points that carry whole
families of states ((phi_2, phi_3) = (0, 0), c_1 = c_4, upsilon = 0); here nothing degenerates except the flat state,
which is a true singularity of the space (two cones that meet at their tips).  Radians throughout.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from origami_nlp.chart.chart import Chart, chart_of, crease_number
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import quaternion as quat
from origami_nlp.pattern import Scene
from origami_nlp.problem import FoldLimits


@dataclass(frozen=True, repr=False)
class HalfChain(ShortRepr):
    """The half-chain of a scene; see the module.

    Attributes
    ----------
    chart
        Of the scene that it folds.
    sectors
        Sector angles along the chain [rad].
    last_normal, last_along, up
        Inward normal of the last mirror, and a basis of its plane, each [3].
    reach
        Half widths of the base rectangle [rad], its borders being walls (fold angle at +-pi, or crease 1 on the axis).
    walls
        Names of the walls: two borders of the base, then in the order of `Points.walls`.
    limits
        Fold limits of a wedge state.
    stops
        Those before facets meet: variable and angle [rad].
    """

    chart: Chart
    sectors: tuple[float, ...]
    last_normal: np.ndarray
    last_along: np.ndarray
    up: np.ndarray
    reach: tuple[float, float]
    walls: tuple[str, ...]
    limits: FoldLimits
    stops: tuple[tuple[int, float], ...]

    @property
    def scene(self) -> Scene:
        """The scene that it folds."""
        return self.chart.scene

    @property
    def kind(self) -> str:
        """``"degree6"`` or ``"wedge"``."""
        return self.chart.kind

    @property
    def wrapped(self) -> tuple[bool, ...]:
        """Which of the first three of `Points.walls` are angles modulo 2 pi."""
        return WRAPPED[self.kind] + (True,) * len(self.stops)

    @cached_property
    def orbit(self) -> list[int]:
        """For each crease, the position of its fold angle in a wedge state."""
        return list(self.scene.group.orbit)

    @property
    def size(self) -> int:
        """Number of fold angles of a wedge state."""
        return len(self.sectors) + 1

    def penultimate(self, base: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return creases (first, second last but one, P) over base points [..., 2], each [..., 3]."""
        p, q = base[..., 0], base[..., 1]
        if self.kind == "degree6":
            a1, a2, _ = self.sectors
            turn = quat.fold(np.cos(p / 4), np.sin(p / 4), (1.0, 0.0, 0.0))
            b2, b3 = (math.cos(a1), math.sin(a1), 0.0), (math.cos(a1 + a2), math.sin(a1 + a2), 0.0)
            first = np.broadcast_to([1.0, 0.0, 0.0], (*p.shape, 3))
            before = np.stack(np.broadcast_arrays(*quat.rotate(turn, b2)), axis=-1)
            turn = quat.multiply(turn, quat.fold(np.cos(q / 2), np.sin(q / 2), b2))
            return first, before, np.stack(np.broadcast_arrays(*quat.rotate(turn, b3)), axis=-1)
        a1 = self.sectors[0]
        turn = quat.fold(np.cos(p / 2), np.sin(p / 2), (0.0, 1.0, 0.0))
        first = np.stack(np.broadcast_arrays(*quat.rotate(turn, (1.0, 0.0, 0.0))), axis=-1)
        turn = quat.multiply(turn, quat.fold(np.cos(q / 4), np.sin(q / 4), (1.0, 0.0, 0.0)))
        b2 = (math.cos(a1), math.sin(a1), 0.0)
        tip = np.stack(np.broadcast_arrays(*quat.rotate(turn, b2)), axis=-1)
        return first, first, tip

    def fold_margin(self, base: np.ndarray) -> np.ndarray:
        """sin^2 a - y^2: positive where the two leaves are apart, zero where they meet, negative where no state is."""
        height = self.penultimate(base)[2] @ self.last_normal
        return np.asarray(math.sin(self.sectors[-1]) ** 2 - height**2)

    def points(self, base: np.ndarray, leaf: np.ndarray) -> Points:
        """Fold the chain: base [V, 2], leaf [V] of +1, -1 (0: where the leaves meet)."""
        _, before, tip = self.penultimate(base)
        a = self.sectors[-1]
        y = tip @ self.last_normal
        foot = np.arctan2(tip @ self.up, tip @ self.last_along)
        # tan delta = sqrt(sin^2 a - y^2) / cos a, from cos a = sqrt(1 - y^2) cos delta; the difference of squares as a
        # product, since both leaves meet where it vanishes
        root = np.sqrt(np.maximum((math.sin(a) - y) * (math.sin(a) + y), 0.0))
        root = np.where(leaf == 0, 0.0, root)
        delta = np.arctan2(root, math.cos(a))
        place = foot + np.where(leaf == 0, 1, leaf) * delta
        last = np.cos(place)[..., None] * self.last_along + np.sin(place)[..., None] * self.up
        n1, n2 = np.cross(before, tip), np.cross(tip, last)
        # fold angle from the normals of two facets about their crease, valley positive
        inner = np.arctan2(np.einsum("...i,...i", tip, np.cross(n1, n2)), (n1 * n2).sum(-1))
        side = np.cross(self.last_normal, last)
        # from the last facet to its mirror image: half of the fold angle lies on this side
        half = np.arctan2(
            np.einsum("...i,...i", last, np.cross(n2, side)), np.einsum("...i,...i", n2, side)
        )
        if self.kind == "degree6":
            wedge = np.stack([base[..., 0], base[..., 1], inner, 2 * half], axis=-1)
            # c_1 = c_4: the angle from crease 1 to crease 4 on the mirror; +-pi (book fold) is no contact
            other = np.arctan2(last[..., 2], last[..., 0])
        else:
            wedge = np.stack([base[..., 1], inner, 2 * half], axis=-1)
            other = np.cos(place)  # crease 3 on its own side of the axis
        cut = np.where(inner >= 0, inner - math.pi, inner + math.pi)
        stops = [self._beyond(wedge, v, at) for v, at in self.stops]
        return Points(wedge, np.stack([y, cut, other, *stops], axis=-1))

    def _beyond(self, wedge: np.ndarray, variable: int, at: float) -> np.ndarray:
        """How far a fold angle is above that of a stop; the inner one goes on from +pi to -pi."""
        off = wedge[..., variable] - at
        if variable == self.size - 2:
            off = np.where(
                off > math.pi, off - math.tau, np.where(off < -math.pi, off + math.tau, off)
            )
        return np.asarray(off)


@dataclass(frozen=True)
class Points:
    """States of a chain.

    wedge: fold angles of the chain [V, k]; the inner one in [-pi, pi], the last in (-2 pi, 2 pi).
    walls: values of the curved walls [V, 3 + stops], a wall where they vanish: height y over the last mirror (the last
        fold angle is +-pi there), the inner fold angle off +-pi (wrapped), and, for degree 6, the angle from crease 1
        to crease 4 (wrapped), for wedges the cosine of crease 3's elevation; then fold angles off their stops.
    """

    wedge: np.ndarray
    walls: np.ndarray


WRAPPED = {"degree6": (False, True, True), "wedge": (False, True, False)}
"""Which of the first three of `Points.walls` are angles modulo 2 pi."""


def chain_of(scene: Scene) -> HalfChain:
    """Return the half-chain of a scene.

    Parameters
    ----------
    scene
        Of D1 and degree 6, or D_n and degree 4 n, with creases on all mirrors and full contact.

    Returns
    -------
    HalfChain
        The half-chain, which folds over two parameters.

    Raises
    ------
    OptionError
        If the scene has not two symmetric degrees of freedom of a known kind, or does not ask for full contact.
    """
    chart = chart_of(scene)
    if chart is None:
        raise OptionError(
            f"symmetry = {scene.symmetry!r} leaves no chart of two degrees of freedom: the space is analysed for D1 of "
            "degree 6 and D<n> of degree 4 n, with creases on all mirrors"
        )
    if scene.contact != "full":
        raise OptionError(f'contact = "{scene.contact}": the admissible space needs "full"')
    group = scene.group
    sectors = tuple(ray.sector for ray in group.rays[:-1])
    creases = [crease_number(scene, r) for r in range(len(sectors) + 1)]
    names = [f"phi_{crease} = +-pi" for crease in creases]
    limits = FoldLimits(*scene.limit_angles[:, np.array(creases) - 1])
    at_stops = [c for c in limits.both if c.at != math.pi]
    stops = tuple((c.index, c.side * c.at) for c in at_stops)
    stop_names = (f"phi_{creases[c.index]} = {c.where}" for c in at_stops)
    first, last = creases[0], creases[-1]
    up = np.array([0.0, 0.0, 1.0])
    if chart.kind == "degree6":
        touch = f"creases {first} and {last} on each other"
        walls = (names[0], names[1], names[3], names[2], touch, *stop_names)
        along, normal, reach = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), math.pi
    else:
        axis = (f"crease {crease} on the axis" for crease in (first, last))
        walls = (next(axis), names[0], names[2], names[1], next(axis), *stop_names)
        c, s = math.cos(math.pi / group.order), math.sin(math.pi / group.order)
        if group.order == 2:
            c, s = 0.0, 1.0
        normal, along, reach = np.array([s, -c, 0.0]), np.array([c, s, 0.0]), math.pi / 2
    return HalfChain(chart, sectors, normal, along, up, (reach, math.pi), walls, limits, stops)
