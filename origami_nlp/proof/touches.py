"""Full contact: every critical point of the states whose facets do not cross, also where facets touch.

A local minimum x has fold limits P and gaps T closed and is a minimum among {closure, P, T}, also where the admissible
set is a union near x.  So it is critical in the sense of Fritz John, without a constraint qualification: with f degrees
of freedom and |P| + |T| < f all minors of [G | C | W] with one column more than there are equations vanish on the free
creases (W the gradients of T).  Where |P| + |T| = f every closed state is a candidate; where more is closed, x is among
the candidates of some f of the contacts.  Strata with |P| + |T| <= f are therefore all.  Those with T empty are treated
within fold limits; for f = 2 there remain one touch with at most one closed crease, and two touches.  A touch that
follows from closed creases (all between the ray and the facet are fully folded) holds on all of {closure, P}: its state
is one of that stratum.

Two kinds of strata of a vertex of degree five are left out as well, since x is on another stratum too:
- Sectors e and e+1 equal, crease e between them fully folded: rays e-1 and e+1 coincide, and a gap of one of them off a
  facet that the other bounds vanishes on all of {closure, crease e fully folded}.
- Ray k on facet k+2 and ray k+2 on facet k+4, sectors k and k+1 together less than pi.  If the rays differ, the great
  circles of both facets coincide, and creases k+3 and k+4 are at 0 or +-pi: one at +-pi is a stratum with one touch;
  both at 0 is the flat state, as facets k+2 to k+4 are then an arc longer than pi.  If the rays are one, crease k+1 is
  fully folded between equal sectors: the case before.

Gaps are those of the vertex, which leaves out what cannot touch.  On D_1 (four rays) facets 1 and 3 meet where rays 1
and 4 do, or where one of them lies on the mirror, its crease closed: the row is that the rays meet.

At each critical point the signs of all rays off all facets are enclosed (`separation`).  Where facets cross it is
dropped.  Where all are apart but for P and T, of independent gradients, the signs of the Lagrange multipliers and the
index decide as within fold limits.  What remains are stacks of facets: there the package's exact test decides whether
the layers have an order (`PatternProblem.refuses`), and where gaps are closed its cone the verdict (`classify`).

Undecided or refused, by name: more than two degrees of freedom, C_n, wedges of more rays, sectors of pi and more, sets
of dimension one that contacts hold.  Singular flat foldings are listed.

What vanishes on a stratum where facets touch, over boxes: closure, gaps, minors with slopes of gaps beside it.

Arcs i and j of the sphere, shorter than pi, have a common point exactly where none of the four numbers n_i.c_j,
-n_i.c_{j+1}, -n_j.c_i, n_j.c_{i+1} has the opposite sign of another; they cross where all have one sign strictly.
Where some are exactly zero - creases that are fully folded put rays into planes of facets - the package's test of
layers has the word.

Ray k on facet j, inside its arc: facets k - 1 and k touch it from one side where rays k - 1 and k + 1 are on this side,
and cross it where they are on different ones.  Rays of a D_1 wedge on each other, on the mirror: the facets touch where
their planes differ.  Images of a wedge are apart as long as its rays are between the mirrors.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import INPUT_TOL, OUTSIDE, RESOLVED, SUMMED
from origami_nlp.proof.boxes import Boxes, BoxProblem, strata
from origami_nlp.proof.pieces import Piece, ReducedVertex, piece_of
from origami_nlp.proof.rows import (
    UNIT,
    Affine,
    Chain,
    Gap,
    Quadratic,
    Triples,
    joined,
    number,
    variables,
)

Three = tuple[int, int, int]


class TouchedPiece:
    """The rows of a piece with some gaps closed.

    Ray k on facet j is reached from both ends of the facet, by fewer folds than the whole loop has: the gap is a row
    both ways, and boxes go where the ray is certainly beyond an end.

    Parameters
    ----------
    piece
        Without touches.
    touches
        Gaps that are closed.
    """

    def __init__(self, piece: Piece, touches: Sequence[Gap]) -> None:
        self.piece, self.size, chain = piece, piece.size, piece.chain
        gaps, refused, slopes = list[Three](), list[Three](), list[Three]()
        # of each gap the number of the slope by each variable
        self.columns: list[dict[int, int]] = []
        for touch in touches:
            ways, beyond, slope = _rows(chain, touch)
            gaps, refused = gaps + ways, refused + beyond
            self.columns.append({v: len(slopes) + i for i, v in enumerate(slope)})
            slopes += slope.values()
        # rays on each other are not opposite: their cosine is 1
        met = [(chain.first, chain.up, 3)] if touches[0].kind == "meet" else []
        self.gaps, self.refused, self.slopes, self.met = (
            Triples(chain, some) for some in (gaps, refused, slopes, met)
        )
        many = piece.rank + len(touches) + 1
        self.subsets = list(itertools.combinations(range(self.size), many))

    def rows(
        self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, np.ndarray]:
        """Enclose closure, gaps, refusals and minors over boxes, and say which of them hold there, [R, K].

        Parameters
        ----------
        lower, upper
            Shape [n, K] [rad].
        pins
            -1, 0 or +1, shape [n, K].
        """
        piece = self.piece
        middle, half = variables(lower, upper)
        folded, torques = piece.chain.fold(middle, half), piece.torques(middle, half)
        met = self.met.at(folded)
        met += number(0 * met.value - 1.0, 4 * UNIT, self.size)
        rows = [q.affine() for q in (piece.closure(folded), self.gaps.at(folded), met)]
        rows.append(refusal(self.refused.at(folded).affine()))
        if self.subsets:
            known, slopes = piece.minors(folded, torques), self.slopes.at(folded)
            base = {tuple(s): known[i] for i, s in enumerate(piece.subsets.tolist())}
            for column in self.columns:
                base = expanded(base, {v: slopes[i] for v, i in column.items()}, self.size)
            rows += [Quadratic(*(v[None] for v in base[s].parts)).affine() for s in self.subsets]
        every = joined(rows)
        asked = np.ones(every.centre.shape, dtype=bool)
        for i, s in enumerate(self.subsets, start=len(asked) - len(self.subsets)):
            asked[i] = (pins == 0)[list(s)].all(axis=0)
        return every, asked


def _rows(chain: Chain, touch: Gap) -> tuple[list[Three], list[Three], dict[int, Three]]:
    """Return a touch's gap, each way; what is certainly not positive; and its slopes, by variable."""
    if touch.kind == "facet":
        ways = chain.ways(*touch.rays)
        beyond = [t for w in ways for t in chain.inside(*w)]
        return [chain.gap(*w) for w in ways], beyond, chain.gap_slopes(*ways[0])
    k, *meets = touch.rays
    k = 3 if meets else k
    steps = range(k + 1, chain.steps) if touch.kind == "end" else range(k)
    ends = (k, chain.last) if touch.kind == "end" else (chain.up if meets else chain.first, k)
    slope = {int(chain.variable[i]): (ends[0], i, ends[1]) for i in steps if chain.folds[i]}
    gap = (chain.first, 0, 3) if meets else chain.closed(k, kind=touch.kind)
    return [gap], [], slope


