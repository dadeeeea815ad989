"""All minima of a sheet of flat vertices of degree four of which none folds flat, with cycles or without.

Let z_i = sin(theta) cot(phi_i/2), and [ij] the cross product of unit vectors along creases i and j.  The four unit
quaternions round a flat vertex have product 1 or -1 exactly where (w_1 + u_1)(w_2 + u_2), w = cot(phi/2), is -[12]/[34]
times (w_4 - u_4)(w_3 - u_3): its part out of the sheet says the factor, that in the sheet

    [13] z_2 = -([23] z_1 + [12] z_3),  [13] z_4 = [34] z_1 + [41] z_3,

its real part s^2 + z_3^2 = [23][34]/([12][41]) (s^2 + z_1^2), s = sin(theta).  The product is 1, no full turn, where an
odd number of folds are negative.  That leaves two curves through the flat state, phi_3 of the sign of phi_1 (mode 1) or
of the other (mode -1).  No fold is 0 off the flat state unless opposite creases are in one line, and no two are at 180
degrees unless the vertex folds flat: both are refused.  So a mode says the signs of all folds: in mode 1 those of w_2
and w_4 are opposite; in mode -1, at flat, w_2 has the sign of ([12][34] - [23][41]) w_1 / [13], and w_4 the same.

With one crease at phi = 2 theta and a mode at each vertex all z are functions of theta, and z = 0 is a fold limit.  In
mode 1 the fold across has 1/sin^2(phi_2/2) = A + B X + C sqrt((X - r_1)(X - r_3)) with X = 1/sin^2(phi_1/2) and B, C >
0, which grows with X; in mode -1 the root has the sign -, that is convex and least where phi_2 or phi_4 is at 180
degrees; and where phi_1 or phi_3 is, both w_2 and w_4 have the sign of w_3 or w_1, so that just one of them has passed
0 on the way.  So folds grow together until one is at 180 degrees, and do not close after that.

A vertex that is reached twice asks that two z be equal: where their difference has no zero no state closes, where it is
steep one at most, a rigid state.
Vertices with equal sectors, in either order, in one mode, from creases with one fold but for its sign, have all folds
in common: such folds are one number here, and a loop that asks for nothing else closes identically, along a curve.

"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from flint import arb, arb_series

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern
from origami_nlp.proof.certificate import ProvedState, Region
from origami_nlp.proof.sheets import (
    TERMS,
    Budget,
    Equal,
    FlatSheet,
    Look,
    VertexRound,
    closer,
    halved,
    least,
    sign_of,
    state_of,
)

MOST_VERTICES = 12
"""Of a sheet: 4,096 choices of modes."""


class QuadVertex(NamedTuple):
    """A vertex: creases, [i i+1] and [i i+2] of each, classes of its sectors, and the signs of folds in each mode."""

    creases: tuple[int, ...]
    beside: tuple[Any, ...]
    across: tuple[Any, ...]
    sectors: tuple[int, ...]
    signs: dict[int, tuple[int, ...]]

    def under(self, p: int, z: Any, square: Any) -> Any:
        """Return the square of z opposite place p from z there, and sin^2 theta."""
        k = self.beside
        ratio = k[(p + 1) % 4] * k[(p + 2) % 4] / (k[p] * k[(p + 3) % 4])
        return (square + z * z) * ratio - square

    def others(self, p: int, z: Any, opposite: Any) -> list[Any]:
        """Return z at the places after p from that at p, and the one opposite."""
        k, c = self.beside, self.across[p]
        return [
            -(k[(p + 1) % 4] * z + k[p] * opposite) / c,
            opposite,
            (k[(p + 3) % 4] * opposite + k[(p + 2) % 4] * z) / c,
        ]


@dataclass(frozen=True)
class QuadSheet:
    """Vertices, each after one that shares a crease with it; by how much sectors taken as equal differ."""

    sheet: FlatSheet
    vertices: list[QuadVertex]
    deviation: float
    folds_flat = False

    def search(self, budget: Budget) -> QuadSearch:
        """Return what goes through its closed states."""
        return QuadSearch(self, budget)

    def signs(self, modes: Sequence[int]) -> dict[int, int] | None:
        """Return the signs of folds of the first vertices in these modes; None where they contradict each other."""
        found: dict[int, int] = {}
        for vertex, mode in zip(self.vertices, modes, strict=False):
            own = dict(zip(vertex.creases, vertex.signs[mode], strict=True))
            known = next((c for c in vertex.creases if c in found), None)
            turn = 1 if known is None else found[known] * own[known]
            for c, s in own.items():
                if found.setdefault(c, turn * s) != turn * s:
                    return None
        return found


def as_quads(sheet: FlatSheet) -> tuple[QuadSheet | None, str]:
    """Return a sheet of which no vertex folds flat, or None and why its states are not enumerated."""
    rounds = sheet.rounds
    if len(rounds) > MOST_VERTICES:
        return None, f"{len(rounds)} vertices (at most {MOST_VERTICES})"
    for one in rounds:
        if not all(abs(one.cross(i, 2)) > CLOSURE_TOL for i in (0, 1)):
            return None, f"at vertex {one.vertex} opposite creases are in one line"
    # the most sensitive first: least is done to its folds before
    order = [min(rounds, key=lambda r: min(float(abs(r.cross(i, 2)).mid()) for i in (0, 1)))]
    for one in order:
        order += [r for r in rounds if r not in order and {*r.creases} & {*one.creases}]
    around = {c for r in rounds for c in r.creases}
    if len(order) < len(rounds) or len(around) < sheet.pattern.creases:
        return None, "vertices do not hang together, or a crease is none of theirs"
    equal = Equal()
    sectors = [tuple(equal.of(a) for a in r.sectors) for r in order]
    vertices = [_vertex(r, s, equal.slack) for r, s in zip(order, sectors, strict=True)]
    return QuadSheet(sheet, vertices, equal.deviation), ""


def _vertex(one: VertexRound, sectors: tuple[int, ...], slack: Any) -> QuadVertex:
    beside, across = ([one.cross(i, n) for i in range(4)] for n in (1, 2))
    side = sign_of(across[0])
    turn = sign_of(beside[0] * beside[2] - beside[1] * beside[3]) * side
    return QuadVertex(
        one.creases,
        tuple(c + slack for c in beside),
        tuple(c + slack for c in across),
        sectors,
        {1: (1, -side, 1, side), -1: (1, turn, -1, turn)},
    )


class VertexStep(NamedTuple):
    """A vertex from one known fold: nodes (numbers of folds) of its creases, the known one, at a place, first."""

    nodes: tuple[int, ...]
    vertex: QuadVertex
    place: int


@dataclass
class Modes:
    """How the folds of a sheet follow from one of them, its first vertices in these modes.

    Attributes
    ----------
    quads, modes, drive
        One crease has phi = 2 theta.
    signs
        Of folds, for theta > 0.
    node
        The number of the fold of each crease; that of `drive` is 0.
    sense
        Of each number, the sign of the fold that it is, for theta > 0.
    steps, loops
        What is computed, in order; pairs of numbers that must agree.
    """

    quads: QuadSheet
    modes: tuple[int, ...]
    drive: int
    signs: dict[int, int]
    node: dict[int, int] = field(default_factory=dict)
    sense: list[int] = field(default_factory=list)
    steps: list[VertexStep] = field(default_factory=list)
    loops: list[tuple[int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        turn = self.signs[self.drive]
        self.signs = {c: turn * s for c, s in self.signs.items()}
        known: dict[Any, tuple[int, ...]] = {}
        self._number(self.drive)
        left = list(range(len(self.modes)))
        while left:
            v = next(i for i in left if {*self.quads.vertices[i].creases} & {*self.node})
            left.remove(v)
            self._vertex(v, known)

    def _number(self, crease: int) -> int:
        """Return a new number for the fold of a crease."""
        self.sense.append(self.signs[crease])
        self.node.setdefault(crease, len(self.sense) - 1)
        return len(self.sense) - 1

    def _vertex(self, v: int, known: dict[Any, tuple[int, ...]]) -> None:
        vertex = self.quads.vertices[v]
        creases = vertex.creases
        places = [p for p in range(4) if creases[p] in self.node]
        for p in places:
            key, way = self._seen(v, p, self.node[creases[p]])
            if key in known:
                at = dict(zip(way, known[key], strict=True))
                break
        else:
            p = places[0]
            way = tuple((p + i) % 4 for i in range(4))
            nodes = (self.node[creases[p]], *(self._number(creases[i]) for i in way[1:]))
            at = dict(zip(way, nodes, strict=True))
            self.steps.append(VertexStep(nodes, vertex, p))
            for i in range(4):
                key, way = self._seen(v, i, at[i])
                known[key] = tuple(at[j] for j in way)
        for i, number in at.items():
            if (one := self.node.setdefault(creases[i], number)) != number:
                self.loops.append((number, one))

    def _seen(self, v: int, p: int, number: int) -> tuple[Any, tuple[int, ...]]:
        """Return a vertex as it is seen from one of its creases, and the order in which its creases are."""
        sectors, mode = self.quads.vertices[v].sectors, self.modes[v] * (-1) ** p
        ahead, back = (tuple((p + s * i) % 4 for i in range(4)) for s in (1, -1))
        one = tuple(sectors[i] for i in ahead)
        two = tuple(sectors[(i - 1) % 4] for i in back)
        return min(((number, one, mode), ahead), ((number, two, mode), back))

    def states(self, theta: Any) -> list[Any] | None:
        """Return |z| of all numbers as series over theta; None where some state is certainly not within fold limits."""
        middle = self._states(theta.mid(), ([], []))
        zs, _ = middle if theta == theta.mid() else self._states(theta, middle)
        return None if len(zs) < len(self.sense) or any(z[0] < 0 for z in zs) else zs

    def _states(self, theta: Any, at: tuple[list[Any], list[Any]]) -> tuple[list[Any], list[Any]]:
        """Return |z|, and the squares that roots are drawn of, as long as these are real.

        By those in the middle they are known better.
        """
        x = arb_series([theta, 1], TERMS)
        s = x.sin()
        square, away = s * s, theta - theta.mid()

        def better(x: Any, known: list[Any], number: int) -> Any:
            return narrowed(x, known[number], away) if number < len(known) else x

        zs, squares = [x.cos()], list[Any]()
        for nodes, vertex, p in self.steps:
            known, *senses = (self.sense[n] for n in nodes)
            z = known * zs[nodes[0]]
            squares.append(better(vertex.under(p, z, square), at[1], len(squares)))
            if squares[-1][0] < 0:
                break
            own = vertex.others(p, z, senses[1] * _root(squares[-1]))
            for value, sense in zip(own, senses, strict=True):
                zs.append(better(sense * value, at[0], len(zs)))
        return zs, squares

    def folds(self, theta: Any, zs: list[Any]) -> list[Any]:
        """Return the folds of all numbers, for theta > 0, as series."""
        x = arb_series([theta, 1], TERMS)
        s = x.sin()
        found = [2 * self.sense[0] * x]
        for z, sense in zip(zs[1:], self.sense[1:], strict=True):
            if z[0] > 0 and not (s[0] > 0 and z[0].mid() < s[0].mid()):
                half = (s / z).atan()
            elif s[0] > 0:
                half = arb.pi() / 2 - (z / s).atan()
            else:
                half = arb_series([arb.nan()] * TERMS, TERMS)
            found.append(2 * sense * half)
        return found

    def of_creases(self, folds: Sequence[Any], side: int) -> list[Any]:
        """Return the folds of all creases on a side of the flat state from those of all numbers."""
        return [
            side * self.signs[c] * self.sense[n] * folds[n] for c, n in sorted(self.node.items())
        ]


def _root(under: Any) -> Any:
    """Return the root of a series; where it may be 0, its value alone."""
    if under[0] > 0:
        return under.sqrt()
    value = arb(0).union(abs(under[0]).upper().sqrt())
    return arb_series([value, *[arb.nan()] * (TERMS - 1)], TERMS)


def narrowed(box: Any, at: Any, away: Any) -> Any:
    """Return a series over a ball, by Taylor about its middle where it is so known better."""
    found = [box[j] for j in range(TERMS)]
    for j in range(TERMS - 1):
        value = math.comb(TERMS - 1, j) * box[TERMS - 1]
        for k in range(TERMS - 2, j - 1, -1):
            value = value * away + math.comb(k, j) * at[k]
        found[j] = closer(found[j], value)
    return arb_series(found, TERMS)


QUARTER = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
ALIKE = 1e-9
"""Folds that differ by less reach 180 degrees all but together: none is known to be the first [rad]."""
WIDEST = 1e-6
"""Radius within which a minimum is listed, at most [rad]: a wider one names no state."""


class CurveState(NamedTuple):
    """States of a curve over theta: |z| of all numbers, folds of all creases, U' and U''."""

    zs: list[Any]
    folds: list[Any]
    first: Any
    second: Any


