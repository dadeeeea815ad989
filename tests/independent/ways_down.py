"""Lower admissible neighbours of a state, and how far down a descent from one of them goes."""

from __future__ import annotations

import itertools

import numpy as np

from tests.independent.closing import PI, close, fold_long
from tests.independent.exact_states import SHUT, exactly_admissible, possible, stacked_out
from tests.independent.sheet import PatternProblem

MOST_STRATA = 40
VERIFIED = 6
"""Lower neighbours that are looked at with 80 digits, for each stratum and radius."""
WAY = np.concatenate([np.linspace(1, 0.1, 19), np.logspace(-1.25, -4, 12)])


def look(
    problem: PatternProblem, x: np.ndarray, radius: float, count: int, rng: np.random.Generator
) -> tuple[int, int, list[np.ndarray]]:
    """Look at `count` admissible neighbours; return their number, and the lower ones, as
    `verify_minimum.Verification` has them."""
    kinds = strata(problem, x, rng)
    turns = few_free(problem)
    seen, apart, found = 0, 0, []
    for attempt in range(4):
        if seen >= count or (attempt and not seen):
            break
        per = max(8, (count - seen) // len(kinds) + 1)
        held = np.repeat(np.array(kinds), per, axis=0)
        if attempt == 0 and turns:
            held = np.concatenate([held, np.repeat(np.array(turns), 4, axis=0)])
        start = x + directions(problem, x, held, rng) * radius
        y, good, error = close(
            problem.long, problem.orbit, start, held, x, np.full(len(start), radius)
        )
        good &= np.linalg.norm((y - x).astype(float), axis=1) >= 0.03 * radius
        good[good] = possible(problem, y[good], error[good])
        y, held = y[good], held[good]
        change = problem.change(y, x) if len(y) else np.zeros(0)
        bar = -1e-13 * (problem.scale(x) + 1e-3 * float(problem.stiffness.sum()) * radius) * radius
        lower = change < bar
        good, more, wrong = verified(problem, x, y[lower], held[lower], change[lower])
        # all others count as neighbours if layers do not forbid them, to double precision
        seen += int((~lower).sum()) - stacked_out(problem, y[~lower], rng) + len(good) + more
        apart += more
        found += good
        if len(found) >= 2:
            break
        del wrong
    return seen, apart, found


def strata(problem: PatternProblem, x: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    """Masks of the variables that stay: at +-pi or at 0, as many as there are up to a limit."""
    at_limit = PI - np.abs(x) <= SHUT
    at_limit &= problem.contact != "none"
    special = np.flatnonzero(at_limit | (np.abs(x) <= SHUT))
    subsets = [c for size in range(len(special) + 1) for c in itertools.combinations(special, size)]
    if len(subsets) > MOST_STRATA:
        keep = [(), tuple(np.flatnonzero(at_limit)), tuple(special)]
        chosen = rng.permutation(len(subsets))[: MOST_STRATA - 3]
        subsets = list(dict.fromkeys([*keep, *(subsets[k] for k in chosen)]))
    out = []
    for subset in subsets:
        mask = np.zeros(problem.size, dtype=bool)
        mask[list(subset)] = True
        if not mask.all():
            out.append(mask)
    return out


def few_free(problem: PatternProblem) -> list[np.ndarray]:
    """Masks that leave two, three or four variables free: hinges, and short linkages."""
    n = problem.size
    out = []
    for size in (2, 3, 4):
        for free in itertools.combinations(range(n), size):
            mask = np.ones(n, dtype=bool)
            mask[list(free)] = False
            if size < n:
                out.append(mask)
    return out


def directions(
    problem: PatternProblem, x: np.ndarray, held: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Unit directions [B, n] of the free variables: random, every third turned down the torques."""
    d = rng.normal(size=held.shape)
    g = problem.torques(x)
    down = -g / max(float(np.linalg.norm(g)), 1e-300)
    d[::3] = 0.3 * d[::3] + 2 * down
    d *= ~held
    if problem.contact != "none":
        limit = (PI - np.abs(x) <= SHUT) & ~held
        inward = -np.sign(x).astype(float) * np.abs(d)
        d = np.where(limit, inward, d)
    length = np.linalg.norm(d, axis=1, keepdims=True)
    return d / np.maximum(length, 1e-300)


def verified(
    problem: PatternProblem, x: np.ndarray, y: np.ndarray, held: np.ndarray, change: np.ndarray
) -> tuple[list[np.ndarray], int, int]:
    """Verify lower neighbours with 80 digits and by a level way.

    Returns those that hang together with x, and how many are lower but elsewhere, and inadmissible.
    """
    good, apart, wrong = [], 0, 0
    kinds: dict[bytes, int] = {}
    for k in np.argsort(change):
        kind = held[k].tobytes()
        if kinds.get(kind, 0) >= VERIFIED:
            continue
        if len(good) >= 2 or apart >= 2 * VERIFIED:
            break
        kinds[kind] = kinds.get(kind, 0) + 1
        if not exactly_admissible(problem, y[k]):
            wrong += 1
        elif level_way(problem, x, y[k], held[k]):
            good.append(y[k])
        else:
            apart += 1
    return good, apart, wrong


def level_way(problem: PatternProblem, x: np.ndarray, y: np.ndarray, held: np.ndarray) -> bool:
    """Return whether the straight way from y to x, closed point by point, is admissible and level."""
    step = y - x
    length = float(np.linalg.norm(step.astype(float)))
    start = x + WAY[:, None] * step
    mask = np.repeat(held[None], len(WAY), axis=0)
    radius = WAY * length
    z, closed, error = close(problem.long, problem.orbit, start, mask, x, radius)
    if not closed.all() or not possible(problem, z, error).all():
        return False
    distance = np.linalg.norm((z - x).astype(float), axis=1)
    if (distance < 0.2 * radius).any():
        return False
    if not (problem.change(z, x) <= 1e-13 * problem.scale(x) * radius).all():
        return False
    gap = np.linalg.norm(np.diff(z.astype(float), axis=0), axis=1)
    if (gap > 3 * length * np.maximum(-np.diff(WAY), 0.05)).any():
        return False
    return all(exactly_admissible(problem, z[k]) for k in (10, 20, 30))


def descend(
    problem: PatternProblem,
    y: np.ndarray,
    rng: np.random.Generator,
    rounds: int = 100,
    fan: int = 16,
) -> np.ndarray:
    """Go down from y, always admissible, along the best of a fan of directions at many lengths."""
    k = np.bincount(problem.orbit, weights=problem.stiffness)
    step, start_at = 0.03, y
    drops = [0.0]
    for _ in range(rounds):
        if len(drops) > 6 and drops[-1] - drops[-6] < 0.02 * drops[-1]:
            break  # nearly there: this is a verdict, not a minimiser
        kinds = strata(problem, y, rng)
        rng.shuffle(kinds)
        held = np.repeat(np.array(kinds)[:10], fan, axis=0)
        g = problem.torques(y)
        lengths = step * 4.0 ** -rng.integers(0, 3, len(held))
        tangent = downhill(problem, y, held, g / k, k)
        noise = rng.normal(size=held.shape) * ~held
        noise /= np.maximum(np.linalg.norm(noise, axis=1, keepdims=True), 1e-300)
        d = tangent + noise * rng.choice([0.0, 0.1, 0.5, 1.5], (len(held), 1))
        if problem.contact != "none":
            limit = (PI - np.abs(y) <= SHUT) & ~held
            d = np.where(limit, -np.sign(y).astype(float) * np.abs(d), d)
        d /= np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-300)
        start = y + d * lengths[:, None]
        if problem.contact != "none":  # beyond a fold limit is at it
            over = np.abs(start) > PI
            start = np.where(over, np.sign(start) * PI, start)
            held = held | over
        z, closed, error = close(problem.long, problem.orbit, start, held, y, lengths)
        z, held, error = z[closed], held[closed], error[closed]
        change = problem.change(z, y) if len(z) else np.zeros(0)
        order = np.argsort(change)
        order = order[change[order] < 0]
        fine = possible(problem, z[order], error[order])
        moved = False
        for m in order[fine][:4]:
            if exactly_admissible(problem, z[m]):
                y, moved = z[m], True
                break
        drops.append(-float(problem.change(y, start_at)))
        step = min(0.3, 1.7 * step) if moved else step / 4
        if step < 1e-9:
            break
    return y


def downhill(
    problem: PatternProblem, y: np.ndarray, held: np.ndarray, g: np.ndarray, k: np.ndarray
) -> np.ndarray:
    """Unit steps down the energy among closed states to first order, in the scale of the springs."""
    creases, _ = fold_long(problem.long, y[None, problem.orbit])
    jac = creases[0].astype(float).T @ np.eye(problem.size)[problem.orbit]
    root = np.sqrt(k)
    out = np.empty(held.shape)
    cache: dict[bytes, np.ndarray] = {}
    for b, mask in enumerate(held):
        key = mask.tobytes()
        if key not in cache:
            j = jac / root * ~mask
            _, s, vt = np.linalg.svd(j)
            rows = vt[: len(s)][s > 1e-9]
            d = -(root * g) * ~mask
            d = (d - rows.T @ (rows @ d)) / root
            cache[key] = d / max(float(np.linalg.norm(d)), 1e-300)
        out[b] = cache[key]
    return out