def expanded(
    minors: dict[tuple[int, ...], Quadratic], column: dict[int, Quadratic], n: int
) -> dict[tuple[int, ...], Quadratic]:
    """Return the minors with one column more, expanded along it, by their rows."""
    many = len(next(iter(minors))) + 1
    out = {}
    for rows in itertools.combinations(range(n), many):
        terms = [
            (minors[(*rows[:a], *rows[a + 1 :])] * column[v]).times((-1.0) ** a)
            for a, v in enumerate(rows)
            if v in column
        ]
        if terms:
            out[rows] = sum(terms[1:], terms[0])
    return out


def refusal(row: Affine) -> Affine:
    """Return a row that excludes boxes where another is certainly positive, and says nothing elsewhere."""
    out = (row.centre > row.radius()).astype(float)
    return Affine(out, 0 * row.slopes, 2.0 - 1.5 * out)


@dataclass(frozen=True, eq=False)
class ContactStratum:
    """Touches, and the boxes of the fold limits that go with them.

    Attributes
    ----------
    touches
        Gaps that are closed.
    posed
        Their rows.
    start
        Boxes.
    """

    touches: tuple[Gap, ...]
    posed: BoxProblem
    start: Boxes


def gaps_of(vertex: ReducedVertex) -> tuple[list[Gap], list[tuple[int, int]]]:
    """Return what may touch, and pairs of facets that may cross, by their first rays."""
    rays, n = len(vertex.has_crease), vertex.scene.degree
    if vertex.kind == "C":
        every = ((i, j) for i in range(n) for j in range(i + 2, min(n, i + n - 1)))
        pairs = [pair for pair in every if can_cross(vertex, *pair)]
        ends = ((k % n, j) for one in pairs for i, j in (one, one[::-1]) for k in (i, i + 1))
        # beside a facet a ray lies in its plane where the crease between is closed
        far = [one for one in dict.fromkeys(ends) if 3 <= (one[0] - one[1]) % n <= n - 2]
        return [Gap("facet", one) for one in far], pairs
    if vertex.order > 1:  # a mirror ray stays on its own side of the axis
        return [Gap("end", (0,)), Gap("start", (rays - 1,))], []
    creases = [ray.crease for ray in vertex.scene.group.rays]
    if rays == 4 and None not in creases and can_cross(vertex, creases[0], creases[2]):  # type: ignore[arg-type]
        return [Gap("meet", (3, 0)), Gap("meet", (0, 2))], [(0, 2)]
    return [], []


