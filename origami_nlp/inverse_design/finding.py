"""From a question to springs that were checked."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from os import PathLike, fspath
from typing import Any

import numpy as np

from origami_nlp.arguments import check_callback, check_whole, refuse, shown
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.checking import check
from origami_nlp.inverse_design.contact_choice import solve
from origami_nlp.inverse_design.convex import ConvexDesign, scene_of, springs_of
from origami_nlp.inverse_design.infeasibility import why_not
from origami_nlp.inverse_design.result import Design
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.inverse_design.targets_file import Ask, read_targets
from origami_nlp.inverse_design.transition_paths import Passes
from origami_nlp.numerics import DESIGN_SNAP
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.pattern_states import find_states

Progress = Callable[[str], None]
TOPS = 6
"""Rounds in which tops between samples become samples."""
_OF_A_VERTEX = {"maximise": "of its springs the margin is made largest"}
"""What is not asked of a pattern, and why."""


def design(
    targets: Targets | str | PathLike[str],
    ask: Ask | None = None,
    *,
    name: str | None = None,
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
        The question; or a TOML file that states it, with what is asked beyond and the name of the scene.
    ask
        What is asked beyond its states: see `Ask`; in place of what a file asks.
    name
        Of the scene; in place of that of a file.
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
        targets, of_file, label = read_targets(fspath(targets))
        ask, name = ask or of_file, name or label
    if not isinstance(targets, Targets):
        raise OptionError(f"targets = {shown(targets)} must be Targets, or a TOML file of them")
    ask = Ask() if ask is None else ask
    if not isinstance(ask, Ask):
        raise OptionError(f"ask = {shown(ask)} must be an Ask")
    check_whole("seed", seed, 0)
    check_callback("progress", progress)
    _differ(targets)
    if isinstance(targets.origami, Pattern):
        targets.origami.check_plain_hinges("design", stops=True)
        refuse("pattern", _OF_A_VERTEX, maximise=ask.maximise if ask.maximise != "margin" else None)
    if ask.maximise == "barrier" and not targets.barriers:
        raise OptionError("[ask] maximise = 'barrier' needs [[barriers]] with the pairs that count")
    if ask.maximise == "barrier" and targets.model.dof != 1:
        raise OptionError(
            f"[ask] maximise = 'barrier' needs one degree of freedom; the vertex has {targets.model.dof}"
        )
    say = progress or (lambda _: None)
    work = _Work(targets, ask, name, seed, effort, say)
    say("springs for the states")
    posed = work.solved(targets)
    if not posed.feasible:
        return _none(targets, posed, work)
    return work.made(posed)


def _differ(targets: Targets) -> None:
    """Raise an error where two targets close to one state."""
    for a, b in itertools.combinations(targets.placed, 2):
        if np.abs(a.state.x - b.state.x).max() <= DESIGN_SNAP:
            raise OptionError(
                f"states {a.target.name!r} and {b.target.name!r} are one and the same: leave one out"
            )


class _Work:
    """A question on its way."""

    def __init__(
        self, targets: Targets, ask: Ask, name: str | None, seed: int, effort: str, say: Progress
    ) -> None:
        self.targets, self.ask, self.name = targets, ask, name
        self.seed, self.effort, self.say = seed, effort, say
        one = bool(targets.barriers) and targets.model.dof == 1
        self.passes = Passes(targets) if one else None

    def solved(self, targets: Targets) -> ConvexDesign:
        """Solve, with the best choice of passes where barriers are asked for."""
        if self.passes is None:
            return solve(targets)
        best = self._best(targets)
        for _ in range(TOPS):
            # bounds hold at samples: a top between two of them that is too high becomes a sample
            if not best.feasible or not self.passes.see(
                targets.posed(scene_of(targets, springs_of(best)))
            ):
                break
            best = self._best(targets)
        return best

    def _best(self, targets: Targets) -> ConvexDesign:
        """Return the best of all choices of passes."""
        assert self.passes is not None
        lift = self.ask.maximise == "barrier"
        choices = self.passes.choices(lift)
        best: ConvexDesign | None = None
        for choice in choices:
            rows, heights = self.passes.rows(choice)
            posed = solve(targets, rows, heights if lift else ())
            if best is None or _value(posed) > _value(best):
                best = posed
        assert best is not None
        if any(p is not None for choice in choices for p in choice.values()):
            best.every_refuted = False  # other places of the passes were not tried
        return best

    def made(self, posed: ConvexDesign) -> Design:
        """Make the scene of an optimum, and check it."""
        scene = scene_of(self.targets, springs_of(posed), self.name)
        self.say("minima of the scene")
        asked: dict[str, Any] = {"seed": self.seed, "effort": self.effort, "escape": False}
        if isinstance(scene, Scene):
            full = self.targets.full_space and self.targets.symmetric
            minima = find_states(scene, full=full, **asked)
        else:
            minima = find_states(scene, contact=self.targets.contact == "full", **asked)
        ways = {} if self.passes is None else self.passes.ways
        return check(self.targets, posed, scene, minima, ways)


def _value(posed: ConvexDesign) -> float:
    """Return what was maximised; -inf without springs."""
    return float(posed.aim @ posed.answer.v) if posed.feasible else -math.inf


def _none(targets: Targets, posed: ConvexDesign, work: _Work) -> Design:

    def tried(other: Targets) -> bool:
        again = _Work(other, work.ask, None, work.seed, work.effort, work.say)
        return again.solved(other).feasible

    reason = why_not(posed, tried)
    a = posed.answer
    return Design(
        targets=targets,
        margin=posed.margin,
        scene=None,
        states=(),
        extra_minima=(),
        reason=reason,
        failed=(),
        minima=None,
        iterations=a.iterations,
        residual=a.residual,
        refuted=posed.every_refuted,
    )
