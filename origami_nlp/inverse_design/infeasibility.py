"""Why no springs hold the states: the dual of the problem in words, and the smallest change that would help."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.inverse_design.convex import ConvexDesign, solve
from origami_nlp.inverse_design.targets import TURNS, Targets
from origami_nlp.numerics import SETTLED

WEIGHTY = 1e-4
"""Rows whose dual is below this share of the largest are not named."""
BISECTIONS, COARSE = 20, 6
"""Where a size is looked for; the second where each question is many problems."""
WIDEST = 1e4
"""Largest factor by which a range of stiffness is widened when a change is looked for."""


@dataclass(frozen=True)
class Infeasibility:
    """Why a question has no answer.

    Attributes
    ----------
    states
        Names of the states that are in conflict.
    bounds
        Rows that are in conflict, in words, weightiest first.
    proof
        What was proved, with its residual.
    changes
        Changes after which there is an answer, each alone; empty where none of those tried helps.
    """

    states: tuple[str, ...]
    bounds: tuple[str, ...]
    proof: str
    changes: tuple[str, ...]

    @property
    def text(self) -> str:
        """All of it in one line."""
        who = " and ".join(self.states) if self.states else "the bounds alone"
        why = f"no springs hold {who}"
        why += f" with {'; '.join(self.bounds[:4])}" if self.bounds else ""
        return f"{why} ({self.proof})"


Works = Callable[[Targets], bool]


def works(targets: Targets) -> bool:
    """Return whether springs hold the states of a question, whatever else is asked for."""
    return solve(targets).feasible


def why_not(posed: ConvexDesign, tried: Works = works) -> Infeasibility:
    """Turn the dual of a problem without an answer into words.

    Parameters
    ----------
    posed
        Solved, and not feasible.
    tried
        Returns whether a changed question has an answer.

    Returns
    -------
    Infeasibility
        With changes that would help.
    """
    weights = Counter[str]()
    for rows, y in zip(posed.problem.rows, posed.answer.duals, strict=True):
        words = [rows.words] * len(y) if isinstance(rows.words, str) else rows.words
        for one, size in zip(words, np.abs(y).tolist(), strict=True):
            weights[one] = max(weights[one], size)
    for own in ("the mean stiffness is 1", "the margin has a cap"):
        weights.pop(own, None)
    # rows with a dual that counts are those whose combination is contradictory
    least = WEIGHTY * max(weights.values(), default=0.0)
    heavy = [words for words, w in weights.most_common() if w > least]
    names = [t.name for t in posed.targets.states]
    states = tuple(n for n in names if any(f" {n} " in f" {words} " for words in heavy))
    bounds = tuple(w for w in heavy if not w.endswith((" balances", " is stiff")))
    return Infeasibility(states, bounds, proof_of(posed), changes(posed.targets, tried))


def proof_of(posed: ConvexDesign) -> str:
    """Describe what the dual proves, and how well its arithmetic closes."""
    a = posed.answer
    touching = sorted({posed.targets.states[i].name for i, _ in posed.touching})
    how = f", with contacts of {', '.join(touching)} that need not press" if touching else ""
    if posed.loose:
        how = ", whichever contacts press" if posed.balances else ""
    if a.infeasible:
        return f"a combination of the conditions is contradictory{how}; residual {a.residual:.0e}"
    if a.solved:
        return f"the largest margin is {a.bound:.3g}{how}; residual {a.residual:.0e}"
    return f"not decided: the solver ended with {a.status}"


def changes(targets: Targets, tried: Works = works) -> tuple[str, ...]:
    """Find changes after which springs hold the states, each tried alone.

    Parameters
    ----------
    targets
        A question without an answer.
    tried
        Returns whether a changed one has one.

    Returns
    -------
    tuple of str
        In words, with the size of the change found by bisection.
    """
    out = []
    steps = COARSE if targets.barriers else BISECTIONS
    low, high = targets.rest
    if targets.preload is False:
        size = max(-low, high)

        def wound(f: float) -> Targets:
            far = f * size > math.pi * (1 + SETTLED)
            return replace(targets, preload=far, rest_angles=(f * low, f * high))

        # springs of sheets are not wound
        found = (_least(tried, wound, end / size, steps) for end in (TURNS, math.pi))
        if least := next(filter(None, found), None):
            how = " (preload = true)" if least * size > math.pi * (1 + SETTLED) else ""
            out.append(f"let rest angles reach {math.degrees(least * size):.4g} deg{how}")
    low, high = targets.stiffness

    def wider(f: float) -> Targets:
        return replace(targets, stiffness=(low / f, high * f))

    if least := _least(tried, wider, WIDEST, steps):
        out.append(f"let stiffness range from {low / least:.4g} to {high * least:.4g} N m/rad")
    names = [t.name for t in targets.states] if len(targets.states) > 1 else []
    return (
        *out,
        *(f"leave out state {n!r}" for n in names if _works(tried, partial(without, targets, n))),
    )


def _least(tried: Works, make: Callable[[float], Targets], bad: float, steps: int) -> float | None:
    """Return the smallest factor from 1 to `bad` that works, by bisection; None if the largest does not."""
    low, high = 1.0, bad
    if not _works(tried, partial(make, high)):
        return None
    for _ in range(steps):
        # geometric: factors, not differences
        middle = math.sqrt(low * high)
        low, high = (low, middle) if _works(tried, partial(make, middle)) else (middle, high)
    return high


def _works(tried: Works, make: Callable[[], Targets]) -> bool:
    """Return whether a changed question has an answer; one that cannot be asked has none."""
    try:
        return tried(make())
    except OrigamiError:
        return False


def without(targets: Targets, name: str) -> Targets:
    """Return the question without one state, and without what is asked of its energy."""
    return replace(
        targets,
        states=tuple(t for t in targets.states if t.name != name),
        energies=tuple(g for g in targets.energies if name not in (g.first, g.second)),
        barriers=tuple(b for b in targets.barriers if name not in (b.first, b.second)),
    )
