"""Which contacts are closed at a state.

Fold limits, mirrors and the axis are one contact each.  Two facets that touch are kept apart by either
of two pieces of geometry: the other facet stays on one side of the plane of the first, or the first
on one side of the plane of the second (two arcs do not cross exactly when one of these holds).
Each choice is a *piece*: the contacts it closes at this state.  Where only one is possible, the
feasible set near the state is smooth; where two are, it is their union.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from operator import or_

import numpy as np

from origami_nlp.folding import LARGEST_TOLERANCE, LayerProblem, fold_vertex, layer_problem
from origami_nlp.numerics import (
    ANSWERED,
    CONTACT_TOL,
    NEAR_SINGULAR_TOL,
    RANK,
    UNPOLISHED,
    cross,
    quaternion as quat,
)
from origami_nlp.problem.contact import Contact
from origami_nlp.problem.gaps import Gap
from origami_nlp.problem.posed import PosedProblem

Rays = Callable[[], np.ndarray]
Point = Sequence[float]
MOST_LISTED = 256
"""Pieces of the feasible set that are listed one by one."""


@dataclass(frozen=True)
class ClosedContacts:
    """Closed contacts at a state.

    base: rows that always hold.
    branches: for each touching facet pair its possible sets of rows.
    implied: rows that only describe a base row again (crease k lies on a facet because the crease
        between them is folded flat), with that base row.
    complete: whether the pieces are the feasible set beside the state, to first order; else they hold more than it, so
        that a minimum of them is one, and that a state is not a minimum is shown by a lower state alone.
    """

    base: tuple[Contact, ...]
    branches: tuple[tuple[tuple[Contact, ...], ...], ...]
    implied: tuple[tuple[Contact, Contact], ...]
    complete: bool = True

    @property
    def few(self) -> bool:
        """Whether the pieces that meet are few enough to be listed."""
        return math.prod(len(b) for b in self.branches) <= MOST_LISTED

    def combinations(self) -> list[tuple[Contact, ...]] | None:
        """Return every choice of branches as one set of rows, or None where they are too many to be listed.

        A choice whose rows include those of another describes a part of it and is left out.
        """
        if not self.few:
            return None
        bit: dict[Contact, int] = {}
        sets: dict[int, tuple[tuple[Contact, ...], ...]] = {self._said(self.base, bit): ()}
        for branch in self.branches:  # rows as bits; of choices that say the same the first
            before, sets = sets, {}
            said = [(option, self._said(option, bit)) for option in branch]
            for held, choice in before.items():
                for option, rows in said:
                    sets.setdefault(held | rows, (*choice, option))
        return [
            tuple(dict.fromkeys((*self.base, *itertools.chain.from_iterable(choice))))
            for held, choice in sets.items()
            if not any(other & held == other and other != held for other in sets)
        ]

    @staticmethod
    def _said(rows: Iterable[Contact], bit: dict[Contact, int]) -> int:
        """Return rows as bits, which they get as they come."""
        return functools.reduce(or_, (bit.setdefault(c, 1 << len(bit)) for c in rows), 0)


@dataclass(frozen=True)
class ContactWords:
    """Who touches in a contact.

    type: ``fold-limit``; of a vertex ``mirror``, ``axis`` or ``facet-pair``; of a pattern ``vertex-face``,
    ``edge-edge`` or ``face-face``.
    creases: 1-based, all images under the symmetry included for creases at a fold limit.
    facets: 1-based; a facet pair names its two facets, a touch in a pattern that of the face first.
    text: the contact in words.
    corners: of a touch in a pattern, 1-based: the corner that is on a face and three of the face, or two ends of each
    side.
    side: of facets face to face, as in faceOrders of a FOLD file: +1 where the second one lies on the side of the first
    one's normal, -1 where it lies on the other; else 0.
    place: of facets face to face, the point of the second one at which the force acts, in the sheet's reference state.
    """

    type: str
    creases: tuple[int, ...]
    facets: tuple[int, ...]
    text: str
    corners: tuple[int, ...] = ()
    side: int = 0
    place: tuple[float, ...] = ()


def contact_words(model: PosedProblem, contact: Contact, rays: Rays) -> ContactWords:
    """Name the facets and creases of a contact; a facet pair by its two creases where these lie on each other."""
    text = model.name(contact)
    if contact.is_limit:
        return ContactWords("fold-limit", model.creases_of(contact.index), (), text)
    gap = model.structure.gaps[contact.index]
    if gap.pair is not None:
        text = _where_rays_meet(model, rays(), gap) or text
        return ContactWords(gap.type, (), tuple(model.facet_of_ray(i) for i in gap.pair), text)
    if model.scene.group.rays[gap.rays[0]].crease is not None:
        return ContactWords(gap.type, (model.crease_of_ray(gap.rays[0]),), (), text)
    return ContactWords(gap.type, (), (model.facet_of_ray(gap.rays[0]),), text)


def _where_rays_meet(model: PosedProblem, rays: np.ndarray, gap: Gap) -> str | None:
    k, j = gap.rays
    has = model.structure.has_crease
    for end in (j, (j + 1) % len(rays)):
        apart = float(np.linalg.norm(rays[k] - rays[end]))
        if apart <= CONTACT_TOL and has[k % len(has)] and has[end % len(has)]:
            first, second = sorted((model.crease_of_ray(k), model.crease_of_ray(end)))
            facet = model.facet_of_ray(j)
            off = model.crease_of_ray(k)
            return (
                f"creases {first} and {second} on each other "
                f"(opening: crease {off} off the plane of facet {facet})"
            )
    return None


def rays_together(
    model: PosedProblem, rays: np.ndarray, contacts: Sequence[Contact]
) -> list[tuple[Contact, ...]]:
    """Return, for each two rays that lie on each other, the gaps among `contacts` that keep them so."""
    n = len(rays)
    together: dict[tuple[int, int], list[Contact]] = {}
    for contact in contacts:
        if contact.is_limit or (gap := model.structure.gaps[contact.index]).pair is None:
            continue
        k, j = gap.rays
        # two rays on each other: the ray k, and an end of the facet that it lies on
        for end in (j, (j + 1) % n):
            if np.linalg.norm(rays[k] - rays[end]) <= RANK:
                together.setdefault((min(k, end), max(k, end)), []).append(contact)
    return [tuple(found) for found in together.values() if len(found) > 1]


PairForce = Mapping[tuple[int, int], float] | None


def guess_gaps(
    model: PosedProblem,
    gaps: np.ndarray,
    rays: np.ndarray,
    limits: Sequence[Contact],
    pair_force: PairForce,
) -> list[Contact]:
    """Guess which gaps an answer of a solver closes, from their size and the force of separating planes."""
    out = []
    limited = {contact.index for contact in limits if contact.at == math.pi}
    same = model.structure.first_gaps
    for index, gap in enumerate(model.structure.gaps):
        value = gaps[index]
        if gap.pair is None:
            if value <= UNPOLISHED:
                out.append(Contact("gap", index, 1))
            continue
        pressed = pair_force is None or pair_force.get(gap.pair, 0.0) > UNPOLISHED
        if not pressed or abs(value) > NEAR_SINGULAR_TOL:
            continue
        k, j = gap.rays
        side = _side(rays, k, j, gap.pair)
        near = {m for m in (j - 1, j, j + 1, j + 2)}
        if side and not (k in near and limited):
            out.append(Contact("gap", same[index], side))
    return out


def _side(rays: np.ndarray, k: int, j: int, pair: tuple[int, int]) -> int:
    """Return the side of facet j on which the facet that ends at ray k lies; 0 if k is off the facet."""
    n = len(rays)
    a, b, c = rays[j], rays[(j + 1) % n], rays[k]
    normal = cross(a, b)
    if cross(a, c) @ normal < -NEAR_SINGULAR_TOL or cross(c, b) @ normal < -NEAR_SINGULAR_TOL:
        return 0
    start = pair[0] if pair[1] == j else pair[1]
    other = rays[(start + 1) % n] if k == start else rays[start]
    height = other @ normal
    return 0 if abs(height) < ANSWERED else int(math.copysign(1, height))


def closed_contacts(
    model: PosedProblem, x: np.ndarray, gaps: np.ndarray, rays: Rays, tolerance: float
) -> ClosedContacts:
    """Find every contact of a state x [n] that is closed to `tolerance`; `rays` returns those of its piece."""
    base = closed_anyway(model, x, gaps, tolerance)
    values, structure = gaps.tolist(), model.structure
    # where no gap of a pair is closed nothing touches
    of_pair = {
        pair: indices
        for pair, indices in structure.gaps_of_pairs.items()
        if any(abs(values[i]) <= tolerance for i in indices)
    }
    if not of_pair:
        return ClosedContacts(base, (), ())
    at: list[Point] = rays().tolist()
    branches: list[tuple[tuple[Contact, ...], ...]] = []
    implied: list[tuple[Contact, Contact]] = []
    layers = _Layers(model, x, tolerance)
    for indices in of_pair.values():
        options = _pair_pieces(model, layers, at, values, indices, tolerance)
        # a way that closes nothing: the pair is apart at this state, whatever the other ways say
        if () in options:
            continue  # the pair is strictly apart
        kept = set()
        for option in sorted(options):  # not in the order of hashes
            rows = []
            for row in option:
                again = _limit_that_says_the_same(model, row, base)
                if again is None:
                    rows.append(row)
                else:
                    implied.append((row, again))
            kept.add(tuple(rows))
        if () not in kept:
            branches.append(tuple(sorted(kept)))
    return ClosedContacts(base, tuple(branches), tuple(dict.fromkeys(implied)))


def closed_anyway(
    model: PosedProblem, x: np.ndarray, gaps: np.ndarray, tolerance: float
) -> tuple[Contact, ...]:
    """Find the contacts of a state [n] that are closed whichever way pairs of facets pass: `ClosedContacts.base`."""
    base: tuple[Contact, ...] = ()
    if model.has_limits:
        base = model.fold_limits.contacts(x, model.fold_limits.room(x) <= tolerance)
    return base + tuple(Contact("gap", i, 1) for i in model.walls if gaps[i] <= tolerance)


def _pair_pieces(
    model: PosedProblem,
    layers: _Layers,
    rays: list[Point],
    gaps: list[float],
    indices: list[int],
    tolerance: float,
) -> set[tuple[Contact, ...]]:
    """Return the ways in which a pair of facets is kept apart; () means strictly apart.

    `indices` are the pair's four gaps: both ends of the first facet off the second, then the reverse.
    Facets that lie on each other have both sides open pointwise; the order of the layers says which are.
    """
    structure = model.structure
    same = structure.first_gaps
    options: set[tuple[Contact, ...]] = set()
    flat = all(abs(gaps[i]) <= tolerance for i in indices)
    forced = layers.sides(structure.gaps[indices[0]].pair) if flat else (0, 0)
    for ends, not_beyond in zip((indices[:2], indices[2:]), forced, strict=True):
        open_to = [s for s in (1, -1) if not any(s * gaps[e] < -tolerance for e in ends)]
        if not open_to:
            continue
        # a ray counts as touching only if it lies on the facet, not on its plane elsewhere
        touching = [
            e
            for e in ends
            if abs(gaps[e]) <= tolerance and _on_arc(rays, structure.gaps[e].rays, tolerance)
        ]
        # two planes, two sides: four ways in which two arcs may be kept from crossing; each asks both ends to one side
        options |= {
            tuple(Contact("gap", same[e], side) for e in touching)
            for side in open_to
            if side != -not_beyond
        }
    if not options:  # crossing within the tolerance of the caller: nothing to say here
        return {()}
    if any(not o for o in options):
        # strictly apart by this plane, unless the facets are collinear and overlap the other way round
        strict = [o for o in options if o]
        if not strict or not _overlap(rays, structure.gaps[indices[0]].pair, tolerance):
            return {()}
        options = set(strict)
    return options


class _Layers:
    """The layer problem of a state, posed when a pair of facets that lie on each other first asks for it."""

    def __init__(self, model: PosedProblem, x: np.ndarray, tolerance: float) -> None:
        self._model, self._x, self._tolerance = model, x, tolerance

    @cached_property
    def _problem(self) -> LayerProblem | None:
        fold_angles = self._model.expand(self._x)
        creases, _ = fold_vertex(self._model.scene.vertex, fold_angles)
        near = min(max(self._tolerance, CONTACT_TOL), LARGEST_TOLERANCE)
        return layer_problem(creases, fold_angles, near)

    def sides(self, pair: tuple[int, int] | None) -> tuple[int, int]:
        """Return the side of the second facet on which the first must lie, and the reverse; 0 if either is possible."""
        assert pair is not None
        problem = self._problem
        if problem is None:
            return 0, 0
        first, second = (self._model.facet_of_ray(i) - 1 for i in pair)
        for strands in problem.segments.values():
            one = [(s, d) for s, d in strands if s[0] == first]
            two = [(s, d) for s, d in strands if s[0] == second]
            if one and two:
                # layers that other folds force: only one side is then a piece of the feasible set
                left = problem.forced_side(one[0][0], two[0][0])
                # the normal c_j x c_{j+1} of a facet points to the left of its direction, seen from outside
                return left * two[0][1], -left * one[0][1]
        return 0, 0


def _on_arc(rays: list[Point], place: tuple[int, ...], tolerance: float) -> bool:
    """Return whether ray k lies on the arc from ray j to the next, ends included (given: in its plane); place: k, j."""
    k, j = place
    a, b, c = rays[j], rays[(j + 1) % len(rays)], rays[k]
    normal = quat.cross(a, b)
    ahead, back = (quat.dot(quat.cross(*side), normal) for side in ((a, c), (c, b)))
    return bool(ahead >= -tolerance and back >= -tolerance)


def _overlap(rays: list[Point], pair: tuple[int, int] | None, tolerance: float) -> bool:
    """Return whether an end of one facet of the pair lies on the other."""
    assert pair is not None
    i, j = pair
    n = len(rays)
    for a, b in ((i, j), (j, i)):
        normal = quat.cross(rays[b], rays[(b + 1) % n])
        size = math.sqrt(quat.dot(normal, normal))
        for k in (a, (a + 1) % n):
            off = abs(quat.dot(rays[k], normal)) / size if size else math.nan
            if off <= tolerance and _on_arc(rays, (k, b), tolerance):
                return True
    return False


def _limit_that_says_the_same(
    model: PosedProblem, row: Contact, base: Sequence[Contact]
) -> Contact | None:
    """Return the fold limit that makes a ray-on-facet row redundant, if there is one.

    Ray k lies on facet j because both belong to the two facets at a crease m folded to +-pi.  The
    opening of the two contacts is then the same angle.
    """
    k, j = model.structure.gaps[row.index].rays
    n = len(model.structure.has_crease) if model.structure.kind == "D" else model.scene.degree
    closed = model.structure.kind == "C"
    for m, far in (
        (j, j - 1),
        (j + 1, j + 2),
    ):  # crease m bounds facet j; `far` ends its other facet
        if closed:
            m, far = m % n, far % n
        if k != far:
            continue
        if model.structure.kind == "D":
            if not (0 < m < n - 1):
                continue
            variable = sum(model.structure.has_crease[:m])
        else:
            variable = m % model.size
        for limit in base:
            if limit.is_limit and limit.index == variable and limit.at == math.pi:
                # a valley turns the walk around the vertex to the left: the other facet opens on that side
                return limit if row.side == limit.side else None
    return None
