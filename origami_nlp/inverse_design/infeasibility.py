"""Why no springs hold the states: the dual of the problem in words, and the smallest change that would help."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.errors import OrigamiError
from origami_nlp.inverse_design.convex import ConvexDesign
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


def why_not(posed: ConvexDesign, works: Works) -> Infeasibility:
    """Turn the dual of a problem without an answer into words.

    Parameters
    ----------
    posed
        Solved, and not feasible.
    works
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
    return Infeasibility(states, bounds, proof_of(posed), changes(posed.targets, works))


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


def changes(targets: Targets, works: Works) -> tuple[str, ...]:
    """Find changes after which springs hold the states, each tried alone.

    Parameters
    ----------
    targets
        A question without an answer.
    works
        Returns whether a changed one has one.

    Returns
    -------
    tuple of str
        In words, with the size of the change found by bisection.
    """
    out, steps = list[str](), COARSE if targets.barriers else BISECTIONS

    def helps(change: dict[str, Any]) -> bool:
        try:
            return works(replace(targets, **change))
        except OrigamiError:  # one that cannot be asked has no answer
            return False

    def least(make: Callable[[float], dict[str, Any]], bad: float) -> float | None:
        """Return the smallest factor from 1 to `bad` that helps; None if the largest does not."""
        low, high = 1.0, bad
        if not helps(make(high)):
            return None
        for _ in range(steps):
            # geometric: factors, not differences
            middle = math.sqrt(low * high)
            low, high = (low, middle) if helps(make(middle)) else (middle, high)
        return high

    low, high = targets.rest
    if targets.preload is False:
        size, half = max(-low, high), math.pi * (1 + SETTLED)
        wound = lambda f: {"preload": f * size > half, "rest_angles": (f * low, f * high)}  # noqa: E731
        # springs of sheets are not wound
        if factor := least(wound, TURNS / size) or least(wound, math.pi / size):
            how = " (preload = true)" if factor * size > half else ""
            out.append(f"let rest angles reach {math.degrees(factor * size):.4g} deg{how}")
    soft, stiff = targets.stiffness
    if factor := least(lambda f: {"stiffness": (soft / f, stiff * f)}, WIDEST):
        out.append(f"let stiffness range from {soft / factor:.4g} to {stiff * factor:.4g} N m/rad")
    for name in [t.name for t in targets.states] if len(targets.states) > 1 else []:
        left: dict[str, Any] = {"states": tuple(t for t in targets.states if t.name != name)}
        for key in ("energies", "barriers"):
            asks = getattr(targets, key)
            left[key] = tuple(a for a in asks if name not in (a.first, a.second))
        if helps(left):
            out.append(f"leave out state {name!r}")
    return tuple(out)
