"""States with touching facets in closed form, to start searches from (`touches`: on which strata).

With Qx, Qz turns about e1 and e3, a polygon with turns t_i and sides a_i closes as an embedded one does exactly when

    Qx(t_1) Qz(a_1) Qx(t_2) Qz(a_2) ... Qx(t_m) Qz(a_m) = -1,

whatever the sum of its sides.  Where crease k touches facet j this product falls into those of the two pieces, which
must be -1 each, and the turn at crease k is t' + t'' -+ 2 pi.  Pieces that lie beside each other turn to the same side
at the touch, and |phi_k| <= pi, so

    phi_k = t' + t'' - 2 pi sign(t'),  sign(t') = sign(t''),  |t' + t''| >= pi.

The plain sum is the lift q = -1: the pieces cross.  The tip touches from the left of facet j, so that
det(c_j, c_{j+1}, c_k) >= 0, exactly where t' > 0.
"""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.problem import FoldLimits, close_three
from origami_nlp.starts.contact_strata import StratumFamily


def free_parameters(
    sectors: np.ndarray,
    family: StratumFamily,
    strata: np.ndarray,
    limits: FoldLimits,
    rng: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Draw where touches lie, the turns that are free, and which turns close each piece.

    Parameters
    ----------
    sectors
        Sector angles, [N].
    family, strata
        The strata, as positions in the family, [K].
    limits
        Where closed creases are held.
    rng
        Source of the draws.

    Returns
    -------
    positions : numpy.ndarray
        Arc from ray j to each touch, uniform on the part of facet j that it divides [rad], [K, touches].
    turns : numpy.ndarray
        Uniform in (-pi, pi); of closed creases their fold limits, 0 for the flat one of a stack touch,
        [K, N + 2 touches].
    rank : numpy.ndarray
        In each piece the three turns with the lowest rank close it, [K, N + 2 touches].
    """
    n, count = len(sectors), len(strata)
    pinches = len(family.pinched[0].parents)
    way = family.way[strata]
    low = np.zeros((count, pinches + 1))  # the last column: the facet's own end
    positions = low[:, :pinches]
    for p in range(pinches):
        facet = np.array([w.touches[p][1] for w in family.pinched])[way]
        ends = np.array([w.sides[p] for w in family.pinched])[way]
        every = np.arange(count)
        start = np.where(ends[:, 0] < 0, 0.0, low[every, ends[:, 0]])
        end = np.where(ends[:, 1] < 0, sectors[facet], low[every, ends[:, 1]])
        positions[:, p] = start + rng.random(count) * (end - start)
    at_limit = family.at_limit[strata]
    turns = rng.uniform(-math.pi, math.pi, (count, n + 2 * pinches))
    rank = rng.random(turns.shape)
    sides = np.where(at_limit, np.sign(turns[:, :n]), 0)
    turns[:, :n] = limits.hold(turns[:, :n], sides)
    # the three turns of lowest rank close a piece: those of touches first, never those that are held
    rank[:, :n] += 2.0 * at_limit
    rank[:, n:] -= 1.0
    if family.pinched[0].flat:
        flat = np.array([w.flat[1] for w in family.pinched])[way]
        turns[np.arange(count), flat] = 0.0
        rank[np.arange(count), flat] += 2.0
    return positions, turns, rank


def close_pinched(
    sectors: np.ndarray,
    family: StratumFamily,
    strata: np.ndarray,
    positions: np.ndarray,
    turns: np.ndarray,
    rank: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Close pinched polygons in closed form (module docstring).

    Parameters
    ----------
    sectors, family, strata, positions, turns, rank
        As in `free_parameters`.

    Returns
    -------
    x : numpy.ndarray
        Fold angles of those that close on the sheet of paper, [S, N] [rad].
    signs : numpy.ndarray
        Side of each touch, [S, touches].
    row : numpy.ndarray
        Position in `strata` of each, [S]; every one may have up to two solutions a piece.
    """
    n = len(sectors)
    row, turns, rank = np.arange(len(strata)), turns.copy(), rank.copy()
    pieces = family.turn.shape[1]
    tip = family.tip_closed[strata]
    for p in range(pieces):
        if p == pieces - 1 and tip.any():
            _close_the_tip(turns, rank, tip[row], family.turn[family.way[strata[row]]], n)
        row_of, solved, at = _close_piece(
            sectors, family, strata[row], positions[row], turns, rank, p
        )
        row, turns, rank = row[row_of], turns[row_of], rank[row_of]
        np.put_along_axis(turns, at, solved, axis=1)
    way = family.way[strata[row]]
    pinches = len(family.pinched[0].parents)
    signs = np.zeros((len(row), max(pinches, 1)), int)
    good = np.ones(len(row), bool)
    for t in reversed(range(pinches)):
        one, two = turns[:, n + 2 * t], turns[:, n + 2 * t + 1]
        parent = np.array([w.parents[t] for w in family.pinched])[way]
        whole = one + two
        closed = tip[row]
        # pieces on the same side of the touch, and |phi_k| <= pi (module docstring)
        good &= (one * two > 0) & ((np.abs(whole) >= math.pi) | closed)
        signs[:, t] = np.sign(one)
        # the lift q = +1
        whole = whole - np.copysign(2 * math.pi, one)
        whole = np.where(closed, -np.copysign(math.pi, one), whole)
        turns[np.arange(len(row)), parent] = whole
    if not pinches:
        at_limit = np.array([w.flat[0] for w in family.pinched])[way]
        signs[:, 0] = np.sign(turns[np.arange(len(row)), at_limit])
    return turns[good, :n], signs[good], row[good]


def _close_the_tip(
    turns: np.ndarray, rank: np.ndarray, tip: np.ndarray, corner: np.ndarray, n: int
) -> None:
    """Where crease k itself is closed: t' + t'' = +-pi gives the turn of the last piece (in place)."""
    last = corner[:, -1]
    second = (last == n + 1).any(axis=1)
    known = turns[np.arange(len(turns)), np.where(second, n, n + 1)]
    other = np.where(second, n + 1, n)
    i = np.flatnonzero(tip)
    turns[i, other[i]] = np.copysign(math.pi, known[i]) - known[i]
    rank[i, other[i]] = 2.0


def _close_piece(
    sectors: np.ndarray,
    family: StratumFamily,
    strata: np.ndarray,
    positions: np.ndarray,
    turns: np.ndarray,
    rank: np.ndarray,
    p: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Solve the three turns of lowest rank of piece p: which row each solution is of, the turns, and which they are."""
    way = family.way[strata]
    turn, facet = family.turn[way, p], family.facet[way, p]  # [K, M]
    there = turn >= 0
    every = np.arange(len(way))[:, None]
    spots = np.concatenate([positions, np.zeros((len(way), 1))], axis=1)
    start, end = family.start[way, p], family.end[way, p]
    length = np.where(end < 0, sectors[facet], spots[every, end])
    length = np.where(there, length - np.where(start < 0, 0.0, spots[every, start]), 0.0)
    order = np.where(there, rank[every, turn], np.inf)
    chosen = np.sort(np.argsort(order, axis=1)[:, :3], axis=1)
    given = np.where(there, turns[every, turn], 0.0)
    np.put_along_axis(given, chosen, 0.0, axis=1)
    # Q(u_1, t_1) Q(u_2, t_2) Q(u_3, t_3) product = -1, u the axes as carried with these three turns 0
    axes, product = _walk(given, length)
    u = axes[every, chosen]
    target = product * np.array([-1.0, 1.0, 1.0, 1.0])  # minus the conjugate
    angles, exists = close_three(u[:, 0], u[:, 1], u[:, 2], target)
    row, which = np.nonzero(exists)
    return row, angles[row, which], np.take_along_axis(turn, chosen, axis=1)[row]


def _walk(turns: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Multiply Qx(t_1) Qz(a_1) ... of [K, M] turns and sides: axes e1 as carried to each corner [K, M, 3], product."""
    c, s = np.cos(turns / 2), np.sin(turns / 2)
    f, g = np.cos(sides / 2), np.sin(sides / 2)
    w, x, y, z = np.ones(len(turns)), *np.zeros((3, len(turns)))
    axes = np.empty((*turns.shape, 3))
    for i in range(turns.shape[1]):
        axes[:, i, 0] = w * w + x * x - y * y - z * z
        axes[:, i, 1] = 2 * (x * y + w * z)
        axes[:, i, 2] = 2 * (x * z - w * y)
        a, b = c[:, i], s[:, i]
        w, x, y, z = w * a - x * b, x * a + w * b, y * a + z * b, z * a - y * b
        a, b = f[:, i], g[:, i]
        w, x, y, z = w * a - z * b, x * a + y * b, y * a - x * b, z * a + w * b
    return axes, np.stack([w, x, y, z], axis=-1)
