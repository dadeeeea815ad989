"""The pieces of the admissible set X of a scene with two symmetric degrees of freedom: faces, edges, vertices.

They depend on sector angles, symmetry, contact and stops only, not on stiffness and rest angles, and are found once for
all energies on the same geometry.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from origami_nlp.critical.edges import Edge, drawn, trace_edges
from origami_nlp.critical.link import RADII, Link, closed_rows, link_of
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSURE_TOL, FOLLOWED, OUTSIDE, RANK, SETTLED, distinct
from origami_nlp.pattern import Limits, Scene, Vertex
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states import list_flat_folded
from origami_nlp.problem import Model, Problem

FACE_SAMPLES = 8192
"""Random states that are projected onto closure; those in X are spread over its faces."""
CORNER_SEEDS = 24
"""Random states projected onto each pair of contacts."""
LOOSE = 1e-4
"""Singular values below this share of the largest do not move a vertex: contacts and closure are dependent there."""


@dataclass(frozen=True)
class StratumVertex:
    """A state that is a stratum by itself: a corner, an end of a handle, a flat folding, a singular state.

    x: [n].  links: its link at the radii of `link.RADII`; empty with a `reason` where it is not known.
    """

    x: np.ndarray
    links: tuple[Link, ...]
    reason: str = ""


@dataclass(frozen=True)
class StratifiedSet:
    """Faces as a cloud of states [S, n] in X, edges and vertices of X.

    sides: for each edge the sign of its contact's opening inside X; 0 where X is not one half-plane beside the
    edge, as on handles.
    """

    model: Model
    faces: np.ndarray
    edges: tuple[Edge, ...]
    sides: tuple[int, ...]
    vertices: tuple[StratumVertex, ...]


def strata_of(scene: Scene, *, samples: int = FACE_SAMPLES, seed: int = 0) -> StratifiedSet:
    """Return the strata of X; scenes that differ in stiffness and rest angles share them.

    Raises
    ------
    OptionError
        If the scene has not two symmetric degrees of freedom, or its contact is not ``"full"``: X is not compact
        without contact, and its boundary is another one with fold limits only.
    """
    model = Model(scene)
    if model.dof != 2:
        raise OptionError(
            f"symmetry = {scene.symmetry!r} leaves {model.dof} degrees of freedom: critical points are "
            "found for 2 (degree 6 with D1, degree 8 with D2)"
        )
    if scene.contact != "full":
        raise OptionError(
            f"contact = {scene.contact!r}: critical points are found with contact = 'full'"
        )
    return _strata(scene.vertex, scene.group.name, scene.mirror, scene.limits, samples, seed)


@lru_cache(maxsize=32)
def _strata(
    vertex: Vertex, symmetry: str, mirror: int | None, limits: Limits, samples: int, seed: int
) -> StratifiedSet:
    """Find the strata with springs that have the symmetry of the vertex: all equal."""
    n = vertex.degree
    model = Model(Scene(vertex, (1.0,) * n, (0.0,) * n, symmetry, "full", mirror, limits=limits))
    rng = np.random.default_rng(seed)
    cloud, residual = project(model, drawn(model, rng, samples))
    cloud = cloud[(residual <= CLOSURE_TOL) & model.admissible(cloud)]
    edges = trace_edges(model, rng)
    ends = [x for edge in edges if not edge.loop for x in (edge.x[0], edge.x[-1])]
    found = [*list_flat_folded(pose(model.scene)).states, *_corners(model, rng), *ends]
    states = np.array([_settled(State(model, x, SETTLED)) for x in found]).reshape(-1, model.size)
    states = states[distinct(states, SETTLED)]
    keep = [at for at in (State(model, x) for x in states) if not at.refused]
    sides = tuple(_side(model, edge) for edge in edges)
    return StratifiedSet(model, cloud, edges, sides, tuple(_vertex(state) for state in keep))


def _settled(state: State) -> np.ndarray:
    """Close a vertex to rounding, with its fold limits held; contacts and closure may be dependent there."""
    x, rows = state.x, tuple(row for row in closed_rows(state) if row.is_limit)
    y, residual = project(state.problem, x[None], rows, steps=6, dependent=LOOSE)
    return y[0] if residual[0] <= FOLLOWED and np.abs(y[0] - x).max() <= SETTLED else x


def _side(model: Problem, edge: Edge) -> int:
    """Return the sign of the contact's opening in X beside the middle of an edge, 0 if X is on neither or both."""
    circles = link_of(State(model, edge.x[len(edge.x) // 2]), RADII[-1], 24).circles
    if len(circles) != 1:
        return 0
    values = model.local(circles[0].x).openings((edge.row,))[0][:, 0]
    inside = circles[0].inside
    # both signs: a slit, with X on either side; none: a handle
    signs = np.unique(np.sign(values[inside & (np.abs(values) > OUTSIDE)]))
    return int(signs[0]) if len(signs) == 1 else 0


def _vertex(state: State) -> StratumVertex:
    """Look at the link of a vertex."""
    try:
        return StratumVertex(state.x, tuple(link_of(state, radius) for radius in RADII))
    except ValueError as error:
        return StratumVertex(state.x, (), str(error))


def _corners(model: Problem, rng: np.random.Generator) -> list[np.ndarray]:
    """Return the admissible states at which two contacts close whose gradients and closure's are independent."""
    corners: list[np.ndarray] = []
    for pair in itertools.combinations((*model.limits, *model.gaps), 2):
        if pair[0].is_limit and pair[1].is_limit and pair[0].index == pair[1].index:
            continue
        x, residual = project(model, drawn(model, rng, CORNER_SEEDS), pair)
        # Newton onto closure and two contacts: isolated where all gradients are independent
        x = x[(residual <= FOLLOWED) & model.admissible(x)]
        if not len(x):
            continue
        x = x[distinct(x, SETTLED)]
        _, jac = model.constraints(x, pair)
        corners += list(x[np.linalg.svd(jac, compute_uv=False)[:, -1] > RANK])
    return corners