def can_cross(vertex: ReducedVertex, i: int, j: int) -> bool:
    """Return whether facets i and j (from 0) of a vertex could ever cross.

    A common point splits the polygon into two closed loops.  Each closes only if the parts of the two facets that
    belong to it bridge what the longest sector between them has over the others; both share sectors i and j.
    """
    sector_angles = vertex.scene.vertex.sector_angles
    n = len(sector_angles)
    ways = range(i + 1, i + (j - i) % n), range(j + 1, j + (i - j) % n)
    chains = [[sector_angles[m % n] for m in way] for way in ways]
    missing = sum(max(0.0, 2 * max(chain) - sum(chain)) for chain in chains)
    return missing < sector_angles[i] + sector_angles[j] - OUTSIDE


def why_no_touches(vertex: ReducedVertex) -> str:
    """Return why touches of a vertex are not proved here; "" where they are."""
    rays, sectors, (gaps, _) = len(vertex.has_crease), vertex.sectors, gaps_of(vertex)
    if max(vertex.scene.vertex.sector_angles) >= math.pi - INPUT_TOL:
        return "a sector of 180 degrees or more"
    if vertex.kind == "C" and vertex.order > 1:
        return f"touches with symmetry {vertex.problem.symmetry} are not proved"
    if vertex.kind == "D":
        fits = rays == 3 or (vertex.order == 1 and rays == 4 and all(vertex.has_crease))
        # between equal sectors a crease that is fully folded puts its neighbours on each other, and closes gaps
        equal = vertex.order > 1 and fits and bool(abs(sectors[0] - sectors[1]) <= SUMMED)
        if not fits or equal or (gaps and vertex.scene.limits):
            with_stops = " with stops" * bool(vertex.scene.limits) + " of equal sectors" * equal
            return f"touches of a {vertex.problem.symmetry} wedge of {rays} rays{with_stops} are not proved"
    if gaps and vertex.dof > 2:
        return f"{vertex.dof} degrees of freedom: touches are proved for at most 2"
    return ""


def contact_strata(vertex: ReducedVertex) -> Iterator[ContactStratum]:
    """List the strata with touches of a vertex that `why_no_touches` has nothing against."""
    dof, piece = vertex.dof, piece_of(vertex)
    patterns = strata(vertex.size, vertex.problem.fold_limits)
    flat = vertex.problem.fold_limits.folded_flat(patterns.pins.T).T
    at_limit = (patterns.pins != 0).sum(axis=0)
    for touches in _sets(vertex):
        # |P| + |T| <= f
        allowed = at_limit <= dof - len(touches)
        posed = TouchedPiece(piece, touches)
        if touches[0].kind == "meet":  # the gap off facet 0 is none where that lies on the mirror
            on = patterns.pins[0] != 0
            allowed &= on == (touches[0].rays != (3, 0))
        for crease in range(vertex.size if vertex.kind == "C" else 0):
            if any(_says_nothing(vertex, t, crease) for t in touches):
                allowed &= flat[crease] == 0
        if allowed.any():
            yield ContactStratum(touches, posed, patterns[allowed])


def _sets(vertex: ReducedVertex) -> Iterator[tuple[Gap, ...]]:
    """Sets of gaps that may be closed at once; of a wedge one: both are a crease fully folded between equal sectors."""
    for count in range(1, vertex.dof + 1 if vertex.kind == "C" else 2):
        for touches in itertools.combinations(gaps_of(vertex)[0], count):
            if not _on_each_other(vertex, touches):
                yield touches


