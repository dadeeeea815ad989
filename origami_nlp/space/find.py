"""The analysis of the space X of a scene: mesh, walls and layers, then the pieces that hang together."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.chart import wedge_point
from origami_nlp.pattern import Scene, as_scene
from origami_nlp.space import topology
from origami_nlp.space.cells import Cells, admissible_cells, check_lower_dimensional
from origami_nlp.space.chain import HalfChain, chain_of
from origami_nlp.space.mesh import MeshError, mesh_cover
from origami_nlp.space.result import Component, Handle, LocalBranch, PinchPoint, Space, SpaceMesh

SIZE = 64
"""Default number of rings of the mesh around the flat state."""
SIZES = (8, 1025)
ATTEMPTS = (0, 1, 3, 5, 9)
"""Rings added where a mesh turns out too coarse."""


def find_space(scene: Scene, *, rings: int = SIZE) -> Space:
    """Analyse the admissible space of a scene with two symmetric degrees of freedom and full contact.

    Parameters
    ----------
    scene
        What is folded; its springs play no part.
    rings
        Rings of the mesh around the flat state, 8 to 1025; the mesh has about 8 rings^2 vertices.  A few more are
        taken where that mesh is too coarse (see `Space.size`).

    Returns
    -------
    Space
        Components, holes, pinch points and handles, with the mesh.

    Raises
    ------
    OptionError
        If the scene has no such space, or `rings` is out of range.
    MeshError
        If the mesh is too coarse to decide.

    Examples
    --------
    >>> import origami_nlp as o
    >>> space = o.find_space(o.examples.degree6("pi/3"), rings=8)
    >>> len(space.components), space.holes, space.euler_characteristic
    (1, 0, 1)
    """
    scene = as_scene(
        scene, "the admissible space", "find_motion follows a pattern of one degree of freedom"
    )
    size = check_whole("rings", rings, *SIZES)
    chain = chain_of(scene)
    # walls may pass a mesh of one size so closely that another one is needed
    for attempt in ATTEMPTS:
        try:
            cells = admissible_cells(mesh_cover(chain, size + attempt))
            check_lower_dimensional(cells)
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
        Component(
            part.dimension, part.euler, part.holes, part.closed_surfaces, _sample(chain, mesh, part)
        )
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


def _mesh(chain: HalfChain, cells: Cells) -> SpaceMesh:
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


def _chart(chain: HalfChain, cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and branch of each vertex in the paper's chart."""
    wedge = cells.wedge
    if chain.kind == "degree6":
        return wedge[:, 1:3].copy(), np.zeros(len(wedge), dtype=int)
    elevation = cells.cover.base[cells.origin, 0]
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


def _sample(
    chain: HalfChain, mesh: SpaceMesh, part: topology.ComplexComponent
) -> tuple[float, ...]:
    """The state of a component that keeps farthest from fold limits and from the flat state."""
    wedge = mesh.wedge[part.vertices]
    # any state of the component would do: one far from contacts and from flat can be distinguished in a picture
    room = np.minimum(chain.limits.room(wedge).min(axis=1), np.abs(wedge).max(axis=1))
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
        branches.append(LocalBranch(dimension, tuple(mesh.fold_angles[fewest].tolist())))
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
