"""What a symmetry leaves of a vertex: the rays of one piece, its sectors, and the facets that may touch.

The piece of C_n is a period, that of D_n a wedge between two mirrors, both on it.  Its rays stay between the mirrors,
which keep its facets off their images; facets of one piece cross unless the sectors between them are too wide.

Creases that lie on one line all along a stratum, and what a minimum then needs.

Where all creases between two free ones, a and b, are closed (+-pi), their facets lie in one plane, and crease b is at
the angle of the alternating sum of the sectors between from crease a.  If that is a multiple of pi, c_a = s c_b
throughout, s = +-1: closure loses rank there, and all minors may vanish on a whole curve.  But d phi_a = -s d phi_b
keeps closure, so a minimum needs G_a = s G_b.

With a symmetry the images of that motion are motions too: arcs without another crease of a or b inside are disjoint,
or lie on one line, so that all of them go on at once, and the symmetric sum says G_a = s G_b of the variables.  Where a
and b are one variable it is no motion for s = 1, and says G_a = 0 for s = -1 (a crease across a mirror).

Relations of sectors that hold to within what sectors may be off (`rows.SECTORS`) are taken as exact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from origami_nlp.numerics import OUTSIDE
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem, pose


@dataclass(frozen=True)
class Gap:
    """What closes where a ray touches.

    Attributes
    ----------
    kind
        ``facet``: ray k on the facet from ray j; ``start``, ``end``: ray k on the plane of that mirror; ``meet``:
        rays 0 and 3 of a D_1 wedge, in the plane of its mirrors, on each other: 3 on facet 0, or 0 on facet 2.
    rays
        (k, j), or (k,).
    """

    kind: str
    rays: tuple[int, ...]

    @property
    def text(self) -> str:
        """Which it is, 1-based."""
        k, *j = self.rays
        return f"ray {k + 1} on {f'facet {j[0] + 1}' if j else 'a mirror'}"


class ReducedVertex:
    """A vertex in the variables that its symmetry leaves, as boxes see it.

    Parameters
    ----------
    scene
        Of one winding; 1 where it says none.
    problem
        The same, posed; None: as stated.

    Attributes
    ----------
    kind, order
        Of the group, C or D and n.
    has_crease
        Of each ray of the piece.
    sectors
        After each ray of a period, between the rays of a wedge [rad].
    variable_of_crease
        Of the whole vertex, [N].
    gaps, pairs
        What may touch, and pairs of facets that may cross, by their first rays; with full contact only.
    """

    def __init__(self, scene: Scene, problem: PatternProblem | None = None) -> None:
        group, self.scene = scene.group, scene
        self.problem = pose(scene) if problem is None else problem
        self.winding, self.kind, self.order = scene.winding or 1, group.kind, group.order
        self.has_crease = tuple(ray.crease is not None for ray in group.rays)
        sectors = [ray.sector for ray in group.rays]
        self.sectors = np.array(sectors[:-1] if group.kind == "D" else sectors)
        places = [r for r, has in enumerate(self.has_crease) if has]
        self.variable_of_crease = np.array([places.index(r) for r in group.orbit])
        full = scene.contact == "full"
        self.gaps, self.pairs = _gaps(self) if full else ((), ())

    @property
    def size(self) -> int:
        """Number of variables."""
        return self.problem.size

    @property
    def turn(self) -> Fraction:
        """How many pieces make one turn round the axis: closed states of a piece depend on no more of the group."""
        return Fraction(self.order, self.winding)

    @property
    def dof(self) -> int:
        """Degrees of freedom at a regular state."""
        once = 3 if self.kind == "C" else 2
        return self.size - (once if self.turn == 1 else 1)


def _gaps(vertex: ReducedVertex) -> tuple[tuple[Gap, ...], tuple[tuple[int, int], ...]]:
    """Return what may touch, and pairs of facets that may cross, where proofs know touches (`touches`)."""
    rays, n, sectors = (
        len(vertex.has_crease),
        vertex.scene.degree,
        vertex.scene.vertex.sector_angles,
    )
    if vertex.kind == "C":
        every = [(i, j) for i in range(n) for j in range(i + 2, min(n, i + n - 1))]
        pairs = tuple(pair for pair in every if can_cross(sectors, *pair))
        ends = ((k % n, j) for one in pairs for i, j in (one, one[::-1]) for k in (i, i + 1))
        # beside a facet a ray lies in its plane where the crease between is closed
        far = [one for one in dict.fromkeys(ends) if 3 <= (one[0] - one[1]) % n <= n - 2]
        return tuple(Gap("facet", one) for one in far), pairs
    if vertex.order > 1:  # a mirror ray stays on its own side of the axis
        return (Gap("end", (0,)), Gap("start", (rays - 1,))), ()
    creases = [ray.crease for ray in vertex.scene.group.rays]
    if rays == 4 and None not in creases and can_cross(sectors, creases[0], creases[2]):  # type: ignore[arg-type]
        return (Gap("meet", (3, 0)), Gap("meet", (0, 2))), ((0, 2),)
    return (), ()


def can_cross(sector_angles: Sequence[float], i: int, j: int) -> bool:
    """Return whether facets i and j (from 0) of a vertex could ever cross.

    A common point splits the polygon into two closed loops.  Each closes only if the parts of the two facets that
    belong to it bridge what the longest sector between them has over the others; both share sectors i and j.
    """
    n = len(sector_angles)
    ways = range(i + 1, i + (j - i) % n), range(j + 1, j + (i - j) % n)
    chains = [[sector_angles[m % n] for m in way] for way in ways]
    missing = sum(max(0.0, 2 * max(chain) - sum(chain)) for chain in chains)
    return missing < sector_angles[i] + sector_angles[j] - OUTSIDE


@dataclass(frozen=True)
class CollinearPair:
    """Creases on one line while others are closed.

    Attributes
    ----------
    creases
        Variables: two, or one that lies across a mirror.
    sign
        s with G_a = s G_b.
    closed
        Variables between, which are to be closed.
    """

    creases: tuple[int, ...]
    sign: int
    closed: tuple[int, ...]


def collinear_creases(
    sectors: Sequence[float], variable: Sequence[int], doubt: float
) -> tuple[CollinearPair, ...]:
    """List the pairs of a vertex.

    Parameters
    ----------
    sectors
        Of the whole vertex, shape [N] [rad].
    variable
        Of each crease, shape [N].
    doubt
        By which a sector may be off [rad].

    Returns
    -------
    tuple of CollinearPair
        Each pair once for each set of closed ones between that fits.
    """
    n = len(sectors)
    found: dict[CollinearPair, None] = {}
    for a in range(n):
        # each closed crease folds the walk back: sectors count forth and back in turn
        steps = [(-1.0) ** i * sectors[(a + i) % n] for i in range(n - 1)]
        for count in range(1, n):
            total = math.fsum(steps[:count])
            multiple = round(total / math.pi)
            if abs(total - multiple * math.pi) > (count + 1) * doubt:
                continue
            sign = 1 - 2 * (multiple % 2)
            ends = {int(variable[a]), int(variable[(a + count) % n])}
            closed = {int(variable[(a + i) % n]) for i in range(1, count)}
            if not ends & closed and (len(ends) == 2 or sign < 0):
                found[CollinearPair(tuple(sorted(ends)), sign, tuple(sorted(closed)))] = None
    return tuple(found)


def twins_asked(twins: tuple[CollinearPair, ...], pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """Return on which strata creases lie on one line, [T, K]; pins, and those at +-pi, [n, K]."""
    out = np.zeros((len(twins), pins.shape[1]), dtype=bool)
    for t, twin in enumerate(twins):
        free = (pins[list(twin.creases)] == 0).all(axis=0)
        out[t] = free & (flat[list(twin.closed)] != 0).all(axis=0)
    return out
