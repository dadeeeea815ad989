"""The closed states of a mesh of flat vertices of degree four that fold flat: opposite sectors sum to 180 degrees.

Round a vertex with creases u_1..u_4 and sectors a_1..a_4 let c_i, s_i be cosine and sine of half its fold angles, S =
a_1 + a_2 the angle from u_1 to u_3 and D = a_1 - a_2 that from u_2 to -u_4.  The law of cosines across the vertex
(`fold_states`) has q = 1, so phi_3 = +-phi_1, and phi_4 = +-phi_2.  In quaternions q_1 q_2 = (q_3 q_4)^-1 says
s_1 s_2 = -s_3 s_4 off the sheet, so that the signs differ (or one pair is 0 and either sign will do), and in it

    phi_3 = phi_1,  phi_4 = -phi_2:  s_1 c_2 cos(S/2) + c_1 s_2 cos(D/2) = 0    (sign 1)
    phi_3 = -phi_1, phi_4 = phi_2:   s_1 c_2 sin(S/2) - c_1 s_2 sin(D/2) = 0    (sign -1)

and nothing else.  cos(D/2) and sin(S/2) are not 0.  Where the other number is not 0 either, that is
tan(phi_2/2) = kappa tan(phi_1/2), the fold-angle multiplier, 0 and 180 degrees included; where it is (creases 1 and 3,
or 2 and 4, are in one line) either the creases across the line are 0, or those of the line are at +-180 degrees.

So |phi| is one along each row of opposite creases, and with a sign, and one of those two, chosen at each vertex, rows
are 0, at +-180 degrees, or move with others by multipliers: products of curves, each with an energy of its own.  Round
a loop of rows the product K of multipliers is 1, and the loop moves, or it is at 0 or +-180 degrees.
kappa^2 = (1 + u_1.u_3) / (1 - u_2.u_4) or (1 - u_1.u_3) / (1 + u_2.u_4): K = 1 is decided by factors that cancel.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern
from origami_nlp.proof.balls import Ball, exact
from origami_nlp.proof.flat_sheets import cross, dot, flat_sheet, off_line, sector_sum
from origami_nlp.proof.rows import UNIT

MOST_MODES = 5_000
"""Choices of a sign and a branch at each vertex, at most."""
Key = tuple[tuple[int, int], ...]
"""A multiplier squared: classes of cosines x and exponents of 1 + x."""


class VertexMode(NamedTuple):
    """What a vertex does: phi_3 = sign phi_1 and phi_4 = -sign phi_2, and how the pairs (1, 3) and (2, 4) are related.

    `held`: the pair that is 0 or at +-180 degrees, and which of these; None where a multiplier relates them.
    """

    sign: int
    held: tuple[int, str] | None


class Crossing(NamedTuple):
    """A vertex: its creases, and the multiplier of each sign, with its own sign; None where a pair is in one line."""

    creases: tuple[int, ...]
    multipliers: dict[int, tuple[int, Key] | None]

    @property
    def modes(self) -> list[VertexMode]:
        """All that the vertex can do."""
        found = []
        for sign, line in ((1, 0), (-1, 1)):
            if self.multipliers[sign] is not None:
                found.append(VertexMode(sign, None))
            else:
                found += [VertexMode(sign, (1 - line, "flat")), VertexMode(sign, (line, "folded"))]
        return found


class Member(NamedTuple):
    """A row of a curve: its creases, each with its sign, and its multiplier, with its sign."""

    creases: tuple[tuple[int, int], ...]
    sign: int
    key: Key


Curve = tuple[Member, ...]
"""Rows that move together, tan(x/2) = sign kappa tan theta; the first has multiplier 1."""


class StateProduct(NamedTuple):
    """A product of closed states: creases that are 0, rows at +-180 degrees, and curves."""

    flat: frozenset[int]
    folded: tuple[tuple[tuple[int, int], ...], ...]
    curves: tuple[Curve, ...]


@dataclass(frozen=True)
class FoldingMesh:
    """A mesh in which every vertex folds flat.

    Attributes
    ----------
    crossings
        Its vertices.
    rows
        Creases of each row, in order.
    factors
        1 + x of each class of cosines, enclosed.
    deviation
        By how much the sectors of the file differ from the relations that are taken as exact [rad].
    creases
        How many.
    moved
        `SheetInPlane.moved`.
    """

    crossings: tuple[Crossing, ...]
    rows: tuple[tuple[int, ...], ...]
    factors: tuple[Ball, ...]
    deviation: float
    creases: int
    moved: float

    def multiplier(self, key: Key) -> Ball:
        """Return kappa > 0, enclosed."""
        square = exact(1.0)
        for which, power in key:
            factor = self.factors[which] if power > 0 else self.factors[which].inverse()
            for _ in range(abs(power)):
                square = square * factor
        return square.root()

    def products(self, modes: Sequence[VertexMode]) -> Iterator[StateProduct | None]:
        """Yield the closed states in which vertices do so; None where it is not certain whether a loop moves."""
        signs, stuck = self._signs(modes)
        row_of = {c: r for r, row in enumerate(self.rows) for c in row}
        kind: dict[int, str] = dict.fromkeys(stuck, "flat")
        links: list[list[tuple[int, int, Key]]] = [[] for _ in self.rows]
        front = []
        for crossing, mode in zip(self.crossings, modes, strict=True):
            one, two = (row_of[c] for c in crossing.creases[:2])
            if mode.held is not None:
                front.append(((one, two)[mode.held[0]], mode.held[1]))
                continue
            sign, key = crossing.multipliers[mode.sign] or (0, ())
            sign *= signs[crossing.creases[0]] * signs[crossing.creases[1]]
            links[one].append((two, sign, key))
            links[two].append((one, sign, _inverse(key)))
        front += list(kind.items())
        kind = {}
        while front:
            row, what = front.pop()
            if kind.get(row, what) != what:
                return
            if row not in kind:
                kind[row] = what
                front += [(other, what) for other, _, _ in links[row]]
        curves: list[Curve] = []
        rigid: list[tuple[int, ...]] = []
        for row in range(len(self.rows)):
            if row in kind or any(row in done for done in rigid):
                continue
            found = self._loops(row, links)
            if found is None:
                yield None
                return
            rows, moves = found
            if not moves:
                rigid.append(tuple(rows))
                continue
            for r in rows:
                kind[r] = "moves"
            curves.append(tuple(Member(self._along(r, signs), *rows[r]) for r in sorted(rows)))
        for both in itertools.product(("flat", "folded"), repeat=len(rigid)):
            of = kind | {r: w for loop, w in zip(rigid, both, strict=True) for r in loop}
            yield StateProduct(
                frozenset(c for r, row in enumerate(self.rows) for c in row if of[r] == "flat"),
                tuple(self._along(r, signs) for r in range(len(self.rows)) if of[r] == "folded"),
                tuple(curves),
            )

    def _along(self, row: int, signs: dict[int, int]) -> tuple[tuple[int, int], ...]:
        return tuple((c, signs[c]) for c in self.rows[row])

    def _signs(self, modes: Sequence[VertexMode]) -> tuple[dict[int, int], set[int]]:
        """Return the sign of each crease along its row, and rows that these make 0."""
        pairs: dict[int, list[tuple[int, int]]] = {}
        for crossing, mode in zip(self.crossings, modes, strict=True):
            for i, sign in ((0, mode.sign), (1, -mode.sign)):
                a, b = crossing.creases[i], crossing.creases[i + 2]
                pairs.setdefault(a, []).append((b, sign))
                pairs.setdefault(b, []).append((a, sign))
        signs: dict[int, int] = {}
        stuck = set()
        for r, row in enumerate(self.rows):
            signs[row[0]] = 1
            front = [row[0]]
            for a in front:
                for b, sign in pairs.get(a, ()):
                    if b not in signs:
                        signs[b] = sign * signs[a]
                        front.append(b)
                    elif signs[b] != sign * signs[a]:
                        stuck.add(r)
        return signs, stuck

    def _loops(
        self, row: int, links: list[list[tuple[int, int, Key]]]
    ) -> tuple[dict[int, tuple[int, Key]], bool] | None:
        """Return rows that move with one, each with its multiplier, and whether they do; None: not certain."""
        found: dict[int, tuple[int, Key]] = {row: (1, ())}
        front, moves = [row], True
        for a in front:
            for b, sign, key in links[a]:
                there = found[a][0] * sign, _product(found[a][1], key)
                if b not in found:
                    found[b] = there
                    front.append(b)
                    continue
                left = _product(there[1], _inverse(found[b][1]))
                if there[0] != found[b][0]:
                    moves = False
                elif left:
                    if (self.multiplier(left) - exact(1.0)).sign == 0:
                        return None
                    moves = False
        return found, moves


def _product(one: Key, two: Key) -> Key:
    total = Counter(dict(one))
    for which, power in two:
        total[which] += power
    return tuple(sorted((w, p) for w, p in total.items() if p))


def _inverse(key: Key) -> Key:
    return tuple((which, -power) for which, power in key)


def as_folding_mesh(pattern: Pattern, modes: int = MOST_MODES) -> tuple[FoldingMesh | None, str]:
    """Return the mesh of a pattern, or None and why its states are not enumerated."""
    sheet, why = flat_sheet(pattern)
    if sheet is None:
        return None, why
    deviation = 0.0
    cosines: list[tuple[Fraction, Fraction]] = []
    drafts: list[tuple[tuple[int, ...], list[int], list[bool]]] = []
    for one in sheet.rounds:
        u = one.directions
        off = sector_sum(u)
        if off > CLOSURE_TOL:
            return (
                None,
                f"vertex {one.vertex} does not fold flat: opposite sectors sum to {off:.2g} rad off 180 degrees",
            )
        bent = [cross(u[i], u[i + 2]) for i in (0, 1)]
        lines = []
        for i in (0, 1):
            away = off_line(u[i], u[i + 2])
            lines.append(away <= CLOSURE_TOL)
            deviation = max(deviation, away if lines[-1] else 0.0)
            size = dot(u[i], u[i]) * dot(u[i + 2], u[i + 2])
            cosines.append((dot(u[i], u[i + 2]), size))
        deviation = max(deviation, off)
        drafts.append((one.creases, [one.sense * (1 if b > 0 else -1) for b in bent], lines))
    values = [float(c) / math.sqrt(s) for c, s in cosines]
    classes: list[float] = []
    number: list[tuple[int, int]] = []
    for x in values:
        near = [[i for i, y in enumerate(classes) if abs(y - z) <= CLOSURE_TOL] for z in (x, -x)]
        for places, z in zip(near, (x, -x), strict=True):
            if not places:
                places.append(len(classes))
                classes.append(z)
            deviation = max(deviation, abs(classes[places[0]] - z))
        number.append((near[0][0], near[1][0]))
    # the sheet of the relations: each cosine within the deviations of all of them
    room = 4 * deviation + 16 * UNIT
    factors = tuple((exact(1.0) + exact(x)).widened(exact(room).centre) for x in classes)
    crossings = []
    for k, (creases, bend, lines) in enumerate(drafts):
        (along, minus_along), (two, minus_two) = number[2 * k], number[2 * k + 1]
        crossings.append(
            Crossing(
                creases,
                {
                    1: None
                    if lines[0]
                    else (-bend[0], _product(((along, 1),), ((minus_two, -1),))),
                    -1: None
                    if lines[1]
                    else (bend[1], _product(((minus_along, 1),), ((two, -1),))),
                },
            )
        )
    if math.prod(len(c.modes) for c in crossings) > modes:
        return None, f"{len(crossings)} vertices can fold in more than {modes} ways"
    return FoldingMesh(
        tuple(crossings),
        _rows(pattern.creases, crossings),
        factors,
        deviation,
        pattern.creases,
        sheet.moved,
    ), ""


def why_no_mesh(pattern: Pattern, modes: int = MOST_MODES) -> str:
    """Return why not all closed states of a pattern are known as those of a mesh that folds flat; "" where they are.

    Parameters
    ----------
    pattern
        Of any number of vertices.
    modes
        Ways to fold all vertices, each by itself, that are gone through at most.

    Returns
    -------
    str
        The first vertex that is in the way, and why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_mesh
    >>> why_no_mesh(o.examples.pattern("miura", 3, 3))
    ''
    >>> why_no_mesh(o.examples.pattern("waterbomb", 2, 2))
    'vertex 0 has not four creases'
    """
    if pattern.limits:
        return "creases have stops: proofs of meshes know fold limits of +-180 degrees only"
    if pattern.laws:
        return "creases have hinge laws: proofs of meshes know linear springs only"
    return as_folding_mesh(pattern, modes)[1]


def _rows(creases: int, crossings: Sequence[Crossing]) -> tuple[tuple[int, ...], ...]:
    """Return creases that are opposite, and those opposite them, together."""
    beside: dict[int, list[int]] = {c: [] for c in range(creases)}
    for crossing in crossings:
        for i in (0, 1):
            a, b = crossing.creases[i], crossing.creases[i + 2]
            beside[a].append(b)
            beside[b].append(a)
    rows, met = [], set()
    for c in range(creases):
        if c in met:
            continue
        front = [c]
        met.add(c)
        for a in front:
            for b in beside[a]:
                if b not in met:
                    met.add(b)
                    front.append(b)
        rows.append(tuple(sorted(front)))
    return tuple(rows)
