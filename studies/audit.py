"""What published candidate states are: which exact minimum each belongs to, or which artefact it is.

Every candidate is checked for closure, for admissibility and for stationarity, and is then followed downhill through
closed, admissible states (`kkt.follow`) to the exact minimum of its panel that it belongs to.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.folding import check_admissible
from origami_nlp.kkt import (
    State,
    follow,
    lower_dimensional_at,
    project,
    sample_neighbourhood,
)
from origami_nlp.minima import MinimaResult, find_minima
from origami_nlp.numerics import ENDPOINT_TOL
from origami_nlp.pattern import format_angle
from origami_nlp.problem import Model
from studies.baseline import appendix_a
from studies.chart_states import chart_distance, chart_end, chart_point
from studies.closing import closing_alphas, mean_of_rows, named_alpha, other_sides
from studies.published import PRINTED, Candidate

ON_MINIMUM = 2.0
"""A candidate within this many grid steps of an exact minimum, in its chart, is that minimum as a grid sees it."""
CLOSED = 1e-7
"""Openings [rad] of contacts that published states close: a state that is 1e-6 off leaves one of second order open."""

Cause = Literal[
    "exact",
    "duplicate",
    "on a handle",
    "grid jag",
    "chart edge",
    "does not close",
    "wrong side",
    "not admissible",
    "isolated",
    "undecided",
]
CAUSES: tuple[Cause, ...] = Cause.__args__  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Audited:
    """What one candidate is.

    cause, reason: what becomes of it, and why in words.
    closure_residual: |vec q| of all folds.  closes_at: for a candidate that does not close, the sector angles
    alpha_1 of its family at which it does.  admissible: as published.  sides: fold angles with the signs of
    +-pi that a sheet of paper allows, where the published signs are not admissible.
    stationarity: torque left over by the best contact moments, over pi sum k (paper, appendix A); nan where
    the candidate does not close.  paper_test: verdict of appendix A.
    minimum: number (1-based) of the exact minimum that it is or descends to, in its panel; None if there is
    none.  followed_at: the other alpha_1 at which a state that closes there was followed; `minimum` is then
    one of that vertex.  distance: largest change of a fold angle on the way [rad].  grid_steps: distance in
    the paper's chart, in grid steps.  drop: energy lost on the way [J].  steps: states of the descent.
    twin: number of the candidate that it repeats (`duplicate`, and rows that do not close twice over).
    """

    candidate: Candidate
    cause: Cause
    reason: str
    closure_residual: float
    closes_at: tuple[float, ...] = ()
    admissible: bool = False
    sides: tuple[float, ...] | None = None
    stationarity: float = math.nan
    paper_test: str = ""
    minimum: int | None = None
    followed_at: float | None = None
    distance: float = math.nan
    grid_steps: float = math.nan
    drop: float = math.nan
    steps: int = 0
    twin: int | None = None


@dataclass(frozen=True)
class PanelAudit:
    """The candidates of one panel.

    result: the exact minima.  grid_step: of the published grid [rad].  audited: in the order of the file.
    """

    degree: int
    alpha: float
    ratio: float
    result: MinimaResult = field(repr=False)
    grid_step: float
    audited: tuple[Audited, ...]

    @property
    def title(self) -> str:
        """The panel in words."""
        return f"degree {self.degree}, alpha_1 = {format_angle(self.alpha)}, r_k = {self.ratio:g}"

    def count(self, cause: str) -> int:
        """Number of candidates with a cause."""
        return sum(a.cause == cause for a in self.audited)

    @property
    def represented(self) -> tuple[int, ...]:
        """Exact minima (1-based) that some candidate is, to within the grid."""
        return tuple(sorted({a.minimum for a in self.audited if a.cause == "exact" and a.minimum}))

    @property
    def reached(self) -> tuple[int, ...]:
        """Exact minima (1-based) that some candidate is or descends to."""
        own = (a for a in self.audited if a.cause != "does not close")
        return tuple(sorted({a.minimum for a in own if a.minimum}))


def audit_candidates(
    candidates: Sequence[Candidate],
    *,
    seed: int = 0,
    progress: Callable[[int, int, str], None] | None = None,
) -> tuple[PanelAudit, ...]:
    """Audit published candidates, panel by panel.

    Parameters
    ----------
    seed
        Of the search for exact minima.
    progress
        Called as progress(candidates done, candidates in all, panel) after each candidate.

    Raises
    ------
    OptionError
        If there is no candidate.
    """
    if not candidates:
        raise OptionError("candidates: there are none to audit")
    panels: dict[tuple[int, float, float], list[Candidate]] = {}
    for c in candidates:
        panels.setdefault(c.panel, []).append(c)
    exact: dict[tuple[int, float, float], MinimaResult] = {}

    def minima(c: Candidate, alpha: float) -> MinimaResult:
        key = (c.degree, round(alpha, 12), c.ratio)
        if key not in exact:
            exact[key] = find_minima(c.scene(alpha), seed=seed, escape=False)
        return exact[key]

    done, out = 0, []
    for key in sorted(panels):
        members = panels[key]
        result = minima(members[0], members[0].alpha)
        step = grid_step(result.model, members)
        audited: list[Audited] = []
        seen: list[tuple[np.ndarray, int]] = []
        for c in _admissible_first(result.model, members):
            a = _audit_one(c, result, step, seen, minima)
            audited.append(a)
            done += 1
            if progress:
                progress(done, len(candidates), f"degree {c.degree}, {format_angle(c.alpha)}")
        audited.sort(key=lambda a: a.candidate.number)
        out.append(PanelAudit(*_named(members[0]), result, step, _one_each(audited)))
    return tuple(out)


def grid_step(model: Model, candidates: Sequence[Candidate]) -> float:
    """Return the coarsest step pi/128, pi/256, pi/512 whose multiples the chart coordinates are; else pi/128.

    Only candidates that close say something about the grid.
    """
    points = [
        chart_point(model, np.array(c.independent))
        for c in candidates
        if np.abs(model.closure(np.array(c.independent))[0]).max() <= PRINTED
    ]
    for n in (128, 256, 512):
        rest = np.array(points) / (math.pi / n) if points else np.zeros((0, 2))
        if points and np.mean(np.abs(rest - np.round(rest)) < 1e-2) > 0.95:
            return math.pi / n
    return math.pi / 128


def _named(c: Candidate) -> tuple[int, float, float]:
    return c.degree, c.alpha, c.ratio


def _admissible_first(model: Model, members: list[Candidate]) -> list[Candidate]:
    """Order candidates so that of equal geometries the admissible one comes first."""
    vertex = model.scene.vertex

    def key(c: Candidate) -> tuple[bool, int]:
        phi = np.array(c.fold_angles)
        return not check_admissible(vertex, phi, tolerance=PRINTED).admissible, c.number

    return sorted(members, key=key)


def _audit_one(
    c: Candidate,
    result: MinimaResult,
    step: float,
    seen: list[tuple[np.ndarray, int]],
    minima: Callable[[Candidate, float], MinimaResult],
) -> Audited:
    """Audit one candidate; `seen` collects the geometries of the panel."""
    model, vertex = result.model, result.scene.vertex
    x, phi = np.array(c.independent), np.array(c.fold_angles)
    embedding = check_admissible(vertex, phi, tolerance=PRINTED)
    base = Audited(c, "undecided", embedding.reason, embedding.closure_residual)
    twin = next((n for y, n in seen if np.abs(x - y).max() <= PRINTED), None)
    closes = embedding.closure_residual <= PRINTED
    if twin is not None and not closes:
        why = f"the same fold angles as candidate {twin}, which does not close"
        at = closing_alphas(c.degree, x)
        return replace(base, cause="does not close", reason=why, twin=twin, closes_at=at)
    if twin is not None:
        why = f"the same fold angles as candidate {twin}"
        return replace(
            base, cause="duplicate", reason=why, twin=twin, admissible=embedding.admissible
        )
    paper = appendix_a(result.scene, phi).verdict
    if not closes:
        seen.append((x, c.number))
        return _elsewhere(replace(base, cause="does not close", paper_test=paper), minima)
    stationarity = distance_from_stationary(State(model, x, CLOSED))
    base = replace(base, paper_test=paper, stationarity=stationarity)
    group = result.scene.group.elements
    if (
        embedding.admissible
        and not check_admissible(vertex, phi, tolerance=PRINTED, elements=group).admissible
    ):
        seen.append((x, c.number))
        why = "its layers have an order, but none with the symmetry: no symmetric motion leaves it"
        return replace(base, cause="isolated", reason=why, admissible=True)
    sides = None
    if not embedding.admissible:
        sides = other_sides(vertex, x, c.degree, PRINTED)
        if sides is None:
            seen.append((x, c.number))
            return replace(base, cause="not admissible")
        base = replace(base, sides=tuple(sides.tolist()))
        twin = next((n for y, n in seen if np.abs(sides - y).max() <= PRINTED), None)
        if twin is not None:
            why = f"{embedding.reason}; with the right sides of +-pi it is candidate {twin}"
            return replace(base, cause="duplicate", reason=why, twin=twin)
        seen.append((sides, c.number))
    seen.append((x, c.number))
    base = _descend(base, result, x if sides is None else sides, step)
    if sides is not None:
        changed = np.flatnonzero(np.abs(sides - x) > 1) + 1
        names = " and ".join(f"phi_{i}" for i in changed)
        why = f"{embedding.reason}; a sheet of paper has the other sign of pi at {names}"
        return replace(base, cause="wrong side", reason=why)
    return replace(base, admissible=True)


def distance_from_stationary(state: State) -> float:
    """Return |grad U - J' lam - A' mu| / (pi sum k), smallest over lam and mu >= 0.

    The gradient is taken in the space of all N fold angles, as in the paper's appendix A; J is the Jacobian of loop
    closure, A holds the contacts that are closed to within the state's `tolerance` [rad].  Where touching facets can
    be kept apart in several ways, the best is taken: an upper bound on how stationary the state is.
    """
    p, z = state.problem, state.kernel
    best = math.inf
    for rows in state.pieces:
        piece = state.on(rows)
        mu = np.maximum(piece.multiplier_set.smallest, 0.0)
        left = z.T @ (state.gradient - piece.slopes.T @ mu)
        best = min(best, float(np.linalg.norm(left)))
    total = float(np.sum(p.parameters.stiffness))
    return best / (math.pi * total)


def _descend(base: Audited, result: MinimaResult, x: np.ndarray, step: float) -> Audited:
    """Follow an admissible state downhill and say what it is in its panel."""
    model = result.model
    exact = [model.reduce(np.array(m.fold_angles)) for m in result.minima]
    start = np.clip(project(model, x, ())[0], -model.bound, model.bound)
    try:
        path = follow(model, start)
    except ValueError:
        return replace(base, reason="touches itself in a way that the model's contacts refuse")
    near = [float(np.abs(path.end - y).max()) for y in exact]
    hit = int(np.argmin(near)) if near and min(near) <= ENDPOINT_TOL else None
    base = replace(
        base,
        distance=float(np.abs(path.end - start).max()),
        drop=-model.energy_change(start, path.end),
        steps=len(path.states),
    )
    if hit is None:
        rows = State(model, x, CLOSED).contacts.base
        if (
            base.distance <= ENDPOINT_TOL
            and sample_neighbourhood(State(model, x), rows).state is None
        ):
            why = "no admissible neighbour: an isolated state, which no symmetric motion leaves"
            return replace(base, cause="isolated", reason=why)
        why = f"the descent ends at no listed minimum: {path.what.verdict}, {path.what.reason}"
        return replace(base, cause="undecided", reason=why)
    steps = chart_distance(model, start, exact[hit]) / step
    base = replace(base, minimum=hit + 1, grid_steps=steps)
    if steps <= ON_MINIMUM:
        return replace(base, cause="exact", reason=f"{steps:.1f} grid steps from #{hit + 1}")
    at = State(model, start)
    held = lower_dimensional_at(at)
    if held:
        closed = ", ".join(model.name(row) for row in held)
        why = f"slides along a set that exists only with {closed}: nothing beside it is admissible"
        return replace(base, cause="on a handle", reason=why)
    end = chart_end(model, start, step)
    if end:
        return replace(base, cause="chart edge", reason=end)
    return replace(base, cause="grid jag", reason=_jag(at, step))


def _jag(at: State, step: float) -> str:
    """Say between which points of the grid the way down is hidden."""
    held = State(at.problem, at.x, CLOSED).contacts
    if held.base or held.branches:
        return "on a contact: grid neighbours off it are excluded"
    near = State(at.problem, at.x, 8 * step).contacts
    if near.base or near.branches:
        return "next to a contact boundary that crosses the grid at an angle"
    return "in a narrow valley that runs between the grid's eight directions"


def _elsewhere(base: Audited, minima: Callable[[Candidate, float], MinimaResult]) -> Audited:
    """Look for other sector angles at which a candidate closes, and what it is at those of the family pi/12."""
    c = base.candidate
    x = np.array(c.independent)
    alphas = closing_alphas(c.degree, x)
    if not alphas:
        why = "closes at no alpha_1 of its family"
        alpha = mean_of_rows(x) if c.degree == 8 else None
        if alpha is not None:
            why += f": the mean of the two states at elevation +-pi/128, alpha_1 = {named_alpha(alpha)}"
        return replace(base, reason=why)
    words = ", ".join(map(named_alpha, alphas))
    base = replace(base, closes_at=alphas, reason=f"closes at alpha_1 = {words}")
    for alpha in alphas:
        if "pi" not in named_alpha(alpha):
            continue
        result = minima(c, alpha)
        if not check_admissible(
            result.scene.vertex, np.array(c.fold_angles), tolerance=PRINTED
        ).admissible:
            continue
        there = _descend(base, result, x, math.pi / 128)
        if there.minimum is not None:
            what = f"{there.cause} of #{there.minimum} there: {there.reason}"
            return replace(
                there, cause="does not close", reason=f"{base.reason}; {what}", followed_at=alpha
            )
    return base


def _one_each(audited: list[Audited]) -> tuple[Audited, ...]:
    """Keep the nearest candidate of each exact minimum; the others at it are duplicates."""
    best: dict[int, Audited] = {}
    for a in audited:
        if a.cause == "exact" and a.minimum is not None:
            other = best.get(a.minimum)
            if other is None or a.distance < other.distance:
                best[a.minimum] = a
    return tuple(
        replace(
            a,
            cause="duplicate",
            reason=f"the same exact minimum #{a.minimum} as candidate {best[a.minimum].candidate.number}",
            twin=best[a.minimum].candidate.number,
        )
        if a.cause == "exact" and a.minimum is not None and best[a.minimum] is not a
        else a
        for a in audited
    )
