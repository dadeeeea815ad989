"""The space X of all symmetric states that contact admits: components, holes, pinch points, handles.

X lies in the space of wedge fold angles, where phi = +pi and phi = -pi are different points; the paper's
coordinates are only one of its charts.  A point of X is a limit of embedded states (with a symmetric order of
touching layers).  X is made of surfaces, of handles (arcs of states that exist only while creases stay closed) and of
isolated states; surfaces can touch in single points (pinch points), the flat state above all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type, check_whole
from origami_nlp.chart import wedge_point
from origami_nlp.pattern import Scene
from origami_nlp.space import topology
from origami_nlp.space.cells import Cells, admissible_cells, check_thin
from origami_nlp.space.chain import Chain, chain_of
from origami_nlp.space.mesh import SEAM, MeshError, mesh_sheets

SIZE = 64
"""Default number of rings of the mesh around the flat state."""
SIZES = (8, 1025)
ATTEMPTS = (0, 1, 3, 5, 9)
"""Rings added where a mesh turns out too coarse."""
SAME_POINT = 1e-6
"""Points [rad] that are closer are one when the picture in the paper's chart is looked at."""
NEARBY = 0.5
"""Families over one point of the chart hang together over a disc of this radius [rad] around it."""


@dataclass(frozen=True)
class SpaceMesh:
    """X as a complex; vertices on contacts are exact states (rounding).

    fold_angles [V, N], wedge [V, k]: states [rad].  triangles [F, 3].  edges [E, 2]: all of them, handles included.
    chart [V, 2], branch [V]: coordinates and branch of `model.chart.chart_of(scene)`.
    on [V]: bit mask of the walls (`walls`: their names) that pass through a vertex.
    extra_edges [H, 2]: the edges of handles, which border no triangle.
    """

    fold_angles: np.ndarray = field(repr=False)
    wedge: np.ndarray = field(repr=False)
    triangles: np.ndarray = field(repr=False)
    edges: np.ndarray = field(repr=False)
    chart: np.ndarray = field(repr=False)
    branch: np.ndarray = field(repr=False)
    on: np.ndarray = field(repr=False)
    walls: tuple[str, ...]
    extra_edges: np.ndarray = field(repr=False)

    def contacts(self, vertex: int) -> tuple[str, ...]:
        """Name the contacts that are closed at a vertex."""
        return tuple(name for k, name in enumerate(self.walls) if self.on[vertex] >> k & 1)

    def signed_contacts(self, vertex: int) -> tuple[str, ...]:
        """Name the contacts that are closed at a vertex, with the sign of fold angles at +-pi."""
        names = []
        for name in self.contacts(vertex):
            if name.startswith("phi_"):
                crease = int(name.removeprefix("phi_").split(" ")[0])
                name = name.replace("+-", "+" if self.fold_angles[vertex, crease - 1] > 0 else "-")
            names.append(name)
        return tuple(sorted(names))


@dataclass(frozen=True)
class Component:
    """A connected component of X.

    dimension: of its largest stratum.  euler_characteristic, holes (first Betti number), closed_surfaces (second).
    fold_angles: all N fold angles of one of its states, well inside.
    """

    dimension: int
    euler_characteristic: int
    holes: int
    closed_surfaces: int
    fold_angles: tuple[float, ...]


@dataclass(frozen=True)
class PinchPoint:
    """A state without which its neighbourhood in X falls apart.

    kind: ``"pinch point"`` (surfaces touch), ``"handle end"`` (a handle meets a surface) or ``"handle junction"``.
    branches: dimension of each branch and a state close by on it.  vertex: of the mesh.
    """

    kind: str
    fold_angles: tuple[float, ...]
    branches: tuple[tuple[int, tuple[float, ...]], ...]
    contacts: tuple[str, ...]
    vertex: int


@dataclass(frozen=True)
class Handle:
    """An arc of states around which there are no others: they exist only while `contacts` stay closed.

    path: vertices of the mesh, from end to end.  length: in the space of wedge fold angles [rad].
    ends: what each end is (``"free"`` or the kind of the pinch point there).
    """

    contacts: tuple[str, ...]
    path: np.ndarray = field(repr=False)
    fold_angles: np.ndarray = field(repr=False)
    length: float
    ends: tuple[str, str]


