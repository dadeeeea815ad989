"""A single vertex as a body that can be turned: states, and paths of states."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from origami_nlp.folding import fold_vertex
from origami_nlp.pattern import Vertex
from origami_nlp.show.bodies import Body, Crease, Folded, Track

APEX = 0
"""Corner where creases meet; crease i ends at corner i + 1 (from 0), a unit away."""


def vertex_body(vertex: Vertex) -> Body:
    """Return a single vertex as a body: its apex, and the ends of its unit creases.

    Parameters
    ----------
    vertex
        The vertex.

    Returns
    -------
    Body
        Facet i lies between creases i and i + 1 (from 0).
    """
    n = vertex.degree
    facets = tuple((APEX, i + 1, (i + 1) % n + 1) for i in range(n))
    return Body(facets, tuple(Crease(APEX, i + 1, (i - 1) % n, i) for i in range(n)), sectors=True)


def vertex_folded(vertex: Vertex, fold_angles: object, energy: float) -> Folded:
    """Fold a vertex.

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        Of a state that closes, shape [N] [rad].
    energy
        Of it.

    Returns
    -------
    Folded
        Corners as `folding.fold_vertex` has them, the apex at the origin.
    """
    from origami_nlp.show.pose import layer_offsets

    phi = np.asarray(fold_angles, dtype=float)
    creases, _ = fold_vertex(vertex, phi)
    normals = np.cross(creases, np.roll(creases, -1, axis=0))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    corners = np.vstack([np.zeros((1, 3)), creases])
    return Folded(corners, phi, float(energy), layer_offsets(phi, normals))


def vertex_view(vertex: Vertex, fold_angles: object) -> np.ndarray:
    """Return the view of a state that `draw_state` takes.

    Parameters
    ----------
    vertex
        The vertex.
    fold_angles
        Of the state, shape [N] [rad].

    Returns
    -------
    numpy.ndarray
        As `Station.view`.
    """
    from origami_nlp.show.pose import pose_state

    phi = np.asarray(fold_angles, dtype=float)
    return rotation_onto(fold_vertex(vertex, phi)[0], pose_state(vertex, phi).creases)


def vertex_track(
    vertex: Vertex | Sequence[Vertex],
    title: str,
    fold_angles: object,
    energies: Iterable[float],
    *,
    start: int | None = None,
    end: int | None = None,
    parameter: object = None,
    label: str = "arclength in the fold angles [rad]",
) -> Track:
    """Return a path of states of a vertex.

    Parameters
    ----------
    vertex
        The vertex, or that of each state.
    title
        Its name.
    fold_angles
        Of the states, shape [M, N] [rad].
    energies
        Of them, M.
    start, end
        As in `Track`.
    parameter, label
        As in `Track`; by default the arclength.

    Returns
    -------
    Track
        The first state stands as `folding.fold_vertex` has it, each other one is turned as near as can be to the one
        before, so that the whole does not swing about the facet that `fold_vertex` holds.
    """
    phi = np.asarray(fold_angles, dtype=float)
    if parameter is None:
        steps = np.linalg.norm(np.diff(phi, axis=0), axis=1)
        parameter = np.concatenate([[0.0], np.cumsum(steps)])
    states: list[Folded] = []
    vertices = [vertex] * len(phi) if isinstance(vertex, Vertex) else vertex
    for one, row, energy in zip(vertices, phi, energies, strict=True):
        state = vertex_folded(one, row, energy)
        if states:
            turn = rotation_onto(state.corners, states[-1].corners)
            turned = (state.corners @ turn.T, state.shifts @ turn.T)
            state = Folded(turned[0], row, state.energy, turned[1])
        states.append(state)
    vertex, middle = vertices[len(phi) // 2], phi[len(phi) // 2]
    # the middle of the path is what is to be seen well; its own frame is that of the first state, turned along
    turn = rotation_onto(fold_vertex(vertex, middle)[0], states[len(phi) // 2].corners[1:])
    view = vertex_view(vertex, middle) @ turn.T
    return Track(title, np.asarray(parameter, float), label, tuple(states), view, start, end)


def rotation_onto(points: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Return the rotation R [3, 3] with points @ R.T as near as can be to `target` (Kabsch 1976).

    Parameters
    ----------
    points, target
        Shape [M, 3].

    Returns
    -------
    numpy.ndarray
        Orthogonal, of determinant 1.
    """
    u, _, vt = np.linalg.svd(target.T @ points)
    return u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
