"""A chain of a sweep by following: states over the last axis, with searches only as checks."""

from __future__ import annotations

import re
import time

import numpy as np

from origami_nlp.bifurcation import Atlas, Family, ParameterRange, follow_family
from origami_nlp.errors import OptionError
from origami_nlp.minima import judge_in_full_space
from origami_nlp.pattern import Scene
from origami_nlp.sweep.spec import Axis, Sweep
from origami_nlp.sweep.store import Outcome, row_of


def follow_chain(sweep: Sweep, chain: range) -> list[Outcome]:
    """Return the outcomes of the scenes of a chain.

    Raises
    ------
    OrigamiError
        If the scenes are no smooth family over the last axis, or are fewer than three.
    """
    axis = sweep.axes[-1]
    others = sweep.parameters(chain[0])
    values = [sweep.parameters(index)[axis.name] for index in chain]

    def scene_of(t: float) -> Scene:
        return sweep.scene_with({**others, axis.name: t})

    s = sweep.search
    begin = time.perf_counter()
    atlas = follow_family(
        Family(_over(axis, min(values), max(values)), scene_of),
        full=False,
        effort=s["effort"],
        seed=s["seed"],
        max_starts=s["max_starts"],
    )
    seconds = (time.perf_counter() - begin) / len(chain)
    return [
        _outcome(sweep, index, atlas, value, seconds)
        for index, value in zip(chain, values, strict=True)
    ]


def _over(axis: Axis, low: float, high: float) -> ParameterRange:
    log = all(
        place == "ratio" or ".stiffness" in place or re.fullmatch(r"laws\..*\.scale", place)
        for place in axis.places
    )
    if not low < high:
        raise OptionError(f"{axis.name} takes one value: there is nothing to follow")
    return ParameterRange(axis.name, low, high, "", log)


def _outcome(sweep: Sweep, index: int, atlas: Atlas, value: float, seconds: float) -> Outcome:
    """Return what a scene has: its minima on branches, and the searches of a check made there."""
    begin = time.perf_counter()
    scene = sweep.scene(index)
    found = [m for m in atlas.at(value) if m.verdict == "minimum"]
    states = []
    for m in found:
        full = sweep.search["full"] and judge_in_full_space(scene, np.array(m.fold_angles)).verdict
        states.append(row_of(m, m.local_dimension, full or None))
    check = next((c for c in atlas.checks if c.t == value), None)
    seconds += time.perf_counter() - begin
    starts, missing = (check.starts, check.expected_undiscovered) if check else (0, np.nan)
    known = missing if np.isfinite(missing) else None
    return Outcome(index, "done", "", seconds, starts, known, tuple(states))
