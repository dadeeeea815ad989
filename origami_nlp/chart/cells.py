"""Which cells of the mesh of closed states are admissible: faces, then walls and corners that no face borders.

Walls divide the surface into faces; inside a face nothing touches, so one exact look at one state (`check_admissible`)
decides all of it.  Every edge on a wall, and every vertex, that borders no admissible face is looked at by itself,
layers and all: those that pass are states that exist only while facets touch (the paper's 1-handles, isolated flat
foldings).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from origami_nlp.chart.chart import Chart, admissible
from origami_nlp.chart.half_chain import CUT, SEAM, STRAIGHT, HalfChain
from origami_nlp.chart.mesh import (
    DoubleCover,
    MeshError,
    beside,
    edges_of,
    exact_states,
    has,
    mesh_cover,
    pulled,
    several,
)
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import CONTACT_TOL, OUTSIDE, groups
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import check_admissible, pose_paper

ATTEMPTS = (0, 1, 3, 5, 9)
"""Rings added where a mesh turns out too coarse."""
WITNESSES = 3
"""States of a face that are examined; they must agree."""
RADIUS = 1e-4
"""How close to handles other states are looked for, in base coordinates [rad]."""


@dataclass(frozen=True, repr=False)
class Cells(ShortRepr):
    """The admissible cells, as a complex of triangles, edges and vertices in the space of wedge fold angles.

    wedge [V, k], on [V]: vertices (those on the cut appear once for each sign of the inner fold angle they have).
    origin [V]: vertex of the `DoubleCover`.  triangles [F, 3]; extra_edges [E, 2]: edges that border no triangle.
    Vertices on no cell of higher dimension are among the vertices too.
    """

    cover: DoubleCover
    wedge: np.ndarray
    on: np.ndarray
    origin: np.ndarray
    triangles: np.ndarray
    extra_edges: np.ndarray

    @property
    def chart(self) -> Chart:
        """Of the scene."""
        return self.cover.chain.chart

    @cached_property
    def fold_angles(self) -> np.ndarray:
        """States, [V, N] [rad]."""
        return np.asarray(self.wedge[:, self.cover.chain.orbit])

    @cached_property
    def points(self) -> np.ndarray:
        """Coordinates in the scene's chart, [V, 2]."""
        return self.chart.points(self.fold_angles)

    @cached_property
    def branch(self) -> np.ndarray:
        """Branch of that chart, [V]."""
        return self.chart.branch_of(self.fold_angles)[0]

    @cached_property
    def edges(self) -> np.ndarray:
        """All edges, those of triangles and the others: vertices [E, 2], smaller first."""
        edges = np.vstack([edges_of(self.triangles)[0], np.sort(self.extra_edges, axis=1)])
        return np.unique(edges, axis=0)

    def contacts(self, walls: int) -> tuple[str, ...]:
        """Name walls, which are given as the bits of `on`."""
        return tuple(name for k, name in enumerate(self.cover.chain.walls) if walls >> k & 1)


def cells_of(scene: Scene, rings: int) -> Cells:
    """Return the admissible cells of a scene, of a mesh of so many rings or a few more where it is too coarse.

    Raises
    ------
    OptionError
        If the scene has not two symmetric degrees of freedom of a known kind, or does not ask for full contact.
    MeshError
        If the mesh is too coarse to decide.
    """
    return _cells_of(geometry(scene), rings)


@lru_cache(maxsize=32)
def _cells_of(scene: Scene, rings: int) -> Cells:
    chain = HalfChain(scene)
    # walls may pass a mesh of one size so closely that another one is needed
    for attempt in ATTEMPTS:
        try:
            cells = admissible_cells(mesh_cover(chain, rings + attempt))
            check_lower_dimensional(cells)
        except MeshError:
            if attempt == ATTEMPTS[-1]:
                raise
        else:
            break
    return cells


def geometry(scene: Scene) -> Scene:
    """Return a scene without what does not bound its states: springs, loads and its name."""
    n = scene.degree
    plain = replace(scene, stiffness=(1.0,) * n, rest_angles=(0.0,) * n, name=None, preload=())
    return replace(plain, laws=(), loads=(), symmetry=scene.group.name)


