"""Admissible descent on the closed manifold, many states at once, and the minima where it ends.

In the scale z = sqrt(k) phi the energy is half the squared distance from the rest state.  A step goes
along the projected pull of the springs; where contact forbids that, along the best of a fan of
directions up to a right angle away from it, at ever smaller steps, so that a state slides along a
contact of any kind without the descent knowing which.  States must close to 1e-12 and pass the
embedding test.
"""

from __future__ import annotations

import itertools

import numpy as np

from tests.independent.search_charts import closed, pairs, sheets
from tests.independent.search_manifold import Piece

LONGEST = 0.06
"""Longest step [rad, in the largest fold angle]."""
FAN = np.array([0, 20, 45, 65, 78, 84, 87, 88.5, 89.3, 89.7])
ANGLES = np.deg2rad(np.concatenate([FAN, -FAN[1:]]))


def descend(
    piece: Piece, x: np.ndarray, rounds: int = 400, shortest: float = 1e-7
) -> tuple[np.ndarray, np.ndarray]:
    """Descend from each admissible closed state x [B, n].

    Returns the ends, and the length of the last pull (in z, times the root of the mean stiffness).
    """
    x = np.array(np.atleast_2d(x), dtype=float)
    step = np.full(len(x), LONGEST)
    pull = np.full(len(x), np.inf)
    unit = float(piece.root.mean())
    alive = np.arange(len(x))
    rng = np.random.default_rng(5)
    for _ in range(rounds):
        if not len(alive):
            break
        basis = piece.tangent(x[alive])
        down = -np.einsum("bnk,bn->bk", basis, piece.root * (x[alive] - piece.rest))
        size = np.linalg.norm(down, axis=1)
        pull[alive] = size * unit
        going = (pull[alive] > 1e-9) & (step[alive] > shortest)
        alive, basis, down, size = alive[going], basis[going], down[going], size[going]
        if not len(alive):
            break
        first = _try(piece, x[alive], basis, down, size, step[alive], np.zeros((len(alive), 1)))
        moved = first[1]
        for m in np.flatnonzero(moved):
            x[alive[m]] = first[0][m]
        step[alive[moved]] = np.minimum(LONGEST, 2 * step[alive[moved]])
        stuck = np.flatnonzero(~moved)
        if not len(stuck):
            continue
        turn = ANGLES[None, 1:] + rng.uniform(-0.15, 0.15, (len(stuck), 1)) * np.cos(
            ANGLES[None, 1:]
        )
        fan = _try(
            piece, x[alive[stuck]], basis[stuck], down[stuck], size[stuck], step[alive[stuck]], turn
        )
        for k, s in enumerate(stuck.tolist()):
            if fan[1][k]:
                x[alive[s]] = fan[0][k]
            else:
                step[alive[s]] /= 2.5
    return x, pull


def _try(
    piece: Piece,
    x: np.ndarray,
    basis: np.ndarray,
    down: np.ndarray,
    size: np.ndarray,
    step: np.ndarray,
    turn: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Take for each state the lowest admissible trial among the given turns of the pull."""
    count, fan = turn.shape
    co, si = np.cos(turn), np.sin(turn)
    ahead = (down / size[:, None])[:, None, :]
    d = np.stack(
        [co * ahead[..., 0] - si * ahead[..., 1], si * ahead[..., 0] + co * ahead[..., 1]], -1
    )
    move = np.einsum("bnk,bfk->bfn", basis, d) / piece.root
    move *= (step[:, None] / np.abs(move).max(axis=2, initial=1e-300))[..., None]
    # never beyond the foot of the perpendicular, where the energy along a straight line is least
    length = np.linalg.norm(move * piece.root, axis=2)
    move *= np.minimum(1.0, co * size[:, None] / np.maximum(length, 1e-300))[..., None]
    length = np.linalg.norm(move * piece.root, axis=2)
    trial, residual = piece.retract((x[:, None] + move).reshape(-1, piece.size), 5)
    step_taken = trial.reshape(count, fan, -1) - x[:, None]
    change = (step_taken * (0.5 * step_taken + (x - piece.rest)[:, None])) @ piece.stiffness
    wanted = -0.1 * length * co * size[:, None]
    good = (residual.reshape(count, fan) <= 1e-12) & (change <= wanted) & (wanted < 0)
    good &= np.abs(step_taken).max(axis=2) <= 3 * step[:, None]
    flat = np.flatnonzero(good)
    if len(flat):
        good.ravel()[flat] = piece.admissible(trial[flat])
    change = np.where(good, change, np.inf)
    best = change.argmin(axis=1)
    rows = np.arange(count)
    return trial.reshape(count, fan, -1)[rows, best], good[rows, best]


def starts(piece: Piece, count: int, rng: np.random.Generator) -> np.ndarray:
    """Random admissible closed states [count, n]."""
    found: list[np.ndarray] = []
    total = 0
    names = pairs(piece)
    while total < count:
        for name in names:
            s, t = rng.uniform(-np.pi, np.pi, (2, max(16, count // len(names))))
            for x in sheets(piece, s, t, name):
                x = x[closed(piece, x)]
                x = x[piece.admissible(x)]
                found.append(x[: max(4, count // len(names))])
                total += len(found[-1])
    x = np.concatenate(found)
    return x[rng.permutation(len(x))[:count]]


def grid_minima(piece: Piece, size: int) -> np.ndarray:
    """States of all charts' grids that are lower than their admissible neighbours on the sheet."""
    g = (np.arange(size) + 0.5) / size * 2 * np.pi - np.pi
    s, t = np.meshgrid(g, g, indexing="ij")
    found = []
    for name in pairs(piece):
        for x in sheets(piece, s, t, name):
            ok = closed(piece, x)
            ok[ok] = piece.admissible(x[ok])
            u = np.where(ok, piece.energy(x), np.inf)
            u = np.pad(u, 1, constant_values=np.inf)
            centre = u[1:-1, 1:-1]
            lowest = ok.copy()
            for a, b in itertools.product((0, 1, 2), repeat=2):
                if (a, b) != (1, 1):
                    lowest &= centre <= u[a : a + size, b : b + size]
            found.append(x[lowest])
    return np.concatenate(found)
