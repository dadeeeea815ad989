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
from typing import NamedTuple

import numpy as np

from origami_nlp.chart.chart import chart_of, crease_number, flat_ray, fold_rays
from origami_nlp.errors import OptionError
from origami_nlp.numerics import quaternion as quat
from origami_nlp.pattern import Scene

BORDER_P, BORDER_Q, HEIGHT, CUT, OTHER = range(5)
"""Bits of walls, in the order of `HalfChain.walls`."""
STRAIGHT = 1 << BORDER_P | 1 << BORDER_Q
"""Walls that are straight in the base: its borders."""
CURVED = (HEIGHT, CUT, OTHER)
"""Those that are found by their values, in the order of `Points.walls`."""
SEAM = 60
"""The bit of the seam, where the two leaves meet: behind all walls."""


class Points(NamedTuple):
    """States of a chain.

    wedge: fold angles of the chain [V, k]; the inner one in [-pi, pi], the last in (-2 pi, 2 pi).
    walls: values of the curved walls [V, 3], a wall where they vanish: height y over the last mirror (the last
        fold angle is +-pi there), the inner fold angle off +-pi (wrapped), and, for degree 6, the angle from crease 1
        to crease 4 (wrapped), for wedges the cosine of crease 3's elevation.
    """

    wedge: np.ndarray
    walls: np.ndarray


class HalfChain:
    """The half-chain of a scene; see the module.

    Parameters
    ----------
    scene
        Of D1 and degree 6, or D_n and degree 4 n, with creases on all mirrors and full contact.

    Attributes
    ----------
    chart, kind
        Of the scene.
    sectors
        Sector angles along the chain [rad].
    orbit, size
        For each crease the position of its fold angle in a wedge state, and how many that has.
    reach
        Half widths of the base rectangle [rad], its borders being walls (fold angle at +-pi, or crease 1 on the axis).
    walls
        Names of the walls, by bit.
    wrapped
        Which of `Points.walls` are angles modulo 2 pi.

    Raises
    ------
    OptionError
        If the scene has not two symmetric degrees of freedom of a known kind, has stops, or does not ask for full
        contact.
    """

    def __init__(self, scene: Scene) -> None:
        chart, group = chart_of(scene), scene.group
        if chart is None:
            raise OptionError(
                f"symmetry = {scene.symmetry!r} leaves no chart of two degrees of freedom: the space is analysed for "
                "D1 of degree 6 and D<n> of degree 4 n, with creases on all mirrors"
            )
        if scene.contact != "full":
            raise OptionError(f'contact = "{scene.contact}": the admissible space needs "full"')
        if scene.limits:
            raise OptionError("limits: the admissible space is that of scenes without stops")
        self.scene, self.chart, self.kind = scene, chart, chart.kind
        self.sectors = tuple(ray.sector for ray in group.rays[:-1])
        self.orbit, self.size = list(group.orbit), len(group.rays)
        creases = [crease_number(scene, r) for r in range(self.size)]
        folded = [f"phi_{crease} = +-pi" for crease in creases]
        axis = [f"crease {crease} on the axis" for crease in (creases[0], creases[-1])]
        if self.kind == "degree6":
            touch = f"creases {creases[0]} and {creases[-1]} on each other"
            self.walls = (folded[0], folded[1], folded[3], folded[2], touch)
        else:
            self.walls = (axis[0], folded[0], folded[2], folded[1], axis[1])
        self.reach = (math.pi if self.kind == "degree6" else math.pi / 2, math.pi)
        self.wrapped = (False, True, self.kind == "degree6")
        # inward normal of the last mirror, and a basis of its plane
        c, s = math.cos(math.pi / group.order), math.sin(math.pi / group.order)
        if group.order <= 2:  # exactly
            c, s = (0.0, 1.0) if group.order == 2 else (-1.0, 0.0)
        self._normal, self._along = np.array([s, -c, 0.0]), np.array([abs(c), s, 0.0])

    def last_but_one(self, base: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the crease before P, and P over base points [..., 2], each [..., 3]."""
        p, q = base[..., 0], base[..., 1]
        flats = [flat_ray(azimuth) for azimuth in np.cumsum([0.0, *self.sectors[:-1]]).tolist()]
        if self.kind == "degree6":
            rays, _ = fold_rays(flats, [p / 4, q / 2])
        else:
            lift = quat.fold(np.cos(p / 2), np.sin(p / 2), (0.0, 1.0, 0.0))
            rays, _ = fold_rays(flats, [q / 4], turn=lift)
        before, tip = (np.stack(np.broadcast_arrays(*ray), axis=-1) for ray in rays[-2:])
        return before, tip

    def fold_margin(self, base: np.ndarray) -> np.ndarray:
        """sin^2 a - y^2: positive where the two leaves are apart, zero where they meet, negative where no state is."""
        height = self.last_but_one(base)[1] @ self._normal
        return np.asarray(math.sin(self.sectors[-1]) ** 2 - height**2)

    def value(self, bit: int, base: np.ndarray, leaf: np.ndarray) -> np.ndarray:
        """Return the value of a curved wall or of the seam, [V]."""
        if bit == SEAM:
            return self.fold_margin(base)
        return self.points(base, leaf).walls[:, bit - HEIGHT]

    def points(self, base: np.ndarray, leaf: np.ndarray) -> Points:
        """Fold the chain: base [V, 2], leaf [V] of +1, -1 (0: where the leaves meet)."""
        before, tip = self.last_but_one(base)
        a = self.sectors[-1]
        y = tip @ self._normal
        foot = np.arctan2(tip[..., 2], tip @ self._along)
        # tan delta = sqrt(sin^2 a - y^2) / cos a, from cos a = sqrt(1 - y^2) cos delta; the difference of squares as a
        # product, since both leaves meet where it vanishes
        root = np.sqrt(np.maximum((math.sin(a) - y) * (math.sin(a) + y), 0.0))
        delta = np.arctan2(np.where(leaf == 0, 0.0, root), math.cos(a))
        place = foot + np.where(leaf == 0, 1, leaf) * delta
        last = np.cos(place)[..., None] * self._along
        last[..., 2] = np.sin(place)
        n1, n2 = np.cross(before, tip), np.cross(tip, last)
        side = np.cross(self._normal, last)
        # fold angle from the normals of two facets about their crease, valley positive; from the last facet to its
        # mirror image half of it lies on this side
        inner, half = _turn(n1, n2, tip), _turn(n2, side, last)
        if self.kind == "degree6":
            wedge = np.stack([base[..., 0], base[..., 1], inner, 2 * half], axis=-1)
            # c_1 = c_4: the angle from crease 1 to crease 4 on the mirror; +-pi (book fold) is no contact
            other = np.arctan2(last[..., 2], last[..., 0])
        else:
            wedge = np.stack([base[..., 1], inner, 2 * half], axis=-1)
            other = np.cos(place)  # crease 3 on its own side of the axis
        walls = [y, np.where(inner >= 0, inner - math.pi, inner + math.pi), other]
        return Points(wedge, np.stack(walls, axis=-1))


def _turn(one: np.ndarray, two: np.ndarray, about: np.ndarray) -> np.ndarray:
    """Return the angle from one vector to another about an axis, [...]."""
    across = np.einsum("...i,...i", about, np.cross(one, two))
    return np.asarray(np.arctan2(across, np.einsum("...i,...i", one, two)))
