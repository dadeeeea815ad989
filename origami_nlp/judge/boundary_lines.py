"""The boundary of the admissible set over a chart: contact boundaries traced by continuation, seeded by a grid.

Admissibility is looked at on a grid of chart points; between every admissible cell and an excluded neighbour (or the
edge of the chart) the boundary point is bisected to rounding, so that no piece of boundary that separates cells can be
missed.  The contact that closes there is then held, and its zero set followed on the manifold of closed states
(`boundary_curve.advance`: closure and contact to 1e-13 at every point) both ways, to where another contact
closes.  Only geometry enters: the lines are the same for every stiffness (`with_energy` adds a scene's energy).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.judge.boundary_curve import BoundaryCurve, Point, advance, correct, evaluate
from origami_nlp.judge.chart_grid import (
    allowed,
    cells_away,
    chart_limits,
)
from origami_nlp.judge.chart_grid import (
    crossings as crossings_of,
)
from origami_nlp.judge.handles import thin_at
from origami_nlp.judge.loads import row_name, row_weight
from origami_nlp.judge.nearby import is_admissible
from origami_nlp.model.chart import Chart, admissible, chart_of, wedge_elevation
from origami_nlp.model.nlp import Model
from origami_nlp.solve.active import Row, closed_contacts, row_values
from origami_nlp.solve.starts import broken_gap
from origami_nlp.state.scene import Scene

LONGEST, SHORTEST = 0.04, 1e-10
"""Longest step, and the step [rad] to which the end of a line is bisected."""
TURN = 0.06
"""The tangent turns by about this much [rad] a step."""
CHUNK = 12
"""Steps made before admissibility is looked at, for all of them at once."""
MOST_POINTS = 3000
CLOSED = 1e-6
"""Gap [rad] of a contact at a bisected point, before Newton closes it."""
SAME, SHORT = 1e-7, 1e-3
"""States closer than this [rad] are one corner; shorter lines are dropped."""
NEAR = 0.35
"""A bisected point within this many cells of a line belongs to it."""


@dataclass(frozen=True)
class BoundaryLine:
    """One contact boundary between two corners.

    contacts, rows: held closed.  branch: of the chart.  points: chart coordinates [m, 2].  fold_angles: [m, N].
    s: arclength in the space of all N fold angles [m], 0 at the start.  start, end: why it ends there.
    thin: the states around exist only on this line (a 1-handle of the paper).
    """

    contacts: tuple[str, ...]
    rows: tuple[Row, ...] = field(repr=False)
    branch: int
    points: np.ndarray = field(repr=False)
    fold_angles: np.ndarray = field(repr=False)
    s: np.ndarray = field(repr=False)
    start: str
    end: str
    thin: bool = False

    @property
    def length(self) -> float:
        """Arclength [rad] in the space of all N fold angles."""
        return float(self.s[-1])


@dataclass(frozen=True)
class Boundary:
    """All boundary lines of a scene's chart.

    crossings: bisected boundary points between the cells of the grid, per branch [k, 2].
    missed: those that no line passes within `NEAR` cells; where there are any, the boundary is not complete.
    cell: size of a cell in both coordinates.
    """

    lines: tuple[BoundaryLine, ...]
    crossings: tuple[np.ndarray, ...] = field(repr=False)
    missed: tuple[np.ndarray, ...] = field(repr=False)
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
    chart = chart_of(scene)
    if chart is None or scene.contact != "full":
        raise OptionError(
            "the boundary is traced for scenes with two symmetric freedoms, a closed-form chart "
            f"and contact = 'full', not symmetry {scene.group.name}, contact = {scene.contact!r}"
        )
    model = scene.model()
    x0, x1, y0, y1 = chart_limits(chart)
    cell = ((x1 - x0) / size, (y1 - y0) / size)
    lines: list[BoundaryLine] = []
    crossings, missed = [], []
    for branch in range(len(chart.signs)):
        at, states = crossings_of(chart, branch, size)
        crossings.append(at)
        left = np.ones(len(at), dtype=bool)
        tried = np.zeros(len(at), dtype=bool)
        while (left & ~tried).any():
            # from the middle of what is left: ends of lines are corners, where contacts are ambiguous
            waiting = np.flatnonzero(left & ~tried)
            k = int(waiting[len(waiting) // 2])
            tried[k] = True
            line = _line_at(chart, model, branch, states[k])
            if line is not None:
                lines.append(line)
                left &= cells_away(at, line.points, cell) > NEAR
        missed.append(at[left])
    lines += _thin_lines(chart, model, lines, cell)
    lines = [piece for line in lines for piece in _pieces(model, line, lines)]
    return Boundary(tuple(lines), tuple(crossings), tuple(missed), cell)


def with_energy(model: Model, line: BoundaryLine) -> BoundaryCurve:
    """Evaluate a scene's energy, its derivatives and the contact moments along a line."""
    at = model.reduce(line.fold_angles)
    root = np.sqrt(model.multiplicity)
    along = np.gradient(at * root, axis=0)
    points: list[Point] = []
    kept = []
    for k, x in enumerate(at):
        size = float(np.linalg.norm(along[k]))
        point = evaluate(model, x, line.rows, along[k] / size) if size > 0 else None
        if point is not None and point.dimension == 1:
            points.append(point)
            kept.append(k)
    weights = np.array([row_weight(model, row) for row in line.rows])
    return BoundaryCurve(
        contacts=line.contacts,
        rows=line.rows,
        s=line.s[kept],
        fold_angles=line.fold_angles[kept],
        energy=np.array([model.energy(p.x) for p in points]),
        slope=model.scale * np.array([p.slope for p in points]),
        stiffness=model.scale * np.array([p.stiffness for p in points]),
        springs=model.scale * np.array([p.springs for p in points]),
        multipliers=model.scale * np.array([p.multipliers for p in points]) / weights,
        pressed=np.array([p.pressed for p in points], dtype=bool),
        start=line.start,
        end=line.end,
        dimension=1,
    )


