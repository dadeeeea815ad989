"""What published candidate states are: which exact minimum each belongs to, or which artefact it is.

Every candidate is checked for closure and admissibility, and is then followed downhill through closed, admissible
states (`search.descent_path`) to the exact minimum of its panel that it belongs to.

The charts in which the paper's grids sample a vertex end where the manifold of states does not.  Degree 6,
(phi_2, phi_3): at (0, 0) the half-vertex is straight and phi_1 = phi_4 is free, so that one step of the grid next to it
spans a radian and more of fold angle.  Degree 8, (elevation v of crease 1, phi_2): at J = 0, sin |v| = sin(2 alpha_1)
sin(phi_2/2)^2, both solution branches meet, and at phi_2 = 0 the solution formula changes case.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from origami_nlp.chart import chart_of
from origami_nlp.display import Report, Section, Table
from origami_nlp.errors import OptionError
from origami_nlp.io import pick
from origami_nlp.kkt import State, lower_dimensional_at, project, sample_neighbourhood
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import ENDPOINT_TOL, null_space
from origami_nlp.paper.candidates import INDEPENDENT, PRINTED, Candidate
from origami_nlp.pattern import Scene, Vertex, format_angle
from origami_nlp.pattern_problem import check_admissible, pose
from origami_nlp.pattern_states import find_states
from origami_nlp.search import descent_path

ON_MINIMUM = 2.0
"""A candidate within this many grid steps of an exact minimum, in its chart, is that minimum as a grid sees it."""
CLOSED = 1e-7
"""Openings [rad] of contacts that published states close: a state that is 1e-6 off leaves one of second order open."""
ON_GRID = 1e-2
"""Chart coordinates this far from a multiple of a step, in steps, are on its grid."""
STRETCHED = 1.0
"""A grid step that spans at least this many radians of fold angle is next to a singular chart point."""

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
HEADS = ("panel", "published", *CAUSES, "exact minima", "represented", "reached")


@dataclass(frozen=True)
class Audited:
    """What one candidate is.

    cause: what becomes of it: ``exact`` is the nearest to an exact minimum, within `ON_MINIMUM` grid steps; a
    ``duplicate`` closes and repeats fold angles, the sheet or the exact minimum of another (`twin`, its number); ``on a
    handle`` it slides along a set of one dimension beside which nothing is admissible; from a ``grid jag`` it flows
    away; at a ``chart edge`` as well, within a grid step of where the chart ends; on the ``wrong side`` a sheet of
    paper with these facets has the other signs of +-pi (`sides`); no symmetric motion leaves an ``isolated`` one.
    minimum: number (1-based) of the exact minimum of its panel that it is or descends to.  distance: largest change
    of a fold angle on the way [rad].  grid_steps: distance in the paper's chart.  drop: energy lost on the way [J].
    """

    candidate: Candidate
    cause: Cause
    closure_residual: float
    sides: tuple[float, ...] | None = None
    minimum: int | None = None
    distance: float = math.nan
    grid_steps: float = math.nan
    drop: float = math.nan
    twin: int | None = None


@dataclass(frozen=True)
class PanelAudit:
    """The candidates of one panel, in the order of the file.

    result: the exact minima.  grid_step: of the published grid [rad].
    """

    result: MinimaResult = field(repr=False)
    grid_step: float
    audited: tuple[Audited, ...]

    @property
    def title(self) -> str:
        """The panel in words."""
        c = self.audited[0].candidate
        return f"degree {c.degree}, {format_angle(c.alpha)}, {c.ratio:g}"

    @property
    def counts(self) -> dict[Cause, int]:
        """Number of candidates with each cause."""
        return {cause: sum(a.cause == cause for a in self.audited) for cause in CAUSES}

    @property
    def represented(self) -> tuple[int, ...]:
        """Exact minima (1-based) that some candidate is, to within the grid."""
        return tuple(sorted({a.minimum for a in self.audited if a.cause == "exact" and a.minimum}))

    @property
    def reached(self) -> tuple[int, ...]:
        """Exact minima (1-based) that some candidate is or descends to."""
        return tuple(sorted({a.minimum for a in self.audited if a.minimum}))

    @property
    def cells(self) -> list[int]:
        """Numbers in the order of `HEADS`."""
        known = (self.result.minima, self.represented, self.reached)
        return [len(self.audited), *self.counts.values(), *map(len, known)]


@dataclass(frozen=True, repr=False)
class Audit(Report):
    """What published candidates are, panel by panel."""

    panels: tuple[PanelAudit, ...]

    SCHEMA, READS = "origami-nlp/audit/2", False

    def table(self) -> Table:
        """Return one row a panel, and their sums: candidates, what they are, exact minima they belong to."""
        numbers = [p.cells for p in self.panels]
        numbers.append([sum(column) for column in zip(*numbers, strict=True)])
        titles = [*(p.title for p in self.panels), "all"]
        rows = [[title, *map(str, row)] for title, row in zip(titles, numbers, strict=True)]
        title = f"{numbers[-1][0]} published candidates"
        return Table(HEADS, rows, title, "l" + "R" * (len(HEADS) - 1), ends=[len(self.panels) - 1])

    def report_sections(self) -> Iterator[Section]:
        """Return the table."""
        yield self.table()

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data: every candidate with what it is."""
        each = ("cause", "closure_residual", "sides", "minimum", "distance", "grid_steps", "drop")
        own = ("number=candidate.number", "fold_angles=candidate.fold_angles", *each, "twin")
        panels = [
            {
                **pick(p, "title", "grid_step", "counts", "represented", "reached"),
                "minima": [pick(m, "energy", "fold_angles", "kind") for m in p.result.minima],
                "candidates": [pick(a, *own) for a in p.audited],
            }
            for p in self.panels
        ]
        return {"schema": self.SCHEMA, "panels": panels}


