"""The constant internal moment of a vertex: one vector, of which each free crease feels the component along itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL, RANK, cross
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem.problem import PatternProblem
from origami_nlp.problem import FoldLimits


@dataclass(frozen=True)
class PassingMoment:
    """What each facet of a folded vertex receives from the next one, across the crease between them.

    Facets carry no load (preload winds phi0), so in balance it is the same vector all the way round: the springs have
    k_i (phi_i - phi0_i) = m . c_i at each free crease, c_i the unit vector along the deformed crease, from the vertex.

    Attributes
    ----------
    vector
        m [N m in the scene's units], in the frame of the facet between crease N and crease 1, which is held fixed: e1
        along crease 1, e3 the normal on the side from which creases are numbered counter-clockwise.  Half of the
        multipliers of the vector part of the product of folds.
    residual
        Largest |k_i (phi_i - phi0_i) - m . c_i| over free creases [N m]: what one vector leaves.  Not rounding where
        facets that touch carry moments of their own.
    """

    vector: tuple[float, float, float]
    residual: float


def passing_moment(
    scene: Scene, problem: PatternProblem, fold_angles: np.ndarray
) -> PassingMoment | None:
    """Find the moment that balances the springs of the free creases best, whatever the symmetry of the scene.

    Parameters
    ----------
    scene
        Whose springs.
    problem
        The same, posed.
    fold_angles
        All N of a closed state [rad].

    Returns
    -------
    PassingMoment or None
        None where the free creases lie in a plane, or fewer than three are free: there the moment is not known across;
        and where forces pull at facets.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern_problem import passing_moment, pose
    >>> scene = o.examples.degree6("pi/4", ratio=0.01)
    >>> lowest = o.find_minima(scene, max_starts=16).minima[0]
    >>> passing_moment(scene, pose(scene), lowest.fold_angles).residual < 1e-12
    True
    """
    if scene.loads:
        return None
    phi = np.asarray(fold_angles, dtype=float)
    poses = problem.crossings.poses
    vertex, *ends = poses.corners(problem.reduce(phi))
    turn, _ = poses.motions(problem.reduce(phi))
    # the frame of the last facet in the reference state: where that lies flat, exact for wide sectors too
    first, last = (poses.pattern.corners[i] - poses.pattern.corners[0] for i in (1, scene.degree))
    up = cross(last, first)
    up /= np.linalg.norm(up)
    frame = np.array([first, cross(up, first), up])
    creases = (np.array(ends) - vertex) @ turn[-1] @ frame.T
    stiffness = np.array(scene.stiffness)
    torque = scene.torque(phi)
    free = (
        FoldLimits(*scene.limit_angles).room(phi) > CONTACT_TOL
        if scene.contact != "none"
        else np.ones(len(phi), bool)
    )
    c, t, root = creases[free], torque[free], np.sqrt(stiffness[free])
    if len(c) < 3 or np.linalg.svd(c, compute_uv=False)[2] <= RANK:
        return None
    # weighed by 1 / k_i: what is left is measured by the energy that each spring by itself would release
    m = np.linalg.lstsq(c / root[:, None], t / root, rcond=None)[0]
    # what closing to `CLOSURE_TOL` leaves of a component is 0
    x, y, z = np.where(np.abs(m) <= CLOSURE_TOL * stiffness[free].max(), 0.0, m).tolist()
    return PassingMoment((x, y, z), float(np.abs(t - c @ m).max()))