def admissible_cells(cover: DoubleCover) -> Cells:
    """Keep the cells of a surface whose states are admissible with full contact and symmetric layers.

    Vertices are numbered with the sign of the inner fold angle that they have, 3 v + sign + 1, where v is on the cut.
    """
    # side of each curved wall on which a triangle lies: the value farthest from 0 of its vertices, [F, walls]
    side = _farthest(cover.values[cover.triangles])
    good = _good_triangles(cover, side)
    inner = np.where(side[good, 1] < 0, 1, -1)[:, None]  # short of the cut from below: +pi
    kept = cover.triangles[good]
    kept = 3 * kept + 1 + np.where(has(cover.on, CUT)[kept], inner, 0)
    edges = _edges_alone(cover, kept)
    points = _vertices_alone(cover, np.concatenate([kept.ravel(), edges.ravel()]))
    every, number = np.unique(
        np.concatenate([kept.ravel(), edges.ravel(), points]), return_inverse=True
    )
    triangles, alone, _ = np.split(number, [kept.size, kept.size + edges.size])
    origin = every // 3
    wedge = _with_sign(cover.wedge[origin], every % 3 - 1)
    on = cover.on[origin]
    return Cells(cover, wedge, on, origin, triangles.reshape(-1, 3), alone.reshape(-1, 2))


