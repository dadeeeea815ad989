"""What the minima of a scene say: table, states, and how the search went."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.numerics import BALANCED, STATIONARY, residual_words
from origami_nlp.pattern import Scene

MOST_ANGLES = 24
"""Fold angles of a state up to which they are written out; those of larger ones are in the JSON."""
KIND_STYLE = {
    "interior": "green",
    "contact-pinned": "yellow",
    "contact-touching": "cyan",
    "degenerate": "magenta",
}
VERDICT_STYLE = {"stable": "green", "unstable": "red", "undecided": "bold"}


def freedom_words(dimension: int, full: int) -> str:
    """Say what the local dimension of the feasible set means."""
    if dimension == full:
        return f"{dimension}"
    return {0: "0 isolated", 1: "1 handle"}.get(dimension, f"{dimension} of {full}")


def moment_words(moment: Sequence[float], residual: float, degree: int) -> str:
    """Say which moment passes round the vertex, or that there is no such one."""
    largest = max(map(abs, moment))
    vector = ", ".join(f"{v:.6g}" if abs(v) > STATIONARY * largest else "0" for v in moment)
    if residual > BALANCED * (1 + largest):
        return (
            f"no one moment passes round the vertex: ({vector}) N m leaves up to {residual:.2g} N m at a free "
            "crease, which facets that touch carry"
        )
    return (
        f"one moment passes round the vertex: ({vector}) N m, seen from the facet between creases {degree} and 1, "
        f"residual {residual_words(residual)} N m"
    )


def full_space_lines(f: FullSpace) -> list[str]:
    """Say what becomes of a state when its symmetry may break."""
    lines = [f"full space: {f.verdict}: {f.certificate}"]
    if f.unstable_mode:
        lines.append(f"the descent {f.unstable_mode}")
    if f.lands_on:
        name = f"state #{f.lands_on.symmetric}" if f.lands_on.symmetric else "an asymmetric state"
        angles = " ".join(f"{a:.2f}" for a in np.round(np.degrees(f.lands_on.fold_angles), 2) + 0.0)
        lines.append(
            f"it lands on {name} at {f.lands_on.energy:.6g} J, {f.lands_on.kind}: {angles} deg"
        )
    return lines


def undecided_lines(search: SearchReport) -> list[str]:
    """Name the states that may be minima, but were neither certified nor refuted."""
    return [
        f"not decided: energy {r.energy:.9g} J{_where(r)}: {r.certificate}"
        for r in search.undecided
    ]


def _where(state: JudgedState) -> str:
    if len(state.fold_angles) > MOST_ANGLES:
        return ""
    angles = " ".join(f"{a:.6g}" for a in np.degrees(state.fold_angles))
    return f", hits {state.hits}, fold angles [deg] {angles}"


def flag_lines(flags: ResultFlags) -> list[str]:
    """Name the flags that are up."""
    if not flags:
        return []
    return [f"flags up: {', '.join(flags.up)} (causes and cures: docs/flags.md, result.flags)"]


def scene_lines(scene: Scene) -> list[str]:
    """Say what is loaded, and how far sector angles were moved to make nearly special relations exact, if they were."""
    found = scene.relations
    if not found.made_exact:
        return scene.load_lines
    return [
        *scene.load_lines,
        f"sector angles moved by up to {found.moved:.1e} rad, so that {len(found.made_exact)} nearly special "
        "relations hold exactly (origami-nlp model lists them)",
    ]
