"""From a question to springs that were checked."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from os import PathLike, fspath

import numpy as np

from origami_nlp.arguments import check_callback, check_whole, shown
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.checking import check
from origami_nlp.inverse_design.convex import ConvexDesign, scene_of, solve
from origami_nlp.inverse_design.infeasibility import why_not
from origami_nlp.inverse_design.result import Design
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.inverse_design.targets_file import read_targets
from origami_nlp.inverse_design.transition_paths import Passes
from origami_nlp.numerics import DESIGN_SNAP
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states import find_states

Progress = Callable[[str], None]
TOPS = 6
"""Rounds in which tops between samples become samples."""


def design(
    targets: Targets | str | PathLike[str],
    *,
    seed: int = 0,
    effort: str = "normal",
    progress: Progress | None = None,
) -> Design:
    """Find the springs that hold given states with the largest margin, or prove that there are none.

    At fixed states the conditions are convex in stiffness and torque (`equilibrium`), so that the answer is the best
    there is, or a proof that none exists within the bounds; then the main job searches the scene for its minima.  Given
    states with a symmetry imposed are those that wind once round its axis (`Scene.windings`).

    Parameters
    ----------
    targets
        The question; or what `read_targets` takes, a TOML file that states it or the name of an example.
    seed, effort
        Of the search that checks the answer, as of `find_minima`.
    progress
        Called with a line before each stage.

    Returns
    -------
    Design
        With the scene and its check, or with the reason.

    Raises
    ------
    OptionError
        If an argument is not what it must be, a target does not close or is not admissible, or Clarabel is missing.

    Examples
    --------
    >>> import math, origami_nlp as o
    >>> vertex = o.Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3"))
    >>> result = o.find_minima(o.Scene(vertex, (1, 1, 1, 1), (1.2, -1.2, -0.6, -1.2)))
    >>> wanted = o.inverse_design.Target("folded", result.minima[0].fold_angles)
    >>> answer = o.design(o.inverse_design.Targets(vertex, (wanted,)))
    >>> answer.verified, answer.margin > 0
    (True, True)
    """
    if isinstance(targets, str | PathLike):
        targets = read_targets(fspath(targets))
    if not isinstance(targets, Targets):
        raise OptionError(f"targets = {shown(targets)} must be Targets, or a TOML file of them")
    check_whole("seed", seed, 0)
    check_callback("progress", progress)
    for a, b in itertools.combinations(targets.placed, 2):
        if np.abs(a.state.x - b.state.x).max() <= DESIGN_SNAP:
            both = f"{a.target.name!r} and {b.target.name!r}"
            raise OptionError(f"states {both} are one and the same: leave one out")
    targets.origami.check_plain_hinges("design", stops=True)
    say = progress or (lambda _: None)
    say("springs for the states")
    posed, passes = _solved(targets)
    if not posed.feasible:
        reason = why_not(posed, lambda other: _solved(other)[0].feasible)
        return Design(targets, posed.margin, reason=reason, refuted=posed.every_refuted)
    scene = scene_of(posed)
    say("minima of the scene")
    full = targets.full_space and scene.is_symmetric
    found = find_states(scene, seed=seed, effort=effort, escape=False, full=full)
    return check(targets, posed, scene, found, passes)


def _solved(targets: Targets) -> tuple[ConvexDesign, Passes | None]:
    """Solve, with the best choice of passes where barriers are asked for along a curve."""
    if not targets.barriers or targets.model.dof != 1:
        return solve(targets), None
    passes = Passes(targets)
    best = _best(targets, passes)
    for _ in range(TOPS):
        # bounds hold at samples: a top between two of them that is too high becomes a sample
        if not best.feasible or not passes.see(pose(scene_of(best))):
            break
        best = _best(targets, passes)
    return best, passes


def _best(targets: Targets, passes: Passes) -> ConvexDesign:
    """Return the best of all choices of passes."""
    choices = passes.choices()
    posed = [solve(targets, passes.rows(choice)) for choice in choices]
    best = max(posed, key=lambda one: one.margin if one.feasible else -math.inf)
    if any(p is not None for choice in choices for p in choice.values()):
        best.every_refuted = False  # other places of the passes were not tried
    return best
