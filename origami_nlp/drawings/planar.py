"""Faces of a planar drawing: what is on the left of each side, and which edges lie outside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import groups


@dataclass(frozen=True, eq=False)
class Planar:
    """What a drawing encloses.

    Attributes
    ----------
    degree
        How many edges end at each vertex, [V].
    component
        Of each edge, numbered from 0, [E].
    faces
        Of each component, how many it encloses.
    outer
        Whether an edge lies on the outside of its component, [E].
    """

    degree: np.ndarray
    component: np.ndarray
    faces: np.ndarray
    outer: np.ndarray


def planar(points: np.ndarray, edges: np.ndarray) -> Planar:
    """Walk round all faces of a drawing whose edges meet at vertices only.

    Parameters
    ----------
    points
        [V, 2].
    edges
        [E, 2] vertices; twice the same counts once more in `degree` only.

    Returns
    -------
    Planar
        Its faces.

    Examples
    --------
    >>> import numpy as np
    >>> made = planar(np.array([[0, 0], [1, 0], [0, 1], [3, 3.0]]), np.array([[0, 1], [1, 2], [0, 2], [1, 3]]))
    >>> made.degree.tolist(), made.faces.tolist(), made.outer.all()
    ([2, 3, 2, 1], [1], np.True_)
    """
    once, first, back = np.unique(
        np.sort(edges, axis=1), axis=0, return_index=True, return_inverse=True
    )
    del first
    m = len(once)
    tail, head = np.concatenate([once, once[:, ::-1]]).T  # half-edge e runs along edge e % m
    d = points[head] - points[tail]
    order = np.lexsort((np.arctan2(d[:, 1], d[:, 0]), tail))
    place = np.empty(2 * m, int)
    place[order] = np.arange(2 * m)
    begin = np.searchsorted(tail[order], np.arange(len(points)))
    end = np.searchsorted(tail[order], np.arange(len(points)), side="right")
    # arriving by a half-edge one leaves by the first one clockwise from its reverse: the face stays on the left
    reverse = (np.arange(2 * m) + m) % (2 * m)
    here = place[reverse] - 1
    at = head
    here = np.where(here < begin[at], end[at] - 1, here)
    leaving = order[here]
    walk = groups(2 * m, np.column_stack([np.arange(2 * m), leaving]))
    vertex_group = groups(len(points), once)
    names, component = np.unique(vertex_group[once[:, 0]], return_inverse=True)
    middle = points.mean(axis=0) if len(points) else np.zeros(2)
    p, q = points[tail] - middle, points[head] - middle
    area = np.bincount(walk, weights=p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    # of each component the walk outside: of the least signed area
    of_walk = np.empty(len(area), int)
    of_walk[walk] = component[np.arange(2 * m) % m]
    least = np.lexsort((area, of_walk))
    outside = least[np.concatenate([[True], np.diff(of_walk[least]) > 0])] if len(area) else least
    is_outside = np.isin(walk, outside)
    faces = np.bincount(of_walk, minlength=len(names)) - 1
    outer = is_outside[:m] | is_outside[m:]
    degree = np.bincount(edges.ravel(), minlength=len(points))
    return Planar(degree, component[back.ravel()], faces, outer[back.ravel()])
