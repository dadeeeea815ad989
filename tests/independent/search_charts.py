"""All closed states over grids of two fold angles: every chart of the two-dimensional manifold.

Where closure is regular, some two of the fold angles are local coordinates, so charts by all pairs
cover everything but isolated singular states.  The others follow from positions of the creases on
the sphere: a crease in a known mirror plane and at a known distance from a known crease has two
places.  No state is produced by iteration.  Signs: the fold angle of crease i is

    phi_i = atan2(det(c_{i-1}, c_i, c_{i+1}), (c_{i-1} x c_i) . (c_i x c_{i+1})).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from tests.independent.search_manifold import Piece

FLIP = np.array([1.0, -1.0, 1.0])


def dihedral(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Fold angle at crease b between its neighbours a and c."""
    first, second = np.cross(a, b), np.cross(b, c)
    return np.arctan2(np.einsum("...x,...x", first, c), np.einsum("...x,...x", first, second))


def _unit(angle: np.ndarray) -> np.ndarray:
    return np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=-1)


def _next(a: np.ndarray, normal: np.ndarray, length: float, fold: np.ndarray) -> np.ndarray:
    """Crease at `length` from a, on a facet folded by `fold` from the facet with `normal` before a."""
    ahead = np.cross(normal, a)
    side = np.cos(fold)[..., None] * ahead + np.sin(fold)[..., None] * normal
    return np.cos(length) * a + np.sin(length) * side


def _angle(cosine: np.ndarray) -> np.ndarray:
    """Arc cosine, nan beyond one by more than rounding."""
    return np.arccos(np.where(np.abs(cosine) < 1 + 1e-13, np.clip(cosine, -1, 1), np.nan))


def _places(c: np.ndarray, cosine: np.ndarray) -> Iterator[np.ndarray]:
    """Points of the mirror plane y = 0 whose product with c is `cosine`; nan where there are none."""
    reach = np.hypot(c[..., 0], c[..., 2])
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = _angle(cosine / reach)
    for sign in (1, -1):
        yield _unit(np.arctan2(c[..., 2], c[..., 0]) + sign * spread)


def _apex(a: np.ndarray, b: np.ndarray, to_a: float, to_b: float, fold: np.ndarray) -> np.ndarray:
    """Point at distance to_a from a and to_b from b, with sign(det(a, point, b)) that of `fold`."""
    ab = np.einsum("...x,...x", a, b)
    p, q = np.cos(to_a), np.cos(to_b)
    normal = np.cross(a, b)
    squared = np.einsum("...x,...x", normal, normal)
    with np.errstate(invalid="ignore", divide="ignore"):
        u, v = (p - q * ab) / squared, (q - p * ab) / squared
        inside = u[..., None] * a + v[..., None] * b
        rest = 1 - np.einsum("...x,...x", inside, inside)
        height = np.sqrt(np.where(rest > -1e-12, np.maximum(rest, 0), np.nan) / squared)
    return inside - (np.sign(fold) * height)[..., None] * normal


def half_vertex(chain: np.ndarray, s: np.ndarray, t: np.ndarray, pair: str) -> Iterator[np.ndarray]:
    """Creases c_1..c_4 [..., 4, 3] of half a vertex, mirror y = 0, where the named angles are s, t."""
    a1, a2, a3 = chain
    zero = 0 * s
    e1, e2, e3 = np.broadcast_arrays(*np.eye(3)[:, None], zero[..., None])[:3]
    if pair == "12":
        c1 = e1
        c2 = _next(c1, e3, a1, s / 2)
        c3 = _next(c2, np.cross(c1, c2) / np.sin(a1), a2, t)
        for c4 in _places(c3, np.cos(a3) + zero):
            yield np.stack([c1, c2, c3, c4], axis=-2)
    elif pair == "14":
        c1 = e1
        c2 = _next(c1, e3, a1, s / 2)
        # c_3 turned about e2 to c_4 = e1 there; folds at c_4 read from the other side of the chain
        c = np.cos(a3) * e1 + np.sin(a3) * (
            np.cos(t / 2)[..., None] * e2 - np.sin(t / 2)[..., None] * e3
        )
        level = np.cos(a2) - c[..., 1] * c2[..., 1]
        even = c[..., 0] * c2[..., 0] + c[..., 2] * c2[..., 2]
        odd = c[..., 0] * c2[..., 2] - c[..., 2] * c2[..., 0]
        with np.errstate(invalid="ignore", divide="ignore"):
            spread = _angle(level / np.hypot(even, odd))
        for sign in (1, -1):
            d = np.arctan2(odd, even) + sign * spread
            co, si = np.cos(d), np.sin(d)
            turned = np.stack(
                [co * c[..., 0] - si * c[..., 2], c[..., 1], si * c[..., 0] + co * c[..., 2]],
                axis=-1,
            )
            yield np.stack([c1, c2, turned, _unit(d)], axis=-2)
    elif pair == "23":
        c1 = e1
        c2 = _next(c1, e3, a1, zero)
        c3 = _next(c2, np.cross(c1, c2) / np.sin(a1), a2, s)
        c4 = _next(c3, np.cross(c2, c3) / np.sin(a2), a3, t)
        normal = np.cross(c1, c4)
        length = np.linalg.norm(normal, axis=-1, keepdims=True)
        with np.errstate(invalid="ignore", divide="ignore"):
            normal = normal / length
        for sign in (1, -1):
            frame = np.stack([c1, sign * normal, np.cross(c1, sign * normal)], axis=-2)
            yield np.einsum("...ix,...kx->...ki", frame, np.stack([c1, c2, c3, c4], axis=-2))
    elif pair == "24":
        c4 = e1
        c3 = np.cos(a3) * e1 + np.sin(a3) * (
            np.cos(t / 2)[..., None] * e2 - np.sin(t / 2)[..., None] * e3
        )
        across = np.cos(a1) * np.cos(a2) - np.sin(a1) * np.sin(a2) * np.cos(s)
        for c1 in _places(c3, across):
            c2 = _apex(c1, c3, a1, a2, s)
            yield np.stack([c1, c2, c3, c4], axis=-2)
    else:  # "34" and "13" are "12" and "24" of the chain read backwards, reflected in z = 0
        other = {"34": "12", "13": "24"}[pair]
        for creases in half_vertex(chain[::-1], t, s, other):
            yield creases[..., ::-1, :] * np.array([1.0, 1.0, -1.0])


