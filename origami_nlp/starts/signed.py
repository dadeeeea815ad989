"""Starts beside the flat state by the signs of vertices, and which signs can be there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from itertools import product

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, NONZERO, RESOLVED, dense, null_space
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import (
    CanonicalLabelling,
    PatternProblem,
    PopSigns,
    SignConflict,
    SignVector,
    VertexCones,
)
from origami_nlp.starts.family import Listed
from origami_nlp.starts.of_patterns import creases_around

MOST_SIGNED = 6
"""Interior vertices up to which every combination of their signs is started from."""
DRAWN = 16
"""Combinations of more vertices, which are drawn."""
TRIED, GROWN = 12, 0.2
"""Directions that are tried for each, and their largest fold angle [rad]."""
SOLVER = "clarabel"
"""Decides which signs cannot be; without it that is left open."""


class Signed(Listed):
    """States beside the flat one with signs of the vertices that no minimum has yet, none of whose facets cross.

    The sum of the fold angles round a vertex keeps its sign along motions of paper (`PopSigns`), and the states with
    given signs are compact with those on their borders: a descent that does not cross comes to a minimum there, or to a
    vertex that is flat.

    Parameters
    ----------
    problem
        Of a flat pattern.
    labels
        The order of its creases.
    minima
        States whose signs are known, [M, n] [rad].
    pattern
        As it was stated, for proofs; None: that of the problem.

    Attributes
    ----------
    vectors
        What is known of each combination of signs that was asked about, as far as `states` has come.
    """

    name = "signs of vertices that no minimum has"
    sentence = "beside the flat state, with signs of the vertices that no minimum has yet"

    def __init__(
        self,
        problem: PatternProblem,
        labels: CanonicalLabelling,
        minima: np.ndarray,
        pattern: Pattern | None = None,
    ) -> None:
        self.size, self._problem, self._labels = problem.size, problem, labels
        pattern = pattern or problem.pattern
        self._cones = VertexCones(pattern) if find_spec(SOLVER) and not pattern.cell else None
        signs = PopSigns(problem.pattern)
        turn = [frozenset(creases) for creases in creases_around(problem.pattern, labels)]
        places = [turn.index(frozenset(creases)) for creases in signs.around]
        # vertices in an order that labels do not change
        self._order = sorted(range(len(places)), key=places.__getitem__)
        self._rows = signs.rows
        self._seen = {signs.of(x) for x in minima}
        self._conflicts: list[SignConflict] = []
        self.vectors: list[SignVector] = []

    def states(self) -> Iterator[np.ndarray]:
        """Yield one for each combination of signs for which one is found."""
        rng = np.random.default_rng(0)
        free = null_space(dense(self._problem.closure.jacobian(np.zeros(self.size))))
        for signs in self._wanted(rng):
            if signs in self._seen:
                self.vectors.append(SignVector(signs, "minimum", conflict=self._why(signs)))
                continue
            found = self._decide(signs, free, rng)
            self.vectors.append(found)
            if found.fold_angles:
                yield np.array(found.fold_angles)

    def _wanted(self, rng: np.random.Generator) -> Iterator[str]:
        many = len(self._rows)
        if many > MOST_SIGNED:
            some: Sequence[Sequence[float]] = rng.normal(size=(DRAWN, many)).tolist()
        else:
            some = list(product((1.0, -1.0), repeat=many)) if many else []
        for values in some:
            at = dict(zip(self._order, values, strict=True))
            yield "".join("+" if at[v] > 0 else "-" for v in range(many))

    def _decide(self, signs: str, free: np.ndarray, rng: np.random.Generator) -> SignVector:
        """Look for a state, then for a direction in all cones and a state beside it, then for why there is none."""
        sides = np.array([float(f"{s}1") for s in signs])
        base = free @ (free.T @ (self._rows.T @ sides))
        for k in range(TRIED):
            aside = free @ (free.T @ self._labels.drawn(rng.normal(size=self.size)))
            if (phi := self._closed(base + 0.2 * k * aside, sides)) is not None:
                return SignVector(signs, "state", tuple(phi.tolist()))
        if (why := self._why(signs)) is not None:
            return SignVector(signs, "impossible", conflict=why)
        for k in range(TRIED if self._cones else 0):
            towards = self._labels.drawn(rng.normal(size=self.size)) if k else None
            inside = self._cones.direction(signs, towards=towards) if self._cones else None
            if inside is None:
                break
            if (phi := self._closed(inside, sides)) is not None:
                return SignVector(signs, "state", tuple(phi.tolist()))
        return SignVector(signs, "open")

    def _why(self, signs: str) -> SignConflict | None:
        """Return why no state beside the flat one has some signs, if that is proved; known for others, or new."""
        if self._cones is None:
            return None
        for why in self._conflicts:
            here = "".join(signs[self._cones.vertices.index(v)] for v in why.vertices)
            if here in (why.signs, why.signs.translate(TURNED)):
                return why
        new = self._cones.conflict(signs)
        self._conflicts += [new] if new else []
        return new

    def _closed(self, direction: np.ndarray, sides: np.ndarray) -> np.ndarray | None:
        """Return the closed state beside the flat one in a direction, if it has the signs and nothing crosses."""
        problem = self._problem
        start = GROWN * direction / max(float(np.abs(direction).max()), NONZERO)
        phi, residual = problem.project(start)
        good = residual <= CLOSURE_TOL and (np.sign(self._rows @ phi) == sides).all()
        good = good and problem.fold_limits.inside(phi).all()
        if good and np.abs(phi).max() > RESOLVED and not problem.crossings.find(phi):
            return phi
        return None


TURNED = str.maketrans("+-", "-+")
