"""States with touching facets in closed form, to start searches from (`touches`: on which strata).

With Qx, Qz turns about e1 and e3, a polygon with turns t_i and sides a_i closes as an embedded one does exactly when

    Qx(t_1) Qz(a_1) Qx(t_2) Qz(a_2) ... Qx(t_m) Qz(a_m) = -1,

whatever the sum of its sides.  Where crease k touches facet j this product falls into those of the two pieces, which
must be -1 each, and the turn at crease k is t' + t'' -+ 2 pi.  Pieces that lie beside each other turn to the same side
at the touch, and |phi_k| <= pi, so

    phi_k = t' + t'' - 2 pi sign(t'),  sign(t') = sign(t''),  |t' + t''| >= pi.

The plain sum is the sheet q = -1: the pieces cross.  The tip touches from the left of facet j, so that
det(c_j, c_{j+1}, c_k) >= 0, exactly where t' > 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import SceneError
from origami_nlp.folding import (
    find_crossings,
    fold_vertex,
    row_values,
    stack_depths,
    stack_rule,
    tip_depths,
)
from origami_nlp.minima.touches import MOST_TOUCHES, Family, Row, TouchStrata, list_strata
from origami_nlp.numerics import FOLLOWED, OUTSIDE
from origami_nlp.programme import Model, close_three

DRAWS = 8
"""States drawn on a stratum at a time."""
PASSES = 12
"""Rounds over strata after which fewer starts than asked are returned."""


@dataclass(frozen=True, eq=False)
class TouchStarts:
    """S states on strata with touches, each closed, on the sheet of paper and without a crossing that the tests see.

    Attributes
    ----------
    x
        Fold angles [rad], [S, n].
    act
        Closed creases, [S, n]: -1, 0 or 1, the sign of phi = +-pi.
    touches
        Rows (k, j, side), [S, 3, 3]: crease k on facet j, 0-based, side * det(c_j, c_{j+1}, c_k) >= 0; an empty slot is
        (-1, -1, 0).
    gaps
        Position of each touch in `Structure.gaps` (the first gap with these rays), [S, 3]; -1 for an empty slot.
    stratum
        Number in `strata`, [S].
    strata
        The strata of the model.
    tried, started
        How many draws each stratum has had, and how many starts came of them, before and now, [R].
    """

    x: np.ndarray
    act: np.ndarray
    touches: np.ndarray
    gaps: np.ndarray
    stratum: np.ndarray
    strata: TouchStrata
    tried: np.ndarray
    started: np.ndarray

    def __len__(self) -> int:
        return len(self.x)


def model_rows(model: Model) -> dict[Row, int]:
    """Return the rows (k, j) of a model without symmetry, with the first of `Structure.gaps` that each is.

    Parameters
    ----------
    model
        Of a scene without symmetry.

    Returns
    -------
    dict
        Empty where contact is not full.  Rows with k - j in {2, N - 1} are fold limits and left out.
    """
    n = model.size
    first: dict[Row, int] = {}
    for index, gap in enumerate(model.structure.gaps):
        if gap.pair is not None and 3 <= (gap.rays[0] - gap.rays[1]) % n <= n - 2:
            first.setdefault((gap.rays[0], gap.rays[1]), index)
    return first


def model_strata(model: Model) -> TouchStrata:
    """List the strata with touches of a model without symmetry (`list_strata`).

    Raises
    ------
    SceneError
        If the scene has a symmetry.
    """
    if not model.scene.group.is_trivial:
        raise SceneError(f"symmetry is {model.symmetry}: touches are pinched without symmetry only")
    return list_strata(model.scene.vertex.sector_angles, frozenset(model_rows(model)))


def touch_starts(
    model: Model, rng: np.random.Generator, count: int, before: TouchStarts | None = None
) -> TouchStarts:
    """Draw states on strata with touches, all strata equally often.

    Parameters
    ----------
    model
        Of a scene without symmetry.
    rng
        Draws where touches lie, and the turns that are free.
    count
        How many starts are wanted.
    before
        An earlier answer for this model, to go on with the strata that have been tried least.

    Returns
    -------
    TouchStarts
        At most `count`; fewer where strata are empty or hard to hit, none where nothing can touch.

    Raises
    ------
    SceneError
        If the scene has a symmetry.
    """
    strata, rows = model_strata(model), model_rows(model)
    zero = np.zeros(len(strata), int)
    tried, started = (
        (zero, zero.copy()) if before is None else (before.tried.copy(), before.started.copy())
    )
    found: list[tuple[np.ndarray, ...]] = []
    have = 0
    for _ in range(PASSES if len(strata) else 0):
        # those that gave nothing at first are probably empty
        due = np.where((started == 0) & (tried >= 4 * DRAWS), 4 * tried, tried)
        turn = _in_turn(strata, due, rng)[: max(2 * (count - have), 16)]
        tried[turn] += DRAWS
        x, act, touches, number = draw(model, strata, np.repeat(turn, DRAWS), rng)
        # the first of every stratum, then the second of every stratum, ... up to twice its share
        place = np.full(len(strata), len(turn))
        place[turn] = np.arange(len(turn))
        again = _rank(rng.random(len(x)), (number,))
        keep = np.lexsort((place[number], again))[: count - have]
        keep = keep[again[keep] < max(1, 2 * count // len(strata))]
        np.add.at(started, number[keep], 1)
        found.append((x[keep], act[keep], touches[keep], number[keep]))
        have += len(keep)
        if have == count:
            break
    n = model.size
    x, act, touches, number = (
        (np.concatenate(part) for part in zip(*found, strict=True))
        if found
        else (
            np.zeros((0, n)),
            np.zeros((0, n), np.int8),
            np.zeros((0, MOST_TOUCHES, 3), int),
            zero,
        )
    )
    position = np.full((n, n), -1)
    for (k, j), index in rows.items():
        position[k, j] = index
    used = touches[:, :, 2] != 0
    gaps = np.where(used, position[touches[:, :, 0], touches[:, :, 1]], -1)
    return TouchStarts(x, act, touches, gaps, number, strata, tried, started)


def _in_turn(strata: TouchStrata, due: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Order strata: lowest `due` first, then by turns one of each class, in it one of each way to pinch."""
    r = len(strata)
    chance = rng.random(r)
    way, seen = np.zeros(r, int), 0
    for family in strata.families:
        way[seen : seen + len(family.way)] = family.way
        seen += len(family.way)
    kind = strata.touches * 64 + strata.closed
    of_way = _rank(chance, (kind, way, due))
    of_kind = _rank(of_way + chance, (kind, due))
    return np.lexsort((chance, of_kind, due))


