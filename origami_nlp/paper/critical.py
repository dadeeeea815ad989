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
from origami_nlp.kkt import State, Stratum, newton, project
from origami_nlp.numerics import (
    BALANCED,
    FIRM,
    FOLLOWED,
    NONZERO,
    RANK,
    SETTLED,
    STATIONARY,
    distinct,
    rank,
)
from origami_nlp.paper.links import RADII, Link, Way, link_of
from origami_nlp.paper.morse import ROUNDING, CriticalPoint, CriticalPoints, Kind, Part
from origami_nlp.pattern import Scene, as_scene
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.problem import Contact, Problem

KINDS: tuple[Kind, ...] = ("minimum", "saddle", "maximum")
"""Of a regular point, by its index."""
THINNED = 3
"""Of so many vertices of the mesh one is a start of Newton."""
RINGS, SIZES = 24, (8, 1025)
"""Rings of the mesh around the flat state, by default and at least and most."""

Judged = tuple[int, Kind, str]
"""What a point contributes, its kind, and how that was decided."""
LONGEST_STEP = 0.3
"""Newton steps are cut to this length [rad]: a start belongs to the critical points near it."""
MANY_STEPS = 15
"""Of Newton."""
DIFFERENCE = 1e-5
"""Step of the differences by which many states learn how closure bends [rad]."""
NEAR = 1e-3
"""Length of a last step [rad] from which one state at a time goes on."""


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
    search = _Search(scene, rings)
    points = [*map(search.vertex, search.corners), *search.edges(), *search.interior()]
    search.warn_of_neighbours(points)
    points.sort(key=lambda p: rank(p.energy / search.problem.scale, p.fold_angles))
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

    @property
    def smooth(self) -> bool:
        """Whether X is one sector beside it."""
        each = ((len(link.circles), link.pieces, len(link.thin)) for link in self.links)
        return set(each) == {(1, 1, 0)}


@lru_cache(maxsize=32)
def stratum_vertices(scene: Scene, rings: int) -> tuple[StratumVertex, ...]:
    """Find the vertices of X, of a scene without springs (`chart.geometry`): where contacts meet, or edges end."""
    cells, problem = cells_of(scene, rings), pose(scene)
    count = len(cells.wedge)
    alone = ~np.isin(np.arange(count), cells.edges)
    alone[[v for path, *_ in border_paths(cells) for v in (path[0], path[-1])]] = True
    alone[[s.vertex for s in spots(count, cells.triangles, cells.extra_edges)]] = True
    x = cells.wedge[alone]
    thin = [line for line in trace_boundary(scene) if line.thin]

    def at(y: np.ndarray) -> StratumVertex:
        ways = [way for line in thin for way in _ways(problem, line, y)]
        return _linked(scene, State(problem, y, SETTLED), ways)

    return tuple(map(at, x[distinct(x, SETTLED)]))


def _linked(scene: Scene, state: State, handles: Sequence[Way]) -> StratumVertex:
    """Sample the links of a state; none with the reason where they are not known."""
    try:
        links = tuple(link_of(scene, state, radius, handles) for radius in RADII)
    except ValueError as error:
        return StratumVertex(state.x, (), str(error))
    return StratumVertex(state.x, links)


def _ways(problem: PatternProblem, line: BoundaryLine, x: np.ndarray) -> Iterator[Way]:
    """Go through the directions in which a handle leaves a state at one of its ends."""
    at = problem.reduce(line.fold_angles)
    for end, beside in ((0, 1), (-1, -2)):
        if np.abs(at[end] - x).max() <= SETTLED:
            yield at[beside] - at[end], line.rows(problem)