def _with_sign(wedge: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """Set the inner fold angle of wedge states [K, k] to +pi or -pi where sign [K] is not 0."""
    out = np.array(wedge)
    out[:, -2] = np.where(sign == 0, out[:, -2], sign * math.pi)
    return out


def _farthest(values: np.ndarray) -> np.ndarray:
    """Return the value farthest from 0 along the second axis."""
    far = np.abs(values).argmax(axis=1)
    return np.take_along_axis(values, far[:, None], axis=1)[:, 0]


def _good_triangles(cover: DoubleCover, side: np.ndarray) -> np.ndarray:
    """Decide each face by examining states inside it, shape [F]."""
    chain, paper = cover.chain, pose_paper(cover.chain.scene.vertex)
    face = _faces(cover, side)
    wedge, clearance = _inner_states(cover, side)
    at = np.tile(face, len(wedge) // len(face))
    verdict = np.zeros(face.max() + 1, dtype=bool)
    order = np.lexsort((-clearance, at))
    for mine in np.split(order, np.flatnonzero(np.diff(at[order])) + 1):
        best = mine[:WITNESSES][clearance[mine[:WITNESSES]] > OUTSIDE]
        if not len(best):
            if side[mine[0] % len(face), 0] < 0:
                continue  # beyond the last mirror
            raise MeshError("a face of the space is thinner than rounding: use a larger size")
        # next to where two walls meet, facets cross by products of small angles
        said = {check_admissible(paper, x[chain.orbit]).admissible for x in wedge[best]}
        if len(said) == 2:
            raise MeshError("states of one face differ in admissibility: use a larger size")
        verdict[at[mine[0]]] = said.pop()
    return verdict[face]


def _inner_states(cover: DoubleCover, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """States inside triangles: middles of triangles, then of their edges, as wedge fold angles [4 F, k].

    Also how far each keeps from walls and seam [4 F]: negative where it is on another side than its triangle (edges are
    straight, walls are not).
    """
    chain, base = cover.chain, cover.base[cover.triangles]
    middles = [base.mean(axis=1), *(0.5 * (base[:, k] + base[:, k - 1]) for k in range(3))]
    leaf, sides = np.tile(_farthest(cover.leaf[cover.triangles]), 4), np.tile(side, (4, 1))
    point = np.concatenate(middles)
    wedge, walls = chain.points(point, leaf)
    far = (np.abs(sides) > math.pi / 2) & np.array(chain.wrapped)
    # the state must be on the side of the wall on which its triangle is
    inside = (sides[:, 0] > 0) & (far | (walls * sides > 0)).all(axis=1)
    room = np.minimum(np.abs(walls).min(axis=1), (math.pi - np.abs(wedge)).min(axis=1))
    return wedge, np.where(inside, np.minimum(room, chain.fold_margin(point)), -1.0)


def _faces(cover: DoubleCover, side: np.ndarray) -> np.ndarray:
    """Number the connected pieces into which the walls divide the surface, for each triangle."""
    pairs = beside(cover.triangles)
    one, two = side[pairs[:, 0]], side[pairs[:, 1]]
    # an angle modulo 2 pi: from +3 to -3 it passes pi, and not the wall at 0
    around = np.array(cover.chain.wrapped) & (np.abs(one) + np.abs(two) >= math.pi)
    apart = ((one * two < 0) & ~around).any(axis=1)
    return groups(len(cover.triangles), pairs[~apart])


def _edges_alone(cover: DoubleCover, kept: np.ndarray) -> np.ndarray:
    """Admissible edges on walls that border no kept triangle: numbers of their vertices with signs, [E, 2]."""
    edges, _ = edges_of(cover.triangles)
    common = cover.on[edges[:, 0]] & cover.on[edges[:, 1]]
    here = (common & ~(1 << SEAM)) != 0
    edges, common = edges[here], common[here]
    leaf = _farthest(cover.leaf[edges])
    # a straight border stays straight
    free = np.where(common & STRAIGHT == 0, common, 0)
    middle = pulled(cover.chain, cover.base[edges].mean(axis=1), leaf, free)
    wedge = exact_states(cover.chain, middle, leaf, common)
    used, cut = _named(edges_of(kept)[0]), has(common, CUT)
    found = []
    for s in (-1, 1):
        numbers = 3 * edges + 1 + np.where(has(cover.on[edges], CUT), s, 0)
        alone = cut | ((wedge[:, -2] >= 0) == (s > 0))
        alone &= ~np.isin(_named(numbers), used)
        alone[alone] = _stand_alone(cover, _with_sign(wedge, s * cut)[alone])
        found.append(numbers[alone])
    return np.concatenate(found)


def _named(edges: np.ndarray) -> np.ndarray:
    """One number for each edge, whatever its direction."""
    ends = np.sort(edges, axis=1)
    return ends[:, 0] * (1 << 31) + ends[:, 1]


def check_lower_dimensional(cells: Cells) -> None:
    """Look around every handle for states that nothing holds: there must be none.

    Raises
    ------
    MeshError
        If a handle has embedded states beside it: then it is the border of a surface that the mesh missed.
    """
    inner = np.setdiff1d(cells.extra_edges, cells.triangles)
    if len(cells.extra_edges) and not len(inner):
        raise MeshError("a handle is shorter than the mesh: use a larger size")
    cover, chain, origin = cells.cover, cells.cover.chain, cells.origin[inner]
    turn, paper = 2 * math.pi * np.arange(16) / 16, pose_paper(chain.scene.vertex)
    for side in (-1, 1):
        leaf = np.where(cover.leaf[origin] == 0, side, cover.leaf[origin])
        for step in RADIUS * np.stack([np.cos(turn), np.sin(turn)], axis=1):
            base = cover.base[origin] + step
            states = chain.points(base, leaf).wedge
            near = np.abs(states - cells.wedge[inner]).max(axis=1) < 0.1  # no jump from +pi to -pi
            near &= chain.fold_margin(base) > 0
            # not on the handle itself
            near &= (math.pi - np.abs(states)).min(axis=1) > CONTACT_TOL
            states = states[near][:, chain.orbit]
            states = states[admissible(chain.scene, states)]
            if any(check_admissible(paper, phi).admissible for phi in states):
                raise MeshError("a handle has a surface next to it: use a larger size")


def _stand_alone(cover: DoubleCover, wedge: np.ndarray) -> np.ndarray:
    """Return which states [K, k] are admissible by themselves, their layers ordered with the symmetry."""
    chain, paper = cover.chain, pose_paper(cover.chain.scene)
    good = (np.abs(wedge) <= math.pi + CONTACT_TOL).all(axis=1)
    phi = np.clip(wedge, -math.pi, math.pi)[:, chain.orbit]
    good[good] = admissible(chain.scene, phi[good])
    good[good] = [check_admissible(paper, one).admissible for one in phi[good]]
    return np.asarray(good)


def _vertices_alone(cover: DoubleCover, used: np.ndarray) -> np.ndarray:
    """Numbers of admissible vertices, with signs, on two walls or more that are on no other cell."""
    found = []
    for s in (-1, 0, 1):
        who = np.flatnonzero(several(cover.on) & (has(cover.on, CUT) == (s != 0)))
        who = who[~np.isin(3 * who + s + 1, used)]
        inside = _stand_alone(cover, _with_sign(cover.wedge[who], np.full(len(who), s)))
        found.append(3 * who[inside] + s + 1)
    return np.concatenate(found)
