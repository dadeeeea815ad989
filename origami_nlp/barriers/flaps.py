"""Three closed flaps that turn about one edge: their lower-dimensional set, and the lowest exit from it, proved.

Degree 6, creases c_1, c_2, c_3 (every other one) fully folded at s pi, s = +-1, equal sectors on both sides of each:
three flaps two facets thick, whose other creases h_1, h_2, h_3 lie on one axis.  Fold limits hold (|phi| <= pi).

1. *The set.*  Neighbouring flaps make the angle g_j = pi + s phi(h_j) >= 0, and the vertex closes where g_1 + g_2 + g_3
   = 2 pi, that is sum phi(h_j) = -s pi: a polygon in a plane.
2. *Where it is isolated.*  Near such a state let c_i open by a_i >= 0.  The part of closure across the axis is sum a_i
   w_i u_i + O(a^2), u_i the unit vector of flap i across the axis, w_i = sin(sector) > 0.  If some g_j > pi, all u_i
   lie in an open half plane: v . u_i >= d > 0 for some v, also near by, so that 0 >= d min(w) sum a_i - O(a^2) and all
   a_i = 0.  So every admissible state near by keeps the three creases fully folded.
3. *Its ends.*  g_j > pi means s phi(h_j) > 0, for one j only.  These states are open in the admissible set, and a path
   leaves them through s phi(h_j) = 0: the segment phi(h_j) = 0, phi(h_k) + phi(h_l) = -s pi.
4. *The bound.*  On the set the energy is a convex quadratic, on the segment a parabola: its smallest value bounds every
   path out from below.

`tests/barriers/test_flaps.py` gets all four steps a second way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL
from origami_nlp.pattern import Scene


@dataclass(frozen=True)
class FlapExit:
    """The lowest exit of a thin set of three closed flaps.

    closed: creases that stay fully folded on it (1-based).  hinge: the crease (1-based) that is flat at every exit.
     energy: smallest one there, in the scene's units; no path out stays below.  fold_angles: of that
    state [N] [rad].
    """

    at_limit: tuple[int, ...]
    hinge: int
    energy: float
    fold_angles: np.ndarray = field(repr=False)


def flap_exit(scene: Scene, fold_angles: np.ndarray) -> FlapExit | None:
    """Return the proved lowest exit of the thin set of three closed flaps that a state lies on.

    Parameters
    ----------
    fold_angles
        All N fold angles of an admissible state [rad].

    Returns
    -------
    exit
        None where the state is on no such set, or where the set is not thin.
    """
    phi = np.asarray(fold_angles, dtype=float)
    sectors = np.array(scene.vertex.sector_angles)
    if scene.degree != 6 or not scene.vertex.flat or scene.contact == "none":
        return None
    if scene.limits or scene.laws:  # stops cut the segment, and laws need not be convex on it
        return None
    for first in (0, 1):
        at_limit = np.arange(first, 6, 2)
        hinges = (at_limit + 1) % 6
        side = np.sign(phi[at_limit[0]])
        if (
            np.abs(phi[at_limit] - side * math.pi).max() > CONTACT_TOL
            or np.abs(sectors[at_limit] - sectors[at_limit - 1]).max() > CLOSURE_TOL
            # step 1: the gaps g_j = pi + s phi(h_j) sum to 2 pi
            or abs(phi[hinges].sum() + side * math.pi) > 3 * CONTACT_TOL
        ):
            continue
        # step 2: thin where some g_j > pi
        wide = hinges[side * phi[hinges] > CONTACT_TOL]
        if len(wide) != 1:
            return None
        one, two = (h for h in hinges if h != wide[0])
        k, rest = np.array(scene.stiffness), np.array(scene.wound_angles)
        # least of k_1 (x - r_1)^2 + k_2 (-s pi - x - r_2)^2 over the segment
        x = (k[one] * rest[one] + k[two] * (-side * math.pi - rest[two])) / (k[one] + k[two])
        # step 4: a parabola on a segment is least at its vertex, or at the end next to it
        x = float(np.clip(x, *sorted((0.0, -side * math.pi))))
        out = np.zeros(6)
        # step 3: phi(h_j) = 0 at every exit
        out[at_limit], out[one], out[two] = side * math.pi, x, -side * math.pi - x
        numbers = tuple((at_limit + 1).tolist())
        return FlapExit(numbers, int(wide[0]) + 1, float(scene.energy(out)), out)
    return None
