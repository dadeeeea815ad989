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
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.chart import chart_of
from origami_nlp.display import Report, Section, Table
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, lower_dimensional_at, project, sample_neighbourhood
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import ENDPOINT_TOL, null_space
from origami_nlp.paper.candidates import INDEPENDENT, PRINTED, Candidate
from origami_nlp.pattern import Scene, format_angle
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

NEAR = ("exact", "duplicate", "on a handle", "grid jag", "chart edge")
FAR = ("does not close", "wrong side", "not admissible", "isolated", "undecided")
CAUSES = (*NEAR, *FAR)
HEADS = ("panel", "published", *CAUSES, "exact minima", "represented", "reached")


@dataclass(frozen=True)
class Audited:
    """What one candidate is.

    number, fold_angles: of the candidate.
    cause: what becomes of it: ``exact`` is the nearest to an exact minimum, within `ON_MINIMUM` grid steps; a
    ``duplicate`` closes and repeats fold angles, the sheet or the exact minimum of another; ``on a
    handle`` it slides along a set of one dimension beside which nothing is admissible; from a ``grid jag`` it flows
    away; at a ``chart edge`` as well, within a grid step of where the chart ends; on the ``wrong side`` a sheet of
    paper with these facets has the other signs of +-pi; no symmetric motion leaves an ``isolated`` one.
    minimum: number (1-based) of the exact minimum of its panel that it is or descends to.  distance: largest change
    of a fold angle on the way [rad].
    """

    number: int
    fold_angles: tuple[float, ...]
    cause: str
    minimum: int | None = None
    distance: float = math.nan


@dataclass(frozen=True, repr=False)
class PanelAudit(ShortRepr):
    """The candidates of one panel, in the order of the file.

    title: the panel in words.  grid_step: of the published grid [rad].  minima: energies of the exact minima [J].
    """

    title: str
    grid_step: float
    minima: tuple[float, ...]
    candidates: tuple[Audited, ...]

    ALSO = ("counts",)

    @property
    def counts(self) -> dict[str, int]:
        """Numbers in the order of `HEADS`.

        Of candidates, of those with each cause, of exact minima, of those that some candidate is to within the grid,
        and of those that some candidate is or descends to.
        """
        causes = Counter(a.cause for a in self.candidates)
        reached = {a.minimum for a in self.candidates if a.minimum}
        exact = {a.minimum for a in self.candidates if a.minimum and a.cause == "exact"}
        numbers = (*map(len, (self.minima, exact, reached)),)
        every = (len(self.candidates), *(causes[c] for c in CAUSES), *numbers)
        return dict(zip(HEADS[1:], every, strict=True))


@dataclass(frozen=True, repr=False)
class Audit(Report):
    """What published candidates are, panel by panel."""

    panels: tuple[PanelAudit, ...]

    SCHEMA, READS = "origami-nlp/audit/2", False

    def table(self) -> Table:
        """Return one row a panel, and their sums: candidates, what they are, exact minima they belong to."""
        numbers = [[*p.counts.values()] for p in self.panels]
        numbers.append([sum(column) for column in zip(*numbers, strict=True)])
        titles = [*(p.title for p in self.panels), "all"]
        rows = [[title, *map(str, row)] for title, row in zip(titles, numbers, strict=True)]
        return Table(HEADS, rows, "published candidates", "l" + "R" * (len(HEADS) - 1))

    def report_sections(self) -> Iterator[Section]:
        """Return the table."""
        yield self.table()


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
        panel = _Panel(panels[key], find_states(panels[key][0].scene, seed=seed, escape=False))
        audited = []
        for c in panel.candidates:
            audited.append(panel.audit(c))
            done += 1
            if progress:
                progress(done, len(candidates), panel.title)
        audited.sort(key=lambda a: a.number)
        energies = tuple(m.energy for m in panel.result.minima)
        out.append(PanelAudit(panel.title, panel.step, energies, _one_each(audited)))
    return Audit(tuple(out))


def chart_ends(scene: Scene, x: np.ndarray, step: float) -> bool:
    """Return whether an end of the chart lies within one grid `step` of state x."""
    model = pose(scene)
    if scene.degree == 6:
        at = null_space(model.closure(x)[1])[1:3]
        singular = float(np.linalg.svd(at, compute_uv=False).min())
        return step >= STRETCHED * singular and max(abs(x[1]), abs(x[2])) <= math.pi / 2
    chart = chart_of(scene)
    assert chart is not None
    fold, v = chart.points(model.expand(x))
    alpha = scene.vertex.sector_angles[0]
    edge = math.asin(min(1.0, math.sin(2 * alpha) * math.sin(fold / 2) ** 2))
    return bool(abs(fold) <= step or abs(abs(v) - edge) <= step)


