"""The list of a proof, found again by a second program: a sheet in doubles along curves, a vertex in boxes of balls.

What it shares with the prover are lemmas, not code: round a vertex that folds flat opposite folds are equal up to sign,
and tangents of half the others proportional; at another one a fold gives all, in two ways.  Here folds come from angles
between directions on the sphere, multipliers from measured states, each minimum from thousands of states of a curve and
golden sections between them.  What lies between two of these it does not see: the prover shows that nothing does.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from origami_nlp.pattern import Scene
from origami_nlp.proof.certificate import Certificate, StatedSheet, read_certificate
from origami_nlp.proof.vertex_check import BESIDE, VertexSearch

STATES = 4_000
"""Of a curve."""
PARTS = 40
"""Into which what is between two of them is cut, again and again."""
START = np.geomspace(1e-5, 5e-4, 50)
"""Of a curve, its first states [rad]."""
BEFORE = 1e-12
"""Scanned states lie so far before their places [rad]: the last one before 180 degrees."""
NEAR = 1e-5
"""By which a state may be listed off, beyond its radius [rad]."""
CLOSED = 1e-8
"""What a closed loop of folds may miss, or that of logarithms of multipliers."""
LEAST = 1e-5
"""How far states are gone along a curve to see whether the energy falls [rad]."""


class NoSheet(Exception):
    """What is stated is no sheet of the lemmas; its text says why."""


class _Vertex:
    """A vertex: its creases counter-clockwise, and unit vectors along them [4, 3]."""

    def __init__(self, creases: Sequence[int], unit: np.ndarray) -> None:
        self.creases, self.unit = list(creases), unit
        two = np.roll(unit, -1, axis=0)
        self.sectors = np.arctan2(np.cross(unit, two)[:, 2], (unit * two).sum(axis=1))

    def closes(self, phi: np.ndarray) -> bool:
        """Return whether rotations by folds leave all where it is, turned by no full turn."""
        turn = np.eye(2, dtype=complex)
        for u, a in zip(self.unit, phi.tolist(), strict=True):
            axis = np.array([[0, u[0] - 1j * u[1]], [u[0] + 1j * u[1], 0]])
            turn = turn @ (math.cos(a / 2) * np.eye(2) - 1j * math.sin(a / 2) * axis)
        return bool(np.abs(turn - np.eye(2)).max() < CLOSED)

    def folds(self, place: int, first: np.ndarray, side: int) -> np.ndarray:
        """Return folds [4, K] from the one at a place, the crease opposite on a side; nan where none close."""
        u = np.roll(self.unit, -place, axis=0)
        u1, u2 = (np.broadcast_to(x, (len(first), 3)) for x in u[:2])
        c, s = np.cos(first)[:, None], np.sin(first)[:, None]
        u4 = u[3] * c - np.cross(u[0], u[3]) * s + u[0] * (u[0] @ u[3]) * (1 - c)
        # u3 has the products that it has in the sheet with u2 and u4
        p, q, d = u[2] @ u[1], u[2] @ u[3], (u2 * u4).sum(axis=1)
        a, b = (p - q * d) / (1 - d * d), (q - p * d) / (1 - d * d)
        height = side * np.sqrt((1 - a * a - b * b - 2 * a * b * d) / (1 - d * d))
        u3 = a[:, None] * u2 + b[:, None] * u4 + height[:, None] * np.cross(u2, u4)
        ring = [u4, u1, u2, u3, u4, u1]
        out = []
        for before, at, after in (ring[i : i + 3] for i in range(4)):
            n, m = np.cross(before, at), np.cross(at, after)
            out.append(np.arctan2((at * np.cross(n, m)).sum(axis=1), (n * m).sum(axis=1)))
        return np.roll(np.array(out), place, axis=0)


def _vertices(said: StatedSheet) -> list[_Vertex]:
    """Return the interior vertices, each after one that shares a crease with it."""
    place = np.array([(*p, 0.0) for p in said.corners])
    crease = {frozenset(c): i for i, c in enumerate(said.creases)}
    after: dict[int, dict[int, int]] = {}
    for f in said.facets:
        for a, v, b in zip(f, f[1:] + f[:1], f[2:] + f[:2], strict=True):
            if b in after.setdefault(v, {}):
                raise NoSheet("facets overlap along a side, or one is clockwise")
            after[v][b] = a
    found = []
    for v, following in after.items():
        ring = [next(iter(following))]
        while following.get(ring[-1], ring[0]) != ring[0]:
            ring.append(following[ring[-1]])
        if {*ring} != {*following} or ring[-1] not in following:
            continue
        if len(ring) != 4 or any(frozenset((v, w)) not in crease for w in ring):
            raise NoSheet(f"vertex {v} has not four creases")
        away = place[ring] - place[v]
        one = _Vertex(
            [crease[frozenset((v, w))] for w in ring], away / np.linalg.norm(away, axis=1)[:, None]
        )
        if not np.isclose(one.sectors.sum(), math.tau) or not (one.sectors > 0).all():
            raise NoSheet(f"vertex {v} is not flat")
        found.append(one)
    order = found[:1]
    for one in order:
        order += [r for r in found if r not in order and {*r.creases} & {*one.creases}]
    if len(order) < len(found) or {c for r in found for c in r.creases} != {*crease.values()}:
        raise NoSheet("vertices do not hang together, or a crease is none of theirs")
    return order


def sheet_minima(said: StatedSheet) -> Iterator[np.ndarray]:
    """Yield all minima that a scan finds."""
    order = _vertices(said)
    k, rest = np.array(said.stiffness), np.array(said.rest)
    flat = [abs(v.sectors[0] + v.sectors[2] - math.pi) < CLOSED for v in order]
    if any(flat) != all(flat):
        raise NoSheet("some vertices fold flat, and others do not")
    if all(flat):
        yield from _Folding(order, k, rest).minima()
        return
    curves = 0
    for sides in itertools.product((1, -1), repeat=len(order)):
        states = partial(_scan, order, sides)
        theta = np.r_[START, np.linspace(0, math.pi, STATES + 1)[1:] - BEFORE]
        inside = ~np.isnan(states(theta)[1])
        if not inside[0]:
            continue
        if not inside.all():
            end = int(np.argmin(inside))
            low = _until(lambda x, of=states: ~np.isnan(of(x)[1]), *theta[end - 1 : end + 1])  # type: ignore[misc]
            # folds move as a root of what is left of theta there
            near = low - (low - theta[max(end - 2, 0)]) * np.linspace(1, 0, PARTS)[1:] ** 2
            theta = np.r_[theta[: max(end - 2, 0) + 1], near]
        if np.nanmedian(np.abs(states(theta)[1])) < CLOSED:
            curves += 1
            for side in (1, -1):
                for x in _wells(lambda x, of=states, s=side: _bent(k, s * of(x)[0], rest), theta):  # type: ignore[misc]
                    yield side * states(np.array([x]))[0][:, 0]
    if not curves or not rest.any():
        yield np.zeros(len(k))


def _bent(k: np.ndarray, folds: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return the energies of folds [n, K]."""
    return np.asarray(0.5 * k @ (folds - rest[:, None]) ** 2)