class QuadCurve:
    """The energy along a curve through the flat state, on a side of it; fold limits as gaps."""

    def __init__(self, modes: Modes, side: int, pattern: Pattern) -> None:
        self.modes, self.side = modes, side
        springs = zip(pattern.stiffness.tolist(), pattern.rest.tolist(), strict=True)
        self.hinges = [(arb(k), arb(rest)) for k, rest in springs]
        self.sides = {c: side * s for c, s in modes.signs.items()}

    def _known(self, x: Any, middle: CurveState | None) -> CurveState | None:
        zs = self.modes.states(x)
        if zs is None:
            return None
        folds = self.modes.of_creases(self.modes.folds(x, zs), self.side)
        if middle:
            both = zip(folds, middle.folds, strict=True)
            folds = [narrowed(f, at, x - x.mid()) for f, at in both]
        first, second = arb(0), arb(0)
        for phi, (k, rest) in zip(folds, self.hinges, strict=True):
            torque = k * (phi[0] - rest)
            first += torque * phi[1]
            second += k * phi[1] * phi[1] + 2 * torque * phi[2]
        return CurveState(zs, folds, first, second)

    def over(self, x: Any) -> Look | None:
        """Return U', U'' and gaps over theta."""
        middle = at = self._known(x.mid(), None)
        box = at if x == x.mid() else self._known(x, at)
        if box is None:
            return None
        gaps = {n: (z[0], z[1]) for n, z in enumerate(box.zs)}
        first = box.first
        if middle:
            first = closer(first, middle.first + box.second * (x - x.mid()))
        return Look(first, box.second, gaps, box.folds)

    def state(self, low: float, high: float, gaps: Sequence[Any] = ()) -> ProvedState | None:
        """Return the state of a minimum between two numbers, held by some of the gaps; None where it is not known."""
        known = self.over(arb(low).union(arb(high)))
        if known is None:
            return None
        ends = [self.over(arb(x)) for x in (low, high)]
        held = {n for n in gaps if not all(e is not None and e.gaps[n][0] > 0 for e in ends)}
        exactly = {c: self.sides[c] * math.pi for c, n in self.modes.node.items() if n in held}
        return state_of([f[0] for f in known.known], exactly)


