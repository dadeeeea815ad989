"""Which facets are apart, cross or touch at certified states: signs of rays off facets, over boxes.

Arcs i and j of the sphere, shorter than pi, have a common point exactly where none of the four numbers n_i.c_j,
-n_i.c_{j+1}, -n_j.c_i, n_j.c_{i+1} has the opposite sign of another; they cross where all have one sign strictly.
Where some are exactly zero - creases that are fully folded put rays into planes of facets - the package's test of
layers has the word.

Ray k on facet j, inside its arc: facets k - 1 and k touch it from one side where rays k - 1 and k + 1 are on this side,
and cross it where they are on different ones.  Rays of a D_1 wedge on each other, on the mirror: the facets touch where
their planes differ.  Images of a wedge are apart as long as its rays are between the mirrors.
"""

from __future__ import annotations

import numpy as np

from origami_nlp.proof.pieces import piece_of
from origami_nlp.proof.reduced import Gap, ReducedVertex
from origami_nlp.proof.rows import Triples, variables

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
    walls = [g for g in vertex.gaps if g.kind in ("start", "end") and g not in touches]
    found += [*signs([chain.closed(*g.rays, kind=g.kind) for g in walls])]
    for i, j in vertex.pairs:
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