def _scan(
    order: Sequence[_Vertex], sides: Sequence[int], theta: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return all folds [n, K], and by how much loops do not close, nan where folds are none of a sheet."""
    folds = {order[0].creases[0]: theta}
    off = np.zeros(len(theta))
    for vertex, side in zip(order, sides, strict=True):
        at = next(i for i, c in enumerate(vertex.creases) if c in folds)
        found = vertex.folds(at, folds[vertex.creases[at]], side)
        # a turn too much: an even number of folds is negative
        off = np.where(np.prod(np.sign(found), axis=0) < 0, off, np.nan)
        for c, phi in zip(vertex.creases, found, strict=True):
            miss = phi - folds.setdefault(c, phi)
            off = np.where(np.abs(miss) > np.abs(off), miss, off)
    return np.array([folds[c] for c in sorted(folds)]), off


def _until(holds: Callable[[np.ndarray], np.ndarray], low: float, high: float) -> float:
    """Return up to where something holds from a number on."""
    for _ in range(12):
        some = np.linspace(low, high, PARTS + 1)
        fails = np.flatnonzero(~holds(some))
        last = int(fails[0]) if len(fails) else PARTS
        low, high = float(some[max(last - 1, 0)]), float(some[last])
    return low


def _wells(energy: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> Iterator[float]:
    """Yield where an energy is least along states of a number, its last one included, its first not."""
    u = energy(x)
    falls, rises = u[1:] <= u[:-1], u[1:] <= np.r_[u[2:], np.inf]
    for i in (np.flatnonzero(falls & rises) + 1).tolist():
        low, high = float(x[i - 1]), float(x[min(i + 1, len(x) - 1)])
        for _ in range(12):
            some = np.linspace(low, high, PARTS + 1)
            least = int(np.argmin(energy(some)))
            low, high = float(some[max(least - 1, 0)]), float(some[min(least + 1, PARTS)])
        yield high if i == len(x) - 1 else 0.5 * (low + high)


ZERO, TURNED, FREE = range(3)


class _Folding:
    """A sheet that folds flat: rows of opposite creases are 0, at +-180 degrees, or move by measured multipliers."""

    def __init__(self, order: Sequence[_Vertex], k: np.ndarray, rest: np.ndarray) -> None:
        self.order, self.k, self.rest = order, k, rest
        self.row = list(range(len(k)))
        for v in order:
            for a, b in (v.creases[::2], v.creases[1::2]):
                old, new = self.row[b], self.row[a]
                self.row = [new if r == old else r for r in self.row]
        self.rows = sorted(set(self.row))
        # of each sign of opposite folds, tan(phi_2/2) over tan(phi_1/2); none where a row is straight
        self.ratio: list[dict[int, float]] = []
        for v in order:
            own = {}
            for side in (1, -1):
                phi = v.folds(0, np.array([1.0]), side)[:, 0]
                ratio = math.tan(phi[1] / 2) / math.tan(phi[0] / 2)
                if CLOSED < abs(ratio) < 1 / CLOSED and np.isclose(abs(phi[2]), 1):
                    own[int(np.sign(phi[2]))] = ratio
            self.ratio.append(own)

    def minima(self) -> Iterator[np.ndarray]:
        """Yield all states that are least along the groups of rows that move, and stay as others begin to."""
        for kind in itertools.product(range(3), repeat=len(self.rows)):
            kinds = dict(zip(self.rows, kind, strict=True))
            ways = [self._ways(kinds, v, r) for v, r in zip(self.order, self.ratio, strict=True)]
            for signs in itertools.product(*ways):
                free = {r for r, one in kinds.items() if one == FREE}
                groups = self._together({r for r, one in kinds.items() if one}, signs, free)
                for states in itertools.product(*(self._least(g, free) for g in groups or ())):
                    phi = np.zeros(len(self.k))
                    for state in states:
                        phi[list(state)] = list(state.values())
                    if groups is not None and self._stays(kinds, phi):
                        if not all(v.closes(phi[v.creases]) for v in self.order):
                            raise NoSheet("states do not close")
                        yield phi

    def _ways(self, kinds: dict[int, int], v: _Vertex, ratio: dict[int, float]) -> list[int]:
        """Return the signs of opposite folds, 0 for any, that a vertex may have."""
        one, two = (kinds[self.row[c]] for c in v.creases[:2])
        if one == two:
            return [s for s in (1, -1) if one == TURNED or s in ratio] if one else [0]
        sign = 1 if two == ZERO or (one, two) == (TURNED, FREE) else -1
        return [] if sign in ratio else [sign]

    def _together(
        self, rows: set[int], signs: Sequence[int], moving: set[int]
    ) -> list[dict[int, float]] | None:
        """Return creases that move together, with factors of tangents; None where a loop does not close."""
        links: dict[int, list[tuple[int, float]]] = {}
        for v, s, ratio in zip(self.order, signs, self.ratio, strict=True):
            a, b, c, d = v.creases
            edges = [(x, y, float(f)) for x, y, f in ((a, c, s), (b, d, -s)) if self.row[x] in rows]
            if {self.row[a], self.row[b]} <= moving:
                edges.append((a, b, ratio[s]))
            for x, y, f in edges:
                links.setdefault(x, []).append((y, f))
                links.setdefault(y, []).append((x, 1 / f))
        groups: list[dict[int, float]] = []
        for first in (c for c, r in enumerate(self.row) if r in rows):
            if any(first in g for g in groups):
                continue
            found, front = {first: 1.0}, [first]
            for x in front:
                for y, f in links.get(x, ()):
                    if y not in found:
                        front.append(y)
                    if abs(found.setdefault(y, f * found[x]) / (f * found[x]) - 1) > CLOSED:
                        return None
            groups.append(found)
        return groups

    def _angles(self, group: dict[int, float], theta: np.ndarray) -> np.ndarray:
        factor = np.array(list(group.values()))[:, None]
        return 2 * np.arctan2(factor * np.sin(theta / 2), np.cos(theta / 2))

    def _energy(self, group: dict[int, float], theta: np.ndarray) -> np.ndarray:
        creases = list(group)
        return _bent(self.k[creases], self._angles(group, theta), self.rest[creases])

    def _least(self, group: dict[int, float], free: set[int]) -> list[dict[int, float]]:
        """Return states of a group: at +-180 degrees, or where its energy is least between."""
        if self.row[min(group)] not in free:
            return [{c: s * math.pi * f for c, f in group.items()} for s in (1, -1)]
        theta = np.linspace(-math.pi, math.pi, STATES + 2)[1:-1]
        wells = list(_wells(lambda x: self._energy(group, x), theta))
        inside = [x for x in wells if NEAR < abs(x) and theta[0] < x < theta[-1]]
        return [
            dict(zip(group, self._angles(group, np.array([x]))[:, 0].tolist(), strict=True))
            for x in inside
        ]

    def _stays(self, kinds: dict[int, int], phi: np.ndarray) -> bool:
        """Return whether the energy grows as rows that are 0, or at +-180 degrees, begin to move."""
        for kind in (ZERO, TURNED):
            rows = [r for r, one in kinds.items() if one == kind]
            for many in range(1, len(rows) + 1):
                for some in itertools.combinations(rows, many):
                    freed = kinds | dict.fromkeys(some, FREE)
                    ways = [
                        [s for s in self._ways(freed, v, r) if self._fits(v, s, phi)]
                        if {self.row[c] for c in v.creases} & {*some}
                        else [0]
                        for v, r in zip(self.order, self.ratio, strict=True)
                    ]
                    for signs in itertools.product(*ways):
                        groups = self._together({*some}, signs, {*some})
                        if groups is not None and len(groups) == 1 and self._falls(groups[0], phi):
                            return False
        return True

    def _fits(self, v: _Vertex, sign: int, phi: np.ndarray) -> bool:
        a, b, c, d = np.sign(phi[v.creases])
        return bool(c == sign * a and d == -sign * b)

    def _falls(self, group: dict[int, float], phi: np.ndarray) -> bool:
        """Return whether the energy falls from a state along a curve that begins there."""
        for theta in (LEAST, -LEAST, math.pi - LEAST, LEAST - math.pi):
            start = 0.0 if abs(theta) == LEAST else math.copysign(math.pi, theta)
            at = self._angles(group, np.array([start]))[:, 0]
            if np.abs(at - phi[list(group)]).max() < LEAST:
                here, there = self._energy(group, np.array([start, theta]))
                if there < here:
                    return True
        return False


BOXES = 1_000_000
"""Of a vertex, all its windings: five minutes."""
SECOND = "a second program in {}, which found the list again; lemmas are those of the prover"


@dataclass(frozen=True)
class Check:
    """What came of a check.

    Attributes
    ----------
    refused
        What is listed and was not found, or found and is not listed, the first; empty: the lists are the same.
    minima
        How many were found again.
    open
        What the proof leaves open, or the check, a line each; empty: the list is complete.
    by
        What found it.
    """

    refused: str
    minima: int
    open: tuple[str, ...]
    by: str

    @property
    def lines(self) -> list[str]:
        """All of it, as the command prints it."""
        if self.refused:
            return [f"refused: {self.refused}"]
        many = f"{self.minima} {'minimum' if self.minima == 1 else 'minima'}"
        head = "checked" if not self.open else "checked, but not all is decided"
        return [f"{head}: {many} found again", *(f"open: {o}" for o in self.open), f"by {self.by}"]

    def to_dict(self) -> dict[str, object]:
        """Return all of it as plain data, for JSON."""
        return {
            "schema": "origami-nlp/check/1",
            "checked": not self.refused,
            "refused": self.refused or None,
            "complete": not (self.refused or self.open),
            "minima": self.minima,
            "open": list(self.open),
            "by": self.by,
        }


def check_proof(proof: str | Path | Certificate) -> Check:
    """Find the list of a proof again, by a second program.

    Parameters
    ----------
    proof
        The file, ``"-"`` for standard input, or a certificate that was read.

    Returns
    -------
    Check
        Whether the lists are the same.

    Raises
    ------
    CertificateError
        If the file cannot be read or is no proof.
    """
    said = read_certificate(proof) if isinstance(proof, str | Path) else proof
    found = _of_sheet(said.sheet) if said.sheet else _of_vertex(said, cast("Scene", said.scene))
    refused, left = found.refused, list(found.minima)
    for number, one in enumerate(said.minima, start=1):
        far = [float(np.abs(x - one.fold_angles).max()) for x in left]
        if not one.radius <= NEAR:
            refused = refused or f"minimum {number} is listed to within {one.radius:.3g} rad"
        elif not far or min(far) > NEAR + one.radius:
            refused = refused or f"minimum {number} was not found again"
        else:
            del left[int(np.argmin(far))]
    low, high = said.regions
    for phi in left:
        if not ((low - NEAR <= phi) & (phi <= high + NEAR)).all(axis=1).any():
            refused = refused or f"a minimum is not listed: {_angles(phi)}"
    reasons = (*(one.reason for one in said.undecided), *found.open)
    return Check(refused, len(found.minima), reasons, SECOND.format(found.arithmetic))


class _Found(NamedTuple):
    """Minima, why the proof is refused, what stays open, in which arithmetic."""

    minima: list[np.ndarray]
    refused: str
    open: list[str]
    arithmetic: str


def _of_sheet(sheet: StatedSheet) -> _Found:
    found: list[np.ndarray] = []
    with np.errstate(all="ignore"):
        try:
            for phi in sheet_minima(sheet):
                if not any(np.abs(phi - x).max() < NEAR for x in found):
                    found.append(phi)
        except NoSheet as problem:
            return _Found([], str(problem), [], "doubles")
    return _Found(found, "", [], "doubles")


def _of_vertex(said: Certificate, scene: Scene) -> _Found:
    if scene.contact != "fold-limits" or scene.laws or scene.loads or not scene.is_flat:
        return _Found([], "no vertex of linear springs within fold limits", [], "balls")
    low, high = said.regions
    listed = np.array([one.fold_angles for one in said.minima]).reshape(-1, 1, scene.degree)
    beside = ((low - BESIDE <= listed) & (listed <= high + BESIDE)).all(axis=2).any(axis=0)
    wider = np.where(beside, 0.0, BESIDE)[:, None]
    left_open, found = np.stack([low - wider, high + wider], axis=1), _Found([], "", [], "balls")
    boxes = 0
    if scene.is_symmetric:
        near = np.full((1, 2, scene.degree), BESIDE) * [[[-1], [1]]]
        left_open = np.concatenate([left_open, near])
        found.open.append(f"within {BESIDE:g} rad of the flat state the check does not look")
    for winding in scene.windings:
        search = VertexSearch(scene, winding, left_open, BOXES - boxes)
        boxes += search.boxes
        found.minima.extend(search.minima)
        if boxes >= BOXES:
            found.open.append(f"the check ended after {boxes} boxes")
        elif search.rest:
            why = f"a minimum is not excluded: {_angles(search.rest[0].mean(axis=0))}"
            return found._replace(refused=why)
    return found


def _angles(phi: np.ndarray) -> str:
    return f"fold angles ({', '.join(f'{a:.6g}' for a in np.degrees(phi).tolist())}) deg"
