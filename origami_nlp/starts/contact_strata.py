"""The ways in which facets of a vertex without symmetry can touch, as strata on which states close in closed form.

A folded vertex is a closed spherical polygon: corner i is crease i, side i is facet i.  Where crease k touches facet j
the polygon is pinched: it falls into two that close separately and share a corner there,

- A = (t', j+1, ..., k-1) with the part of side j that follows the touch,
- B = (t'', k+1, ..., j) with the part that precedes it,

of k - j and N - (k - j) + 1 corners (mod N), at least three each.  A second touch pinches one of these in the same way.
A *stack touch* pinches nothing: crease i is closed and the crease e at the tip of its narrower facet is flat, so that
the facet beyond the tip lies on the wider one (`folding.stack_rule`).

A *stratum* is a set of touches with a set of closed creases; sides of touches and signs of creases are not
distinguished. Only strata in general position are listed: in each piece three turns must be left to close it, and the
corner at a touch is not closed itself, except where one touch leaves another turn in exchange.
What is not listed is of higher codimension: creases on creases, and pieces that lie folded flat.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.folding import stack_rule

MOST_TOUCHES = 3
"""Slots for touches that a state has."""
MOST_FULL = 8
"""Largest degree of which every stratum is listed: their number grows as 2^N N^4."""
MOST_FOLDED = 2
"""Closed creases beside a touch above that degree; none beside two touches."""
MOST_TWICE = 12
"""Largest degree with two touches."""

Row = tuple[int, int]
"""(k, j): crease k on facet j, 0-based."""
Corner = tuple[int, int, int, int]
"""Turn at a corner, facet of the side after it, and the touches at which that side starts and ends (-1: its ends)."""
Polygon = tuple[Corner, ...]


@dataclass(frozen=True)
class Pinched:
    """A polygon pinched at touches.

    Turns 0 .. N-1 are the creases, N + 2 p and N + 2 p + 1 those of the two corners that touch p makes of one.

    Attributes
    ----------
    touches
        The rows (k, j).
    parents
        The turn that each touch divides in two.
    sides
        For each touch the touches at which the part of facet j that it divides starts and ends, or -1.
    pieces
        Polygons that close separately, those with fewest corners first.
    flat
        For a stack touch the crease that is closed and the crease at the tip that is flat, else ().
    """

    touches: tuple[Row, ...]
    parents: tuple[int, ...]
    sides: tuple[tuple[int, int], ...]
    pieces: tuple[Polygon, ...]
    flat: tuple[int, ...] = ()

    def crease(self, turn: int, degree: int) -> int:
        """Return the crease of a turn."""
        return turn if turn < degree else self.touches[(turn - degree) // 2][0]


def pinch(whole: Pinched, degree: int, rows: Collection[Row]) -> list[Pinched]:
    """List the ways to pinch one more time, at one of `rows`."""
    p, out = len(whole.touches), []
    for at, piece in enumerate(whole.pieces):
        m = len(piece)
        for a, b in itertools.product(range(m), repeat=2):
            row = whole.crease(piece[a][0], degree), piece[b][1]
            # pieces of (a - b) and m + 1 - (a - b) corners (mod m), three at least in each
            if not 3 <= (a - b) % m <= m - 2 or row not in rows:
                continue
            turn, facet, start, end = piece[b]
            after = [piece[(b + 1 + c) % m] for c in range((a - b - 1) % m)]
            before = [piece[(a + 1 + c) % m] for c in range((b - a - 1) % m)]
            one = ((degree + 2 * p, facet, p, end), *after)
            two = ((degree + 2 * p + 1, *piece[a][1:]), *before, (turn, facet, start, p))
            rest = [q for i, q in enumerate(whole.pieces) if i != at]
            out.append(
                Pinched(
                    (*whole.touches, row),
                    (*whole.parents, piece[a][0]),
                    (*whole.sides, (start, end)),
                    tuple(sorted([*rest, one, two], key=len)),
                )
            )
    return out


def _shape(pinched: Pinched, degree: int) -> frozenset[tuple[Row, ...]]:
    """Return the pieces without the order of the touches that made them: corners and sides by crease and facet."""
    shapes = set()
    for piece in pinched.pieces:
        names = [(pinched.crease(corner[0], degree), corner[1]) for corner in piece]
        first = names.index(min(names))
        shapes.add(tuple(names[first:] + names[:first]))
    return frozenset(shapes)


def _stacked(sectors: tuple[float, ...], rows: Collection[Row]) -> list[Pinched]:
    n, rule = len(sectors), stack_rule(sectors)
    whole = tuple((i, i, -1, -1) for i in range(n))
    out = []
    for i in range(n):
        row = int(rule.row[i, 0]), int(rule.row[i, 1])
        if rule.end[i] >= 0 and row in rows:
            out.append(Pinched((row,), (), (), (whole,), (i, int(rule.end[i]))))
    return out


@dataclass(frozen=True, eq=False)
class StratumFamily:
    """Strata of equally many pinches as arrays: T ways to pinch (P pieces of at most M corners), R strata.

    Attributes
    ----------
    pinched
        The T ways.
    turn, facet, start, end
        By corner, [T, P, M]: `Corner`; turn -1 where a piece has fewer corners.
    way
        Position in `pinched` of each stratum, [R].
    at_limit
        Which creases are closed, [R, N], bool.
    tip_closed
        Whether crease k of the (only) touch is among them, [R].
    """

    pinched: tuple[Pinched, ...]
    turn: np.ndarray
    facet: np.ndarray
    start: np.ndarray
    end: np.ndarray
    way: np.ndarray
    at_limit: np.ndarray
    tip_closed: np.ndarray


def _family(ways: list[Pinched], n: int, most: int) -> StratumFamily:
    """Write ways to pinch as arrays and list the closed creases, at most `most`, of each."""
    pieces = len(ways[0].pieces)
    widest = max(len(piece) for way in ways for piece in way.pieces)
    corners = np.full((len(ways), pieces, widest, 4), -1)
    for t, way in enumerate(ways):
        for p, piece in enumerate(way.pieces):
            corners[t, p, : len(piece)] = piece
    sizes = range(min(most + 1, n) + 1)
    chosen = [list(c) for size in sizes for c in itertools.combinations(range(n), size)]
    masks = np.zeros((len(chosen), n), bool)
    for mask, creases in zip(masks, chosen, strict=True):
        mask[creases] = True
    # bookkeeping: `used` counts fully folded creases by piece, `left` how many each piece can spare
    way_of, at_limit, tip_closed = [], [], []
    for t, way in enumerate(ways):
        own = [np.isin(np.arange(n), [c[0] for c in piece]) for piece in way.pieces]
        # three turns close a piece, so that all others may be fully folded
        room = np.array([len(piece) - 3 for piece in way.pieces])
        tips = [k for k, _ in way.touches] if not way.flat else []
        good = ~masks[:, tips].any(axis=1)
        if way.flat:
            good &= masks[:, way.flat[0]] & ~masks[:, way.flat[1]]
            room -= 1
        good &= masks.sum(axis=1) <= most + len(way.flat) // 2
        used = (masks[:, None, :] & np.array(own)[None]).sum(axis=2)
        for tip in (False, True):
            if tip and (len(tips) != 1 or room[-1] < 1):
                continue
            left = room - np.array([*[0] * (pieces - 1), int(tip)])
            closed = masks[good & (used <= left).all(axis=1)]
            if tip:
                closed = closed[closed.sum(axis=1) < most] | (np.arange(n) == tips[0])
            way_of.append(np.full(len(closed), t))
            at_limit.append(closed)
            tip_closed.append(np.full(len(closed), tip))
    turn, facet, start, end = np.moveaxis(corners, -1, 0)
    where = np.concatenate(way_of), np.concatenate(at_limit), np.concatenate(tip_closed)
    return StratumFamily(tuple(ways), turn, facet, start, end, *where)


@dataclass(frozen=True, eq=False)
class ContactStrata:
    """Every listed stratum with a touch, of one vertex.

    Attributes
    ----------
    families
        Stack touches, one pinch, two pinches (those that there are); a stratum's number counts through them.
    touches
        How many touches each has, [R].
    closed
        How many closed creases, [R].
    label
        Equal for strata with the same touches and closed creases, [R]: two creases on one facet, in either order.
    """

    families: tuple[StratumFamily, ...]
    touches: np.ndarray
    closed: np.ndarray
    label: np.ndarray

    def __len__(self) -> int:
        return len(self.touches)

    def words(self, number: int) -> str:
        """Name a stratum; creases and facets 1-based."""
        family, r = self.find(number)
        way = family.pinched[family.way[r]]
        text = ", ".join(f"crease {k + 1} on facet {j + 1}" for k, j in way.touches)
        at_limit = [str(i + 1) for i in np.flatnonzero(family.at_limit[r])]
        return text + (f"; closed: {', '.join(at_limit)}" if at_limit else "")

    def numbers(self, rows: Iterable[Row], closed: Iterable[int]) -> np.ndarray:
        """Return the strata with just these touches and closed creases; none where they are not listed."""
        touches, at_limit, out, seen = frozenset(rows), set(closed), [], 0
        for family in self.families:
            same = [t for t, way in enumerate(family.pinched) if frozenset(way.touches) == touches]
            mask = np.isin(np.arange(family.at_limit.shape[1]), list(at_limit))
            is_here = np.isin(family.way, same) & (family.at_limit == mask).all(axis=1)
            out.append(np.flatnonzero(is_here) + seen)
            seen += len(family.way)
        return np.concatenate([np.zeros(0, int), *out])

    def find(self, number: int) -> tuple[StratumFamily, int]:
        """Return the family of a stratum and its position there."""
        for family in self.families:
            if number < len(family.way):
                return family, number
            number -= len(family.way)
        raise IndexError("there are fewer strata")


@lru_cache(maxsize=32)
def list_strata(sectors: tuple[float, ...], rows: frozenset[Row]) -> ContactStrata:
    """List the strata with touches of a vertex without symmetry.

    Parameters
    ----------
    sectors
        Sector angles of all N facets [rad].
    rows
        The rows (k, j) that are modelled.

    Returns
    -------
    ContactStrata
        All up to degree `MOST_FULL`; above, those with few closed creases.
    """
    n = len(sectors)
    whole = Pinched((), (), (), (tuple((i, i, -1, -1) for i in range(n)),))
    once = pinch(whole, n, rows)
    again = once if n <= MOST_TWICE else []
    # two touches in either order make the same pieces
    twice = {_shape(way, n): way for first in again for way in pinch(first, n, rows)}
    many = n > MOST_FULL
    families = [
        _family(ways, n, most)
        for ways, most in (
            (_stacked(sectors, rows), MOST_FOLDED if many else n),
            (once, MOST_FOLDED if many else n),
            (list(twice.values()), 0 if many else n),
        )
        if ways
    ]
    touches = [np.array([len(f.pinched[t].touches) for t in f.way], int) for f in families]
    closed = [f.at_limit.sum(axis=1) for f in families]
    groups: dict[frozenset[Row], int] = {}
    keys = []
    for f in families:
        group = [groups.setdefault(frozenset(w.touches), len(groups)) for w in f.pinched]
        keys.append(np.array(group)[f.way] * 2**n + f.at_limit @ 2 ** np.arange(n))
    none = [np.zeros(0, int)]
    _, label = np.unique(np.concatenate([*keys, *none]), return_inverse=True)
    number_of, closed_of = (np.concatenate([*parts, *none]) for parts in (touches, closed))
    return ContactStrata(tuple(families), number_of, closed_of, label)
