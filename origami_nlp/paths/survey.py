"""Follow all minima of a few searches over a parameter: events located, counts between them, checks reported."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np

from origami_nlp.arguments import check_callback, check_flag, check_type, check_until, check_whole
from origami_nlp.contact import breaking_stiffnesses
from origami_nlp.continuation import STEPS, ContinuationOptions, Equilibrium, Line, nearest
from origami_nlp.errors import OUT_OF_TIME, unless_stopped
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult, check_prove
from origami_nlp.numerics import SETTLED
from origami_nlp.paths.driver import search_minima
from origami_nlp.paths.family import Family, family_of, with_generic_symmetry
from origami_nlp.paths.followed import FollowedDiagram
from origami_nlp.paths.parameter_range import ParameterRange, parse_parameter_range
from origami_nlp.paths.records import SearchCheck
from origami_nlp.paths.result import Atlas
from origami_nlp.pattern import Scene, Stated, as_origami
from origami_nlp.proof import ProofOptions


def follow(
    origami: Stated,
    parameter: str | ParameterRange,
    *,
    checks: int = 3,
    full: bool = True,
    prove: bool | float | ProofOptions = False,
    options: ContinuationOptions | None = None,
    seconds: float | None = None,
    progress: Callable[[str], object] | None = None,
    **search: Any,
) -> Atlas:
    """Follow the minima of a vertex or a pattern over a parameter.

    Searches at a few values (the middle for one check, both ends for two, then the middles of the widest intervals
    without events) give the states to begin with; every state that no branch explains begins a new one.  Of several
    `Scene.windings` the first, or the one that is stated, is followed.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    parameter
        The parameter and its range, such as ``"ratio=0.01:100"``; see `parse_parameter_range`.  Of a pattern also
        ``"mountains.stiffness=1:2"``, ``"vertices.x[5]=0:0.1"`` (see `pattern.with_numbers`), or an option of an
        example by its name, ``"alpha=50deg:60deg"`` of ``"miura:3x3"``.
    checks
        Number of searches.
    full
        Whether events at which a symmetric state loses its stability without the symmetry are located.
    prove
        Whether it is proved at each check that no minimum is missing, or the seconds for it, as for `find_minima`.
    options
        Of the continuation: lengths of steps, points and arcs at most.
    seconds
        Wall time; what was followed by then is judged and returned, see `Atlas.interrupted`.  None: no limit.
    progress
        Called with what it is at, in words, whenever that changes.
    search
        Of the searches: effort, seed, max_starts, starts of `find_minima`.

    Returns
    -------
    Atlas
        Branches, events, counts and checks.

    Raises
    ------
    OptionError
        If the scene has no such parameter, or an argument is not what it must be.
    Interrupted
        If the user interrupts it: a `KeyboardInterrupt` whose ``result`` holds what was followed.

    Examples
    --------
    >>> import origami_nlp as o
    >>> atlas = o.follow(o.examples.degree6("pi/3"), "ratio=0.2:1", checks=1, full=False)
    >>> [(event.type, round(event.t, 6)) for event in atlas.events]
    [('closes', 0.355732)]
    >>> [state.kind for state in atlas.at(0.3)]
    ['interior', 'contact-touching', 'degenerate', 'degenerate']
    """
    stated = parse_parameter_range(parameter) if isinstance(parameter, str) else parameter
    check_type("parameter", stated, ParameterRange)
    until = check_until(seconds)
    check_callback("progress", progress)
    check_whole("checks", checks, 1)
    check_flag("full", full)
    check_prove("prove", prove)
    check_type("options", options or STEPS, ContinuationOptions)
    asked: dict[str, Any] = {"full": full, "prove": prove, "options": options, "checks": checks}
    what: Any = as_origami(origami)
    whole = origami if isinstance(origami, str) else what
    others = ""
    if isinstance(what, Scene):
        whole = with_generic_symmetry(what, (stated,))
        others = " and ".join(map(str, whole.windings[1:]))
    found = follow_family(
        family_of(whole, stated), until=until, progress=progress, **asked, **search
    )
    if others:  # each winding is a problem of its own
        more = f"states that wind {others} times round are not followed: state their winding"
        found = replace(found, alarms=(*found.alarms, more))
    return unless_stopped(found, found.stopped)


def follow_family(
    family: Family,
    *,
    checks: int = 3,
    full: bool = True,
    options: ContinuationOptions | None = None,
    until: float = math.inf,
    progress: Callable[[str], object] | None = None,
    **search: Any,
) -> Atlas:
    """Follow the minima of a family of scenes or patterns; arguments as for `follow`.

    options: of the continuation.  until: when the time is over (`time.monotonic`).
    """
    say, steps = progress or (lambda _: None), options or family.steps
    survey = _Survey(family, full, say, steps=steps, until=until)
    try:
        survey.run(checks, search)
    except KeyboardInterrupt:
        if not survey.arcs:
            raise KeyboardInterrupt from None  # nothing is followed yet
        survey.stop()
    return cast(Atlas, survey.result())


class _Survey(FollowedDiagram):
    """Searches and what they start, until the atlas is made."""

    def __init__(self, family: Family, full: bool, say: Any, **options: Any) -> None:
        self._say, self.family = say, family
        self._free: Line | None = None
        if full and family.symmetric:
            free = Family(family.parameter, lambda t: family.scene_of(t).without_symmetry, 2)
            self._free = free.line
            options["functions"] = [("breaks-symmetry", self.across)]
        super().__init__(family.line, family.parameter, progress=self._followed, **options)
        self._known = dict[Equilibrium, float]()
        self.checks: list[SearchCheck] = []
        self.alarms: list[str] = []

    def _followed(self, arcs: int, s: float) -> None:
        """Say how much of the diagram is known, and where a branch is followed from."""
        at = f"{self.parameter.name} = {self.parameter.t_of(s):.4g}"
        self._say(f"{len(self.checks)} searches compared, {arcs} arcs followed, now from {at}")

    def across(self, frame: Equilibrium) -> float:
        """Return the smallest stiffness of a state across its symmetry, with loaded contacts held.

        nan where there is no one Hessian, or none is asked for; inf where nothing breaks the symmetry and keeps the
        contacts.
        """
        if self._free is None:
            return math.nan
        if frame not in self._known:
            state = State(self._free.at(frame.s), frame.problem.expand(frame.state))
            pieces = state.pieces if frame.hold else ((),)
            found = math.nan
            if len(pieces) == 1:
                found = min(breaking_stiffnesses(state, frame.problem, pieces[0]), default=math.inf)
            self._known[frame] = found
        return self._known[frame]

    def run(self, checks: int, search: dict[str, Any]) -> None:
        """Search at both ends and in the middle, then in the widest gaps; follow what is new."""
        self.add_flat()
        over, middle = self.parameter, 0.5 * sum(self.parameter.ends)
        todo = [middle] if checks == 1 else [*over.ends, middle][:checks]
        while todo and not self.late:
            t, now = over.t_of(todo[0]), time.monotonic()
            self._say(f"search at {over.name} = {t:.4g}")
            until = now + (self.steps.until - now) / len(todo)
            self._compare(t, search_minima(self.family.scene_of(t), until, **search))
            todo = todo[1:]
            if not todo and len(self.checks) < checks:
                # the middle of the widest interval between events and checks
                taken = [over.s_of(c.t) for c in self.checks]
                cuts = np.unique([*over.ends, *(n.s for n in self.nodes), *taken])
                k = int(np.diff(cuts).argmax())
                todo = [float(0.5 * (cuts[k] + cuts[k + 1]))]

    def _compare(self, t: float, result: MinimaResult) -> None:
        """Follow what is new among the minima of a search, and note what does not fit."""
        s, at = self.parameter.s_of(t), f"{self.parameter.name} = {t:.9g}"
        missed, met, followed = 0, list[np.ndarray](), self.frames_at(s, saddles=False)
        for minimum in result.minima:
            if self.late:  # each of many states takes long to begin with
                break
            x = self.line.problem.reduce(np.array(minimum.fold_angles))
            # not explained by any branch: it begins one
            if nearest(followed, x) > SETTLED:
                # `followed` has the frames of index 0: what lies on another one is a saddle to the tracer
                if nearest((f for _, f in self.states_at(s)), x) <= SETTLED:
                    self.alarms.append(f"{at}: a minimum lies on a branch of saddles")
                    continue
                self.add(x, s, "minimum")
                followed = self.frames_at(s, saddles=False)
            met.append(x)
        for frame in [] if self.late else followed:
            if min((np.abs(frame.state - x).max() for x in met), default=1.0) > SETTLED:
                # a followed state that is a minimum and that the search has not found
                if (what := frame.judged).verdict == "minimum":
                    missed += 1
                else:
                    said = f"the state of a branch is {what.verdict}: {what.reason}"
                    self.alarms.append(f"{at}: {said}")
        known = "" if result.completeness is None else result.completeness.status
        complete = OUT_OF_TIME if result.search.left_out else known
        self.checks.append(SearchCheck(t, len(result.minima), len(followed), missed, complete))

    def seen_as(self, frame: Equilibrium, phi: np.ndarray) -> dict[str, Any]:
        """Return the energy of the scene: it counts what it took to wind preloaded springs."""
        return {"energy": float(self.family.scene_of(self.parameter.t_of(frame.s)).energy(phi))}

    def pack(self) -> Atlas:
        """Judge what was followed, and pack it."""
        over, family, (branches, events) = self.parameter, self.family, self.records()
        self.alarms += [branch.alarm for branch in branches if branch.alarm]
        return Atlas(
            over, branches, events, tuple(dict.fromkeys(self.alarms)), self.steps_made,
            self.interrupted or any(c.complete == OUT_OF_TIME for c in self.checks),
            family.scene_of(over.low), tuple(self.checks), family, self, example=family.example,
        )  # fmt: skip
