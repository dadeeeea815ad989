"""Does a claimed minimum stand?  The judge of every state that the package reports.

A state stands when it closes (a plain product of rotation matrices), lies next to a state that
closes in extended precision, and no admissible neighbour at the radii 1e-6, 1e-4 and 1e-2 that hangs
together with it is lower in energy.  Neighbours are drawn in random directions and down the torques,
in all strata of creases that stay shut or flat, and by turning few creases while all others are
held (two creases on one line turn as a hinge); they are closed in extended precision, and those that
are lower are closed again, asked for crossings and layers, and compared with 80 digits.  From the
lowest a descent that stays admissible tells how much lower it goes, and how far.

What it does not see: sets of states that exist only while facets touch at fold angles other than 0
and +-pi (`pockets` looks for these), and lower states that no level straight way joins to the state
(`elsewhere` counts them: basins can be narrower than the radius).

Nothing here uses the package but the numbers that it reports.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property

import mpmath as mp
import numpy as np

from tests.independent.arcs import crossing_margin, nearest_touch
from tests.independent.closing import LONG, PI, close, fold_long
from tests.independent.exact import embedded, fold_exactly
from tests.independent.layering import Map, combinatorics, stackable, stackable_with
from tests.independent.relations import DIGITS, exact_sectors
from tests.independent.rotations import spin_sign

RADII = (1e-6, 1e-4, 1e-2)
SHUT = 1e-9
"""A reported fold angle this close [rad] to +-pi, or to 0, is there."""
CLOSES = 1e-12
"""Largest entry of M - 1 of a state that may be reported."""
NEXT = 1e-6
"""A reported state lies this close [rad] to one that closes in extended precision."""
CROSSING = 1e-16
"""Depth of crossings that extended precision tells from touching."""
ROUNDING = 1e-13
"""Features of a reported state this close [rad] touch."""
MOST_STRATA = 40
VERIFIED = 6
"""Lower neighbours that are looked at with 80 digits, for each stratum and radius."""


@dataclass(frozen=True)
class Sheet:
    """A scene as numbers.

    sectors [N]; orbit: for each crease its variable, from 0; stiffness, rest [N]; contact: "full",
    "fold-limits" or "none"; maps: the symmetries that layers must have.
    """

    sectors: np.ndarray
    orbit: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    contact: str
    maps: tuple[Map, ...] = ()

    @classmethod
    def of(cls, scene) -> Sheet:
        """Read the numbers of a scene of the package."""
        n = len(scene.stiffness)
        maps = []
        for shift, mirrored in scene.group.elements:
            to = tuple((shift - i if mirrored else i + shift) % n for i in range(n))
            if mirrored or shift:
                maps.append((to, bool(mirrored)))
        return cls(
            np.array(scene.vertex.sector_angles),
            np.unique(scene.group.orbit, return_inverse=True)[1],
            np.array(scene.stiffness),
            np.array(scene.rest_angles),
            scene.contact,
            tuple(maps),
        )

    @property
    def size(self) -> int:
        return int(self.orbit.max()) + 1

    @cached_property
    def first(self) -> np.ndarray:
        """The first crease of each orbit."""
        return np.array([int(np.flatnonzero(self.orbit == v)[0]) for v in range(self.size)])

    @cached_property
    def exact(self) -> list[mp.mpf]:
        return exact_sectors(self.sectors)

    @cached_property
    def long(self) -> np.ndarray:
        with mp.workdps(DIGITS):
            return np.array([_long(a) for a in self.exact])

    def change(self, x: np.ndarray, start: np.ndarray) -> np.ndarray:
        """U(x) - U(start) without cancellation."""
        d = (x - start)[..., self.orbit]
        return (d * (d / 2 + start[self.orbit] - self.rest)) @ self.stiffness.astype(LONG)

    def torques(self, x: np.ndarray) -> np.ndarray:
        """dU/dx of the variables."""
        k = self.stiffness * (x[self.orbit].astype(float) - self.rest)
        return np.bincount(self.orbit, weights=k, minlength=self.size)

    def scale(self, x: np.ndarray) -> float:
        """Sum of the sizes of all torques [N m]."""
        return float(np.abs(self.stiffness * (x[self.orbit].astype(float) - self.rest)).sum())


@dataclass(frozen=True)
class Stand:
    """What the judge found.

    closure: largest entry of M - 1 of the reported numbers.  offset: distance [rad] of the reported
    state from the nearest one found that closes in extended precision; inf if none is near.
    allowed: whether the reported state itself is admissible.
    looked: admissible neighbours at each radius.  elsewhere: verified lower neighbours that no level
    way joins to the state, at each radius.
    neighbour, radius, change: the lowest verified neighbour that hangs together with the state [N],
    and its energy less that of the state.  end, drop, reach: where the descent from it ends, how much
    lower, how far away [rad].  why: why the state is false; empty where it stands.
    """

    closure: float
    offset: float
    allowed: bool
    looked: tuple[int, ...] = ()
    elsewhere: tuple[int, ...] = ()
    neighbour: tuple[float, ...] | None = None
    radius: float = 0.0
    change: float = 0.0
    end: tuple[float, ...] | None = None
    drop: float = 0.0
    reach: float = 0.0
    why: str = ""

    @property
    def false(self) -> bool:
        return bool(self.why)


def product_of_folds(sectors: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Return prod_i Rx(phi_i) Rz(alpha_i), factor by factor."""
    m = np.eye(3)
    for a, f in zip(sectors, phi, strict=True):
        c, s = math.cos(f), math.sin(f)
        m = m @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        c, s = math.cos(a), math.sin(a)
        m = m @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return m


