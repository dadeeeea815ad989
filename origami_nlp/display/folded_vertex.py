"""A single vertex as a body that can be turned."""

from __future__ import annotations

import numpy as np

from origami_nlp.display.bodies import Body, Crease, FoldedBody
from origami_nlp.folding import fold_vertex
from origami_nlp.pattern import Vertex

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


def vertex_folded(vertex: Vertex, fold_angles: object, energy: float) -> FoldedBody:
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
    FoldedBody
        Corners as `folding.fold_vertex` has them, the apex at the origin.
    """
    from origami_nlp.display.pose import layer_offsets

    phi = np.asarray(fold_angles, dtype=float)
    creases, _ = fold_vertex(vertex, phi)
    normals = np.cross(creases, np.roll(creases, -1, axis=0))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    corners = np.vstack([np.zeros((1, 3)), creases])
    return FoldedBody(corners, phi, float(energy), layer_offsets(phi, normals))


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
        As `Keyframe.view`.
    """
    from origami_nlp.display.pose import pose_state

    phi = np.asarray(fold_angles, dtype=float)
    return rotation_onto(fold_vertex(vertex, phi)[0], pose_state(vertex, phi).creases)


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