def _says_nothing(vertex: ReducedVertex, touch: Gap, crease: int) -> bool:
    """Whether a ray lies on an edge of the facet it touches where a crease between equal sectors is fully folded."""
    a, n = vertex.sectors, vertex.size
    if abs(a[crease - 1] - a[crease]) > SUMMED:
        return False
    ray, facet = touch.rays
    met = {(crease - 1) % n, (crease + 1) % n} - {ray}
    return len(met) == 1 and met <= {facet, (facet + 1) % n}


def _on_each_other(vertex: ReducedVertex, touches: tuple[Gap, ...]) -> bool:
    """Whether two contacts close at once only with coincident rays, a fully folded crease, or all flat (degree 5)."""
    a, n = vertex.sectors, vertex.size
    if len(touches) != 2 or n != 5:
        return False
    one, two = touches[0].rays, touches[1].rays
    for (k, j), other in ((one, two), (two, one)):
        if j == (k + 2) % n and other == (j, (j + 2) % n):
            return bool(a[k] + a[(k + 1) % n] < math.pi - RESOLVED)
    return False


APART, CROSSED, UNCLEAR = 1, -1, 0


def separation(
    vertex: ReducedVertex,
    x: np.ndarray,
    radius: np.ndarray,
    pins: np.ndarray,
    touches: tuple[Gap, ...],
) -> tuple[np.ndarray, np.ndarray]:
    """Say what facets do at R states, where some gaps are closed.

    Parameters
    ----------
    vertex
        With contact ``full``.
    x, radius, pins
        States [R, n], how well each is known [R], and the strata [R, n].
    touches
        What is closed.

    Returns
    -------
    verdicts : numpy.ndarray
        `APART` but for the touches, `CROSSED`, or `UNCLEAR`, [R].
    sides : numpy.ndarray
        On which side each touch is open, +1 or -1 of its gap; 0 where that is unclear, [R, T].
    """
    chain = piece_of(vertex).chain
    n = chain.around
    facets = n if vertex.kind == "C" else n - 1
    # a root is known to its radius; pinned angles are +-pi exactly
    wide = np.where(pins == 0, radius[:, None], 0.0)
    low, high = np.nextafter(x - wide, -9.0), np.nextafter(x + wide, 9.0)
    folded = chain.fold(*variables(low.T, high.T))

    def signs(wanted: list[tuple[int, int, int]]) -> np.ndarray:
        return Triples(chain, wanted).at(folded).affine().signs()

    apart = [(k, j) for j in range(facets) for k in range(n) if k not in (j, (j + 1) % n)]
    known = signs([chain.gap(*chain.shortest(k, j)) for k, j in apart])
    off = dict(zip(apart, known, strict=True))
    level = np.zeros(len(x), dtype=int)
    found = [level + APART]
    gaps, pairs = gaps_of(vertex)
    walls = [g for g in gaps if g.kind in ("start", "end") and g not in touches]
    found += [*signs([chain.closed(*g.rays, kind=g.kind) for g in walls])]
    for i, j in pairs:
        ends = {(a, b) for k, b in ((i, j), (j, i)) for a in (k, (k + 1) % n)}
        if any(t.kind == "meet" or t.rays in ends for t in touches):
            continue
        v = np.stack(
            [
                off.get((j, i), level),
                -off.get(((j + 1) % n, i), level),
                -off.get((i, j), level),
                off.get(((i + 1) % n, j), level),
            ]
        )
        least, most = v.min(axis=0), v.max(axis=0)
        one = np.where((least > 0) | (most < 0), CROSSED, UNCLEAR)
        found.append(np.where((least < 0) & (most > 0), APART, one))
    sides = []
    for t in touches:
        if t.kind == "facet":
            k, j = t.rays
            before, after = (off.get(((k + s) % n, j), level) for s in (-1, 1))
            inside = (signs(chain.inside(*chain.shortest(k, j))) < 0).all(axis=0)
            sides.append(np.where(inside & (before == after), before, UNCLEAR))
            found.append(np.where(inside & (before * after < 0), CROSSED, np.abs(sides[-1])))
        elif t.kind == "meet":
            # gap (k, j) = -(angle of the rays) times a positive number, open where -turn is the angle's sign
            sides.append(np.where((pins == 0).all(axis=1), signs([(0, 1, 2)])[0], UNCLEAR))
            found.append(np.abs(sides[-1]))
        else:
            sides.append(level + 1)
    return np.min(found, axis=0), np.array(sides, dtype=int).reshape(len(touches), len(x)).T
