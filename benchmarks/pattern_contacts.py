"""Times of patterns that are pressed together: about a hundred pairs of facets close to each other, and more."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.pattern import examples
from origami_nlp.pattern_problem import FoldedGeometry, PatternProblem
from origami_nlp.pattern_states import contact_descent_off, descend, judge

CASES = (
    *(("yoshimura:4x4", seed) for seed in range(6)),
    ("yoshimura:5x5", 0),
    ("yoshimura:6x6", 0),
    ("waterbomb:3x4", 0),
)
"""Patterns, and seeds of their rest angles."""
QUICK = (("yoshimura:4x4", 1),)
REST = 2.2, 3.2
"""Rest angles are drawn between these, with the signs of mountains and valleys, and cut at pi [rad]."""
GUESS = 0.3
"""Fold angle of mountains and valleys of the start [rad]."""
CLOSE = 0.05
"""Facets with features that face each other closer than this, over the sheet's size, are a close pair."""


@dataclass(frozen=True)
class PatternContact:
    """A pattern that was pressed together.

    Attributes
    ----------
    name, seed, facets, creases
        The pattern, and the seed of its rest angles.
    pairs
        Of facets that are close to each other in the end.
    touching
        Contacts that are closed there: fold limits and features.
    seconds
        Processor time from the pattern's problem to the judged state.
    verdict
        Of the state; "not decided" where the descent found no way on, nor that none is left.
    closure, torque
        Its residuals: of closure, and torque without balance over the largest (of what is not decided: what is left).
    """

    name: str
    seed: int
    facets: int
    creases: int
    pairs: int
    touching: int
    seconds: float
    verdict: str
    closure: float
    torque: float

    def cells(self) -> list[str]:
        """Return its row of a table."""
        counts = (f"{k:,}" for k in (self.facets, self.creases, self.pairs, self.touching))
        residuals = (f"{x:.0e}" for x in (self.closure, self.torque))
        return [self.name, str(self.seed), *counts, f"{self.seconds:.2g}", *residuals, self.verdict]


def measure_contacts(
    quick: bool = False, progress: Callable[[str], object] = lambda text: None
) -> list[PatternContact]:
    """Time descents into contact, one each.

    Parameters
    ----------
    quick
        One of them alone.
    progress
        Called with the name of each.

    Returns
    -------
    list of PatternContact
    """
    found = []
    for name, seed in QUICK if quick else CASES:
        progress(f"contact: {name}, rest angles {seed}")
        found.append(measure_contact(name, seed))
    return found


def measure_contact(name: str, seed: int) -> PatternContact:
    """Fold a pattern with rest angles of a seed until facets press on each other, and judge where it ends."""
    kind, _, size = name.partition(":")
    pattern = examples.pattern(kind, *map(int, size.split("x")))
    rest = np.random.default_rng(seed).uniform(*REST, pattern.creases)
    sheet = PatternProblem(
        pattern.with_springs(1.0, list(pattern.signs * np.minimum(rest, math.pi)))
    )
    begin = time.process_time()
    start, _ = sheet.project(GUESS * pattern.signs)
    free = descend(sheet, start)
    end = contact_descent_off(sheet, free.path) or free
    state = judge(sheet, end.phi)
    seconds = time.process_time() - begin
    decided = end.arrived or state.verdict == "minimum"
    close = sheet.features.facing(FoldedGeometry(sheet.crossings.poses, state.phi), CLOSE)
    return PatternContact(
        name,
        seed,
        pattern.facets,
        pattern.creases,
        len({frozenset(touch.facets) for touch, _ in close}),
        len(state.contacts),
        seconds,
        state.verdict if decided else "not decided",
        state.closure_residual,
        state.kkt_residual if math.isfinite(state.kkt_residual) else math.inf,
    )