def _rank(value: np.ndarray, groups: tuple[np.ndarray, ...]) -> np.ndarray:
    """Return the place of each value among those of its group."""
    order = np.lexsort((value, *groups))
    new = np.zeros(len(order), bool)
    if len(order):
        new[0] = True
    for g in groups:
        new[1:] |= g[order][1:] != g[order][:-1]
    start = np.maximum.accumulate(np.where(new, np.arange(len(order)), 0))
    rank = np.empty(len(order), int)
    rank[order] = np.arange(len(order)) - start
    return rank


def draw(
    model: Model, strata: TouchStrata, numbers: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Draw one set of free parameters for each of `numbers` [K] and return the states found (none, one or more each).

    Returns
    -------
    x, act, touches, numbers
        As in `TouchStarts`.
    """
    sectors = np.array(model.scene.vertex.sector_angles)
    n, parts = len(sectors), []
    seen = 0
    for family in strata.families:
        local = numbers[(numbers >= seen) & (numbers < seen + len(family.way))] - seen
        if len(local):
            drawn = free_parameters(sectors, family, local, rng)
            x, signs, row = close_pinched(sectors, family, local, *drawn)
            touches = np.zeros((len(x), MOST_TOUCHES, 3), int)
            touches[:, :, :2] = -1
            all_rows = np.array([way.touches for way in family.pinched])
            touches[:, : all_rows.shape[1], :2] = all_rows[family.way[local[row]]]
            touches[:, : all_rows.shape[1], 2] = signs
            act = np.where(family.shut[local[row]], np.sign(x), 0).astype(np.int8)
            good = ~faulty(model, x, act, touches)
            parts.append((x[good], act[good], touches[good], local[row][good] + seen))
        seen += len(family.way)
    if not parts:
        none = np.zeros((0, MOST_TOUCHES, 3), int)
        return np.zeros((0, n)), np.zeros((0, n), np.int8), none, np.zeros(0, int)
    x, act, touches, number = (np.concatenate(part) for part in zip(*parts, strict=True))
    return x, act, touches, number


def faulty(model: Model, x: np.ndarray, act: np.ndarray, touches: np.ndarray) -> np.ndarray:
    """Tell which states [K, n] do not close, do not touch as they say, or have facets that cross, [K]."""
    vertex = model.scene.vertex
    rays, q = fold_vertex(vertex, x)
    bad = (np.abs(q[:, 1:]).max(axis=1) > FOLLOWED) | (q[:, 0] < 0)
    used = touches[:, :, 2] != 0
    values = row_values(rays, touches[:, :, 0], touches[:, :, 1])
    bad |= (used & (np.abs(values) > FOLLOWED)).any(axis=1)
    left = np.flatnonzero(~bad)
    depth = find_crossings(rays[left], model.structure.pairs).depth
    wrong = (depth > OUTSIDE).any(axis=1)
    wrong |= (tip_depths(rays[left], touches[left]) > OUTSIDE).any(axis=1)
    stacked = stack_depths(stack_rule(vertex.sector_angles), x[left], act[left])
    bad[left] = wrong | (stacked > OUTSIDE).any(axis=1)
    return bad


def free_parameters(
    sectors: np.ndarray, family: Family, strata: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Draw where touches lie, the turns that are free, and which turns close each piece.

    Parameters
    ----------
    sectors
        Sector angles, [N].
    family, strata
        The strata, as positions in the family, [K].
    rng
        Source of the draws.

    Returns
    -------
    positions : numpy.ndarray
        Arc from ray j to each touch, uniform on the part of facet j that it divides [rad], [K, touches].
    turns : numpy.ndarray
        Uniform in (-pi, pi); +-pi for closed creases, 0 for the flat one of a stack touch, [K, N + 2 touches].
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
    shut = family.shut[strata]
    turns = rng.uniform(-math.pi, math.pi, (count, n + 2 * pinches))
    rank = rng.random(turns.shape)
    turns[:, :n] = np.where(shut, np.copysign(math.pi, turns[:, :n]), turns[:, :n])
    rank[:, :n] += 2.0 * shut
    rank[:, n:] -= 1.0
    if family.pinched[0].flat:
        flat = np.array([w.flat[1] for w in family.pinched])[way]
        turns[np.arange(count), flat] = 0.0
        rank[np.arange(count), flat] += 2.0
    return positions, turns, rank


def close_pinched(
    sectors: np.ndarray,
    family: Family,
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
    tip = family.tip_shut[strata]
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
        good &= (one * two > 0) & ((np.abs(whole) >= math.pi) | closed)
        signs[:, t] = np.sign(one)
        whole = whole - np.copysign(2 * math.pi, one)
        whole = np.where(closed, -np.copysign(math.pi, one), whole)
        turns[np.arange(len(row)), parent] = whole
    if not pinches:
        shut = np.array([w.flat[0] for w in family.pinched])[way]
        signs[:, 0] = np.sign(turns[np.arange(len(row)), shut])
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
    family: Family,
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