def audit_candidates(
    candidates: Sequence[Candidate],
    *,
    seed: int = 0,
    progress: Callable[[int, int, str], None] | None = None,
) -> Audit:
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
    done, out = 0, []
    for key in sorted(panels):
        members = panels[key]
        result = find_states(members[0].scene, seed=seed, escape=False)
        step = grid_step(result.scene, members)
        audited: list[Audited] = []
        seen: list[tuple[np.ndarray, int]] = []
        for c in _admissible_first(result.scene.vertex, members):
            audited.append(_audit_one(c, result, step, seen))
            done += 1
            if progress:
                progress(done, len(candidates), f"degree {c.degree}, {format_angle(c.alpha)}")
        audited.sort(key=lambda a: a.candidate.number)
        out.append(PanelAudit(result, step, _one_each(audited)))
    return Audit(tuple(out))


def grid_step(scene: Scene, candidates: Sequence[Candidate]) -> float:
    """Return the coarsest step pi/128, pi/256, pi/512 whose multiples the chart coordinates are; else pi/128.

    Only candidates that close say something about the grid.
    """
    states, model = [np.array(c.independent) for c in candidates], pose(scene)
    closed = [x for x in states if np.abs(model.closure(x)[0]).max() <= PRINTED]
    points = np.array([chart_point(scene, model.expand(x)) for x in closed])
    for n in (128, 256, 512):
        rest = points / (math.pi / n)
        if len(points) and np.mean(np.abs(rest - np.round(rest)) < ON_GRID) > 0.95:
            return math.pi / n
    return math.pi / 128


def chart_point(scene: Scene, phi: np.ndarray) -> np.ndarray:
    """Return the chart coordinates of a state [N]: (phi_2, phi_3), or (phi_2, elevation) with degree 8."""
    chart = chart_of(scene)
    assert chart is not None
    return chart.points(phi)


def chart_ends(scene: Scene, x: np.ndarray, step: float) -> bool:
    """Return whether an end of the chart lies within one grid `step` of state x."""
    model = pose(scene)
    if scene.degree == 6:
        shown = null_space(model.closure(x)[1])[1:3]
        singular = float(np.linalg.svd(shown, compute_uv=False).min())
        return step >= STRETCHED * singular and max(abs(x[1]), abs(x[2])) <= math.pi / 2
    fold, v = chart_point(scene, model.expand(x))
    alpha = scene.vertex.sector_angles[0]
    edge = math.asin(min(1.0, math.sin(2 * alpha) * math.sin(fold / 2) ** 2))
    return abs(fold) <= step or abs(abs(v) - edge) <= step