@dataclass(frozen=True)
class Space:
    """The admissible space of a scene; see the module.

    holes: first Betti number.  euler_characteristic: V - E + F.  size: rings of the mesh it was computed with.
    """

    scene: Scene
    size: int
    components: tuple[Component, ...]
    holes: int
    pinch_points: tuple[PinchPoint, ...]
    handles: tuple[Handle, ...]
    euler_characteristic: int
    mesh: SpaceMesh

    @property
    def signature(self) -> tuple[int, ...]:
        """(components, holes, Euler characteristic, pinch points, handle ends and junctions, handles)."""
        kinds = [p.kind for p in self.pinch_points]
        pinch = kinds.count("pinch point")
        counts = (len(self.components), self.holes, self.euler_characteristic)
        return (*counts, pinch, len(kinds) - pinch, len(self.handles))

    @property
    def corners(self) -> tuple[tuple[tuple[str, ...], int], ...]:
        """States of X where two contacts or more close, by their contacts, with how many vertices have them."""
        counts: dict[tuple[str, ...], int] = {}
        mesh = self.mesh
        for v in np.flatnonzero(_several(mesh.on)).tolist():
            key = mesh.signed_contacts(v)
            counts[key] = counts.get(key, 0) + 1
        return tuple(sorted(counts.items()))

    @property
    def picture_joins(
        self,
    ) -> tuple[tuple[tuple[float, float], tuple[tuple[float, ...], ...]], ...]:
        """Points of the paper's chart where states that are apart in X are drawn on top of each other.

        For each such point: its coordinates, and one state [N] of each separate set of states over it.
        """
        return _picture_joins(self.mesh)

    @property
    def picture_holes(self) -> int:
        """Loops (first Betti number) of the picture of X in the paper's chart, where states drawn at one point are one.

        Families over one point are arcs (contractible), so each join of n separate sets lowers the Euler
        characteristic by n - 1; a picture in the plane encloses no volume.
        """
        joins = [len(states) - 1 for _, states in self.picture_joins]
        return _picture_components(self.mesh) - (self.euler_characteristic - sum(joins))

    def to_dict(self) -> dict[str, Any]:
        """JSON-able summary (without the mesh)."""
        return {
            "schema": "origami-nlp/space/1",
            "scene": self.scene.name,
            "size": self.size,
            "components": [
                {
                    "dimension": c.dimension,
                    "euler_characteristic": c.euler_characteristic,
                    "holes": c.holes,
                    "closed_surfaces": c.closed_surfaces,
                    "fold_angles": list(c.fold_angles),
                }
                for c in self.components
            ],
            "holes": self.holes,
            "euler_characteristic": self.euler_characteristic,
            "pinch_points": [
                {
                    "kind": p.kind,
                    "fold_angles": list(p.fold_angles),
                    "contacts": list(p.contacts),
                    "branches": [
                        {"dimension": d, "fold_angles": list(phi)} for d, phi in p.branches
                    ],
                }
                for p in self.pinch_points
            ],
            "handles": [
                {
                    "contacts": list(h.contacts),
                    "length": h.length,
                    "ends": list(h.ends),
                    "fold_angles": h.fold_angles.tolist(),
                }
                for h in self.handles
            ],
        }


def analyse_space(scene: Scene, size: int = SIZE) -> Space:
    """Analyse the admissible space of a scene with two symmetric freedoms and full contact.

    Parameters
    ----------
    size
        Rings of the mesh around the flat state, 8 to 1025; the mesh has about 8 size^2 vertices.  A few more are
        taken where that mesh is too coarse (`Space.size` tells).

    Raises
    ------
    OptionError
        If the scene has no such space, or `size` is out of range.
    MeshError
        If the mesh is too coarse to decide.
    """
    check_type("scene", scene, Scene)
    size = check_whole("size", size, *SIZES)
    chain = chain_of(scene)
    for attempt in ATTEMPTS:
        try:
            cells = admissible_cells(mesh_sheets(chain, size + attempt))
            check_thin(cells)
        except MeshError:
            if attempt == ATTEMPTS[-1]:
                raise
            continue
        size += attempt
        break
    count = len(cells.wedge)
    pieces = topology.parts(count, cells.triangles, cells.extra_edges)
    mesh = _mesh(chain, cells)
    components = tuple(
        Component(part.dimension, part.euler, part.holes, part.closed_surfaces, _sample(mesh, part))
        for part in pieces
    )
    pinch = tuple(_pinch_point(mesh, spot) for spot in _spots(cells))
    kinds = {p.vertex: p.kind for p in pinch}
    arcs = tuple(
        _handle(mesh, path, kinds)
        for path in topology.handles(count, cells.triangles, cells.extra_edges)
    )
    holes = sum(c.holes for c in components)
    euler = sum(c.euler_characteristic for c in components)
    return Space(scene, size, components, holes, pinch, arcs, euler, mesh)


def _mesh(chain: Chain, cells: Cells) -> SpaceMesh:
    edges = topology.all_edges(cells.triangles, cells.extra_edges)
    chart, branch = _chart(chain, cells)
    return SpaceMesh(
        cells.wedge[:, chain.orbit],
        cells.wedge,
        cells.triangles,
        edges,
        chart,
        branch,
        cells.on,
        chain.walls,
        cells.extra_edges,
    )