def judge(sheet: Sheet, fold_angles, count: int = 2000, seed: int = 0) -> Stand:
    """Judge a claimed minimum; see the module."""
    phi = np.asarray(fold_angles, dtype=float)
    closure = float(np.abs(product_of_folds(sheet.sectors, phi) - np.eye(3)).max())
    rng = np.random.default_rng(seed)
    x = base(sheet, phi)
    if x is None:
        return Stand(closure, math.inf, False, why="no state that closes is near")
    offset = float(np.abs(x[sheet.orbit] - phi).max())
    allowed = admissible_to_rounding(sheet, x)
    why = ""
    if closure > CLOSES:
        why = f"closes to {closure:.1e}"
    elif offset > NEXT:
        why = f"is {offset:.1e} rad from a state that closes"
    elif not allowed:
        why = "is not admissible"
    if why:
        return Stand(closure, offset, allowed, why=why)
    return _around(sheet, x, Stand(closure, offset, allowed), count, rng)


def _around(sheet: Sheet, x: np.ndarray, stand: Stand, count: int, rng) -> Stand:
    """Look at the neighbours of x at all radii, and go down from the lowest."""
    margin = 1e-8 * sheet.scale(x) + 1e-13 * float(sheet.stiffness.sum())
    for radius in RADII:
        seen, apart, found = look(sheet, x, radius, count, rng)
        stand = replace(stand, looked=(*stand.looked, seen), elsewhere=(*stand.elsewhere, apart))
        if not found:
            continue
        y = min(found, key=lambda one: float(sheet.change(one, x)))
        end = descend(sheet, y, rng)
        drop, reach = -float(sheet.change(end, x)), float(np.abs(end - x).max())
        if drop <= margin * reach:
            continue  # the state is known to rounding only
        return replace(
            stand,
            neighbour=tuple(y[sheet.orbit].astype(float).tolist()),
            radius=radius,
            change=float(sheet.change(y, x)),
            end=tuple(end[sheet.orbit].astype(float).tolist()),
            drop=drop,
            reach=reach,
            why=f"a neighbour at {radius:g} leads down by {drop:.2e} to {reach:.1e} rad away",
        )
    return stand


def base(sheet: Sheet, phi: np.ndarray) -> np.ndarray | None:
    """Return the variables of the nearest state that closes, if one is near.

    Creases reported at +-pi or 0 are there exactly, if a state with them there is near.
    """
    x = phi[sheet.first].astype(LONG)
    shut = np.abs(math.pi - np.abs(phi[sheet.first])) <= SHUT
    shut &= sheet.contact != "none"
    x = np.where(shut, np.sign(x) * PI, x)
    flat = np.abs(x) <= SHUT
    masks = [shut | flat, shut, np.zeros_like(shut)]
    start = np.array([np.where(m & flat, LONG(0), x) for m in masks])
    radius = np.full(3, 0.1)
    y, closed, _ = close(sheet.long, sheet.orbit, start, np.array(masks), x, radius)
    distance = np.where(closed, np.abs(y - x).max(axis=1).astype(float), np.inf)
    if not closed.any():
        return None
    near = np.flatnonzero(distance <= 2 * SHUT)
    best = near[0] if len(near) else int(np.argmin(distance))
    with mp.workdps(DIGITS):
        exact, _ = close_exactly(sheet, y[best])
        if exact is None:
            return y[best]
        return np.array([_long(v) for v in exact])