def quarter_vertex(
    chain: np.ndarray, s: np.ndarray, t: np.ndarray, pair: str
) -> Iterator[np.ndarray]:
    """Creases c_1..c_3 [..., 3, 3] of a quarter, mirrors y = 0 and x = 0, where the angles are s, t."""
    a1, a2 = chain
    zero = 0 * s
    if pair == "12":
        c1, e3 = np.broadcast_arrays(np.eye(3)[0], np.eye(3)[2], zero[..., None])[:2]
        c2 = _next(c1, e3, a1, s / 2)
        c3 = _next(c2, np.cross(c1, c2) / np.sin(a1), a2, t)
        free = np.stack([c1, c2, c3], axis=-2)
        turn = np.arctan2(c3[..., 0], c3[..., 2])
        for half_turn in (0, np.pi):
            co, si = np.cos(turn + half_turn)[..., None], np.sin(turn + half_turn)[..., None]
            x, y, z = free[..., 0], free[..., 1], free[..., 2]
            yield np.stack([co * x - si * z, y, si * x + co * z], axis=-1)
    elif pair == "23":
        for creases in quarter_vertex(chain[::-1], t, s, "12"):
            yield creases[..., ::-1, :][..., [1, 0, 2]]
    else:
        y, x = np.sin(a1) * np.cos(s / 2), np.sin(a2) * np.cos(t / 2)
        with np.errstate(invalid="ignore"):
            z = np.sqrt(1 - x**2 - y**2)
        for sign in (1, -1):
            c2 = np.stack([x, y, sign * z], axis=-1)
            u = np.arctan2(sign * z, x) - np.arctan2(np.sin(a1) * np.sin(s / 2), np.cos(a1) + zero)
            v = np.arctan2(sign * z, y) - np.arctan2(np.sin(a2) * np.sin(t / 2), np.cos(a2) + zero)
            c1 = _unit(u)
            c3 = _unit(v)[..., [1, 0, 2]]
            yield np.stack([c1, c2, c3], axis=-2)


def fold_angles(creases: np.ndarray, half: bool) -> np.ndarray:
    """Fold angles of the variables, in (-pi, pi], from the creases of the piece."""
    n = creases.shape[-2]
    c = [creases[..., i, :] for i in range(n)]
    end = FLIP if half else np.array([-1.0, 1.0, 1.0])
    around = [c[1] * FLIP, *c, c[-2] * end]
    return np.stack([dihedral(*around[i : i + 3]) for i in range(n)], axis=-1)


def pairs(piece: Piece) -> list[str]:
    """Names of all charts: two fold angles of the piece each, 1-based."""
    return ["".join(map(str, p)) for p in itertools.combinations(range(1, piece.size + 1), 2)]


def sheets(piece: Piece, s: np.ndarray, t: np.ndarray, pair: str) -> Iterator[np.ndarray]:
    """Closed states [..., n] over s, t (broadcast), one array for each root; nan where there is none."""
    s, t = np.broadcast_arrays(s, t)
    place = half_vertex if piece.half else quarter_vertex
    for creases in place(piece.chain, s, t, pair):
        yield fold_angles(creases, piece.half)


def closed(piece: Piece, x: np.ndarray, tolerance: float = 1e-9) -> np.ndarray:
    """Return which states [..., n] are real and close (beyond a mirror, fold angles wrap and do not)."""
    flat = x.reshape(-1, x.shape[-1])
    ok = np.isfinite(flat).all(axis=1)
    ok[ok] = np.abs(piece.closure(flat[ok])[0]).max(axis=1) <= tolerance
    return ok.reshape(x.shape[:-1])
