"""How a symmetric vertex closes, from the product of all its folds and from nothing else.

The whole vertex, the fold angles of an orbit put in at each of its creases, closes where q = Q(b_1, x_1) .. Q(b_N,
x_N) is +1: where the scalar of this unit quaternion is 1. A piece of the vertex has a number c of its own: the scalar
of a period and its sectors, or -n_1 . H n_k of a wedge. That q has the scalar -T_n(c), T_n Chebyshev's polynomial, n
the order of the group, is an identity between polynomials in the sines and cosines of half angles; it is not assumed
but compared at fold angles drawn at random (a false one would hold there by accident only).

So a vertex is closed where T_n(c) + 1 = 0, and each root of this polynomial, isolated by FLINT, is a set of closed
states that a proof has to cover: it is refused where the tree of one is missing. At the root -1, which is there for
odd n, the period is no turn at all: more than one equation, those of the piece.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Protocol

from flint import arb, ctx, fmpz_poly

from origami_nlp.pattern import Scene
from origami_nlp.proof.check_points import Refused

BITS = 256
"""To which roots are known: more than anything is computed with."""
DRAWN = 8
"""Fold angles at which the identity is compared."""
AGREES = 1e-9
"""What is left of it there, at most: sectors are known to 1e-15."""


@lru_cache(maxsize=64)
def closing_numbers(order: int) -> tuple[Any, ...]:
    """Return balls that hold the roots of T_n(c) + 1, the largest first; -1 exactly.

    Parameters
    ----------
    order
        n, from 1.

    Returns
    -------
    tuple of arb
        Distinct roots: the numbers c of closed states.
    """
    polynomial = fmpz_poly.chebyshev_t(order) + 1
    with ctx.workprec(BITS):
        found: Any = polynomial.complex_roots()
    roots = [root.real for root, _ in found]
    roots.sort(key=lambda v: -float(v.mid()))
    if not polynomial(-1):
        roots[-1] = arb(-1)
    return tuple(roots)


def whole_vertex(scene: Scene, sectors: Sequence[Any], angles: Sequence[Any]) -> list[Any]:
    """Multiply all folds of a vertex.

    Parameters
    ----------
    scene
        With the orbits of its creases.
    sectors
        Balls of all sector angles, shape [N].
    angles
        Of the orbits, in the order of the creases on the rays of the piece, balls.

    Returns
    -------
    list
        q, [w, x, y, z].
    """
    places = sorted(set(scene.group.orbit))
    azimuth, q = arb(0), [arb(1), arb(0), arb(0), arb(0)]
    for orbit, sector in zip(scene.group.orbit, sectors, strict=True):
        s, c = (angles[places.index(orbit)] / 2).sin_cos()
        b, a = azimuth.sin_cos()
        x, y = a * s, b * s
        # q Q(b, angle), b = (cos azimuth, sin azimuth, 0)
        w, i, j, k = q
        q = [
            w * c - i * x - j * y,
            w * x + i * c - k * y,
            w * y + j * c + k * x,
            i * y - j * x + k * c,
        ]
        azimuth = azimuth + sector
    return q


class Numbered(Protocol):
    """A piece of a vertex: `count` fold angles, its number c, and the whole vertex that it makes."""

    count: int

    def number(self, angles: Sequence[Any]) -> Any:
        """Return c at balls of fold angles."""

    def vertex(self, angles: Sequence[Any]) -> list[Any]:
        """Return the product of all folds, [w, x, y, z]."""


def check_identity(scene: Scene, piece: Numbered) -> None:
    """Compare the scalar of the whole vertex with -T_n of the piece's number, at fold angles drawn at random.

    Raises
    ------
    Refused
        If they differ: what is checked of the piece says nothing about the vertex.
    """
    draw = random.Random(0)
    polynomial = fmpz_poly.chebyshev_t(scene.group.order)
    for _ in range(DRAWN):
        angles = [arb(draw.uniform(-3.0, 3.0)) for _ in range(piece.count)]
        value = arb(0)
        number = piece.number(angles)
        # Horner's rule, the highest coefficient first
        for coefficient in reversed(polynomial.coeffs()):
            value = value * number + coefficient
        scalar = piece.vertex(angles)[0]
        if not (scalar.overlaps(-value) and (scalar + value).abs_upper() < AGREES):
            raise Refused("the whole vertex is not what its piece, repeated, makes")