class _Search:
    """The search for the critical points of one energy; `doubts` are what it cannot decide, in words."""

    def __init__(self, scene: Scene, rings: int) -> None:
        self.scene, self.cells, self.problem = geometry(scene), cells_of(scene, rings), pose(scene)
        self.lines = trace_boundary(self.scene)
        self.corners = stratum_vertices(self.scene, rings)
        self.doubts: list[str] = []
        # states that are known: at corners, and along edges
        self.known = np.array([v.x for v in self.corners]).reshape(-1, self.problem.size)
        # the multiplier and curvature, scaled, from which they decide
        least = (self.problem.parameters.stiffness / self.problem.multiplicity).min()
        self.firm = FIRM * float(least)

    def far(self, x: np.ndarray) -> float:
        """Return how far a state is from those that are known [rad]."""
        return float(np.abs(self.known - x).max(axis=1).min(initial=np.inf))

    def interior(self) -> Iterator[CriticalPoint]:
        """Critical points at which nothing touches."""
        problem, many = self.problem, len(self.corners)
        lines = [problem.reduce(line.fold_angles[1:-1:4]) for line in self.lines]
        starts = np.concatenate([self.cells.wedge[::THINNED], *lines, self.known[many:]])
        # one of those that come to rest beside each other goes on
        x = approach(problem, problem.fold_limits.clip(starts))
        # vertices at which closure loses rank: two circles of directions, or none
        tips = [v.x for v in self.corners if v.links and len(v.links[0].circles) != 1]
        self.known = np.zeros((0, problem.size))
        for start in x[distinct(x, NEAR)] if len(x) else x:
            plane = settle(problem, start)
            # the strata of closed contacts are looked at by themselves
            if plane is None or plane.state.refused or _closed(plane.state):
                continue
            # Newton approaches a stationary flat state slowly and stops beside it: its vertex counts for it
            if any(np.abs(plane.state.x - tip).max() <= RADII[-1] for tip in tips):
                continue
            if self.far(plane.state.x) > SETTLED:
                self.known = np.vstack([self.known, plane.state.x])
                yield self._interior(plane)

    def _interior(self, plane: Stratum) -> CriticalPoint:
        curvature = np.linalg.eigvalsh(plane.tangent.T @ plane.hessian @ plane.tangent)
        if np.abs(curvature).min() <= self.firm:
            judged = self.count_links(_linked(self.scene, plane.state, ()))
            return _point(plane, "interior", judged)
        # Morse: a nondegenerate interior point of index k adds (-1)^k
        index = int((curvature < 0).sum())
        how = f"reduced Hessian, index {index}"
        return _point(plane, "interior", ((-1) ** index, KINDS[index], how), index)

    def edges(self) -> Iterator[CriticalPoint]:
        """Critical points along the edges, handles included."""
        for line in self.lines:
            x = self.problem.reduce(line.fold_angles)
            ahead = np.gradient(x, line.s, axis=0, edge_order=2 if len(x) > 2 else 1)
            pull = self.problem.parameters.torque(x)
            slope = np.einsum("kj,kj->k", pull, ahead)
            level = np.abs(slope) <= BALANCED * float(np.abs(pull).max())
            # a continuous dU/ds that changes sign has a zero in between
            for k in np.flatnonzero((slope[:-1] * slope[1:] <= 0) & ~(level[:-1] & level[1:])):
                found = self._on_edge(line, x[k], x[k + 1], slope[k : k + 2])
                if found is not None:
                    self.known = np.vstack([self.known, found.state.x])
                    yield self._edge(found, line)

    def _on_edge(
        self, line: BoundaryLine, a: np.ndarray, b: np.ndarray, slope: np.ndarray
    ) -> Stratum | None:
        """Find the critical point between two points of an edge; None where it is known already."""
        start = a + (b - a) * slope[0] / (slope[0] - slope[1])
        found = settle(self.problem, start, line.rows(self.problem)[:1])
        reach = 1.5 * float(np.abs(b - a).max()) + SETTLED
        if found is None or found.state.refused or np.abs(found.state.x - a).max() > reach:
            if self.far(0.5 * (a + b)) > reach:
                where = f"'{line.contacts[0]}' near {in_degrees(a)}"
                self.doubts.append(f"dU/ds changes sign on {where}: no point found")
            return None
        return found if self.far(found.state.x) > SETTLED else None

    def _edge(self, held: Stratum, line: BoundaryLine) -> CriticalPoint:
        problem, row = self.problem, held.contacts[0]
        curvature, push = held.stiffness, float(held.forces[0])
        falls = int(curvature < 0)
        index = falls if abs(curvature) > self.firm else None
        if line.thin or index is None or abs(push) <= self.firm:
            rows, ahead = line.rows(problem), held.tangent[:, 0] / problem.root
            ways = [(ahead, rows), (-ahead, rows)] if line.thin else []
            judged = self.count_links(_linked(self.scene, held.state, ways))
        elif push < 0:  # U falls into X, the lower link is one arc, chi = 1, the point adds nothing
            how = f"multiplier < 0: not essential, index {index} along the edge"
            judged = 0, "regular", how
        else:
            how = f"multiplier > 0, index {index} along the edge"
            judged = 1 - 2 * falls, KINDS[falls], how
        # a handle is held from two sides: its multipliers are not unique
        moment = () if line.thin else (push * problem.scale / problem.weight(row),)
        names = tuple(dict.fromkeys(map(problem.name, _closed(held.state)))) or line.contacts
        part: Part = "handle" if line.thin else "boundary"
        return _point(held, part, judged, index, names, moment)

    def vertex(self, vertex: StratumVertex) -> CriticalPoint:
        """Judge a vertex by its links."""
        problem = self.problem
        state = State(problem, vertex.x, SETTLED)
        rows = _closed(state)
        found = state.on(rows).multiplier_set
        multipliers: tuple[float, ...] = ()
        size = 1.0 + float(np.abs(state.gradient).max())
        if rows and found.residual <= STATIONARY * size and (found.smallest >= 0).all():
            values = found.smallest * problem.scale / [problem.weight(r) for r in rows]
            multipliers = tuple(np.where(np.abs(values) < ROUNDING, 0.0, values).tolist())
        part: Part = "corner" if vertex.smooth else "singular"
        names = tuple(dict.fromkeys(map(problem.name, rows)))
        return _point(state.on(), part, self.count_links(vertex), None, names, multipliers)

    def warn_of_neighbours(self, points: list[CriticalPoint]) -> None:
        """Record points so near to a vertex that the vertex's link may have counted them already."""
        corners = np.array([v.x for v in self.corners])
        for p in points:
            if p.stratum in ("interior", "boundary", "handle") and len(corners):
                x = self.problem.reduce(np.array(p.fold_angles))
                if np.abs(corners - x).max(axis=1).min() <= RADII[0]:
                    self.doubts.append(f"{in_degrees(x)} lies inside the sampled link of a vertex")

    def count_links(self, at: StratumVertex) -> Judged:
        """Judge a state by its links at several radii."""
        if not at.links:
            self.doubts.append(f"the link of {in_degrees(at.x)} is not known: {at.reason}")
            return 0, "undecided", "link not known"
        counts = [link.lower(self.problem.parameters) for link in at.links]
        chi, empty, whole = counts[-1]
        # 1 for a minimum (chi 0), -1 for a saddle (two lower arcs), 1 for a maximum (a whole circle has chi 0), 0 for
        # regular
        adds = 1 - chi
        radii = " and ".join(f"{link.radius:g}" for link in at.links)
        if len(set(counts)) > 1:
            self.doubts.append(f"links of {in_degrees(at.x)} disagree between radii {radii}")
        how = f"sampled link at radii {radii} rad, {at.links[-1].pieces} pieces"
        if empty:
            return adds, "minimum", how
        if adds > 0:
            return adds, "maximum" if whole else "pinch", how
        return adds, "saddle" if adds else "regular", how


