"""The check of the proof of a strip: claims box by box, and the list of minima that follows from them.

The statement.  All closed states lie on the curves of `check_strip_sheet`, which meet in the flat state alone: no
fold along the row is 0 elsewhere.  On a curve the states that close as paper, no fold beyond +-180 degrees and, with
contact, no facets crossing, are some closed intervals, with U twice differentiable; a local minimum is a zero of U'
inside one, or an end towards which U falls.  What is claimed of each box is shown anew in balls, the box cut where that
is not clear at once; the minima that follow are held against those listed, one by one.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from flint import arb

from origami_nlp.proof.check_lists import Refused, precision, refuse_wide
from origami_nlp.proof.check_strip_boxes import ThetaBall
from origami_nlp.proof.check_strip_contact import CheckedContact
from origami_nlp.proof.check_strip_sheet import FlatSheet, turned
from origami_nlp.proof.strip_certificate import (
    CertifiedCurve,
    CertifiedMinimum,
    StripCertificate,
    TouchingBox,
)

CUTS = 12
"""How often a box is halved at most, where a claim is not clear at once."""
STATED = 1e-12
"""How far fold angles may be beyond their stated radius [rad]: they are printed, and nothing rests on them."""
CLOSED = ("rising", "falling", "convex", "concave", "touching")
"""Claims of boxes in which all states close within fold limits."""


class Found(NamedTuple):
    """A minimum that follows from claims: its curve, theta between two numbers, and how it is held."""

    curve: int
    low: float
    high: float
    kind: str


class StripCheck:
    """One check on its way.

    Parameters
    ----------
    said
        What is checked.
    progress
        As for `check_proof`.

    Attributes
    ----------
    found
        Minima that follow.
    open
        What is left open, a line each.
    counts
        How many boxes have each claim.
    """

    def __init__(self, said: StripCertificate, progress: Callable[[int, int], object]) -> None:
        self.said, self.progress = said, progress
        self.found: list[Found] = []
        self.maxima = 0
        self.open: list[str] = []
        self.counts: Counter[str] = Counter()

    @precision()
    def run(self) -> None:
        """Check every claim.

        Raises
        ------
        Refused
            At the first one that is not confirmed.
        """
        said = self.said
        if any(not k >= 0 for k in said.stiffness):
            raise Refused("a stiffness is negative")
        refuse_wide(said.minima)
        self.sheet = FlatSheet(said)
        self.contact = CheckedContact(self.sheet) if said.contact else None
        every = {(1, *rest) for rest in itertools.product((1, -1), repeat=len(said.row) - 1)}
        signs = [curve.signs for curve in said.curves]
        if set(signs) != every or len(signs) != len(every):
            raise Refused(f"there are {len(every)} curves, each of them once")
        total, done = sum(len(c.claims) for c in said.curves), 0
        for number, curve in enumerate(said.curves):
            self._covers(number, curve)
            for k, claim in enumerate(curve.claims):
                self.counts[claim] += 1
                self._confirm(number, curve, k, claim)
                done += 1
                if not done % 50:
                    self.progress(done, total)
            self._follows(number, curve)
        self._lists()

    def over(self, curve: int, low: Any, high: Any) -> ThetaBall:
        """Return the states of a box."""
        return ThetaBall(self.sheet, self.said.curves[curve].signs, low, high)

    def _name(self, number: int, low: Any, high: Any) -> str:
        return f"curve {number + 1}, theta in [{float(low):.9g}, {float(high):.9g}]"

    def _covers(self, number: int, curve: CertifiedCurve) -> None:
        ends = curve.ends
        up = all(a < b for a, b in itertools.pairwise(ends))
        if not (up and arb(ends[0]) < -arb.pi() / 2 and arb(ends[-1]) > arb.pi() / 2):
            raise Refused(f"the boxes of curve {number + 1} are not all of it")
        listed = [t.box for t in curve.touches]
        if listed != [k for k, c in enumerate(curve.claims) if c == "touching"]:
            raise Refused(f"touches of curve {number + 1} are not those of its boxes")

    def _touches(self, curve: CertifiedCurve, k: int) -> TouchingBox:
        found = next(t for t in curve.touches if t.box == k)
        if any((s.crease, s.side) not in self.sheet.stops for s in found.stops):
            raise Refused("a stop of a box is none of the sheet's")
        return found

    def _meets(self, over: ThetaBall, met: TouchingBox) -> int:
        """Return the sign of the slope of all gaps, and rooms of stops, of a box; 0: not certain, or they have two."""
        slopes = set()
        if met.touches:
            assert self.contact is not None
            slopes.add(self.contact.touches(over, met.touches))
        elif self.contact is not None and not self.contact.apart(over):
            return 0
        for stop in met.stops:
            rate = -stop.side * over.box.folds[stop.crease][1]
            slopes.add(1 if rate > 0 else -1 if rate < 0 else 0)
        return slopes.pop() if len(slopes) == 1 else 0

    def _gaps(self, over: ThetaBall, met: TouchingBox) -> list[int]:
        """Return the signs of gaps at one state, then of the rooms of stops; 0: not certain."""
        found = []
        if met.touches:
            assert self.contact is not None
            found += self.contact.gaps(over, met.touches)
        for stop in met.stops:
            room = self.sheet.room((stop.crease, stop.side), over.folds[stop.crease])
            found.append(1 if room > 0 else -1 if room < 0 else 0)
        return found

    def _confirm(self, number: int, curve: CertifiedCurve, k: int, claim: str) -> None:
        low, high = curve.ends[k : k + 2]
        if claim in ("open", "limit"):  # a limit is asked of all such boxes together (`_follows`)
            if claim == "open":
                self.open.append(f"{self._name(number, low, high)}: not decided")
            return
        met = self._touches(curve, k) if claim == "touching" else TouchingBox(k, ())
        if (claim == "crossing" or met.touches) and self.contact is None:
            raise Refused(f"{self._name(number, low, high)}: facets are not asked about")
        slope = 0
        front = [(arb(low), arb(high), 0)]
        while front:
            a, b, depth = front.pop()
            over = self.over(number, a, b)
            sign = self._shows(over, claim, met)
            if sign and slope in (0, sign):
                slope = sign if claim == "touching" else 0
                continue
            if depth == CUTS:
                raise Refused(f"{self._name(number, low, high)} is not shown to be: {claim}")
            middle = ((a + b) / 2).mid()
            front += [(a, middle, depth + 1), (middle, b, depth + 1)]

    def _shows(self, over: ThetaBall, claim: str, met: TouchingBox) -> int:
        """Return +-1 if a claim certainly holds over a box, for touches the sign of their gaps' slope; else 0."""
        if claim == "outside":
            return int(over.outside())
        if claim == "crossing":
            assert self.contact is not None
            return int(over.known and self.contact.crosses(over))
        if not over.inside([(s.crease, s.side) for s in met.stops]):
            return 0
        first, second = over.slope()
        if claim == "touching":
            return self._meets(over, met) if first > 0 or first < 0 else 0
        value = {"rising": first, "falling": -first, "convex": second, "concave": -second}[claim]
        if not value > 0:
            return 0
        return int(self.contact is None or self.contact.apart(over))

    def _slope(self, number: int, theta: Any) -> int:
        """Return the sign of U' at one state that closes, 0 where it is not certain."""
        first, _ = self.over(number, theta, theta).slope()
        return 1 if first > 0 else -1 if first < 0 else 0

    def _follows(self, number: int, curve: CertifiedCurve) -> None:
        """Add what minima follow from the claims of a curve."""
        runs = [
            (name, [k for k, _ in group])
            for name, group in itertools.groupby(enumerate(curve.claims), key=lambda e: e[1])
        ]
        half = arb.pi() / 2
        for i, (name, boxes) in enumerate(runs):
            low, high = curve.ends[boxes[0]], curve.ends[boxes[-1] + 1]
            first, last = i == 0, i == len(runs) - 1
            a, b = (-half if first else arb(low)), (half if last else arb(high))
            if name in ("convex", "concave"):
                signs = self._slope(number, a), self._slope(number, b)
                if 0 in signs:
                    self.open.append(f"{self._name(number, low, high)}: U' is 0 at an end")
                elif signs[0] != signs[1]:
                    # U' grows or falls over all of it: it has one zero
                    if name == "convex":
                        self.found.append(Found(number, low, high, "inside"))
                    else:
                        self.maxima += 1
            elif name == "touching":
                for k in boxes:
                    self._touch(
                        number, curve, k, (first and k == boxes[0], last and k == boxes[-1])
                    )
            elif name == "limit":
                before = curve.claims[boxes[0] - 1] if not first else ""
                after = curve.claims[boxes[-1] + 1] if not last else ""
                self._limit(number, [curve.ends[k] for k in (*boxes, boxes[-1] + 1)], before, after)
            if name in CLOSED and name != "touching":
                for at_end, x, theta, toward in ((first, a, low, -1), (last, b, high, 1)):
                    if at_end:
                        slope = self._slope(number, x) * toward
                        if not slope:
                            self.open.append(f"{self._name(number, theta, theta)}: U' at the end")
                        elif slope < 0:
                            self.found.append(Found(number, theta, theta, "end"))

    def _touch(self, number: int, curve: CertifiedCurve, k: int, ends: tuple[bool, bool]) -> None:
        """Add the state where facets meet, or a crease its stop, if U falls towards it, and the end of a curve."""
        low, high = curve.ends[k : k + 2]
        met = self._touches(curve, k)
        gaps = [min(self._gaps(self.over(number, x, x), met)) for x in (low, high)]
        slope = self._slope(number, ((arb(low) + arb(high)) / 2).mid())
        if 0 in (*gaps, slope):
            self.open.append(f"{self._name(number, low, high)}: the gap at an end")
        elif (gaps[1] - gaps[0]) * slope > 0:
            self.found.append(Found(number, low, high, "held"))
        for at_end, x, gap, toward in zip(ends, (low, high), gaps, (-1, 1), strict=True):
            if at_end and gap > 0 and slope * toward < 0:
                self.found.append(Found(number, x, x, "end"))

    def _limit(self, number: int, ends: list[float], before: str, after: str) -> None:
        """Add the state where a fold reaches +-180 degrees, coming from the side that closes, if U falls towards it."""
        name = self._name(number, ends[0], ends[-1])
        sides = [s for s, claim in ((1, before), (-1, after)) if claim in CLOSED]
        if {before, after} - {*CLOSED, "outside"}:
            self.open.append(f"{name}: creases reach +-180 degrees beside what is not decided")
        elif not sides:
            if not self._never(number, ends[0], ends[-1], 0):
                self.open.append(f"{name}: several creases reach +-180 degrees")
        else:
            toward = sides[0]
            way = ends if toward > 0 else ends[::-1]
            slopes, passes = self._along(number, way)
            if slopes is None:
                self.open.append(f"{name}: creases at +-180 degrees are not decided")
            elif passes == (len(sides) == 2):
                raise Refused(
                    f"{name}: what closes beside it is not what creases at +-180 degrees say"
                )
            elif passes and slopes * toward < 0:
                self.found.append(Found(number, ends[0], ends[-1], "limit"))

    def _along(self, number: int, way: Sequence[float]) -> tuple[int | None, bool]:
        """Follow folds from a state that closes on one side of limits: the sign of U', and whether one passes.

        None where it is not certain.
        Each fold across the row that may be at +-180 degrees moves one way: it passes once, and no more.
        """
        start = self.over(number, way[0], way[0])
        if not start.inside():
            return None, False
        before = [float(a.mid()) for a in start.folds]
        moving: dict[int, int] = {}
        slopes = set()
        cuts = [*way]
        while len(cuts) > 1:
            low, high = min(cuts[:2]), max(cuts[:2])
            over = self.over(number, low, high)
            if over.known:
                over.follow(before)
            sure = over.known
            for c in self.sheet.across:
                rate = over.box.folds[c][1]
                sign = (1 if rate > 0 else -1 if rate < 0 else 0) if sure else 0
                if sure and c not in moving and abs(over.folds[c]) < arb.pi():
                    continue
                if not sign or moving.setdefault(c, sign) != sign:
                    sure = False
            first, _ = over.slope()
            sign = 1 if first > 0 else -1 if first < 0 else 0
            sure = sure and over.within_stops()
            if sure and sign and self.contact is not None:
                sure = self.contact.apart(over, weakly=True)
            if not (sure and sign):
                middle = 0.5 * (low + high)
                if middle in (low, high) or len(cuts) > 60 + len(way):
                    return None, False
                cuts.insert(1, middle)
                continue
            slopes.add(sign)
            at = self.over(number, cuts[1], cuts[1])
            at.follow(before)
            before = [float(a.mid()) for a in at.folds]
            last = at
            del cuts[0]
        if len(slopes) != 1:
            return None, False
        past = [abs(last.folds[c]) - arb.pi() for c in self.sheet.across]
        if not all(p > 0 or p < 0 for p in past):
            return None, False
        return slopes.pop(), any(bool(p > 0) for p in past)

    def _never(self, number: int, low: float, high: float, depth: int) -> bool:
        """Return whether in each part of an interval one vertex closes as no paper, though folds pass limits there.

        Of its folds one at most may be at +-180 degrees, and moves one way: it changes once at most.
        """
        over = self.over(number, low, high)
        return (
            over.outside()
            or self._stays_open(number, over, low, high)
            or (
                depth < CUTS
                and all(
                    self._never(number, a, b, depth + 1)
                    for a, b in itertools.pairwise((low, 0.5 * (low + high), high))
                )
            )
        )

    def _stays_open(self, number: int, over: ThetaBall, low: float, high: float) -> bool:
        at = [self.over(number, x, x) for x in (low, high)]
        if not over.known:
            return False
        for vertex in self.sheet.vertices:
            pair = [vertex.creases[1], vertex.creases[3]]
            passing = [c for c in pair if not abs(over.folds[c]) < arb.pi()]
            rate = over.box.folds[passing[0]][1] if passing else arb(1)
            if len(passing) > 1 or not (rate > 0 or rate < 0) or not abs(rate * over.away) < 1:
                continue
            if all(
                all(abs(a.folds[c]) < arb.pi() for c in pair) and turned(vertex, a.folds) < 0
                for a in at
            ):
                return True
        return False

    def _lists(self) -> None:
        """Hold the minima that follow against those that are listed.

        Raises
        ------
        Refused
            If one is not listed, or one that is does not follow.
        """
        signs = [curve.signs for curve in self.said.curves]
        left = list(enumerate(self.said.minima, start=1))
        at_rest = self._rests_flat()
        flat = 0
        for one in self.found:
            matching = [
                (i, m)
                for i, m in left
                if signs[one.curve] == m.signs and one.low <= m.theta[0] <= m.theta[1] <= one.high
            ]
            name = self._name(one.curve, one.low, one.high)
            if one.kind == "inside" and one.low < 0 < one.high and at_rest:
                # U = 0: the flat state, on all curves
                flat += 1
                if flat != len(signs):
                    continue
            if not matching:
                raise Refused(f"{name}: a minimum is not listed")
            number, minimum = matching[0]
            self._agrees(one, number, minimum)
            left.remove(matching[0])
        if 0 < flat < len(signs):
            self.open.append("the flat state: a minimum of some of its curves only")
        if left:
            raise Refused(f"minimum {left[0][0]} does not follow from the claims")
        if not self.open and self.maxima != self.said.maxima:
            raise Refused(f"{self.maxima} maxima lie inside the curves, not {self.said.maxima}")
        self.open += [f"{one.reason}" for one in self.said.undecided if not self.open]

    def _rests_flat(self) -> bool:
        return not any(self.said.rest) and not any(self.said.laws)

    def _agrees(self, one: Found, number: int, minimum: CertifiedMinimum) -> None:
        """Refuse a minimum that is listed where it is not, or with other fold angles."""
        low, high = minimum.theta
        over = self.over(one.curve, low, high)
        name = f"minimum {number}"
        if one.kind == "inside":
            at_rest = self._rests_flat()
            if not (self._slope(one.curve, low) < 0 < self._slope(one.curve, high)):
                if not (at_rest and low <= 0 <= high):
                    raise Refused(f"{name}: U' does not change its sign where it is listed")
            elif low <= 0 <= high and not at_rest:
                raise Refused(f"{name} is not distinguished from the flat state")
        if (one.kind == "held") != bool(minimum.touching or minimum.stops):
            raise Refused(f"{name}: what holds it is not what is listed")
        if one.kind in ("limit", "held"):
            self._reached(one, number, minimum)
        if one.kind == "end":
            half = arb.pi() / 2
            over = self.over(one.curve, *((-half, -half) if low < 0 else (half, half)))
        over.follow(minimum.fold_angles)
        for said, angle in zip(minimum.fold_angles, over.folds, strict=True):
            if not abs(angle - said) <= arb(minimum.radius) + STATED:
                raise Refused(f"{name}: its fold angles are not those of its theta")

    def _reached(self, one: Found, number: int, minimum: CertifiedMinimum) -> None:
        """Refuse a state at a limit, or where facets meet, that is not between the two numbers listed."""
        low, high = minimum.theta
        if one.kind == "held":
            curve = self.said.curves[one.curve]
            k = next(i for i, end in enumerate(curve.ends) if end == one.low)
            met = self._touches(curve, k)
            at = [self._gaps(self.over(one.curve, x, x), met) for x in (low, high)]
            both = list(zip(*at, strict=True))
            # those that are open at both ends are open between them
            meet = [min(p, q) <= 0 for p, q in both]
            if not any(meet) or any(max(p, q) < 0 for p, q in both):
                raise Refused(f"minimum {number}: facets do not meet where it is listed")
            many = len(met.touches)
            pairs = {
                (min(t.facets), max(t.facets))
                for t, m in zip(met.touches, meet[:many], strict=True)
                if m
            }
            stops = {s for s, m in zip(met.stops, meet[many:], strict=True) if m}
            if {(min(p), max(p)) for p in minimum.touching} != pairs or {*minimum.stops} != stops:
                raise Refused(f"minimum {number}: other facets touch, or stops, than those listed")
            return
        ends = [self.over(one.curve, x, x) for x in (low, high)]
        if not (any(e.inside() for e in ends) and any(e.outside() for e in ends)):
            raise Refused(f"minimum {number}: no crease reaches +-180 degrees where it is listed")