# ---------------------------------------------------------------- pieces between corners


def _pieces(model: Model, line: BoundaryLine, lines: list[BoundaryLine]) -> list[BoundaryLine]:
    """Cut a line where others end on it, and say of each piece which contacts are closed and whether it is thin."""
    at = model.reduce(line.fold_angles)
    s, points = line.s, line.points
    cuts = {0, len(s) - 1}
    corners = [(ln.fold_angles[k], ln.points[k]) for ln in lines for k in (0, -1)]
    for phi, point in corners:
        x = model.reduce(phi)
        local = model.local(x)
        values = row_values(model, x, line.rows, local.gaps, local.gaps_jacobian)[0]
        if np.abs(values).max() > CLOSED:
            continue
        away = np.linalg.norm((at - x) * np.sqrt(model.multiplicity), axis=1)
        k = int(away.argmin())
        if away[k] <= SAME:
            cuts.add(k)
        elif away[k] <= LONGEST and 0 < k < len(s) - 1:
            k += bool(away[k + 1] < away[k - 1])
            at, points = np.insert(at, k, x, axis=0), np.insert(points, k, point, axis=0)
            s = np.insert(s, k, s[k - 1] + float(away[k - 1] if away[k - 1] <= LONGEST else 0.0))
            cuts = {c + (c >= k) for c in cuts} | {k}
    out = []
    ends = sorted(cuts)
    for i, (a, b) in enumerate(itertools.pairwise(ends)):
        if s[b] - s[a] < SHORT or b - a < 2:
            continue
        middle = at[(a + b) // 2]
        closed = closed_contacts(model, middle, model.local(middle).gaps)
        rows = (closed.combinations() or [closed.base])[0] or line.rows
        here = slice(a, b + 1)
        out.append(
            BoundaryLine(
                tuple(row_name(model, row) for row in rows),
                rows,
                line.branch,
                points[here],
                model.expand(at[here]),
                s[here] - s[a],
                line.start if i == 0 else "another boundary ends here",
                line.end if b == ends[-1] else "another boundary ends here",
                bool(thin_at(model, middle)),
            )
        )
    return out


# ---------------------------------------------------------------- continuation


def _line_at(
    chart: Chart, model: Model, branch: int, fold_angles: np.ndarray
) -> BoundaryLine | None:
    """Trace the boundary through a bisected state [N]; None at a corner, or where no contact closes."""
    x = model.reduce(fold_angles)
    contacts = closed_contacts(model, x, model.local(x).gaps, CLOSED)
    choices = contacts.combinations() or [contacts.base]
    for row in dict.fromkeys(row for rows in choices for row in rows):
        start = correct(model, x.copy(), (row,))
        if start is None or np.abs(start - x).max() > 1e-3 or not is_admissible(model, start):
            continue
        line = _trace(chart, model, branch, start, (row,))
        if line is not None:
            return line
    return None


def _thin_lines(
    chart: Chart, model: Model, lines: list[BoundaryLine], cell: tuple[float, float]
) -> list[BoundaryLine]:
    """Trace the sets on the edge of the chart that exist only while several contacts stay closed."""
    x0, x1, y0, y1 = chart_limits(chart)
    t = (np.arange(24) + 0.5) / 24
    edges = [(np.full_like(t, x), y0 + t * (y1 - y0)) for x in (x0, x1)]
    edges += [(x0 + t * (x1 - x0), np.full_like(t, y)) for y in (y0, y1)]
    found: list[BoundaryLine] = []
    for branch in range(len(chart.signs)):
        for x, y in edges:
            good, states = allowed(chart, branch, x, y)
            for k in np.flatnonzero(good):
                at = np.array([[x[k], y[k]]])
                known = [ln for ln in (*lines, *found) if ln.branch == branch]
                if any(cells_away(at, ln.points, cell)[0] < NEAR for ln in known):
                    continue
                start = model.reduce(states[k])
                rows = thin_at(model, start)
                if not rows or not is_admissible(model, start):
                    continue
                line = _trace(chart, model, branch, start, rows)
                if line is not None:
                    found.append(line)
    return found


def _trace(
    chart: Chart,
    model: Model,
    branch: int,
    x: np.ndarray,
    rows: tuple[Row, ...],
) -> BoundaryLine | None:
    """Follow `rows` from the admissible state x [n] both ways; None where no motion keeps them closed."""
    first = evaluate(model, x, rows)
    if first is None or first.dimension != 1:
        return None
    turned = evaluate(model, x, rows, -first.tangent)
    assert turned is not None
    ahead, why_end = _one_way(model, first, rows)
    behind: list[tuple[np.ndarray, float]] = []
    why_start = why_end
    if why_end != "closed curve":
        behind, why_start = _one_way(model, turned, rows)
    states = np.array([*(y for y, _ in reversed(behind)), x, *(y for y, _ in ahead)])
    if len(states) < 3:
        return None
    s = np.array([*(-v for _, v in reversed(behind)), 0.0, *(v for _, v in ahead)])
    phi = model.expand(states)
    return BoundaryLine(
        tuple(row_name(model, row) for row in rows),
        rows,
        branch,
        chart_points(chart, phi),
        phi,
        s - s[0],
        why_start,
        why_end,
    )


def chart_points(chart: Chart, fold_angles: np.ndarray) -> np.ndarray:
    """Return the chart coordinates of states [m, N], shape [m, 2]."""
    rays = chart.scene.group.rays
    if chart.kind == "degree6":
        return fold_angles[:, [rays[1].crease, rays[2].crease]]
    elevation = [wedge_elevation(chart.scene, phi) for phi in fold_angles]
    return np.stack([fold_angles[:, rays[1].crease], elevation], axis=-1)


def _one_way(
    model: Model, first: Point, rows: tuple[Row, ...]
) -> tuple[list[tuple[np.ndarray, float]], str]:
    """Follow the tangent of `first`: states with their arclength, and why they end."""
    out: list[tuple[np.ndarray, float]] = []
    point, s, h = first, 0.0, 1e-2
    root = np.sqrt(model.multiplicity)
    while len(out) < MOST_POINTS:
        ahead: list[tuple[Point, float, float]] = []
        last, total, step = point, s, h
        why = ""
        while len(ahead) < CHUNK:
            moved = advance(model, last, rows, step)
            turn = math.inf
            if moved is not None:
                turn = float(np.linalg.norm(moved[0].tangent - last.tangent))
            if turn > 3 * TURN:
                if step <= 1e-5:
                    why = "singular: closure or contacts lose rank, or no solution beyond"
                    break
                step /= 2
                continue
            assert moved is not None
            last, total = moved[0], total + moved[1]
            ahead.append((last, total, step))
            step = min(LONGEST, step * min(2.0, TURN / max(turn, 1e-3 * TURN)))
        kept = _admissible_run(model, [p.x for p, _, _ in ahead])
        for p, value, _ in ahead[:kept]:
            out.append((p.x, value))
            back = float(np.linalg.norm(root * (p.x - first.x)))
            if len(out) > 5 and back <= LONGEST and p.tangent @ first.tangent > 0.9:
                out.append((first.x, value + back))
                return out, "closed curve"
        if kept:
            point, s, h = ahead[kept - 1][0], ahead[kept - 1][1], step
        if kept < len(ahead):
            return _last_stretch(model, point, s, ahead[kept][2], rows, out)
        if why:
            return _last_stretch(model, point, s, 1e-5, rows, out)
    return out, f"more than {MOST_POINTS} points"


def _admissible_run(model: Model, states: list[np.ndarray]) -> int:
    """How many of the states, from the first on, are admissible."""
    count = 0
    for x in states:
        beyond = model.structure.limits and (np.abs(x) > model.bound + 1e-11).any()
        if beyond or broken_gap(model, model.local(x).gaps) is not None:
            break
        count += 1
    if count:
        good = admissible(model.scene, model.expand(np.array(states[:count])))
        count = count if good.all() else int(np.argmin(good))
    # the order of layers is looked at where a run ends: it changes at corners, and then stays
    low, high = -1, count
    if count and not is_admissible(model, states[count - 1]):
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if is_admissible(model, states[middle]) else (low, middle)
    return high


def _last_stretch(
    model: Model,
    point: Point,
    s: float,
    h: float,
    rows: tuple[Row, ...],
    out: list[tuple[np.ndarray, float]],
) -> tuple[list[tuple[np.ndarray, float]], str]:
    """Bisect to the end of a line, put its last point on the corner, and say what closes there."""
    while h > SHORTEST:
        moved = advance(model, point, rows, h)
        if moved is None or not is_admissible(model, moved[0].x):
            h /= 2
            continue
        point, s = moved[0], s + moved[1]
        out.append((point.x, s))
        h *= 0.9
    found = closed_contacts(model, point.x, model.local(point.x).gaps, CLOSED)
    extra = dict.fromkeys(found.base)
    for options in found.branches:
        extra.update(dict.fromkeys(options[0]))
    new = tuple(row for row in extra if row not in rows)
    if not new:
        return out, "singular: closure or contacts lose rank, or no solution beyond"
    corner = correct(model, point.x.copy(), (*rows, *new))
    if corner is not None and np.abs(corner - point.x).max() < CLOSED:
        out.append((corner, s + float(np.linalg.norm(corner - point.x))))
    return out, "another contact closes (" + "; ".join(row_name(model, row) for row in new) + ")"
