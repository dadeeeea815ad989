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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from origami_nlp.numerics import OUTSIDE
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem, pose


@dataclass(frozen=True)
class RayGap:
    """What closes where a ray touches.

    Attributes
    ----------
    rays
        (k, j): ray k on the facet that starts at ray j; (r, side): ray r on the first mirror (0) or the last (1).
    pair
        The two facets, by their first rays; None at a mirror.
    """

    rays: tuple[int, int]
    pair: tuple[int, int] | None = None

    @property
    def text(self) -> str:
        """Which it is, 1-based."""
        k, j = self.rays
        return f"ray {k + 1} on {'a mirror' if self.pair is None else f'facet {j + 1}'}"


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
        What may touch: gaps, and pairs of facets by their first rays; with full contact only.
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
        self.pairs = tuple(_facet_pairs(scene)) if full else ()
        self.gaps = (*_mirror_gaps(self), *_facet_gaps(self)) if full else ()

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

    @property
    def walls(self) -> tuple[int, ...]:
        """Positions of the gaps at mirrors."""
        return tuple(i for i, gap in enumerate(self.gaps) if gap.pair is None)


def _mirror_gaps(vertex: ReducedVertex) -> Iterator[RayGap]:
    """Keep the rays of a wedge between its mirrors: those beside one are by their facet, or their fold limit."""
    if vertex.kind == "C":
        return
    last = len(vertex.has_crease) - 1
    # both mirrors of D_1 are one plane
    sides = (0,) if vertex.order == 1 else (0, 1)
    for r in range(1, last):
        for side in sides:
            if r not in ({1, last - 1} if vertex.order == 1 else {(1, last - 1)[side]}):
                yield RayGap((r, side))
    if vertex.order > 1:
        # a mirror ray stays on its own side of the axis
        yield from (RayGap((0, 1)), RayGap((last, 0)))


def _facet_gaps(vertex: ReducedVertex) -> Iterator[RayGap]:
    rays = len(vertex.has_crease)
    for i, j in vertex.pairs:
        for on, other in ((j, i), (i, j)):
            yield from (RayGap((k, on), (i, j)) for k in (other, (other + 1) % rays))


def _facet_pairs(scene: Scene) -> Iterator[tuple[int, int]]:
    """Go through the pairs of facets that may cross, by their first rays; of images under C_n the first."""
    group, n = scene.group, scene.degree
    if group.kind == "D":
        last = len(group.rays) - 1
        wanted = [(i, j) for i in range(last) for j in range(i + 2, last)]
    else:
        period, seen, wanted = n // group.order, set[tuple[int, ...]](), []
        for i in range(period):
            for j in (k % n for k in range(i + 2, i + n - 1)):
                turns = range(0, n, period)
                images = {tuple(sorted(((i + m) % n, (j + m) % n))) for m in turns}
                if not images & seen:
                    wanted.append((min(i, j), max(i, j)))
                seen |= images
    for i, j in wanted:
        a, b = _facet_of(scene, i), _facet_of(scene, j)
        if (a - b) % n not in (0, 1, n - 1) and can_cross(scene.vertex.sector_angles, a, b):
            yield i, j


def _facet_of(scene: Scene, r: int) -> int:
    """Return the facet of the vertex that starts at ray r, or that a mirror ray r runs through; from 0."""
    rays, n = scene.group.rays, scene.degree
    if scene.group.kind == "C":
        return r % n
    crease = rays[r].crease
    if crease is not None:
        return crease
    beside = rays[1 if r == 0 else r - 1].crease
    assert beside is not None, "two mirrors cannot bound one facet piece"
    return (beside - 1) % n if r == 0 else beside


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
