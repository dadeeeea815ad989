"""Follow all minima of a few searches over a parameter: events located, counts between them, checks reported."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from origami_nlp.arguments import (
    check_callback,
    check_flag,
    check_type,
    check_until,
    check_whole,
    refuse,
)
from origami_nlp.continuation import (
    STEPS,
    BifurcationDiagram,
    ContinuationOptions,
    Equilibrium,
    GeometryLine,
    ParameterLine,
)
from origami_nlp.critical import find_critical_points
from origami_nlp.errors import OUT_OF_TIME, Interrupted, OptionError, unless_stopped
from origami_nlp.kkt import State, classify
from origami_nlp.minima import MinimaResult, check_prove, full_scene
from origami_nlp.numerics import SETTLED
from origami_nlp.paths.atlas import Atlas
from origami_nlp.paths.branches import branches_of, chains_of, widest_gap
from origami_nlp.paths.family import (
    SAMPLES,
    Family,
    family_of,
    pattern_family,
    with_generic_symmetry,
)
from origami_nlp.paths.judging import Touching, breaking_eigenvalue, parts_of
from origami_nlp.paths.parameter_range import ParameterRange, parse_parameter_range
from origami_nlp.paths.records import Cost, PathBranch, SearchCheck
from origami_nlp.pattern import Scene, Stated, Vertex, as_origami
from origami_nlp.proof import ProofOptions
from origami_nlp.space import find_space

MOST_CHECKS = 100
_OF_A_PATTERN = {"starts": "the effort says how many starts a vertex gets"}
_OF_A_SCENE = {
    "full": "states of a pattern keep no symmetry",
    "morse": "critical points of a pattern are not counted",
    "prove": "lists along a parameter are not proved for patterns",
}
"""What only the one or the other takes, and why."""
JUDGING = 0.1
"""Share of a time limit that is kept for judging what was followed."""


def follow(
    origami: Stated,
    parameter: str | ParameterRange,
    *,
    checks: int = 3,
    through_folds: bool = True,
    full: bool | None = None,
    morse: bool | None = None,
    prove: bool | float | ProofOptions | None = None,
    effort: str = "normal",
    seed: int = 0,
    max_starts: int | None = None,
    starts: int | None = None,
    options: ContinuationOptions | None = None,
    seconds: float | None = None,
    progress: Callable[[str], object] | None = None,
) -> Atlas:
    """Follow the minima of a vertex or a pattern over a parameter.

    Searches at a few values (the middle for one check, both ends for two, then the middles of the widest intervals
    without events) give the states to begin with; every state that no branch explains begins a new one.  Each of
    `Scene.windings` is followed by itself: `Atlas.others`.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    parameter
        The parameter and its range, such as ``"ratio=0.01:100"``; see `parse_parameter_range`.  Of a pattern also
        ``"mountains.stiffness=1:2"``, ``"vertices.x[5]=0:0.1"`` (see `pattern.with_places`), or an option of an example
        by its name, ``"alpha=50deg:60deg"`` of ``"miura:3x3"``.
    checks
        Number of searches.
    through_folds
        Whether branches are followed beyond limit points (folds), where the states are saddles.
    full
        Of scenes: whether events at which a symmetric state loses its stability without the symmetry are located; None
        is True.
    morse
        Of scenes: whether the Morse identity is verified at each check (two symmetric degrees of freedom and full
        contact only).
    prove
        Of scenes: whether it is proved at each check that no minimum is missing, or the seconds for it, as for
        `find_minima`.
    effort, seed, max_starts, starts
        Of the searches, see `find_minima`; `starts` of patterns.
    options
        Of the continuation: lengths of steps, points and arcs at most.
    seconds
        Wall time; what was followed by then is judged and returned, see `Atlas.interrupted`.  None: no limit.
    progress
        Called with what it is at, in words, whenever that changes.

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
    >>> atlas = o.follow(o.examples.degree6("pi/3"), "ratio=0.2:1", checks=1, max_starts=16, full=False)
    >>> [(event.type, round(event.t, 6)) for event in atlas.events]
    [('closes', 0.355732)]
    >>> [state.kind for state in atlas.at(0.3)]
    ['interior', 'contact-touching', 'degenerate', 'degenerate']
    """
    stated = parse_parameter_range(parameter) if isinstance(parameter, str) else parameter
    check_type("parameter", stated, ParameterRange)
    until = check_until(seconds)
    check_callback("progress", progress)
    given = {"full": full, "morse": morse, "prove": prove}
    given |= {"max_starts": max_starts, "starts": starts}
    asked: dict[str, Any] = {k: v for k, v in given.items() if v is not None}
    asked |= {"options": options, "checks": checks, "through_folds": through_folds}
    asked |= {"effort": effort, "seed": seed, "until": until, "progress": progress}
    what = as_origami(origami)
    if not isinstance(what, Scene):
        refuse("pattern", _OF_A_SCENE, **given)
        named = origami if isinstance(origami, str) else what
        sheet = follow_family(pattern_family(named, stated), **asked)
        return unless_stopped(sheet, sheet.stopped)
    refuse("scene", _OF_A_PATTERN, **given)
    what = with_generic_symmetry(what, (stated,))
    found = list[Atlas]()
    for one in what.of_each_winding:
        found.append(follow_family(family_of(one, stated), **asked))
        if found[-1].stopped:
            break
    late = any(atlas.interrupted for atlas in found)
    whole = replace(found[0], others=tuple(found[1:]), interrupted=late)
    return unless_stopped(whole, found[-1].stopped)


def follow_family(
    family: Family,
    *,
    checks: int = 3,
    through_folds: bool = True,
    full: bool = True,
    morse: bool = False,
    prove: bool | float | ProofOptions = False,
    effort: str = "normal",
    seed: int = 0,
    max_starts: int | None = None,
    starts: int | None = None,
    options: ContinuationOptions | None = None,
    until: float = math.inf,
    progress: Callable[[str], object] | None = None,
) -> Atlas:
    """Follow the minima of a family of scenes or patterns; arguments as for `follow`.

    options: of the continuation.  until: when the time is over (`time.monotonic`).
    """
    check_whole("checks", checks, 1, MOST_CHECKS)
    for name, flag in {"through_folds": through_folds, "full": full, "morse": morse}.items():
        check_flag(name, flag)
    check_prove("prove", prove)
    check_type("options", STEPS if options is None else options, ContinuationOptions)
    given = {"max_starts": max_starts, "starts": starts}
    search = {"effort": effort, "seed": seed, **{k: v for k, v in given.items() if v is not None}}
    search["prove"] = prove
    survey = _Survey(family, through_folds, full, morse, search, options, until, progress)
    survey.web.add_flat()
    ends = [family.parameter.low, family.parameter.high]
    middle = family.parameter.t_of(0.5 * (survey.web.low + survey.web.high))
    survey.check(([middle] if checks == 1 else [*ends, middle])[:checks])
    while len(survey.checks) < checks and not survey.web.late:
        s = widest_gap(survey.web, [family.parameter.s_of(c.t) for c in survey.checks])
        if s is None:
            break
        survey.check([family.parameter.t_of(s)])
    return survey.atlas()


class _Survey:
    """Searches and what they start, until the atlas is made."""

    def __init__(
        self,
        family: Family,
        through_folds: bool,
        full: bool,
        morse: bool,
        search: dict[str, object],
        steps: ContinuationOptions | None,
        until: float,
        progress: Callable[[str], object] | None,
    ) -> None:
        self._say = progress or (lambda _: None)
        self._begin = time.perf_counter()
        self.family, self.parameter = family, family.parameter
        self._morse, self._search = morse, search
        self._full = full and family.symmetric
        self._scene = family.scene(self.parameter.low)
        self._across: WeakKeyDictionary[Equilibrium, float] = WeakKeyDictionary()
        self._touching: Touching = {}
        functions = [("breaks-symmetry", self.across)] if self._full else []
        # some of the time is for judging what was followed
        turn = until if math.isinf(until) else until - JUDGING * (until - time.monotonic())
        self.web = BifurcationDiagram(
            family.line,
            *self.parameter.ends,
            steps=steps or family.steps,
            through_folds=through_folds,
            functions=functions,
            until=turn,
            progress=self._followed,
        )
        self.checks: list[SearchCheck] = []
        self.alarms: list[str] = []
        self._euler: dict[Vertex, int] = {}

    @cached_property
    def _full_line(self) -> ParameterLine | GeometryLine | None:
        if not self._full:
            return None
        few = 2 if self.family.still else SAMPLES
        return Family(self.parameter, lambda t: full_scene(self.family.sampled(t)), few).line

    def across(self, frame: Equilibrium) -> float:
        """Return the smallest eigenvalue across the symmetry; nan where it is not asked for."""
        if self._full_line is None:
            return float("nan")
        if frame not in self._across:
            self._across[frame] = breaking_eigenvalue(
                frame, self._full_line, self._scene, self._touching
            )
        return self._across[frame]

    def _followed(self, arcs: int, s: float) -> None:
        """Say how much of the diagram is known, and where a branch is followed from."""
        at = f"{self.parameter.name} = {self.parameter.t_of(s):.4g}"
        self._say(f"{len(self.checks)} searches compared, {arcs} arcs followed, now from {at}")

    def check(self, values: list[float]) -> None:
        """Search at some values at once; follow what is new at one after the other, and compare."""
        if self.web.late:
            return
        begin, until = time.perf_counter(), self.web.steps.until
        left = None if math.isinf(until) else max(until - time.monotonic(), 0.0)
        scenes = [self.family.scene(t) for t in values]
        listed = ", ".join(f"{t:.4g}" for t in values)
        self._say(f"search at {self.parameter.name} = {listed}")
        try:
            results = self.family.search(scenes, left, **self._search)
        except Interrupted:
            if not self.checks:
                raise KeyboardInterrupt from None  # nothing is followed yet
            self.web.stop()
            return
        seconds = time.perf_counter() - begin
        self._begin += seconds
        for t, result in zip(values, results, strict=True):
            self._compare(t, result, seconds / len(values))

    def _compare(self, t: float, result: MinimaResult, seconds: float) -> None:
        """Follow what is new among the minima of a search that took so long, and note what does not fit."""
        begin = time.perf_counter()
        morse = ""
        if self._morse and not self.web.late and not result.is_pattern:
            morse = self._identity(result.scene, result)
        more = time.perf_counter() - begin
        seconds, self._begin = seconds + more, self._begin + more
        model: Any = result.model
        s = self.parameter.s_of(t)
        new, met, followed = 0, [], self._minima(s)
        for minimum in result.minima:
            if self.web.late:  # each of many states takes long to begin with
                break
            x = model.reduce(np.array(minimum.fold_angles))
            # not explained by any branch: it begins one
            if _nearest(followed, x) > SETTLED:
                # `followed` has the frames of index 0: what lies on another one is a saddle to the tracer
                if _nearest([f for _, f in self.web.states_at(s)], x) <= SETTLED:
                    self.alarms.append(
                        f"{self.parameter.name} = {t:.9g}: a minimum lies on a branch of saddles"
                    )
                    continue
                new += self.web.add(x, s, "minimum")
                followed = self._minima(s)
            met.append(x)
        missed = 0
        for frame in [] if self.web.late else followed:
            if min((np.abs(frame.state - x).max() for x in met), default=1.0) > SETTLED:
                what = classify(State(model, frame.state))
                # a followed state that is a minimum and that the search has not found
                missed += what.verdict == "minimum"
                if what.verdict != "minimum":
                    self.alarms.append(
                        f"{self.parameter.name} = {t:.9g}: the state of a branch is {what.verdict}: {what.reason}"
                    )
        self.checks.append(
            SearchCheck(
                t,
                len(result.minima),
                len(followed),
                new,
                missed,
                getattr(result.search, "expected_undiscovered", math.inf),
                result.search.starts,
                seconds,
                morse,
                _complete(result),
            )
        )

    def _wound(self, branch: PathBranch) -> PathBranch:
        """Return a branch whose energies count what it took to wind preloaded springs, as those of scenes do."""
        if not self.family.preloaded:
            return branch
        points = (
            replace(p, energy=p.energy + self.family.winding(self.parameter.s_of(p.t)))
            for p in branch.points
        )
        return replace(branch, points=tuple(points))

    def _minima(self, s: float) -> list[Equilibrium]:
        """Return the states of branches at s that may be minima, each once."""
        out: list[Equilibrium] = []
        for frame in (*(f for _, f in self.web.states_at(s)), *self.web.alone_at(s)):
            if not frame.index and _nearest(out, frame.state) > SETTLED:
                out.append(frame)
        return out

    def _identity(self, scene: Scene, result: MinimaResult) -> str:
        """Return whether the critical points of a scene sum to the Euler characteristic of its states."""
        try:
            found = find_critical_points(scene, result)
            known = self._euler.get(scene.vertex)
            euler = find_space(scene).euler_characteristic if known is None else known
        except OptionError as error:
            return f"no Morse count: {error}"
        self._euler[scene.vertex] = euler
        verdict = found.verdict(euler)
        agree = found.comparison is None or found.comparison.agree
        if not verdict.closes or not agree:
            self.alarms.append(f"{scene.label}: {verdict.text}")
        return verdict.text

    def atlas(self) -> Atlas:
        """Judge what was followed, and pack it."""
        web = self.web
        chains = chains_of(web)
        parts = {k: parts_of(arc) for k, arc in enumerate(web.arcs)}
        branches, events = branches_of(web, self.parameter, chains, parts, self.across)
        branches = tuple(self._wound(branch) for branch in branches)
        begun = {k: number for number, chain in enumerate(chains, start=1) for k, _ in chain}
        for number, branch in enumerate(branches, start=1):
            for r in branch.kind_ranges:
                if not r.stable and r.kind != "saddle":
                    self.alarms.append(
                        f"branch {number}, {self.parameter.name} {r.t[0]:.6g} to {r.t[1]:.6g}: {r.kind}: "
                        f"{r.certificate}"
                    )
        cost = Cost(
            web.tally.steps,
            web.tally.evaluations,
            time.perf_counter() - self._begin,
            sum(c.seconds for c in self.checks),
        )
        return Atlas(
            self.family.scene_of(self.parameter.low),
            self.parameter,
            branches,
            events,
            tuple(self.checks),
            tuple(dict.fromkeys(self.alarms)),
            cost,
            self.family,
            web,
            begun,
            interrupted=web.interrupted or any(c.complete == OUT_OF_TIME for c in self.checks),
            example=getattr(self.family, "example", ""),
        )


def _complete(result: MinimaResult) -> str:
    """Return why the minima of a search are all, or that its time was over; "" where that is not known."""
    if result.search.left_out:
        return OUT_OF_TIME
    return "" if result.completeness is None else result.completeness.status


def _nearest(frames: list[Equilibrium], x: np.ndarray) -> float:
    return min((float(np.abs(f.state - x).max()) for f in frames), default=np.inf)
