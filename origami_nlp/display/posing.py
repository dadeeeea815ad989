"""What puts the states of a vertex or a pattern into space, and paths of states one after the other."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.display.bodies import Body, Crease, FoldedBody, Trajectory
from origami_nlp.display.papers import apex_of, area_of, paper_of, pattern_view
from origami_nlp.pattern import Pattern, Scene, Vertex
from origami_nlp.pattern_problem import PatternCrossings


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
        pattern = paper_of(origami)
        # corner of a single vertex, which stays where it is
        self._apex = apex_of(pattern)
        self._crease_of = np.arange(pattern.creases)
        if pattern.cell:
            pattern, self._crease_of = pattern.cell.tiles
        self._crossings = PatternCrossings(pattern)
        parts = [tuple(dict.fromkeys(piece)) for piece in self._crossings.pieces.tolist()]
        left = {(q[i - 1], v): k for k, q in enumerate(parts) for i, v in enumerate(q)}
        creases = tuple(Crease(a, b, left[b, a], left[a, b]) for a, b in pattern.ends.tolist())
        self.body = Body(tuple(parts), creases)
        # lines are as wide as for a vertex with creases of length 1
        mean = pattern.lengths.mean() if pattern.creases else self._crossings.size
        self._scale = 1.0 / float(mean)

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
            The state; a single vertex is at the origin.
        """
        phi = np.asarray(fold_angles, float)[self._crease_of]
        x = np.nan_to_num(self._crossings.poses.corners(phi))
        shifts = np.zeros((len(self.body.facets), 3))
        middle = x[self._crossings.pieces.ravel()].mean(axis=0)
        if self._apex is not None:
            middle = x[self._apex]
            normals = np.array([area_of(c) for c in self._crossings.poses.polygons(phi)])
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            shifts = _layer_offsets(phi, normals)[self._crossings.polygon]
        return FoldedBody((x - middle) * self._scale, phi, float(energy), shifts)

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
        phi = np.asarray(fold_angles, float)[self._crease_of]
        return pattern_view(self._crossings.poses.polygons(phi))

    def track(
        self,
        title: str,
        fold_angles: object,
        energies: Sequence[float] | np.ndarray,
        *,
        start: int | None = None,
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
        start
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
        return join_states(title, states, self.view(phi[len(phi) // 2]), parameter, label, start)


def join_states(
    title: str,
    states: Sequence[FoldedBody],
    view: np.ndarray,
    parameter: object,
    label: str,
    start: int | None = None,
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
    parameter, label, start
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
        title, np.asarray(parameter, float), label, tuple(joined), view @ turn.T, start
    )


def _layer_offsets(phi: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Displace the facets round a vertex at closed creases: a valley (+pi) lays the next facet on top."""
    n = len(phi)
    # facets are drawn apart where a crease is this near to pi [rad]
    closed = np.abs(np.abs(phi) % (2 * math.pi) - math.pi) < 0.1
    # crease i lies between facets i - 1 and i; begun behind the most open crease
    first = int(np.argmin(np.abs(phi)))
    around = (first + 1 + np.arange(n)) % n
    moves = (closed * np.copysign(0.05, phi))[around, None] * normals[around - 1]
    offsets = np.zeros((n, 3))
    offsets[around] = np.cumsum(moves, axis=0)
    if closed.all():  # once round: share out what does not fit
        offsets[around] -= offsets[first] * np.arange(1, n + 1)[:, None] / n
    else:
        offsets -= offsets[first]
    return offsets - offsets.mean(axis=0)


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