def _chart(chain: Chain, cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and branch of each vertex in the paper's chart."""
    wedge = cells.wedge
    if chain.kind == "degree6":
        return wedge[:, 1:3].copy(), np.zeros(len(wedge), dtype=int)
    elevation = cells.sheets.base[cells.origin, 0]
    chart = np.stack([wedge[:, 1], elevation], axis=1)
    misfit = []
    for sign in (1, -1):
        value = wedge_point(chain.scene, elevation, wedge[:, 1], sign).value
        error = np.abs(value - wedge[:, [0, 2]]).max(axis=1)
        misfit.append(np.where(np.isfinite(error), error, 10.0))
    branch = np.where(misfit[1] < misfit[0], 1, 0)
    if (
        chain.scene.group.order == 2
    ):  # each side of the flat state has one branch: `closed_forms.wedge3`
        branch = np.where(elevation > 0, 1, branch)
        branch = np.where(elevation < 0, 0, branch)
    return chart, branch


def _places(mesh: SpaceMesh) -> np.ndarray:
    """Number of the chart point (branches apart) of each vertex."""
    return _groups(np.column_stack([mesh.chart, 10.0 * mesh.branch]))


def _groups(points: np.ndarray) -> np.ndarray:
    """Number the groups of points [V, d] that coincide to `SAME_POINT`."""
    from scipy.spatial import cKDTree

    return topology.label(
        len(points), cKDTree(points).query_pairs(SAME_POINT, output_type="ndarray")
    )


def _picture_joins(
    mesh: SpaceMesh,
) -> tuple[tuple[tuple[float, float], tuple[tuple[float, ...], ...]], ...]:
    """Chart points with states that X does not connect over the disc of radius `NEARBY` around the point."""
    place = _places(mesh)
    low, high = np.full((2, place.max() + 1, mesh.wedge.shape[1]), -math.inf)
    low = -low
    np.minimum.at(low, place, mesh.wedge)
    np.maximum.at(high, place, mesh.wedge)
    found = []
    for k in np.flatnonzero((high - low).max(axis=1) > 1e-3):
        over = np.flatnonzero(place == k)
        point = mesh.chart[over[0]]
        near = np.linalg.norm(mesh.chart - point, axis=1) < NEARBY
        edges = mesh.edges[near[mesh.edges].all(axis=1)]
        piece = topology.label(len(place), edges)[over]
        first = over[np.unique(piece, return_index=True)[1]]
        if len(first) > 1:
            states = tuple(tuple(mesh.fold_angles[v].tolist()) for v in first)
            found.append(((float(point[0]), float(point[1])), states))
    return tuple(found)


def _picture_components(mesh: SpaceMesh) -> int:
    place = _places(mesh)
    joined = place[mesh.edges]
    return int(topology.label(int(place.max()) + 1, joined).max()) + 1


def _several(on: np.ndarray) -> np.ndarray:
    """Where two walls or more are closed (the seam of the sheets is none)."""
    walls = on & ~(1 << SEAM)
    return (walls & (walls - 1)) != 0


def _sample(mesh: SpaceMesh, part: topology.Part) -> tuple[float, ...]:
    """The state of a component that keeps farthest from phi = +-pi and from the flat state."""
    wedge = mesh.wedge[part.vertices]
    room = np.minimum(math.pi - np.abs(wedge).max(axis=1), np.abs(wedge).max(axis=1))
    free = mesh.on[part.vertices] == 0
    best = part.vertices[np.argmax(np.where(free, room, room - 2 * math.pi))]
    return tuple(mesh.fold_angles[best].tolist())


def _spots(cells: Cells) -> list[topology.Spot]:
    return topology.spots(len(cells.wedge), cells.triangles, cells.extra_edges)


def _pinch_point(mesh: SpaceMesh, spot: topology.Spot) -> PinchPoint:
    dimensions = spot.dimensions
    if dimensions.count(2) >= 2:
        kind = "pinch point"
    elif 2 in dimensions:
        kind = "handle end"
    else:
        kind = "handle junction"
    branches = []
    for dimension, around in spot.branches:
        # the neighbour on fewest contacts, in the middle of the branch
        fewest = around[np.argmin([int(mesh.on[v]).bit_count() for v in around])]
        branches.append((dimension, tuple(mesh.fold_angles[fewest].tolist())))
    v = spot.vertex
    phi = tuple(mesh.fold_angles[v].tolist())
    return PinchPoint(kind, phi, tuple(branches), mesh.contacts(v), v)


def _handle(mesh: SpaceMesh, path: np.ndarray, kinds: dict[int, str]) -> Handle:
    common = int(np.bitwise_and.reduce(mesh.on[path]))
    contacts = tuple(name for k, name in enumerate(mesh.walls) if common >> k & 1)
    length = float(np.linalg.norm(np.diff(mesh.wedge[path], axis=0), axis=1).sum())
    ends = tuple(kinds.get(int(v), "free") for v in (path[0], path[-1]))
    if path[0] == path[-1]:
        ends = ("loop", "loop")
    return Handle(contacts, path, mesh.fold_angles[path], length, (ends[0], ends[1]))


__all__ = [
    "Component",
    "Handle",
    "PinchPoint",
    "Space",
    "SpaceMesh",
    "analyse_space",
]
