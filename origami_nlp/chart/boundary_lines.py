"""The boundary of the admissible set over a chart: contact boundaries traced by continuation, seeded by a grid.

Admissibility is looked at on a grid of chart points; between every admissible cell and an excluded neighbour (or the
edge of the chart) the boundary point is bisected, to rounding where a line starts from it, so that no piece of boundary
that separates cells can be missed.  The contact that closes there is held, and its zero set followed on closed states
(`continuation.trace`: closure and contact to `FOLLOWED` at every point) both ways, to where another contact
closes.  Only geometry enters: the lines are the same for every stiffness (`with_energy` adds a scene's energy).

Of lines that a symmetry of the vertex takes to one another, the paper turned over among them, one is traced.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.chart.boundary_walk import STEPS, closing_words, walk
from origami_nlp.chart.chart import Chart, chart_of, chart_points
from origami_nlp.chart.grid import allowed, chart_limits, crossings_of, distance_from, last_allowed
from origami_nlp.continuation import (
    CLOSES_ANOTHER,
    BoundaryCurve,
    Point,
    boundary_of,
    correct,
    evaluate,
)
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State, Stratum, lower_dimensional_at
from origami_nlp.numerics import CONTACT_TOL, FOLLOWED, NEAR_CONTACT, NEAR_SINGULAR_TOL, SETTLED
from origami_nlp.pattern import Relabelling, Scene, symmetries
from origami_nlp.problem import Contact, Model

CORNER = math.sqrt(CONTACT_TOL)
"""Accuracy [rad] of ends where the next contact closes tangentially: their distance, squared, is `CONTACT_TOL`."""
SHORT = 1e-3
"""Shorter lines [rad] are dropped."""
ASIDE = 1e-3
"""Step [rad] by which a contact is moved along to see whether the chart shows it."""
NEAR = 0.35
"""A bisected point within this many cells of a line belongs to it."""


@dataclass(frozen=True, repr=False)
class BoundaryLine(ShortRepr):
    """One contact boundary between two corners.

    contacts, rows: held closed.  branch: of the chart.  points: chart coordinates [m, 2].  fold_angles: [m, N].
    s: arclength in the space of all N fold angles [m], 0 at the start.  start, end: why it ends there.
    thin: the states around exist only on this line (a 1-handle of the paper).
    """

    contacts: tuple[str, ...]
    rows: tuple[Contact, ...] = field(repr=False, metadata={"plain": False})
    branch: int
    points: np.ndarray = field(repr=False, metadata={"plain": False})
    fold_angles: np.ndarray = field(repr=False, metadata={"plain": False})
    s: np.ndarray = field(repr=False, metadata={"plain": False})
    start: str
    end: str
    thin: bool = False

    ALSO = ("length", "ends")

    @property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Fold angles of its first and its last state."""
        return self.fold_angles[0], self.fold_angles[-1]

    @property
    def length(self) -> float:
        """Arclength [rad] in the space of all N fold angles."""
        return float(self.s[-1])

    @property
    def hidden(self) -> bool:
        """Whether all its states share one point of the chart."""
        return bool(np.ptp(self.points, axis=0).max() < SETTLED)


@dataclass(frozen=True, repr=False)
class Boundary(ShortRepr):
    """All boundary lines of a scene's chart.

    crossings: bisected boundary points between the cells of the grid, per branch [k, 2].
    missed: those that no line passes within `NEAR` cells; where there are any, the boundary is not complete.
    cell: size of a cell in both coordinates.
    """

    lines: tuple[BoundaryLine, ...]
    crossings: tuple[np.ndarray, ...] = field(repr=False, metadata={"plain": False})
    missed: tuple[np.ndarray, ...] = field(repr=False, metadata={"plain": False})
    cell: tuple[float, float]

    @property
    def complete(self) -> bool:
        """Whether every boundary point that the grid saw lies on a line."""
        return not any(len(m) for m in self.missed)


