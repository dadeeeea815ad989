"""Starts on strata with touches: which strata have their turn, and states drawn on them (closed by `pinches`)."""

from __future__ import annotations

from dataclasses import dataclass, replace

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
from origami_nlp.numerics import FOLLOWED, OUTSIDE
from origami_nlp.problem import OPEN, Model
from origami_nlp.starts.batch_states import Samples
from origami_nlp.starts.contact_closed_form import close_pinched, free_parameters
from origami_nlp.starts.contact_strata import MOST_TOUCHES, ContactStrata, list_strata
from origami_nlp.starts.crossings import model_rows
from origami_nlp.starts.family import StartFamily

DRAWS = 8
"""States drawn on a stratum at a time."""
SHARES = ((8, 2, 1), (4, 2, 1))
"""How often strata with one touch and with two, with no, one and more closed creases have their turn: few contacts lead
to many minima, and minima with two touches are hardly ever reached from elsewhere."""
RARE, MOST_RARE = 1024, 40_000
"""Draws on a stratum without closed creases that gave nothing so far, and on all of these together: a state with two
touches closes in one draw of 500 where its three pieces are triangles, and minima there are hardly ever reached from
other strata."""
PASSES = 12
"""Rounds over strata after which fewer starts than asked are returned."""


@dataclass(frozen=True, eq=False)
class ContactStarts:
    """S states on strata with touches, each closed as a sheet of paper and without a crossing that the tests see.

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
    strata: ContactStrata
    tried: np.ndarray
    started: np.ndarray

    def __len__(self) -> int:
        return len(self.x)


class Touches(StartFamily):
    """Closed states on strata with touches, which they hold until the descent has converged.

    Parameters
    ----------
    model
        Of a scene without symmetry.

    Attributes
    ----------
    found
        The last answer of `contact_starts`, whose counts hold those before; None before the first.
    """

    name = "touches"
    sentence = "where creases touch facets"

    def __init__(self, model: Model) -> None:
        super().__init__(model)
        self.found: ContactStarts | None = None

    def draw(self, rng: np.random.Generator, many: int) -> Samples:
        """Draw states on the strata that were tried least (`contact_starts`)."""
        self.found = new = contact_starts(self._model, rng, many, self.found)
        sides = np.where(new.gaps == OPEN, 1, new.touches[..., 2])
        s = Samples.on(new.x, new.act, hold=True)
        return replace(s, slots=new.gaps, sides=sides)


def model_strata(model: Model) -> ContactStrata:
    """List the strata with touches of a model without symmetry (`list_strata`).

    Raises
    ------
    SceneError
        If the scene has a symmetry.
    """
    if not model.scene.group.is_trivial:
        raise SceneError(f"symmetry is {model.symmetry}: touches are pinched without symmetry only")
    return list_strata(model.scene.vertex.sector_angles, frozenset(model_rows(model)))


def contact_starts(
    model: Model, rng: np.random.Generator, count: int, before: ContactStarts | None = None
) -> ContactStarts:
    """Draw states on strata with touches, those with few contacts more often (`SHARES`).

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
    ContactStarts
        About `count`; fewer where strata are empty or hard to hit, none where nothing can touch.

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
    share = np.array(SHARES)[strata.touches - 1, np.minimum(strata.closed, 2)]
    found: list[tuple[np.ndarray, ...]] = []
    have = 0
    for _ in range(PASSES if len(strata) else 0):
        # those that gave nothing at first are probably empty
        due = np.where((started == 0) & (tried >= 4 * DRAWS), 4 * tried, tried) // share
        turn = _in_turn(strata, due, rng)[: max(2 * (count - have), 16)]
        tried[turn] += DRAWS
        x, act, touches, number = draw(model, strata, np.repeat(turn, DRAWS), rng)
        # the first of every stratum, then the second of every stratum, ... up to twice its share
        place = np.full(len(strata), len(turn))
        place[turn] = np.arange(len(turn))
        again = _rank(rng.random(len(x)), (number,))
        keep = np.lexsort((place[number], again))[: count - have]
        keep = keep[again[keep] < share[number[keep]] * max(1, 2 * count // len(strata))]
        np.add.at(started, number[keep], 1)
        found.append((x[keep], act[keep], touches[keep], number[keep]))
        have += len(keep)
        if have == count:
            break
    # once, and longer, on strata without closed creases that gave nothing
    rare = np.flatnonzero((strata.closed == 0) & (started == 0))
    if before is None and len(rare):
        draws = min(RARE, max(DRAWS, MOST_RARE // len(rare)))
        tried[rare] += draws
        x, act, touches, number = draw(model, strata, np.repeat(rare, draws), rng)
        keep = np.flatnonzero(_rank(rng.random(len(x)), (number,)) < share[number])
        np.add.at(started, number[keep], 1)
        found.append((x[keep], act[keep], touches[keep], number[keep]))
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
    return ContactStarts(x, act, touches, gaps, number, strata, tried, started)


def _in_turn(strata: ContactStrata, due: np.ndarray, rng: np.random.Generator) -> np.ndarray:
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
    model: Model, strata: ContactStrata, numbers: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Draw one set of free parameters for each of `numbers` [K] and return the states found (none, one or more each).

    Returns
    -------
    x, act, touches, numbers
        As in `ContactStarts`.
    """
    sectors = np.array(model.scene.vertex.sector_angles)
    n, parts = len(sectors), []
    seen = 0
    for family in strata.families:
        local = numbers[(numbers >= seen) & (numbers < seen + len(family.way))] - seen
        if len(local):
            drawn = free_parameters(sectors, family, local, model.fold_limits, rng)
            x, signs, row = close_pinched(sectors, family, local, *drawn)
            touches = np.zeros((len(x), MOST_TOUCHES, 3), int)
            touches[:, :, :2] = -1
            all_rows = np.array([way.touches for way in family.pinched])
            touches[:, : all_rows.shape[1], :2] = all_rows[family.way[local[row]]]
            touches[:, : all_rows.shape[1], 2] = signs
            act = np.where(family.at_limit[local[row]], np.sign(x), 0).astype(np.int8)
            good = ~faulty(model, x, model.fold_limits.folded_flat(act), touches)
            if not model.fold_limits.are_flat:  # else what closes in closed form is within them
                good &= model.fold_limits.inside(x, OUTSIDE).all(axis=1)
                act = model.fold_limits.near(x, OUTSIDE) * np.abs(act)
            parts.append((x[good], act[good], touches[good], local[row][good] + seen))
        seen += len(family.way)
    if not parts:
        none = np.zeros((0, MOST_TOUCHES, 3), int)
        return np.zeros((0, n)), np.zeros((0, n), np.int8), none, np.zeros(0, int)
    x, act, touches, number = (np.concatenate(part) for part in zip(*parts, strict=True))
    return x, act, touches, number


def faulty(model: Model, x: np.ndarray, act: np.ndarray, touches: np.ndarray) -> np.ndarray:
    """Return which states [K, n] do not close, do not touch as they say, or have facets that cross, [K]."""
    vertex = model.scene.vertex
    rays, q = fold_vertex(vertex, x)
    # (q[0] < 0 closes as well, with a turn by 2 pi too many)
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
