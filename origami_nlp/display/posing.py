"""What puts the states of a vertex or a pattern into space, and paths of states one after the other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.display.bodies import Body, Crease, FoldedBody, Trajectory
from origami_nlp.display.folded_pattern import pattern_poser
from origami_nlp.folding import fold_vertex
from origami_nlp.pattern import Pattern, Scene, Vertex


class Poser:
    """What puts states into space, and says from where they are seen.

    Parameters
    ----------
    origami
        A vertex, alone or with its springs, or a pattern.

    Attributes
    ----------
    body
        What is folded.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.display import Poser
    >>> [len(Poser(one).body.facets) for one in (o.examples.miura("pi/3"), o.examples.pattern("miura", 2, 3))]
    [4, 6]
    """

    def __init__(self, origami: Scene | Vertex | Pattern) -> None:
        if isinstance(origami, Pattern):
            self.body, self._fold, self._view = pattern_poser(origami)
            return
        vertex = origami.vertex if isinstance(origami, Scene) else origami
        self.body = vertex_body(vertex)
        self._fold = lambda phi, energy: vertex_folded(vertex, phi, energy)
        self._view = lambda phi: vertex_view(vertex, phi)

    def folded(self, fold_angles: object, energy: float) -> FoldedBody:
        """Put a state into space.

        Parameters
        ----------
        fold_angles
            Of a state that closes, shape [N] [rad].
        energy
            Of it.

        Returns
        -------
        FoldedBody
            The state.
        """
        return self._fold(np.asarray(fold_angles, float), float(energy))

    def view(self, fold_angles: object) -> np.ndarray:
        """Return from where pictures show a state, as `Keyframe.view`.

        Parameters
        ----------
        fold_angles
            Of the state, shape [N] [rad].

        Returns
        -------
        numpy.ndarray
            Rows: right, up, towards the viewer.
        """
        return self._view(np.asarray(fold_angles, float))

    def track(
        self,
        title: str,
        fold_angles: object,
        energies: Sequence[float] | np.ndarray,
        *,
        start: int | None = None,
        end: int | None = None,
        parameter: object = None,
        label: str = "arclength in the fold angles [rad]",
    ) -> Trajectory:
        """Return a path of states.

        Parameters
        ----------
        title
            Its name.
        fold_angles
            Of the states, shape [M, N] [rad].
        energies
            Of them, M.
        start, end
            As in `Trajectory`.
        parameter, label
            As in `Trajectory`; by default the arclength.

        Returns
        -------
        Trajectory
            As `join_states` makes it.
        """
        phi = np.asarray(fold_angles, float)
        states = [self.folded(row, e) for row, e in zip(phi, energies, strict=True)]
        if parameter is None:
            steps = np.linalg.norm(np.diff(phi, axis=0), axis=1)
            parameter = np.concatenate([[0.0], np.cumsum(steps)])
        return join_states(
            title, states, self.view(phi[len(phi) // 2]), parameter, label, start, end
        )


def join_states(
    title: str,
    states: Sequence[FoldedBody],
    view: np.ndarray,
    parameter: object,
    label: str,
    start: int | None = None,
    end: int | None = None,
) -> Trajectory:
    """Return states as a path that does not swing about what is held where each stands by itself.

    Parameters
    ----------
    title
        Its name.
    states
        Each as it stands by itself.
    view
        Of the one in the middle.
    parameter, label, start, end
        As in `Trajectory`.

    Returns
    -------
    Trajectory
        The first state stands as it does by itself, each other one is turned as near as can be to the one before.
    """
    joined = list(states[:1])
    for state in states[1:]:
        turn = rotation_onto(state.corners, joined[-1].corners)
        corners, shifts = state.corners @ turn.T, state.shifts @ turn.T
        joined.append(FoldedBody(corners, state.fold_angles, state.energy, shifts))
    # the middle of the path is what is to be seen well; its own frame is that of the first state, turned along
    k = len(states) // 2
    turn = rotation_onto(states[k].corners, joined[k].corners)
    return Trajectory(
        title, np.asarray(parameter, float), label, tuple(joined), view @ turn.T, start, end
    )


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