def trace_boundary(scene: Scene, size: int = 161) -> Boundary:
    """Trace the boundary of the admissible set of `scene` over its chart.

    Parameters
    ----------
    size
        Cells along each coordinate of the grid that seeds the lines, >= 8.

    Raises
    ------
    OptionError
        If the scene has no chart of two coordinates, or full contact is not asked for: other boundaries of a
        chart are no contacts.
    """
    scene.check_plain_hinges("the boundary of the admissible set", laws=True)
    chart = chart_of(scene)
    if chart is None or scene.contact != "full":
        raise OptionError(
            "the boundary is traced for scenes with two symmetric degrees of freedom, a closed-form chart "
            f"and contact = 'full', not symmetry {scene.group.name}, contact = {scene.contact!r}"
        )
    model = Model(scene)
    x0, x1, y0, y1 = chart_limits(chart)
    cell = ((x1 - x0) / size, (y1 - y0) / size)
    moves = _moves(scene)
    lines: list[BoundaryLine] = []
    seeds = [crossings_of(chart, branch, size) for branch in range(len(chart.signs))]
    crossings = tuple(inside for inside, _ in seeds)
    left = [np.ones(len(at), dtype=bool) for at in crossings]
    for branch, (inside, beyond) in enumerate(seeds):
        tried = np.zeros(len(inside), dtype=bool)
        while (left[branch] & ~tried).any():
            # from the middle of what is left: ends of lines are corners, where contacts are ambiguous
            waiting = np.flatnonzero(left[branch] & ~tried)
            k = int(waiting[len(waiting) // 2])
            tried[k] = True
            exact = last_allowed(chart, branch, inside[[k]], beyond[[k]])
            (state,) = allowed(chart, branch, *exact.T)[1]
            found = _line_at(chart, model, branch, state)
            for line in _with_images(chart, model, found, moves):
                lines.append(line)
                at, mine = crossings[line.branch], left[line.branch]
                mine[mine] = distance_from(at[mine] / cell, line.points / cell) > NEAR
    missed = tuple(at[mine] for at, mine in zip(crossings, left, strict=True))
    lines += _thin_lines(chart, model, lines, cell, moves)
    lines += _hidden_lines(chart, model, lines, moves)
    lines = [piece for line in lines for piece in _pieces(model, line, lines)]
    return Boundary(tuple(lines), crossings, missed, cell)


def with_energy(model: Model, line: BoundaryLine) -> BoundaryCurve:
    """Evaluate a scene's energy, its derivatives and the contact moments along a line."""
    at = model.reduce(line.fold_angles)
    along = np.gradient(at * model.root, axis=0)
    points: list[Point] = []
    kept = []
    for k, x in enumerate(at):
        size = float(np.linalg.norm(along[k]))
        point = evaluate(State(model, x).on(line.rows), along[k] / size) if size > 0 else None
        if point is not None and point.dimension == 1:
            points.append(point)
            kept.append(k)
    return boundary_of(line.rows, points, line.s[kept], 1.0, (line.start, line.end))


# ---------------------------------------------------------------- pieces between corners


def _pieces(model: Model, line: BoundaryLine, lines: list[BoundaryLine]) -> list[BoundaryLine]:
    """Cut a line where others end on it, and say of each piece which contacts are closed and whether it is thin."""
    at = model.reduce(line.fold_angles)
    s, points = line.s, line.points
    cuts = {0, len(s) - 1}
    corners = [(ln.fold_angles[k], ln.points[k]) for ln in lines for k in (0, -1)]
    for phi, point in corners:
        x = model.reduce(phi)
        held = State(model, x).on(line.rows)
        if np.abs(held.openings).max() > CORNER:
            continue
        exact = correct(held)
        if exact is None or np.abs(exact.x - x).max() > 10 * CORNER:
            continue
        x = exact.x
        away = np.linalg.norm((at - x) * model.root, axis=1)
        k = int(away.argmin())
        if away[k] <= SETTLED:
            cuts.add(k)
        elif away[k] <= STEPS.longest and 0 < k < len(s) - 1:
            # the nearest point lies before or behind the corner: it goes in between the two neighbours that it
            # separates
            k += bool(away[k + 1] < away[k - 1])
            at, points = np.insert(at, k, x, axis=0), np.insert(points, k, point, axis=0)
            s = np.insert(
                s, k, s[k - 1] + float(away[k - 1] if away[k - 1] <= STEPS.longest else 0.0)
            )
            cuts = {c + (c >= k) for c in cuts} | {k}
    out = []
    ends = sorted(cuts)
    for i, (a, b) in enumerate(itertools.pairwise(ends)):
        if s[b] - s[a] < SHORT or b - a < 2:
            continue
        middle = State(model, at[(a + b) // 2])
        # what is closed in the middle of a piece is closed all along it; at its ends more is
        rows = middle.pieces[0] or line.rows
        here = slice(a, b + 1)
        out.append(
            BoundaryLine(
                tuple(model.name(row) for row in rows),
                rows,
                line.branch,
                points[here],
                model.expand(at[here]),
                s[here] - s[a],
                line.start if i == 0 else "another boundary ends here",
                line.end if b == ends[-1] else "another boundary ends here",
                bool(lower_dimensional_at(middle)),
            )
        )
    return out


# ---------------------------------------------------------------- continuation


def _line_at(
    chart: Chart, model: Model, branch: int, fold_angles: np.ndarray
) -> BoundaryLine | None:
    """Trace the boundary through a bisected state [N]; None at a corner, or where no contact closes."""
    at = State(model, model.reduce(fold_angles), NEAR_CONTACT)
    # contacts that stay closed together are held together: the set of one may branch where that of all goes on
    together = [rows for rows in at.pieces if len(rows) > 1]
    for held in dict.fromkeys([*together, *((row,) for rows in at.pieces for row in rows)]):
        start = correct(at.on(held))
        if start is None or np.abs(start.x - at.x).max() > NEAR_SINGULAR_TOL or start.refused:
            continue
        line = _trace(chart, branch, start.on(held))
        if line is not None:
            return line
    return None


def _thin_lines(
    chart: Chart,
    model: Model,
    lines: list[BoundaryLine],
    cell: tuple[float, float],
    moves: Sequence[Relabelling],
) -> list[BoundaryLine]:
    """Trace the sets on the edge of the chart that exist only while several contacts stay closed."""
    x0, x1, y0, y1 = chart_limits(chart)
    t = (np.arange(24) + 0.5) / 24
    edges = [(np.full_like(t, x), y0 + t * (y1 - y0)) for x in (x0, x1)]
    edges += [(x0 + t * (x1 - x0), np.full_like(t, y)) for y in (y0, y1)]
    found: list[BoundaryLine] = []
    for branch in range(len(chart.signs)):
        x, y = (np.concatenate(each) for each in zip(*edges, strict=True))
        good, states = allowed(chart, branch, x, y)
        at = np.stack([x, y], axis=-1) / cell

        def clear(points: np.ndarray, by: list[BoundaryLine], branch: int = branch) -> np.ndarray:
            known = [ln.points / cell for ln in by if ln.branch == branch]
            return np.all([distance_from(points, line) >= NEAR for line in known], axis=0)

        good[good] &= clear(at[good], lines)
        for k in np.flatnonzero(good):
            if found and not clear(at[[k]], found)[0]:
                continue
            start = State(model, model.reduce(states[k]))
            rows = lower_dimensional_at(start)
            if not rows or start.refused:
                continue
            line = _trace(chart, branch, start.on(rows))
            found += _with_images(chart, model, line, moves)
    return found


def _hidden_lines(
    chart: Chart, model: Model, lines: list[BoundaryLine], moves: Sequence[Relabelling]
) -> list[BoundaryLine]:
    """Trace from corners the contacts whose whole line is one point of the chart, which no cell sees."""
    found: list[BoundaryLine] = []
    for line in lines:
        for phi in line.fold_angles[[0, -1]]:
            at = State(model, model.reduce(phi))
            for row in dict.fromkeys(r for rows in at.pieces for r in rows):
                if not _stays(chart, at.on((row,))):
                    continue
                # dependent contacts describe one line twice
                if any(distance_from(phi[None], ln.fold_angles)[0] < SHORT for ln in found):
                    continue
                new = _trace(chart, line.branch, at.on((row,)))
                if new is not None and new.length > SHORT:
                    found += _with_images(chart, model, new, moves)
    return found


def _stays(chart: Chart, held: Stratum) -> bool:
    """Return whether moving from a state with a contact held stays on the same point of the chart."""
    point = evaluate(held)
    if point is None or point.dimension != 1:
        return False
    problem = held.state.problem
    beside = held.state.at(held.state.x + ASIDE * point.tangent / problem.root)
    moved = correct(beside.on(held.contacts))
    if moved is None:
        return False
    both = chart_points(chart, problem.expand(np.array([held.state.x, moved.x])))
    return bool(np.ptp(both, axis=0).max() < SETTLED)


def _trace(chart: Chart, branch: int, held: Stratum) -> BoundaryLine | None:
    """Follow contacts from an admissible state both ways; None where no motion keeps them closed."""
    walked = walk(held)
    if walked is None:
        return None
    problem = held.state.problem
    phi = problem.expand(walked.states)
    names = tuple(problem.name(row) for row in held.contacts)
    points = chart_points(chart, phi)
    return BoundaryLine(
        names, held.contacts, branch, points, phi, walked.s, walked.start, walked.end
    )


# ---------------------------------------------------------------- images


def _moves(scene: Scene) -> list[Relabelling]:
    """Return the symmetries of the vertex, its fold limits and the imposed symmetry, whatever the springs."""
    plain = replace(
        scene,
        stiffness=(1.0,) * scene.degree,
        rest_angles=(0.0,) * scene.degree,
        symmetry=scene.group.name,
        preload=(),
        laws=(),
        loads=(),
    )
    return symmetries(plain)


def _with_images(
    chart: Chart, model: Model, line: BoundaryLine | None, moves: Sequence[Relabelling]
) -> Iterator[BoundaryLine]:
    """Yield a line, if there is one, and the others that symmetries take it to."""
    known = [] if line is None else [line]
    yield from known
    for move in moves if line else ():
        states = move.back(known[0].fold_angles)
        middle = states[None, len(states) // 2]
        if any(distance_from(middle, ln.fold_angles)[0] < SHORT for ln in known):
            continue  # it is there already, or the symmetry keeps the line
        new = _image(chart, model, known[0], states)
        if new is not None:
            known.append(new)
            yield new


def _image(
    chart: Chart, model: Model, line: BoundaryLine, states: np.ndarray
) -> BoundaryLine | None:
    """Return the line to whose states [m, N] a symmetry takes those of another; None where contacts are ambiguous."""
    at = model.reduce(states)
    middle = len(at) // 2
    branches = {chart.locate(states[k])[0] for k in (middle // 2, middle, (middle + len(at)) // 2)}
    each = dict.fromkeys(row for rows in State(model, at[middle]).pieces for row in rows)
    m = model.equation_count
    rows = [r for r in each if np.abs(model.constraints(at, (r,))[0][:, m:]).max() <= FOLLOWED]
    rows = rows[: len(line.rows)]
    ((branch, *more), *others) = branches
    if more or others or len(rows) < len(line.rows):
        return None
    why = [
        closing_words(State(model, x).on(tuple(rows))) if end.startswith(CLOSES_ANOTHER) else end
        for end, x in ((line.start, at[0]), (line.end, at[-1]))
    ]
    return replace(
        line,
        contacts=tuple(map(model.name, rows)),
        rows=tuple(rows),
        branch=branch,
        points=chart_points(chart, states),
        fold_angles=states,
        start=why[0],
        end=why[1],
    )