def _closed(state: State) -> tuple[Contact, ...]:
    """Return the closed contacts of a state, one description for each."""
    found = state.contacts
    return tuple(dict.fromkeys((*found.base, *(r for o in found.branches for r in o[0]))))


def _point(
    held: Stratum,
    part: Part,
    judged: Judged,
    index: int | None = None,
    names: tuple[str, ...] = (),
    multipliers: tuple[float, ...] = (),
) -> CriticalPoint:
    """State a point; its residual is that of closure, contacts and, except at vertices, of stationarity."""
    state, (contribution, kind, how) = held.state, judged
    residual = max(state.residual, float(np.abs(held.openings).max(initial=0.0)))
    if part not in ("corner", "singular"):
        size = 1.0 + float(np.abs(state.gradient).max())
        residual = max(residual, float(np.abs(held.imbalance).max()) / size)
    phi = tuple((state.fold_angles + 0.0).tolist())
    what = (state.energy, part, kind, contribution, phi, names, multipliers, residual, how, index)
    return CriticalPoint(*what)


def in_degrees(x: np.ndarray) -> str:
    """Write the fold angles of the model's variables in degrees, for a doubt."""
    return "(" + ", ".join(f"{v:z.3f}" for v in np.degrees(x)) + ") deg"


def settle(problem: Problem, x: np.ndarray, rows: tuple[Contact, ...] = ()) -> Stratum | None:
    """Return the critical point along the stratum of `rows` near x [n], admissible or not; None where there is none."""
    found = newton(problem, project(problem, x, rows)[0], rows)[0]
    if found is None:
        return None
    held = State(problem, found.x).on(rows)
    off = max(held.state.residual, float(np.abs(held.openings).max(initial=0.0)))
    return held if off <= FOLLOWED else None


def approach(problem: Problem, x: np.ndarray) -> np.ndarray:
    """Run Newton on closed states [K, n] of two degrees of freedom; return those that come to rest."""
    length = np.zeros(len(x))
    for _ in range(MANY_STEPS):
        jac = problem.constraints(x)[1]
        z = np.linalg.svd(jac)[2][:, -2:]  # [K, 2, n]
        pull = problem.parameters.torque(x)
        lam = np.einsum("kij,kj->ki", np.linalg.pinv(jac.swapaxes(1, 2), rcond=RANK), pull)
        hessian = np.einsum("kin,knm,kjm->kij", z, problem.parameters.hessian(x), z)
        for i in (0, 1):  # less lam . c''
            ahead, back = (
                problem.constraints(x + h * z[:, i])[1] for h in (DIFFERENCE, -DIFFERENCE)
            )
            bent = np.einsum("km,kmn,kjn->kj", lam, ahead - back, z) / (2 * DIFFERENCE)
            hessian[:, i] -= bent
        step = -np.einsum("kij,kjn,kn->ki", np.linalg.pinv(hessian, rcond=RANK), z, pull)
        length = np.linalg.norm(step, axis=1)
        step *= np.minimum(1.0, LONGEST_STEP / np.maximum(length, NONZERO))[:, None]
        x = project(problem, x + np.einsum("ki,kin->kn", step, z), steps=4)[0]
        inside = problem.fold_limits.inside(x, LONGEST_STEP).all(axis=1)
        x, length = x[inside], length[inside]
    return np.asarray(x[length <= NEAR])