class QuadSearch:
    """All choices of modes, what closes in each, and its minima.

    Attributes
    ----------
    minima, open
        What is shown, and what is left.
    curves
        How many go through the flat state.
    """

    def __init__(self, quads: QuadSheet, budget: Budget) -> None:
        self.quads, self.budget = quads, budget
        self.pattern = pattern = quads.sheet.pattern
        self.minima: list[ProvedState] = []
        self.open: list[Region] = []
        self.curves = 0
        self.rests = not pattern.rest.any()
        first = quads.vertices[0]
        k = first.beside
        # of two opposite creases that which folds more
        self.drive = first.creases[0 if k[1] * k[2] > k[0] * k[3] else 2]

    @property
    def over(self) -> str:
        """Over which states the statement ranges, in words."""
        return (
            f"the flat state and {self.curves} curves through it, along which vertices of equal sectors "
            "fold alike"
        )

    def run(self) -> None:
        """Go through all choices; then ask of the flat state."""
        self._choose((), [(0.0, QUARTER)])
        # off it the energy falls along every curve, but where no spring pulls
        if not self.curves or self.rests:
            self.minima.append(ProvedState(np.zeros(self.pattern.creases), 0.0))

    def _choose(self, modes: tuple[int, ...], left: list[tuple[float, float]]) -> None:
        """Choose a mode at each vertex in turn; theta is in what is left."""
        signs = self.quads.signs(modes)
        if signs is None:
            return
        whole = len(modes) == len(self.quads.vertices)
        if modes:
            links = Modes(self.quads, modes, self.drive, signs)
            if links.loops:
                left = self._closing(links, left)
        if not whole:
            for mode in (1, -1) if left else ():
                self._choose((*modes, mode), left)
        elif not links.loops:
            self._curve(links)
        else:
            for low, high in left:
                zs = links.states(arb(low).union(arb(high)))
                alone = zs is not None and bool(sign_of(_differ(zs, links.loops[0])[1]))
                for side in (1, -1):
                    self._leave(links, side, low, high, "a rigid state", alone)

    def _curve(self, links: Modes) -> None:
        """Add the minima of a curve along which all loops close."""
        self.curves += 1
        links = _first_folded(links)
        for side in (1, -1):
            curve = QuadCurve(links, side, self.pattern)
            found = least(curve.over, 0.0, QUARTER, self.budget, self.rests)
            for low, high, why in found.open:
                self._leave(links, side, low, high, why)
            for low, high, gaps in found.minima:
                state = curve.state(low, high, gaps)
                if state is not None and state.radius <= WIDEST:
                    self.minima.append(state)
                else:
                    self._leave(links, side, low, high, "the fold angles of a minimum")

    def _closing(self, links: Modes, left: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """Return the smallest intervals in which loops may close, those that meet as one."""
        found = list[tuple[float, float]]()
        for ends in left:
            for low, high, none in halved(partial(self._none, links), *ends, self.budget):
                if not none and found and found[-1][1] == low:
                    found[-1] = found[-1][0], high
                elif not none:
                    found.append((low, high))
        return found

    def _none(self, links: Modes, low: float, high: float) -> bool | None:
        """Return whether no state closes in an interval; None where that is not known."""
        theta = arb(low).union(arb(high))
        at, zs = links.states(theta.mid()), links.states(theta)
        if zs is None:
            return True
        off = [_differ(zs, one) for one in links.loops]
        if at is not None:
            both = zip(off, links.loops, strict=True)
            off = [narrowed(x, _differ(at, one), theta - theta.mid()) for x, one in both]
        return any(sign_of(x[0]) for x in off) or None

    def _leave(
        self, links: Modes, side: int, low: float, high: float, why: str, alone: bool = False
    ) -> None:
        ends = np.array([np.full(self.pattern.creases, s * math.pi) for s in (-1, 1)])
        theta = arb(low).union(arb(high))
        zs = links.states(theta)
        folds = links.of_creases(links.folds(theta, zs), side) if zs else []
        for (c, _), f in zip(sorted(links.node.items()), folds, strict=bool(folds)):
            s = side * links.signs[c]
            ends[:, c] = (0.0, math.pi) if s > 0 else (-math.pi, 0.0)
            if f[0].is_finite():
                ends[0, c] = max(ends[0, c], float(f[0].lower()))
                ends[1, c] = min(ends[1, c], float(f[0].upper()))
        self.open.append(Region(ends[0], ends[1], why, alone, alone))


def _differ(zs: Sequence[Any], loop: tuple[int, int]) -> Any:
    return zs[loop[0]] - zs[loop[1]]


def _first_folded(links: Modes) -> Modes:
    """Return a curve given by the crease that is first at 180 degrees: no root is 0 before."""
    low, high = 0.0, 0.5 * math.pi
    for _ in range(60):
        middle = 0.5 * (low + high)
        zs = links.states(arb(middle))
        low, high = (low, middle) if zs is None or any(not z[0] > 0 for z in zs) else (middle, high)
    zs = links.states(arb(low))
    if zs is None:
        return links
    sizes = [float(z[0].mid()) for z in zs]
    first = sizes.index(min(sizes))
    if not first or sizes[0] - sizes[first] < ALIKE:
        return links
    drive = min(c for c, n in links.node.items() if n == first)
    return Modes(links.quads, links.modes, drive, links.signs)
