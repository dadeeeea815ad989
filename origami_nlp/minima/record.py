"""What a search has found and done: distinct states, how often each was reached, failures included."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.folding import fold_vertex
from origami_nlp.kkt import (
    Classification,
    Polished,
    State,
    classify,
    exact_beside,
    not_told_apart,
    of_image,
)
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, NEAR_SINGULAR_TOL
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.problem import Model, Problem
from origami_nlp.starts import Listed

BREAKDOWNS = (np.linalg.LinAlgError, ArithmeticError)
"""How linear algebra fails at one state: that state is counted and named, and the search goes on."""


@dataclass(eq=False)
class FoundState:
    """A distinct state that descents ended at: its polish, how many reached it, what it was judged to be.

    hits: over all starts.  in_rounds: over those that are drawn anew, corners left out.  first: the number of the drawn
    start that reached it first, from 1; 0 for none.
    listed: found by listing or tracing, not by descent.  orbit: for an image of a minimum found
    before, under a symmetry that the scene has without asking for it, that minimum.
    lost: why the end is no state at all (then it is on no list); "" for a state.
    """

    polished: Polished
    hits: int = 0
    in_rounds: int = 0
    first: int = 0
    listed: bool = False
    orbit: FoundState | None = None
    what: Classification | None = None
    lost: str = ""

    @property
    def is_minimum(self) -> bool:
        """Whether it was judged to be a minimum."""
        return self.what is not None and self.what.verdict == "minimum"

    @property
    def gives_way(self) -> bool:
        """Whether it was listed, never polished, and judged not to be stationary."""
        unpolished = self.listed and math.isnan(self.polished.kkt_residual)
        return unpolished and self.what is not None and self.what.verdict == "not stationary"


@dataclass
class Record:
    """Everything a search did, failures included.

    answers: distinct states.  starts: drawn.  feasible_starts: admissible among them.  stalled: descents that ended
    nowhere.  failed: those whose end is no state, or at which linear algebra broke down, by reason.
    by_source: starts, by kind.  drawn: admissible starts that were drawn anew.
    statuses, solves, iterations: of IPOPT.
    problem: what answers are judged by.
    """

    problem: PatternProblem
    answers: list[FoundState] = field(default_factory=list)
    starts: int = 0
    feasible_starts: int = 0
    stalled: int = 0
    failed: Counter[str] = field(default_factory=Counter)
    by_source: Counter[str] = field(default_factory=Counter)
    drawn: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    solves: int = 0
    iterations: int = 0

    @property
    def minima(self) -> list[FoundState]:
        """The answers that are minima."""
        return [a for a in self.answers if a.is_minimum]

    @property
    def quiet(self) -> int:
        """Random starts since one reached a minimum that none before had reached."""
        first: dict[int, int] = {}
        for a in self.minima:
            if a.first:
                orbit = id(a.orbit or a)
                first[orbit] = min(first.get(orbit, a.first), a.first)
        return self.drawn - max(first.values(), default=0)

    @property
    def drawn_hits(self) -> list[int]:
        """How often random starts reached each minimum, or an image of it, that any start reached."""
        hits: Counter[int] = Counter()
        for a in self.minima:
            if a.hits or a.orbit:
                hits[id(a.orbit or a)] += a.in_rounds
        return list(hits.values())

    @property
    def seen_once(self) -> int:
        """How many minima, images apart, one drawn start reached."""
        return sum(hits == 1 for hits in self.drawn_hits)

    def known(self, x: np.ndarray) -> FoundState | None:
        """Return the answer that a polished state is, if there is one."""
        near = np.flatnonzero(self._apart(x) <= DUPLICATE_TOL)
        return self.answers[near[0]] if len(near) else None

    @contextmanager
    def surviving(self, what: str) -> Iterator[None]:
        """Let a search go on where linear algebra breaks down in the body: it is counted, `what` and why."""
        try:
            yield
        except BREAKDOWNS as error:
            self.failed[f"{what}: {error}"] += 1

    def states_of(self, family: Listed) -> list[np.ndarray]:
        """List the states [n] of a family; none where linear algebra breaks down, which is counted by its name."""
        with self.surviving(family.name):
            return list(family.states())
        return []

    def file(self, model: Problem, polished: Polished) -> tuple[FoundState, bool]:
        """File a polished state under the answer that it is, or as a new one; return whether it has to be judged.

        What Newton could not polish is taken for the exact state next to it, where there is one.  A listed state
        that is not stationary gives way to the stationary one that Newton finds next to it: with data that are
        symmetric but for 1e-10 the lowest state of a hinge set is so far from the minimum.
        """
        if not polished.converged:
            polished = self._exact_beside(polished) or exact_beside(model, polished)
        # answers that are known less exactly than others may lie farther away and still be the same
        widest = max((a.polished.uncertainty for a in self.answers), default=0.0)
        may = self._apart(polished.x) <= max(NEAR_SINGULAR_TOL, polished.uncertainty + widest)
        for known in (self.answers[k] for k in np.flatnonzero(may)):
            if _is_same(known.polished, polished):
                better = polished.converged and (not known.polished.converged or known.gives_way)
                if better:
                    known.polished = polished
                return known, better
        answer = FoundState(polished)
        self.answers.append(answer)
        return answer, True

    def _exact_beside(self, state: Polished) -> Polished | None:
        """Return the nearest exact state on record within `NEAR_SINGULAR_TOL` of a state, or None."""
        if not self.answers:
            return None
        exact = np.array([a.polished.converged for a in self.answers])
        apart = np.where(exact, self._apart(state.x), math.inf)
        nearest = int(apart.argmin())
        return self.answers[nearest].polished if apart[nearest] <= NEAR_SINGULAR_TOL else None

    def _apart(self, x: np.ndarray) -> np.ndarray:
        """Largest difference of a fold angle between each answer and a state [n]."""
        states = np.array([a.polished.x for a in self.answers]).reshape(-1, len(x))
        return np.asarray(np.abs(states - x).max(axis=1, initial=0.0))


def close_orbit(model: Model, record: Record, answer: FoundState) -> None:
    """File the images of a minimum under symmetries that the scene has without asking for them.

    What is certified of one holds for all; where another was refuted, none is a minimum.
    """
    for order, sign in model.own_symmetries[1:]:
        x = sign * answer.polished.x[order]
        image = record.known(x)
        if image is None:
            image = FoundState(replace(answer.polished, x=x, rows=()), listed=True)
            record.answers.append(image)
            judge(record, image)
        assert image.what is not None and answer.what is not None
        if image.what.verdict == "undecided":
            with record.surviving("an image under a symmetry of the scene"):
                image.what = of_image(State(record.problem, image.polished.x), answer.what)
        elif not image.is_minimum:
            why = f"an image under a symmetry of the scene is {image.what.verdict}"
            answer.what = Classification("undecided", None, why, 0)
            return
        if image.orbit is None:
            image.orbit = answer.orbit or answer


def closes(model: Model, x: np.ndarray) -> bool:
    """Return whether all N fold angles close the vertex, by a product of rotations that is not the model's closure."""
    _, q = fold_vertex(model.scene.vertex, model.expand(x))
    return float(np.linalg.norm(q[1:])) <= CLOSURE_TOL