def other_sides(vertex: Vertex, c: Candidate) -> np.ndarray | None:
    """Return the state with other signs of its +-pi that is admissible, fewest changes first; or None."""
    x = np.array(c.independent)
    at_pi = np.flatnonzero(np.abs(np.abs(x) - math.pi) <= PRINTED)
    for count in range(1, len(at_pi) + 1):
        for flipped in itertools.combinations(at_pi, count):
            y = x.copy()
            y[list(flipped)] *= -1
            phi = y[list(INDEPENDENT[c.degree])]
            if check_admissible(vertex, phi, tolerance=PRINTED).admissible:
                return y
    return None


def _admissible_first(vertex: Vertex, members: list[Candidate]) -> list[Candidate]:
    """Order candidates so that of equal geometries the admissible one comes first."""

    def key(c: Candidate) -> tuple[bool, int]:
        phi = np.array(c.fold_angles)
        return not check_admissible(vertex, phi, tolerance=PRINTED).admissible, c.number

    return sorted(members, key=key)


def _audit_one(
    c: Candidate, result: MinimaResult, step: float, seen: list[tuple[np.ndarray, int]]
) -> Audited:
    """Audit one candidate; `seen` collects the geometries of the panel."""
    vertex, x, phi = result.scene.vertex, np.array(c.independent), np.array(c.fold_angles)
    folded = check_admissible(vertex, phi, tolerance=PRINTED)
    base = Audited(c, "undecided", folded.closure_residual)

    def twin(y: np.ndarray) -> int | None:
        return next((n for z, n in seen if np.abs(y - z).max() <= PRINTED), None)

    known = twin(x)
    if folded.closure_residual > PRINTED:
        seen.append((x, c.number))
        return replace(base, cause="does not close", twin=known)
    if known is not None:
        return replace(base, cause="duplicate", twin=known)
    seen.append((x, c.number))
    if folded.admissible:
        if check_admissible(result.scene, phi, tolerance=PRINTED).admissible:
            return _descend(base, result, x, step)
        return replace(base, cause="isolated")  # no order of its layers has the symmetry
    sides = other_sides(vertex, c)
    if sides is None:
        return replace(base, cause="not admissible")
    base, known = replace(base, sides=tuple(sides.tolist())), twin(sides)
    if known is not None:
        return replace(base, cause="duplicate", twin=known)
    seen.append((sides, c.number))
    return replace(_descend(base, result, sides, step), cause="wrong side")


def _descend(base: Audited, result: MinimaResult, x: np.ndarray, step: float) -> Audited:
    """Follow an admissible state downhill and say what it is in its panel."""
    model = pose(result.scene)
    exact = [model.reduce(np.array(m.fold_angles)) for m in result.minima]
    start = np.clip(project(model, x, ())[0], -model.bound, model.bound)
    try:
        end = descent_path(model, start).end
    except ValueError:  # it touches itself in a way that the model's contacts refuse
        return base
    near = [float(np.abs(end - y).max()) for y in exact]
    distance, drop = float(np.abs(end - start).max()), -model.energy_change(start, end)
    base = replace(base, distance=distance, drop=drop)
    if not near or min(near) > ENDPOINT_TOL:
        at = State(model, x, CLOSED)
        if distance <= ENDPOINT_TOL and sample_neighbourhood(at, at.contacts.base).state is None:
            return replace(base, cause="isolated")
        return base
    hit = int(np.argmin(near))
    here, there = (chart_point(result.scene, model.expand(y)) for y in (start, exact[hit]))
    steps = float(np.abs(here - there).max()) / step
    base = replace(base, minimum=hit + 1, grid_steps=steps)
    if steps <= ON_MINIMUM:
        return replace(base, cause="exact")
    if lower_dimensional_at(State(model, start)):
        return replace(base, cause="on a handle")
    return replace(
        base, cause="chart edge" if chart_ends(result.scene, start, step) else "grid jag"
    )


def _one_each(audited: list[Audited]) -> tuple[Audited, ...]:
    """Keep the nearest candidate of each exact minimum; the others at it are duplicates."""
    best: dict[int | None, Audited] = {}
    for a in sorted((a for a in audited if a.cause == "exact"), key=lambda a: a.distance):
        best.setdefault(a.minimum, a)
    return tuple(
        a
        if a.cause != "exact" or best[a.minimum] is a
        else replace(a, cause="duplicate", twin=best[a.minimum].candidate.number)
        for a in audited
    )
