"""All critical points of the energy on the contact-admissible symmetric set X, and the Morse identity.

X has two dimensions, with edges where one contact is closed, vertices where more are, one-dimensional handles, and
the flat state, where two branches of X meet in a point.  A state p contributes 1 - chi(lower link of p) to the Euler
characteristic of X (Goresky and MacPherson, Stratified Morse theory, part I; for a polyhedron Banchoff, 1967):

- interior: grad U vanishes on the tangent plane; (-1)^index.
- edge: grad U vanishes along the edge; with mu > 0 (the energy rises into X) (-1)^index along the edge, with
  mu < 0 nothing, because half of the link is lower and it is one arc.
- vertex, handle, singular state, or a multiplier or curvature that vanishes: counted on the link itself.

The pieces of X are those of the mesh of closed states (`chart.cells_of`).  Interior points come from Newton from
states spread over X and its edges, edge points from every sign change of dU/ds, each of which must be met by one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.chart import (
    BoundaryLine,
    border_paths,
    cells_of,
    geometry,
    parts,
    spots,
    trace_boundary,
)
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, Stratum
from origami_nlp.numerics import (
    BALANCED,
    FIRM,
    SETTLED,
    STATIONARY,
    distinct,
    rank,
)
from origami_nlp.paper.links import RADII, Link, Way, link_of
from origami_nlp.paper.morse import (
    ROUNDING,
    CriticalPoint,
    CriticalPoints,
    Kind,
    Part,
)
from origami_nlp.paper.newton import NEAR, approach, settle
from origami_nlp.pattern import Scene, as_scene
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Contact

KINDS: tuple[Kind, ...] = ("minimum", "saddle", "maximum")
"""Of a regular point, by its index."""
THINNED = 3
"""Of so many vertices of the mesh one is a start of Newton."""
RINGS, SIZES = 24, (8, 1025)
"""Rings of the mesh around the flat state, by default and at least and most."""


def find_critical_points(scene: Scene, *, rings: int = RINGS) -> CriticalPoints:
    """Find every critical point of the energy on the contact-admissible symmetric set X.

    Critical in the sense of stratified Morse theory: on the inside, the edges and the vertices of X.

    Parameters
    ----------
    scene
        What is folded.
    rings
        Of the mesh of X whose vertices are starts of Newton, 8 to 1025.

    Returns
    -------
    CriticalPoints
        In order of energy; their contributions sum to the Euler characteristic of X where none is missing (`closes`).

    Raises
    ------
    OptionError
        If the scene has dead loads, not two symmetric degrees of freedom or not full contact, or an argument is not
        what it must be.
    MeshError
        If contacts meet more closely than a mesh tells apart.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_critical_points(o.examples.degree6("pi/4", ratio=0.01), rings=12)
    >>> found.morse_sum, len(found.minima)
    (1, 2)
    """
    scene = as_scene(scene, "a search for all critical points", "find_minima takes a pattern")
    scene.check_no_forces("critical points")
    check_whole("rings", rings, *SIZES)
    problem = pose(scene)
    if problem.dof != 2:
        raise OptionError(
            f"symmetry = {scene.symmetry!r} leaves {problem.dof} degrees of freedom: critical points are "
            "found for 2 (degree 6 with D1, degree 8 with D2)"
        )
    if scene.contact != "full":
        raise OptionError(
            f"contact = {scene.contact!r}: critical points are found with contact = 'full'"
        )
    search = _Search(scene, problem, rings)
    points = [*map(search.vertex, search.corners), *search.edges(), *search.interior()]
    search.warn_of_neighbours(points)
    points.sort(key=lambda p: rank(p.energy / problem.scale, p.fold_angles))
    pieces = parts(len(search.cells.wedge), search.cells.triangles, search.cells.extra_edges)
    euler = sum(piece.euler_characteristic for piece in pieces)
    return CriticalPoints(scene, tuple(points), euler, tuple(search.doubts))


@dataclass(frozen=True)
class StratumVertex:
    """A state that is a stratum by itself: a corner, an end of a handle, a flat folding, a singular state.

    x: [n].  links: its link at the radii of `links.RADII`; empty with a `reason` where it is not known.
    """

    x: np.ndarray
    links: tuple[Link, ...]
    reason: str = ""


@lru_cache(maxsize=32)
def stratum_vertices(scene: Scene, rings: int) -> tuple[StratumVertex, ...]:
    """Find the vertices of X, of a scene without springs (`chart.geometry`): where contacts meet, or edges end."""
    cells, problem = cells_of(scene, rings), pose(scene)
    count = len(cells.wedge)
    alone = ~np.isin(np.arange(count), cells.edges)
    alone[[v for path, *_ in border_paths(cells) for v in (path[0], path[-1])]] = True
    alone[[s.vertex for s in spots(count, cells.triangles, cells.extra_edges)]] = True
    x = cells.wedge[alone]
    thin = [line for line in trace_boundary(scene).lines if line.thin]

    def at(state: State) -> StratumVertex:
        ways = [way for line in thin for way in _ways(problem, line, state.x)]
        return StratumVertex(state.x, *_links(scene, state, ways))

    return tuple(at(State(problem, y, SETTLED)) for y in x[distinct(x, SETTLED)])


def _links(scene: Scene, state: State, handles: Sequence[Way]) -> tuple[tuple[Link, ...], str]:
    """Sample the links of a state; none with the reason where they are not known."""
    try:
        return tuple(link_of(scene, state, radius, handles) for radius in RADII), ""
    except ValueError as error:
        return (), str(error)


def _ways(problem: PatternProblem, line: BoundaryLine, x: np.ndarray) -> Iterator[Way]:
    """Go through the directions in which a handle leaves a state at one of its ends."""
    at = problem.reduce(line.fold_angles)
    for end, beside in ((0, 1), (-1, -2)):
        if np.abs(at[end] - x).max() <= SETTLED:
            yield at[beside] - at[end], line.rows(problem)


class _Search:
    """The search for the critical points of one energy; `doubts` are what it cannot decide, in words."""

    def __init__(self, scene: Scene, problem: PatternProblem, rings: int) -> None:
        self.scene, self.problem = geometry(scene), problem
        self.cells = cells_of(scene, rings)
        self.lines = trace_boundary(self.scene).lines
        self.corners = stratum_vertices(self.scene, rings)
        self.at_corners = np.array([v.x for v in self.corners]).reshape(-1, problem.size)
        self.doubts: list[str] = []
        self.along = np.zeros((0, problem.size))
        # the multiplier and curvature, scaled, from which they decide
        self.firm = FIRM * float((problem.parameters.stiffness / problem.multiplicity).min())

    def interior(self) -> list[CriticalPoint]:
        """Critical points at which nothing touches."""
        cells, problem = self.cells, self.problem
        lines = [problem.reduce(line.fold_angles[1:-1:4]) for line in self.lines]
        starts = np.concatenate([cells.wedge[::THINNED], *lines, self.along])
        # one of those that come to rest beside each other goes on
        x = approach(problem, problem.fold_limits.clip(starts))
        x = x[distinct(x, NEAR)] if len(x) else x
        # vertices at which closure loses rank: two circles of directions, or none
        tips = [v.x for v in self.corners if v.links and len(v.links[0].circles) != 1]
        known = np.zeros((0, problem.size))
        out = []
        for start in x:
            plane = settle(problem, start)
            # the strata of closed contacts are looked at by themselves
            if plane is None or plane.state.refused or _closed(plane.state):
                continue
            state = plane.state
            # Newton approaches a stationary flat state slowly and stops beside it: its vertex counts for it
            if any(np.abs(state.x - tip).max() <= RADII[-1] for tip in tips):
                continue
            if np.abs(known - state.x).max(axis=1).min(initial=np.inf) > SETTLED:
                known = np.concatenate([known, state.x[None]])
                out.append(self._interior(state, plane))
        return out

    def _interior(self, state: State, plane: Stratum) -> CriticalPoint:
        curvature = np.linalg.eigvalsh(plane.tangent.T @ plane.hessian @ plane.tangent)
        regular = np.abs(curvature).min() > self.firm
        if regular:  # Morse: a nondegenerate interior point of index k adds (-1)^k
            index = int((curvature < 0).sum())
            kind, how = KINDS[index], f"reduced Hessian, index {index}"
            return _point(plane, index, (-1) ** index, "interior", kind, (), (), how)
        contribution, kind, how = self.count_links(state.x, *_links(self.scene, state, ()))
        return _point(plane, None, contribution, "interior", kind, (), (), how)

    def edges(self) -> list[CriticalPoint]:
        """Critical points along the edges, handles included."""
        out: list[CriticalPoint] = []
        for line in self.lines:
            x = self.problem.reduce(line.fold_angles)
            ahead = np.gradient(x, line.s, axis=0, edge_order=2)
            pull = self.problem.parameters.torque(x)
            slope = np.einsum("kj,kj->k", pull, ahead)
            level = np.abs(slope) <= BALANCED * float(np.abs(pull).max())
            # a continuous dU/ds that changes sign has a zero in between
            for k in np.flatnonzero((slope[:-1] * slope[1:] <= 0) & ~(level[:-1] & level[1:])):
                point = self._on_edge(line, x[k], x[k + 1], slope[k : k + 2])
                out += [] if point is None else [point]
        return out

    def _on_edge(
        self, line: BoundaryLine, a: np.ndarray, b: np.ndarray, slope: np.ndarray
    ) -> CriticalPoint | None:
        """Find and judge the critical point between two points of an edge; None where it is known already."""
        rows = line.rows(self.problem)[:1]
        found = settle(self.problem, a + (b - a) * slope[0] / (slope[0] - slope[1]), rows)
        known = np.concatenate([self.along, self.at_corners])
        reach = 1.5 * float(np.abs(b - a).max()) + SETTLED
        if found is None or found.state.refused or np.abs(found.state.x - a).max() > reach:
            if np.abs(known - 0.5 * (a + b)).max(axis=1).min(initial=np.inf) > reach:
                name = line.contacts[0]
                where = in_degrees(a)
                self.doubts.append(f"dU/ds changes sign on '{name}' near {where}: no point found")
            return None
        state = found.state
        if np.abs(known - state.x).max(axis=1).min(initial=np.inf) <= SETTLED:
            return None
        self.along = np.concatenate([self.along, state.x[None]])
        return self._edge(found, line)

    def _edge(self, held: Stratum, line: BoundaryLine) -> CriticalPoint:
        state, row = held.state, held.contacts[0]
        curvature, push = held.stiffness, float(held.forces[0])
        index = int(curvature < 0) if abs(curvature) > self.firm else None
        part: Part = "handle" if line.thin else "boundary"
        # a handle is held from two sides: its multipliers are not unique
        moment = () if line.thin else (push * self.problem.scale / self.problem.weight(row),)
        by_formula = not line.thin and index is not None and abs(push) > self.firm
        kind: Kind
        if not by_formula:
            rows, ahead = line.rows(self.problem), held.tangent[:, 0] / self.problem.root
            ways = [(ahead, rows), (-ahead, rows)] if line.thin else []
            contribution, kind, how = self.count_links(state.x, *_links(self.scene, state, ways))
        elif (
            push < 0
        ):  # U falls into X, the lower link is one arc, chi = 1, and the point adds nothing
            contribution, kind = 0, "regular"
            how = f"multiplier < 0: not essential, index {index} along the edge"
        else:
            contribution, kind = 1 - 2 * int(curvature < 0), KINDS[int(curvature < 0)]
            how = f"multiplier > 0, index {index} along the edge"
        names = tuple(dict.fromkeys(map(self.problem.name, _closed(state)))) or line.contacts
        return _point(held, index, contribution, part, kind, names, moment, how)

    def vertex(self, vertex: StratumVertex) -> CriticalPoint:
        """Judge a vertex by its links."""
        problem = self.problem
        state = State(problem, vertex.x, SETTLED)
        rows = _closed(state)
        held = state.on(rows)
        found = held.multiplier_set
        multipliers: tuple[float, ...] = ()
        size = 1.0 + float(np.abs(state.gradient).max())
        if rows and found.residual <= STATIONARY * size and (found.smallest >= 0).all():
            weights = np.array([problem.weight(r) for r in rows])
            values = found.smallest * problem.scale / weights
            multipliers = tuple(np.where(np.abs(values) < ROUNDING, 0.0, values).tolist())
        contribution, kind, how = self.count_links(vertex.x, vertex.links, vertex.reason)
        smooth = bool(vertex.links) and all(
            len(link.circles) == 1 and link.pieces == 1 and not len(link.thin)
            for link in vertex.links
        )
        part: Part = "corner" if smooth else "singular"
        names = tuple(dict.fromkeys(map(problem.name, rows)))
        return _point(state.on(), None, contribution, part, kind, names, multipliers, how)

    def warn_of_neighbours(self, points: list[CriticalPoint]) -> None:
        """Record points so near to a vertex that the vertex's link may have counted them already."""
        for p in points:
            if p.stratum in ("interior", "boundary", "handle"):
                x = self.problem.reduce(np.array(p.fold_angles))
                if np.abs(self.at_corners - x).max(axis=1).min(initial=np.inf) <= RADII[0]:
                    self.doubts.append(f"{in_degrees(x)} lies inside the sampled link of a vertex")

    def count_links(
        self, x: np.ndarray, links: tuple[Link, ...], reason: str
    ) -> tuple[int, Kind, str]:
        """Return contribution, kind and how from the links of a state at several radii."""
        if not links:
            self.doubts.append(f"the link of {in_degrees(x)} is not known: {reason}")
            return 0, "undecided", "link not known"
        counts = [link.lower(self.problem.parameters) for link in links]
        chi, empty, whole = counts[-1]
        # 1 for a minimum (chi 0), -1 for a saddle (two lower arcs), 1 for a maximum (a whole circle has chi 0), 0 for
        # regular
        contribution = 1 - chi
        radii = " and ".join(f"{link.radius:g}" for link in links)
        if len(set(counts)) > 1:
            self.doubts.append(f"links of {in_degrees(x)} disagree between radii {radii}")
        how = f"sampled link at radii {radii} rad, {links[-1].pieces} pieces"
        if empty:
            return contribution, "minimum", how
        if contribution > 0:
            return contribution, "maximum" if whole else "pinch", how
        return contribution, "saddle" if contribution else "regular", how


def _closed(state: State) -> tuple[Contact, ...]:
    """Return the closed contacts of a state, one description for each."""
    found = state.contacts
    return tuple(dict.fromkeys((*found.base, *(r for o in found.branches for r in o[0]))))


def _point(
    held: Stratum,
    index: int | None,
    contribution: int,
    part: Part,
    kind: Kind,
    names: tuple[str, ...],
    multipliers: tuple[float, ...],
    how: str,
) -> CriticalPoint:
    """State a point; its residual is that of closure, contacts and, except at vertices, of stationarity."""
    state = held.state
    residual = max(state.residual, float(np.abs(held.openings).max(initial=0.0)))
    if part not in ("corner", "singular"):
        size = 1.0 + float(np.abs(state.gradient).max())
        residual = max(residual, float(np.abs(held.imbalance).max()) / size)
    phi = tuple((state.fold_angles + 0.0).tolist())
    what = (state.energy, part, kind, contribution, phi, names, multipliers, residual, how, index)
    return CriticalPoint(*what)


def in_degrees(x: np.ndarray) -> str:
    """Write the fold angles of the model's variables in degrees, for a doubt."""
    return "(" + ", ".join(f"{v:.3f}" for v in np.degrees(x)) + ") deg"
