"""The boundary of the admissible set over a chart: contact curves and corners of the mesh of closed states.

`admissible_cells` knows every contact curve, to rounding, and which side of it has states.  Here its border is put
together from corner to corner, and points are added until they are close.
Only geometry enters: the lines are the same for every stiffness (`with_energy` adds a scene's energy).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.chart.cells import Cells, cells_of, geometry
from origami_nlp.chart.half_chain import CUT, SEAM
from origami_nlp.chart.mesh import MeshError, exact_states, pulled
from origami_nlp.chart.topology import arcs, borders
from origami_nlp.continuation import BoundaryCurve, boundary_of, evaluate
from origami_nlp.io import ShortRepr
from origami_nlp.kkt import State
from origami_nlp.numerics import SETTLED
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Contact

if TYPE_CHECKING:
    pass

RINGS = 24
"""Of the mesh from which boundaries are read."""
CLOSE, DOUBLINGS = 0.04, 12
"""Largest change of a fold angle between points of a line [rad], and how often points are added for it."""


@dataclass(frozen=True, repr=False)
class BoundaryLine(ShortRepr):
    """One contact boundary between two corners.

    contacts: closed along it.  branch: of the chart.  points: chart coordinates [m, 2].  fold_angles: [m, N].
    s: arclength in the space of all N fold angles [m], 0 at the start.
    thin: the states around exist only on this line (a 1-handle of the paper).
    """

    contacts: tuple[str, ...]
    branch: int
    points: np.ndarray = field(repr=False, metadata={"plain": False})
    fold_angles: np.ndarray = field(repr=False, metadata={"plain": False})
    s: np.ndarray = field(repr=False, metadata={"plain": False})
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

    def rows(self, problem: PatternProblem) -> tuple[Contact, ...]:
        """Return what is closed along it, as contacts of a problem, which numbers them as it meets them."""
        # what is closed in the middle of a line is closed all along it; at its ends more is
        return State(problem, problem.reduce(self.fold_angles[len(self.s) // 2])).pieces[0]

    @property
    def hidden(self) -> bool:
        """Whether all its states share one point of the chart."""
        return bool(np.ptp(self.points, axis=0).max() < SETTLED)


Boundary = tuple[BoundaryLine, ...]
"""All lines that bound the states of a chart."""


def trace_boundary(scene: Scene) -> Boundary:
    """Trace the boundary of the admissible set of `scene` over its chart; scenes that differ in springs share it.

    Parameters
    ----------
    scene
        With a chart of two coordinates.

    Returns
    -------
    tuple of BoundaryLine
        All lines.

    Raises
    ------
    OptionError
        If the scene has no chart of two coordinates, or full contact is not asked for: other boundaries of a
        chart are no contacts.
    MeshError
        If contacts meet more closely than a mesh tells apart.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> from origami_nlp.chart import trace_boundary
    >>> len(trace_boundary(examples.degree6("pi/4")))
    8
    """
    return _boundary(geometry(scene))


def outline_of(scene: Scene) -> Boundary | None:
    """Return the boundary of a scene's chart; None where contact is not full, of stops, and where it cannot be told."""
    try:
        return trace_boundary(scene) if scene.contact == "full" and not scene.limits else None
    except MeshError:
        return None


@lru_cache(maxsize=32)
def _boundary(scene: Scene) -> Boundary:
    cells, problem = cells_of(scene, RINGS), pose(scene)
    return tuple(_line(problem, cells, *path) for path in border_paths(cells))


def border_paths(cells: Cells) -> list[tuple[np.ndarray, int, bool]]:
    """Return the border from corner to corner: vertices in order, branch of the chart, and whether it is a handle."""
    branch, sure = cells.chart.branch_of(cells.fold_angles)
    edges, thin = borders(cells.triangles, cells.extra_edges)
    a, b = edges.T
    # of two ends that one is asked for its branch which is farther from where branches meet
    on = np.where(sure[a] >= sure[b], branch[a], branch[b])
    walls = cells.on[a] & cells.on[b] & ~(1 << SEAM)
    kinds, kind = np.unique(np.stack([walls, on, thin], axis=1), axis=0, return_inverse=True)
    # a path goes on through a vertex of two edges that are alike
    many = np.bincount(edges.ravel(), minlength=len(cells.wedge))
    paths = []
    for k, (_, of, alone) in enumerate(kinds.tolist()):
        own = edges[kind.ravel() == k]
        inner = (many == 2) & (np.bincount(own.ravel(), minlength=len(many)) == 2)
        paths += [(path, of, bool(alone)) for path in arcs(own, inner)]
    return paths


def _line(
    problem: PatternProblem, cells: Cells, path: np.ndarray, branch: int, thin: bool
) -> BoundaryLine:
    """Return the line through some vertices, with more points between those that are far apart."""
    cover, x, at = cells.cover, cells.wedge[path], cells.origin[path]
    base, leaf, on = cover.base[at], cover.leaf[at], int(np.bitwise_and.reduce(cells.on[path]))
    for _ in range(DOUBLINGS):
        far = np.flatnonzero(np.abs(np.diff(x, axis=0)).max(axis=1) > CLOSE)
        if not len(far):
            break
        side = np.where(leaf[far] != 0, leaf[far], leaf[far + 1])
        walls = np.full(len(far), on)
        new = pulled(cover.chain, 0.5 * (base[far] + base[far + 1]), side, walls)
        states = exact_states(cover.chain, new, side, walls)
        if on >> CUT & 1:
            states[:, -2] = np.copysign(np.pi, x[far, -2])
        base, leaf = np.insert(base, far + 1, new, axis=0), np.insert(leaf, far + 1, side)
        x = np.insert(x, far + 1, np.clip(states, -np.pi, np.pi), axis=0)
    phi = x[:, cover.chain.orbit]
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(phi, axis=0), axis=1)))
    line = BoundaryLine((), branch, cells.chart.points(phi), phi, s, thin)
    return replace(line, contacts=tuple(map(problem.name, line.rows(problem))))


def with_energy(problem: PatternProblem, line: BoundaryLine) -> BoundaryCurve:
    """Evaluate a scene's energy, its derivatives and the contact moments along a line."""
    at, rows = problem.reduce(line.fold_angles), line.rows(problem)
    along = np.gradient(at * problem.root, axis=0)
    size = np.linalg.norm(along, axis=1)
    found = [
        evaluate(State(problem, x).on(rows), way / much) if much > 0 else None
        for x, way, much in zip(at, along, size, strict=True)
    ]
    points = [(k, p) for k, p in enumerate(found) if p is not None and p.dimension == 1]
    s = line.s[[k for k, _ in points]]
    return boundary_of(rows, [p for _, p in points], s, 1.0, ("corner", "corner"))