def _long(value: mp.mpf) -> np.longdouble:
    return LONG(mp.nstr(value, 30))


def admissible_to_rounding(sheet: Sheet, x: np.ndarray) -> bool:
    """Tell whether a state known to rounding is admissible: features within 1e-13 touch."""
    if exactly_admissible(sheet, x):
        return True
    phi = x[sheet.orbit].astype(float)
    if not _possible_to_rounding(sheet, x):
        return False
    creases = fold_long(sheet.long, x[None, sheet.orbit])[0][0].astype(float)
    key = combinatorics(creases, phi, ROUNDING)
    if not sheet.maps:
        return stackable(*key)
    close = np.linalg.norm(creases[:, None] - creases[None], axis=2) <= ROUNDING
    return stackable_with(*key, tuple(int(row.argmax()) for row in close), sheet.maps)


def _possible_to_rounding(sheet: Sheet, x: np.ndarray) -> bool:
    if sheet.contact != "none":
        over = np.abs(x) > PI
        x = np.where(over & (np.abs(x) <= PI + ROUNDING), np.sign(x) * PI, x)
    return bool(possible(sheet, x[None], np.array([ROUNDING / 8]))[0])


def strata(sheet: Sheet, x: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    """Masks of the variables that stay: at +-pi or at 0, as many as there are up to a limit."""
    shut = PI - np.abs(x) <= SHUT
    shut &= sheet.contact != "none"
    special = np.flatnonzero(shut | (np.abs(x) <= SHUT))
    subsets = [c for size in range(len(special) + 1) for c in itertools.combinations(special, size)]
    if len(subsets) > MOST_STRATA:
        keep = [(), tuple(np.flatnonzero(shut)), tuple(special)]
        chosen = rng.permutation(len(subsets))[: MOST_STRATA - 3]
        subsets = list(dict.fromkeys([*keep, *(subsets[k] for k in chosen)]))
    out = []
    for subset in subsets:
        mask = np.zeros(sheet.size, dtype=bool)
        mask[list(subset)] = True
        if not mask.all():
            out.append(mask)
    return out


def few_free(sheet: Sheet) -> list[np.ndarray]:
    """Masks that leave two, three or four variables free: hinges, and short linkages."""
    n = sheet.size
    out = []
    for size in (2, 3, 4):
        for free in itertools.combinations(range(n), size):
            mask = np.ones(n, dtype=bool)
            mask[list(free)] = False
            if size < n:
                out.append(mask)
    return out


def look(
    sheet: Sheet, x: np.ndarray, radius: float, count: int, rng: np.random.Generator
) -> tuple[int, int, list[np.ndarray]]:
    """Look at `count` admissible neighbours; return their number, and the lower ones, as `Stand`."""
    kinds = strata(sheet, x, rng)
    turns = few_free(sheet)
    seen, apart, found = 0, 0, []
    for attempt in range(4):
        if seen >= count or (attempt and not seen):
            break
        per = max(8, (count - seen) // len(kinds) + 1)
        held = np.repeat(np.array(kinds), per, axis=0)
        if attempt == 0 and turns:
            held = np.concatenate([held, np.repeat(np.array(turns), 4, axis=0)])
        start = x + directions(sheet, x, held, rng) * radius
        y, good, error = close(sheet.long, sheet.orbit, start, held, x, np.full(len(start), radius))
        good &= np.linalg.norm((y - x).astype(float), axis=1) >= 0.03 * radius
        good[good] = possible(sheet, y[good], error[good])
        y, held = y[good], held[good]
        change = sheet.change(y, x) if len(y) else np.zeros(0)
        bar = -1e-13 * (sheet.scale(x) + 1e-3 * float(sheet.stiffness.sum()) * radius) * radius
        lower = change < bar
        good, more, wrong = verified(sheet, x, y[lower], held[lower], change[lower])
        # all others count as neighbours if layers do not forbid them, to double precision
        seen += int((~lower).sum()) - stacked_out(sheet, y[~lower], rng) + len(good) + more
        apart += more
        found += good
        if len(found) >= 2:
            break
        del wrong
    return seen, apart, found


def directions(
    sheet: Sheet, x: np.ndarray, held: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Unit directions [B, n] of the free variables: random, every third turned down the torques."""
    d = rng.normal(size=held.shape)
    g = sheet.torques(x)
    down = -g / max(float(np.linalg.norm(g)), 1e-300)
    d[::3] = 0.3 * d[::3] + 2 * down
    d *= ~held
    if sheet.contact != "none":
        limit = (PI - np.abs(x) <= SHUT) & ~held
        inward = -np.sign(x).astype(float) * np.abs(d)
        d = np.where(limit, inward, d)
    length = np.linalg.norm(d, axis=1, keepdims=True)
    return d / np.maximum(length, 1e-300)


def possible(sheet: Sheet, y: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Tell which states, known to `error` [B], keep the fold limits and do not cross for certain."""
    if not len(y):
        return np.zeros(0, dtype=bool)
    phi = y[:, sheet.orbit]
    ok = spin_sign(sheet.sectors, phi.astype(float)) > 0
    if sheet.contact == "none":
        return ok
    ok &= (np.abs(phi) <= PI).all(axis=1)
    if sheet.contact == "full":
        creases, _ = fold_long(sheet.long, phi)
        ok &= crossing_margin(creases) <= CROSSING + 8 * error
    return ok


def stacked_out(sheet: Sheet, y: np.ndarray, rng: np.random.Generator, sample: int = 20) -> int:
    """Estimate how many of the states have touching layers that cannot be stacked, from a sample."""
    if sheet.contact != "full" or not len(y):
        return 0
    chosen = rng.permutation(len(y))[:sample]
    bad = 0
    for k in chosen:
        phi = y[k][sheet.orbit]
        creases = fold_long(sheet.long, phi[None])[0][0].astype(float)
        if nearest_touch(creases[None])[0] <= 1e-14:
            bad += not stackable(*combinatorics(creases, phi.astype(float), 1e-14))
    return len(y) * bad // len(chosen)


def verified(
    sheet: Sheet, x: np.ndarray, y: np.ndarray, held: np.ndarray, change: np.ndarray
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
        if not exactly_admissible(sheet, y[k]):
            wrong += 1
        elif level_way(sheet, x, y[k], held[k]):
            good.append(y[k])
        else:
            apart += 1
    return good, apart, wrong


def exactly_admissible(sheet: Sheet, y: np.ndarray) -> bool:
    """Close y [n] with 80 digits and ask for fold limits, crossings and layers."""
    with mp.workdps(DIGITS):
        x, creases = close_exactly(sheet, y)
        if x is None:
            return False
        if sheet.contact == "none":
            return True
        if any(abs(v) > mp.pi + mp.mpf(10) ** -28 for v in x):
            return False
        if sheet.contact == "fold-limits":
            return True
        return embedded(creases, [float(x[v]) for v in sheet.orbit], sheet.maps)


def close_exactly(sheet: Sheet, y: np.ndarray):
    """Newton with 80 digits from a state closed to 1e-18; returns variables and creases, or None.

    Creases at +-pi and 0 stay there if the state closes so, or else those at +-pi.  At double roots a
    step halves the distance, and the residual is the distance squared.
    """
    shut = np.asarray(np.abs(y) == PI) & (sheet.contact != "none")
    flat = np.asarray(y == 0)
    start = []
    for v, s in zip(y, shut, strict=True):
        high = float(v)
        start.append(mp.sign(high) * mp.pi if s else mp.mpf(high) + mp.mpf(float(v - LONG(high))))
    for held in (shut | flat, shut) if flat.any() else (shut,):
        x, creases = _newton_exactly(sheet, start, held)
        if x is not None and max(abs(a - b) for a, b in zip(x, start, strict=True)) <= 1e-7:
            return x, creases
    return None, None


def _newton_exactly(sheet: Sheet, x: list, held: np.ndarray):
    least = mp.mpf(10) ** -60
    tie = np.eye(sheet.size)[sheet.orbit] * (1.0 - held)
    before = mp.mpf(0)
    for _ in range(200):
        creases, (a, b, c) = fold_exactly(sheet.exact, [x[v] for v in sheet.orbit])
        r = [(b[2] - c[1]) / 2, (c[0] - a[2]) / 2, (a[1] - b[0]) / 2]
        size = max(abs(v) for v in r)
        if size < least:
            return x, creases
        jac = np.array([[float(c[k]) for c in creases] for k in range(3)]) @ tie
        u, s, vt = np.linalg.svd(jac, full_matrices=False)
        good = s > 1e-14
        if not good.any():
            break
        part = u.T @ np.array([float(v / size) for v in r])
        move = -((part * good / np.where(good, s, 1)) @ vt)
        length = size * float(np.abs(move).max())
        if not 0 < length <= 1e-6:
            break
        if 0.45 < length / max(before, length) < 0.55:  # a double root
            move, length = 2 * move, mp.mpf(0)
        before = length
        x = [v + size * mp.mpf(float(m)) for v, m in zip(x, move, strict=True)]
    return None, None


WAY = np.concatenate([np.linspace(1, 0.1, 19), np.logspace(-1.25, -4, 12)])


def level_way(sheet: Sheet, x: np.ndarray, y: np.ndarray, held: np.ndarray) -> bool:
    """Tell whether the straight way from y to x, closed point by point, is admissible and level."""
    step = y - x
    length = float(np.linalg.norm(step.astype(float)))
    start = x + WAY[:, None] * step
    mask = np.repeat(held[None], len(WAY), axis=0)
    radius = WAY * length
    z, closed, error = close(sheet.long, sheet.orbit, start, mask, x, radius)
    if not closed.all() or not possible(sheet, z, error).all():
        return False
    distance = np.linalg.norm((z - x).astype(float), axis=1)
    if (distance < 0.2 * radius).any():
        return False
    if not (sheet.change(z, x) <= 1e-13 * sheet.scale(x) * radius).all():
        return False
    gap = np.linalg.norm(np.diff(z.astype(float), axis=0), axis=1)
    if (gap > 3 * length * np.maximum(-np.diff(WAY), 0.05)).any():
        return False
    return all(exactly_admissible(sheet, z[k]) for k in (10, 20, 30))


def descend(
    sheet: Sheet, y: np.ndarray, rng: np.random.Generator, rounds: int = 100, fan: int = 16
) -> np.ndarray:
    """Go down from y, always admissible, along the best of a fan of directions at many lengths."""
    k = np.bincount(sheet.orbit, weights=sheet.stiffness)
    step, start_at = 0.03, y
    drops = [0.0]
    for _ in range(rounds):
        if len(drops) > 6 and drops[-1] - drops[-6] < 0.02 * drops[-1]:
            break  # nearly there: this is a verdict, not a minimiser
        kinds = strata(sheet, y, rng)
        rng.shuffle(kinds)
        held = np.repeat(np.array(kinds)[:10], fan, axis=0)
        g = sheet.torques(y)
        lengths = step * 4.0 ** -rng.integers(0, 3, len(held))
        tangent = downhill(sheet, y, held, g / k, k)
        noise = rng.normal(size=held.shape) * ~held
        noise /= np.maximum(np.linalg.norm(noise, axis=1, keepdims=True), 1e-300)
        d = tangent + noise * rng.choice([0.0, 0.1, 0.5, 1.5], (len(held), 1))
        if sheet.contact != "none":
            limit = (PI - np.abs(y) <= SHUT) & ~held
            d = np.where(limit, -np.sign(y).astype(float) * np.abs(d), d)
        d /= np.maximum(np.linalg.norm(d, axis=1, keepdims=True), 1e-300)
        start = y + d * lengths[:, None]
        if sheet.contact != "none":  # beyond a fold limit is at it
            over = np.abs(start) > PI
            start = np.where(over, np.sign(start) * PI, start)
            held = held | over
        z, closed, error = close(sheet.long, sheet.orbit, start, held, y, lengths)
        z, held, error = z[closed], held[closed], error[closed]
        change = sheet.change(z, y) if len(z) else np.zeros(0)
        order = np.argsort(change)
        order = order[change[order] < 0]
        fine = possible(sheet, z[order], error[order])
        moved = False
        for m in order[fine][:4]:
            if exactly_admissible(sheet, z[m]):
                y, moved = z[m], True
                break
        drops.append(-float(sheet.change(y, start_at)))
        step = min(0.3, 1.7 * step) if moved else step / 4
        if step < 1e-9:
            break
    return y


def downhill(
    sheet: Sheet, y: np.ndarray, held: np.ndarray, g: np.ndarray, k: np.ndarray
) -> np.ndarray:
    """Unit steps down the energy among closed states to first order, in the scale of the springs."""
    creases, _ = fold_long(sheet.long, y[None, sheet.orbit])
    jac = creases[0].astype(float).T @ np.eye(sheet.size)[sheet.orbit]
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
