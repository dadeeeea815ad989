"""All minima of a mesh whose vertices fold flat, in which no facets cross, where no creases are in line.

Then all creases move together, and a closed state is the flat one, one inside a curve, or folded flat, every crease at
+-180 degrees: by any signs whose product is -1 round each vertex.  Inside the curves facets are asked about as those of
strips are (`strip_contact`).  At their ends all facets come to lie in one plane: z = z'(xi) (theta - end) for heights z
over that of a facet that stays, so that facets seen with z' for z are apart, or cross, as they do before the end.
States folded flat are of paper if their layers can be ordered; then a curve that ends there leaves it, unless facets
cross on it.  That curves on which facets do not cross end in states of paper is a limit, and is asked as well.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternProblem, order_layers
from origami_nlp.proof.affine import UNIT
from origami_nlp.proof.ball_vectors import part
from origami_nlp.proof.balls import Ball, Jet, exact
from origami_nlp.proof.flat_sheets import SheetMinimum
from origami_nlp.proof.folded_edges import FoldedEdges
from origami_nlp.proof.mesh_curves import QUARTER, CurveEnergy, fold
from origami_nlp.proof.mesh_states import Curve, FoldingMesh, as_folding_mesh
from origami_nlp.proof.strip_contact import (
    APART,
    UNKNOWN,
    Facets,
    FacetTouch,
    StripContact,
    sides_of_plane,
    why_no_strip_contact,
)
from origami_nlp.proof.strip_energy import StripEnergy
from origami_nlp.proof.strip_states import FoldStates, is_narrow
from origami_nlp.proof.strips import along_curves

MOST_BOXES = 4_000
"""Of a curve: facets that meet all but together at its end would take any number."""
FARTHEST = 2.0**-4
"""From the end of a curve, up to which what folds edge to edge is decided there [rad]."""
MOST_FOLDED = 4_096
"""Ways to fold all creases to +-180 degrees, at most."""


def why_no_mesh_contact(pattern: Pattern) -> str:
    """Return why contact of a mesh that folds flat is not proved; "" where it is.

    Parameters
    ----------
    pattern
        A mesh of which `why_no_mesh` says nothing.

    Returns
    -------
    str
        The first reason.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_mesh_contact
    >>> why_no_mesh_contact(o.examples.pattern("miura", 3, 3))
    ''
    >>> why_no_mesh_contact(o.examples.pattern("miura", 3, 4))
    'more than two rows fold side by side, each by itself'
    """
    mesh, why = as_folding_mesh(pattern)
    if mesh is None:
        return why
    first, *rest = ({*c.creases} for c in mesh.crossings)
    together, left = first, rest
    while near := [c for c in left if c & together]:
        together = together.union(*near)
        left = [c for c in left if c not in near]
    if left or len(together) < mesh.creases:
        return "vertices do not hang together, or a crease is none of theirs"
    ways = itertools.product(*(c.modes for c in mesh.crossings)) if mesh.in_line else ()
    if any(p and len(p.curves) > 2 for modes in ways for p in mesh.products(modes)):
        return "more than two rows fold side by side, each by itself"
    if not mesh.in_line and 2 ** (mesh.creases - len(mesh.crossings)) > MOST_FOLDED:
        return f"it can be folded flat in more than {MOST_FOLDED} ways"
    return why_no_strip_contact(pattern)


class FoldingCurve:
    """A curve of a mesh that folds flat, as `strip_energy` asks for it: tan(x/2) = sign kappa tan theta.

    Other creases are still: at 0, or +-1 times 180 degrees.
    """

    def __init__(
        self,
        mesh: FoldingMesh,
        curve: Curve,
        pattern: Pattern,
        still: Sequence[int | None] = (),
    ) -> None:
        self.across: list[int] = []
        self.beside: list[tuple[int, int]] = []
        self.rows = [(mesh.multiplier(m.key), m.sign, m.creases) for m in curve]
        self.even = CurveEnergy(mesh, curve, pattern.stiffness, pattern.rest).even
        self.still = {c: s for c, s in enumerate(still) if s is not None}
        self.turns = dict.fromkeys(self.still, 0)
        self.turns |= {c: m.sign * s for m in curve for c, s in m.creases}

    def states(self, signs: np.ndarray, theta: Ball, at: FoldStates | None = None) -> FoldingStates:
        """Return its states over boxes of theta."""
        return FoldingStates(self, theta)


class FoldingStates:
    """States of such a curve over boxes of theta, [K].

    Attributes
    ----------
    angles, slopes
        Of each crease: phi; phi' with phi''.
    outside
        Nowhere: all close within fold limits.
    ends
        Which end of the curve is in each box, -1 or 1; 0 where none is.
    turns
        Signs of folds for theta > 0.
    """

    def __init__(self, curve: FoldingCurve, theta: Ball) -> None:
        self.angles: dict[int, Ball] = {}
        self.slopes: dict[int, Jet] = {}
        for kappa, sign, creases in curve.rows:
            x, rate, bend = fold(kappa, theta)
            for c, s in creases:
                own = (x, rate, bend) if s * sign > 0 else (-x, -rate, -bend)
                self.angles[c], self.slopes[c] = own[0], Jet(*own[1:])
        zero = exact(np.zeros_like(theta.centre))
        for c, side in curve.still.items():
            self.angles[c] = (exact(side * math.pi) + zero).widened(
                np.asarray(4 * UNIT * abs(side))
            )
            self.slopes[c] = Jet(zero, zero)
        self.outside = np.zeros(theta.centre.shape, bool)
        beyond = np.abs(theta.centre) + theta.radius >= math.nextafter(QUARTER, 0.0)
        self.ends = np.where(beyond, np.sign(theta.centre), 0.0)
        self.from_end = QUARTER - (np.abs(theta.centre) - theta.radius) + 8 * UNIT
        self.curve, self.turns = curve, curve.turns

    @property
    def narrow(self) -> np.ndarray:
        """Whether all fold angles are known to within so little that four of them are no quarter of a turn, [K]."""
        return is_narrow(self.angles)

    def closes(self) -> np.ndarray:
        """Return that all states close, [1, K]."""
        return ~self.outside[None]


class FoldingEnergy(StripEnergy):
    """The energy along such a curve."""

    @property
    def rests_flat(self) -> bool:
        """Whether the slope is 0 in the flat state exactly, as that of an energy that is even in theta."""
        assert isinstance(self.strip, FoldingCurve)
        return self.strip.even


class FoldingContact(StripContact):
    """Which facets of a mesh that folds flat cross: of the sheet that is meant, near the stated one."""

    def __init__(
        self, pattern: Pattern, deviation: float, pairs: list[tuple[int, int]] | None = None
    ) -> None:
        super().__init__(pattern, pairs)
        size = float(np.ptp(pattern.corners, axis=0).max())
        self._room = 16 * len(pattern.polygons) * size * deviation
        self._size, self._deviation, self.deviation = size, deviation, deviation

    def facets(
        self, at: FoldStates, box: FoldStates, angles: dict[int, Ball], half: np.ndarray
    ) -> Facets:
        """Return the facets over boxes; where these reach an end of the curve, heights are their slopes."""
        found = super().facets(at, box, angles, half)
        speed = sum(np.abs(s.value.centre) + s.value.radius for s in box.slopes.values())
        assert isinstance(box, FoldingStates)
        ends = box.ends != 0
        self._ends, self._turns, self._states = box.ends, box.turns, box
        middle, over = [], []
        for m, x in zip(found.middle, found.over, strict=True):
            value = x.value.widened(np.asarray(self._room))
            slope = x.slope.widened(self._room * speed)
            height = part(slope, 2)
            blown = [
                Ball(b.centre.copy(), np.broadcast_to(b.radius, b.centre.shape).copy())
                for b in (m, value)
            ]
            for b in blown:
                b.centre[2][:, ends] = height.centre[:, ends]
                b.radius[2][:, ends] = height.radius[:, ends]
            middle.append(blown[0])
            over.append(Jet(blown[1], slope))
        return Facets(middle, over)

    def over(
        self, facets: Facets, angles: dict[int, Ball], width: np.ndarray
    ) -> tuple[np.ndarray, dict[int, tuple[FacetTouch, ...]]]:
        """Return what is known of all facets over boxes, [K], and where pairs of them meet."""
        ends = self._ends
        signed = {
            c: Ball(np.where(ends, self._turns[c] * ends, a.centre), np.where(ends, 0.0, a.radius))
            for c, a in angles.items()
        }
        status, touches = super().over(facets, signed, width)
        for k in [k for k in touches if ends[k]]:
            del touches[k]
            status[k] = UNKNOWN
        return status, touches

    def _of_pairs(self, facets: Facets, signs: dict[int, np.ndarray]) -> np.ndarray:
        known = super()._of_pairs(facets, signs)
        for k, (a, b) in enumerate(self.pairs):
            for c in range(len(self.pattern.polygons)):
                if c not in (a, b) and (known[k] == UNKNOWN).any():
                    one, other = (self._beyond(facets, p, c) for p in (a, b))
                    known[k][(known[k] == UNKNOWN) & (one * other < 0)] = APART
        for box in np.flatnonzero(self._ends).tolist():
            self._at_end(known[:, box], int(self._ends[box]), float(self._states.from_end[box]))
        return known

    def _at_end(self, known: np.ndarray, side: int, reach: float) -> None:
        """Decide pairs that fold edge to edge at the end of a curve, given how far theta is from it."""
        left = np.flatnonzero(known == UNKNOWN)
        if not len(left) or reach > FARTHEST:
            return
        curve = self._states.curve
        # tan x <= x + x^3 up to there
        edges = FoldedEdges(self, curve.rows, curve.still, side, reach + reach**3, self._deviation)
        known[left] = [edges.pair(*self.pairs[k]) for k in left]
        self.deviation = max(self.deviation, edges.off / self._size)

    def _beyond(self, facets: Facets, p: int, c: int) -> np.ndarray:
        """Return on which side of the plane of polygon c polygon p is, but for corners that both have, [K]."""
        own = self.pattern.polygons[c]
        away = [i for i, v in enumerate(self.pattern.polygons[p]) if v not in own]
        side = sides_of_plane(facets.over[p].value, facets.over[c].value).sign[away]
        return np.where((side == side[0]).all(axis=0), side[0], 0.0)


class MeshContact:
    """All minima with contact of such a mesh, given its curves.

    Attributes
    ----------
    minima, maxima, open, boxes
        As those of `MeshProof`.
    folded
        States that are folded flat.
    deviation
        As that of `MeshMinima`.
    """

    def __init__(
        self, mesh: FoldingMesh, pattern: Pattern, curves: list[Curve], most: int, until: float
    ) -> None:
        self.mesh, self.pattern, self.most, self.until = mesh, pattern, most, until
        self.minima: list[SheetMinimum] = []
        self.open: list[tuple[np.ndarray, np.ndarray, str]] = []
        self.maxima = self.boxes = self.folded = 0
        self._facets = FoldingContact(pattern, mesh.deviation)
        # whether the flat state is a minimum of each curve, None where it is not certain that facets let it fall
        self._flat: list[bool | None] = []
        # of states at the ends of curves: which way the energy goes there, None where facets cross before it
        self._ways: dict[tuple[int, ...], list[int | None]] = {}
        with np.errstate(all="ignore"):
            for curve in curves:
                self._along(curve)
            self._fold()
        self.deviation = self._facets.deviation
        flat = np.zeros(mesh.creases)
        if all(self._flat):
            self.minima.append(SheetMinimum(flat, 0.0))
        elif False not in self._flat:
            self.open.append((flat, flat, "whether facets let the energy fall from the flat state"))

    def _along(self, rows: Curve) -> None:
        """Add the minima inside a curve, and note what is known of its ends."""
        curve = FoldingCurve(self.mesh, rows, self.pattern)
        turns = np.array([[curve.turns[c]] for c in range(self.mesh.creases)], float)
        energy = FoldingEnergy(curve, self.pattern, turns)
        left = min(max(0, self.most - self.boxes), MOST_BOXES)
        ends, claims, examined = along_curves(energy, self._facets, left, self.until)
        self.boxes += examined
        self.maxima += ends.maxima
        near = {
            claim in ("crossing", "open", "touching")
            for low, high, claim in zip(
                claims[0].ends, claims[0].ends[1:], claims[0].claims, strict=False
            )
            if low <= 0 <= high
        }
        flat = None if True in near else False
        for one in ends.minima():
            if one.at_limit:
                continue  # the states that are folded flat are asked by themselves
            if one.theta[0] <= 0 <= one.theta[1]:
                flat = True
            else:
                self.minima.append(SheetMinimum(one.fold_angles, one.radius))
        self._flat.append(flat)
        self.open += ends.open
        for side, claim in ((-1, claims[0].claims[0]), (1, claims[0].claims[-1])):
            inner, outer = (
                np.array([side * math.nextafter(QUARTER, 0.0)]),
                np.array([side * QUARTER]),
            )
            box = energy.over(np.array([0]), np.fmin(inner, outer), np.fmax(inner, outer))
            slope = -side * int(box.slope()[0].sign[0])
            way = None if claim == "crossing" else 0 if claim in ("open", "touching") else slope
            signs = tuple(int(side * turns[c, 0]) for c in range(self.mesh.creases))
            self._ways.setdefault(signs, []).append(way)

    def _fold(self) -> None:
        """Ask of each state that is folded flat whether its layers have an order, and whether it is a way down."""
        problem = PatternProblem(self.pattern)
        for signs in self._signs():
            self.folded += 1
            phi = math.pi * np.array(signs, float)
            ways = self._ways.get(signs, [])
            if time.monotonic() > self.until:
                self.open.append((phi, phi, "time was over"))
                continue
            layers = order_layers(problem, phi).verdict
            if layers == "ordered" and -1 in ways:
                continue
            if layers == "crosses" and all(w is None for w in ways):
                continue
            if layers == "ordered" and 0 not in ways:
                self.minima.append(SheetMinimum(phi, 0.0))
            else:
                self.open.append((phi, phi, "contact at a state that is folded flat"))

    def _signs(self) -> Iterator[tuple[int, ...]]:
        """Yield signs of all creases, of which the product round each vertex is -1."""
        rounds = [c.creases for c in self.mesh.crossings]

        def complete(signs: list[int]) -> Iterator[tuple[int, ...]]:
            known = len(signs)
            for ring in rounds:
                if max(ring) == known - 1 and math.prod(signs[c] for c in ring) > 0:
                    return
            if known == self.mesh.creases:
                yield tuple(signs)
                return
            for s in (1, -1):
                yield from complete([*signs, s])

        yield from complete([])
