"""Closed states of a mesh of vertices of degree four, along one fold: what follows from it vertex by vertex.

One crease has phi = 2 theta; a vertex of which one fold is known gives the other three (`fold_states`), in a mode
each. Where a vertex has several known folds, it closes a loop: the folds that it gives are those known, or the state
does not close.  Two vertices in one mode, with equal sectors (in either order) from creases with one fold but for its
sign, have all folds in common: such folds are one number here, and a loop closes identically where it asks for
nothing else.

Within fold limits the sign of each fold is known for theta > 0: where the formula gives another one, or a sine above
1, no state of these modes closes.  The states that do are those from the flat one to some theta.  In mode 1 the fold
across has 1/sin^2(phi_2/2) = A + B X + C sqrt((X - r_1)(X - r_3)) with X = 1/sin^2(phi_1/2) and B, C > 0, which grows
with X; in mode -1 the root has the sign -, that is convex and least where phi_2 or phi_4 is at 180 degrees; and where
phi_1 or phi_3 is, both w_2 and w_4 have the sign of w_3 or w_1, so that just one of them has passed 0 on the way:
from there an even number of folds is negative.  So folds of a vertex grow together until one of them is at 180
degrees, and do not close after that; and those of a tree of vertices as well.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from origami_nlp.proof.balls import Ball, Jet, argument, exact
from origami_nlp.proof.fold_states import Corner, Fold, closing, is_narrow, other_folds
from origami_nlp.proof.quad_sheets import QuadMesh

HALF_TURN = math.nextafter(math.pi, 0.0)
"""Not above pi, which is between two doubles."""


class VertexStep(NamedTuple):
    """A vertex from one known fold: nodes (numbers of folds) of its creases, the known one first, q and the mode."""

    nodes: tuple[int, int, int, int]
    corner: Corner
    square: Ball
    mode: int


class FoldLoop(NamedTuple):
    """Two folds, as numbers, that are one where a loop closes, up to a sign that is known."""

    one: int
    two: int
    sign: int


@dataclass
class QuadCurve:
    """How the folds of a mesh follow from one of them, its vertices in these modes.

    Attributes
    ----------
    mesh, modes, drive
        Some of its first vertices have modes; one crease of theirs has phi = 2 theta.
    signs
        Of folds, for theta > 0.
    node
        The number of the fold of each crease.
    sense
        Of each number, the sign of the fold that it is, for theta > 0.
    steps, loops
        What is computed, in order; what must agree.
    """

    mesh: QuadMesh
    modes: tuple[int, ...]
    drive: int
    signs: dict[int, int]
    node: dict[int, int] = field(default_factory=dict)
    sense: list[int] = field(default_factory=list)
    steps: list[VertexStep] = field(default_factory=list)
    loops: list[FoldLoop] = field(default_factory=list)

    def __post_init__(self) -> None:
        turn = self.signs[self.drive]
        self.signs = {c: turn * s for c, s in self.signs.items()}
        self._known: dict[tuple[int, tuple[int, ...], int], tuple[int, ...]] = {}
        self._number(self.drive)
        left = list(range(len(self.modes)))
        while left:
            v = next(i for i in left if any(c in self.node for c in self.mesh.vertices[i].creases))
            left.remove(v)
            self._vertex(v)

    def _number(self, crease: int) -> int:
        """Return a new number for the fold of a crease."""
        self.sense.append(self.signs[crease])
        self.node.setdefault(crease, len(self.sense) - 1)
        return len(self.sense) - 1

    def _vertex(self, v: int) -> None:
        creases = self.mesh.vertices[v].creases
        places = [p for p in range(4) if creases[p] in self.node]
        at: dict[int, int] = {}
        for p in places:
            key, way = self._seen(v, p, self.node[creases[p]])
            if key in self._known:
                at = dict(zip(way, self._known[key], strict=True))
                break
        else:
            p = places[0]
            way = tuple((p + i) % 4 for i in range(4))
            nodes = (self.node[creases[p]], *(self._number(creases[i]) for i in way[1:]))
            at = dict(zip(way, nodes, strict=True))
            vertex = self.mesh.vertices[v]
            mode = self.modes[v] * (-1) ** p
            self.steps.append(VertexStep(nodes, vertex.corners[p], vertex.squares[p], mode))  # type: ignore[arg-type]
            for i in range(4):
                key, way = self._seen(v, i, at[i])
                self._known[key] = tuple(at[j] for j in way)
        for i, number in at.items():
            known = self.node.setdefault(creases[i], number)
            if known != number:
                self.loops.append(FoldLoop(number, known, self.sense[number] * self.sense[known]))

    def _seen(
        self, v: int, p: int, number: int
    ) -> tuple[tuple[int, tuple[int, ...], int], tuple[int, ...]]:
        """Return a vertex as it is seen from one of its creases, and the order in which its creases are."""
        vertex = self.mesh.vertices[v]
        mode = self.modes[v] * (-1) ** p
        ahead, back = (tuple((p + s * i) % 4 for i in range(4)) for s in (1, -1))
        one = tuple(vertex.sectors[i] for i in ahead)
        two = tuple(vertex.sectors[(i - 1) % 4] for i in back)
        return min(((number, one, mode), ahead), ((number, two, mode), back))

    @property
    def across(self) -> list[int]:
        """Creases that are not of the fold that the curve is given by."""
        return [c for c in sorted(self.node) if self.node[c] != self.node[self.drive]]

    @property
    def driven(self) -> dict[int, int]:
        """Creases of the fold that the curve is given by, each with its sign for theta > 0."""
        number = self.node[self.drive]
        return {c: self.signs[c] for c, n in self.node.items() if n == number}

    @property
    def beside(self) -> list[tuple[int, int]]:
        """Pairs of those at one vertex, by their places in `across`."""
        place = {c: i for i, c in enumerate(self.across)}
        pairs = set()
        for vertex in self.mesh.vertices:
            own = [place[c] for c in vertex.creases if c in place]
            pairs |= {(a, b) for i, a in enumerate(own) for b in own[i + 1 :]}
        return sorted(pairs)

    def states(self, theta: Ball, at: QuadStates | None = None) -> QuadStates:
        """Return its states over boxes of theta."""
        return QuadStates(self, theta, at)


class QuadStates:
    """States of a curve over boxes of theta, [K]; those in the middles of the boxes make them narrower.

    Attributes
    ----------
    angles, slopes
        Of each crease: phi, modulo a full turn; phi' with phi''.
    outside
        Where no state of these modes closes within fold limits, certainly.
    inside
        Where all folds are within their limits, certainly, asked of single states.
    """

    def __init__(self, curve: QuadCurve, theta: Ball, at: QuadStates | None) -> None:
        self.curve = curve
        zero = exact(np.zeros_like(theta.centre))
        self._side = theta.sign
        self._half = theta.radius
        self._theta_is_flat = (theta.centre == 0) & (theta.radius == 0)
        self.outside = np.zeros(theta.centre.shape, bool)
        self.inside = np.abs(theta.centre) <= math.nextafter(0.5 * math.pi, math.inf)
        self.nodes: list[tuple[Ball, Jet]] = [(theta + theta, Jet(exact(2.0) + zero, zero))]
        self._middle = at
        self._tell(0)
        for step in curve.steps:
            found = self._step(step)
            for number, state in zip(step.nodes[1:], found, strict=True):
                self.nodes.append(self._narrower(number, state))
                self._tell(number)
        self.angles: dict[int, Ball] = {}
        self.slopes: dict[int, Jet] = {}
        for c, number in curve.node.items():
            turn = curve.signs[c] * curve.sense[number]
            angle, rate = self.nodes[number]
            if at is None:  # what is beyond a limit says nothing of states beside it
                angle = Ball(angle.centre, np.where(self.inside, angle.radius, np.inf))
            self.angles[c] = angle if turn > 0 else -angle
            self.slopes[c] = rate if turn > 0 else -rate

    def _narrower(self, number: int, state: tuple[Ball, Jet]) -> tuple[Ball, Jet]:
        """Return a fold over boxes by its value in the middle and its slope where that is known better."""
        angle, rate = state
        if self._middle is None:
            return state
        moved = self._middle.nodes[number][0].widened(rate.value.magnitude * self._half)
        better = self._middle.inside & (moved.radius < angle.radius)
        return Ball(
            *(np.where(better, *x) for x in zip(_pair(moved), _pair(angle), strict=True))
        ), rate

    def _tell(self, number: int) -> None:
        """Note where a fold has another sign than it can have."""
        angle = self.nodes[number][0]
        sign = np.where(angle.magnitude < HALF_TURN, angle.sign, 0.0)
        right = sign * self._side * self.curve.sense[number]
        self.outside = self.outside | (right < 0)
        if number:
            self.inside = self.inside & ((right > 0) | (self._theta_is_flat & (angle.centre == 0)))

    def _step(self, step: VertexStep) -> list[tuple[Ball, Jet]]:
        """Return the folds that follow from one: of the next crease, the one opposite, the last."""
        angle, rate = self.nodes[step.nodes[0]]
        first = Fold.of(angle, rate)
        third, second = self._opposite(step, first)
        both = other_folds(step.corner, first, second)
        return [both[0], third, both[1]]

    def _opposite(self, step: VertexStep, first: Fold) -> tuple[tuple[Ball, Jet], Fold]:
        """Return the fold opposite: sin(phi/2) = mode sqrt(q) sin(phi_1/2)."""
        q = step.square
        kappa = exact(float(step.mode)) * q.root()
        # the half-angles are within a quarter turn: of phi_1 the sign is known where the formula may be a turn off
        angle, rate = self.nodes[step.nodes[0]]
        half = exact(0.5) * angle
        known = angle.magnitude < HALF_TURN
        side = self._side * self.curve.sense[step.nodes[0]]
        by_size = exact(side) * (exact(0.5) * first.low.value).root()
        unknown = np.where(side == 0, 1.0, by_size.radius)
        sine = Ball(
            np.where(known, np.sin(half.centre), np.where(side == 0, 0.0, by_size.centre)),
            np.where(known, half.sine().radius, unknown),
        )
        cosine = Jet((exact(0.5) * first.high.value).root(), -(exact(0.5) * sine * rate.value))
        low = first.low * q
        high = first.high + first.low * (exact(1.0) - q)
        self.outside = self.outside | (high.value.sign < 0)
        root = (exact(0.5) * high.value).root()
        product = kappa * sine
        opposite = argument(root, product)
        turn = rate * cosine * Jet(exact(0.5) * high.value, high.slope * exact(0.5)).inverse_root()
        turn = turn * kappa
        return (opposite + opposite, turn), Fold(low, high, exact(2.0) * product * root, turn)

    def mismatch(self) -> list[Jet]:
        """Return by how much the folds of each loop differ, modulo a full turn, and its slope."""
        found = []
        for loop in self.curve.loops:
            (a, r), (b, s) = self.nodes[loop.one], self.nodes[loop.two]
            other, rate = (b, s.value) if loop.sign > 0 else (-b, -s.value)
            found.append(Jet(a - other, r.value - rate))
        return found

    @property
    def narrow(self) -> np.ndarray:
        """Whether all folds are known so well that four of them are no quarter of a turn, [K]."""
        return is_narrow(self.angles)

    def closes(self) -> np.ndarray:
        """Return which vertices come back turned by no full turn, [vertices, K], where that is `narrow`."""
        corners = [v.corners[0] for v in self.curve.mesh.vertices]
        return closing(corners, self.angles, self.narrow.shape)


def _pair(ball: Ball) -> Sequence[np.ndarray]:
    shape = np.broadcast(ball.centre, ball.radius).shape
    return np.broadcast_to(ball.centre, shape), np.broadcast_to(ball.radius, shape)