class _Panel:
    """The candidates of one panel, admissible ones first, its exact minima, and the geometries that were seen."""

    def __init__(self, members: Sequence[Candidate], result: MinimaResult) -> None:
        self.result, self.scene, self.model = result, result.scene, pose(result.scene)
        self.chart = chart_of(self.scene)
        first = members[0]
        self.title = f"degree {first.degree}, {format_angle(first.alpha)}, {first.ratio:g}"
        # of equal geometries the admissible one is the first
        self.candidates = sorted(
            members, key=lambda c: (not self.is_paper(c.fold_angles), c.number)
        )
        self.step = self._grid_step()
        self.seen: list[np.ndarray] = []

    def is_paper(self, phi: Sequence[float]) -> bool:
        """Return whether a sheet can be folded so, symmetric layers or not."""
        return check_admissible(self.scene.vertex, np.array(phi), tolerance=PRINTED).admissible

    def points(self, x: np.ndarray) -> np.ndarray:
        """Return chart coordinates of states [..., n]: (phi_2, phi_3), or (phi_2, elevation) with degree 8."""
        assert self.chart is not None
        return self.chart.points(self.model.expand(x))

    def _grid_step(self) -> float:
        """Return the coarsest step pi/128, pi/256, pi/512 whose multiples the coordinates are; else pi/128."""
        # only candidates that close say something about the grid
        states = [np.array(c.independent) for c in self.candidates]
        closed = [x for x in states if np.abs(self.model.closure(x)[0]).max() <= PRINTED]
        for n in (128, 256, 512):
            at = self.points(np.array(closed)) / (math.pi / n) if closed else np.full(1, 0.5)
            if np.mean(np.abs(at - np.round(at)) < ON_GRID) > 0.95:
                return math.pi / n
        return math.pi / 128

    def is_known(self, x: np.ndarray) -> bool:
        """Return whether a candidate had the same geometry; note a new one."""
        known = any(np.abs(x - y).max() <= PRINTED for y in self.seen)
        self.seen += [] if known else [x]
        return known

    def other_sides(self, c: Candidate) -> np.ndarray | None:
        """Return the state with other signs of its +-pi that is admissible, fewest changes first; or None."""
        x = np.array(c.independent)
        at_pi = np.flatnonzero(np.abs(np.abs(x) - math.pi) <= PRINTED).tolist()
        for count in range(1, len(at_pi) + 1):
            for flipped in itertools.combinations(at_pi, count):
                y = x.copy()
                y[list(flipped)] *= -1
                if self.is_paper(y[list(INDEPENDENT[c.degree])].tolist()):
                    return y
        return None

    def audit(self, c: Candidate) -> Audited:
        """Audit one candidate."""
        x, phi = np.array(c.independent), np.array(c.fold_angles)
        paper = check_admissible(self.scene.vertex, phi, tolerance=PRINTED)
        base = Audited(c.number, c.fold_angles, "undecided")
        known = self.is_known(x)
        if paper.closure_residual > PRINTED:
            return replace(base, cause="does not close")
        if known:
            return replace(base, cause="duplicate")
        if paper.admissible:
            if check_admissible(self.scene, phi, tolerance=PRINTED).admissible:
                return self.descend(base, x)
            return replace(base, cause="isolated")  # no order of its layers has the symmetry
        sides = self.other_sides(c)
        if sides is None:
            return replace(base, cause="not admissible")
        cause = "duplicate" if self.is_known(sides) else "wrong side"
        return replace(base if cause == "duplicate" else self.descend(base, sides), cause=cause)

    def descend(self, base: Audited, x: np.ndarray) -> Audited:
        """Follow an admissible state downhill and say what it is in its panel."""
        model = self.model
        start = np.clip(project(model, x, ())[0], -model.bound, model.bound)
        try:
            end = descent_path(model, start).end
        except ValueError:  # it touches itself in a way that the model's contacts refuse
            return base
        exact = [model.reduce(np.array(m.fold_angles)) for m in self.result.minima]
        near = [float(np.abs(end - y).max()) for y in exact]
        distance = float(np.abs(end - start).max())
        base = replace(base, distance=distance)
        if min(near, default=math.inf) > ENDPOINT_TOL:
            at = State(model, x, CLOSED)
            alone = (
                distance <= ENDPOINT_TOL
                and sample_neighbourhood(at, at.contacts.base).state is None
            )
            return replace(base, cause="isolated") if alone else base
        hit = int(np.argmin(near))
        steps = float(np.abs(self.points(start) - self.points(exact[hit])).max()) / self.step
        base = replace(base, minimum=hit + 1)
        if steps <= ON_MINIMUM:
            return replace(base, cause="exact")
        if lower_dimensional_at(State(model, start)):
            return replace(base, cause="on a handle")
        at_edge = chart_ends(self.scene, start, self.step)
        return replace(base, cause="chart edge" if at_edge else "grid jag")


def _one_each(audited: list[Audited]) -> tuple[Audited, ...]:
    """Keep the nearest candidate of each exact minimum; the others at it are duplicates."""
    best: dict[int | None, Audited] = {}
    for a in sorted((a for a in audited if a.cause == "exact"), key=lambda a: a.distance):
        best.setdefault(a.minimum, a)
    return tuple(
        replace(a, cause="duplicate") if a.cause == "exact" and best[a.minimum] is not a else a
        for a in audited
    )