def judge(record: Record, answer: FoundState) -> None:
    """Classify an answer: one that does not close is no admissible state, and where linear algebra breaks down nothing
    is decided.
    """
    p, problem = answer.polished, record.problem
    if np.abs(problem.closure.values(p.x)).max() > CLOSURE_TOL:
        answer.what = Classification("not admissible", None, "it does not close", 0)
        return
    try:
        answer.what = classify(State(problem, p.x), polished=p.converged)
        if answer.is_minimum and (why := not_told_apart(problem, p.x)):
            answer.what = Classification("undecided", None, why, 0)
    except BREAKDOWNS as error:
        why = f"linear algebra failed where it was judged: {error}"
        answer.what = Classification("undecided", None, why, 0)


def listed(record: Record, model: Model, x: np.ndarray) -> FoundState:
    """Return an exact state that was listed as an answer, judged."""
    answer = FoundState(exact_state(model, x), listed=True)
    judge(record, answer)
    return answer


def exact_state(model: Problem, x: np.ndarray) -> Polished:
    """Return a state that is known to rounding, as if Newton had ended there."""
    return Polished(x, (), float(np.abs(model.closure(x)[0]).max()), math.nan, True)


def _is_same(one: Polished, other: Polished) -> bool:
    """Return whether two states are one, as far as their accuracy says."""
    exact = one.converged and other.converged
    near = max(DUPLICATE_TOL, one.uncertainty + other.uncertainty) if exact else NEAR_SINGULAR_TOL
    return bool(np.abs(one.x - other.x).max() <= near)
