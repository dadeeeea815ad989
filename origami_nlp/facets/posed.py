"""The programme of a pattern as CasADi symbols, for any solver: closure as independent rows, gaps of features as rows.

Written from the folds alone, by turns of quaternions along loops and of points along walks of facets: it shares neither
values nor derivatives with `closure`, `poses` and `touches`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from scipy.linalg import qr

from origami_nlp.facets.faces import Lying
from origami_nlp.facets.touches import Touch
from origami_nlp.numerics import RANK, dense, quaternion as quat
from origami_nlp.pattern import Loop
from origami_nlp.programme import Nlp

if TYPE_CHECKING:
    from origami_nlp.facets.sheet import Sheet


def independent_rows(sheet: Sheet, phi: np.ndarray) -> np.ndarray:
    """Return the numbers of closure equations that span all of them at a state [n], ascending."""
    # pivoting puts independent equations first
    _, r, order = qr(dense(sheet.jacobian(phi)).T, mode="economic", pivoting=True)
    return np.sort(order[: int((np.abs(np.diag(r)) > RANK).sum())])


def pose(sheet: Sheet, rows: np.ndarray, touches: Sequence[Touch] = ()) -> Nlp:
    """Pose min U subject to some closure equations and gaps.

    Parameters
    ----------
    sheet
        The programme.
    rows
        Numbers of the equations.
    touches
        Features whose gaps, over the sheet's size, are the last rows; their bounds are the caller's.

    Returns
    -------
    Nlp
        Parameters are `Parameters.vector`: stiffness, rest angles and loads.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Sheet, independent_rows, pose
    >>> sheet = Sheet(o.examples.pattern("miura", 3, 3))  # six of twelve equations for a square say nothing new
    >>> phi, _ = sheet.project(0.5 * sheet.pattern.signs)
    >>> rows = independent_rows(sheet, phi)
    >>> sheet.equation_count, len(rows), pose(sheet, rows).g.shape
    (12, 11, (11, 1))
    """
    n = sheet.size
    x, k, rest, load = (ca.SX.sym(name, n) for name in ("x", "k", "rest", "load"))
    energy = 0.5 * ca.dot(k, (x - rest) ** 2) - ca.dot(load, x)
    turns = x - ca.DM(sheet.pattern.reference)
    away = sheet.pattern.corners - sheet.pattern.corners.mean(axis=0)
    size = float(np.abs(away).max(initial=0.0)) or 1.0
    loops = [_loop(sheet, turns, loop)[:3] for loop in sheet.pattern.vertices]
    for loop in sheet.pattern.holes:
        whole = _loop(sheet, turns, loop)
        loops.append(ca.vertcat(whole[:3], whole[3:] / size))
    closure = ca.vertcat(ca.SX(0, 1), *loops)
    gaps = [_gap(sheet, turns, touch) / sheet.crossings.size for touch in touches]
    free = np.full(len(gaps), math.inf)
    lower, upper = (np.append(np.zeros(len(rows)), s * free) for s in (-1.0, 1.0))
    g = ca.vertcat(closure[rows.tolist()], *gaps)
    return Nlp(x, ca.vertcat(k, rest, load), energy, g, lower, upper)


def _loop(sheet: Sheet, turns: ca.SX, loop: Loop) -> ca.SX:
    """Return where the folds round a loop lead: vector part of the turn, and shift, [6]."""
    q, shift = quat.IDENTITY, ca.SX.zeros(3)
    for crease, sign in zip(loop.creases, loop.signs, strict=True):
        fold, point = _fold(sheet, turns, crease, sign)
        after = quat.multiply(q, fold)
        # as in `closure`: the axis passes through `point`
        shift += ca.vertcat(*quat.rotate(q, point)) - ca.vertcat(*quat.rotate(after, point))
        q = after
    return ca.vertcat(*q[1:], shift)


def _fold(sheet: Sheet, turns: ca.SX, crease: int, sign: float) -> tuple[Any, list[float]]:
    """Return the fold of a crease as a quaternion, and a point on its axis."""
    p, half = sheet.pattern, 0.5 * turns[crease]
    axis = (sign * p.directions[crease]).tolist()
    return quat.fold(ca.cos(half), ca.sin(half), axis), p.corners[p.ends[crease, 0]].tolist()


def _gap(sheet: Sheet, turns: ca.SX, touch: Touch) -> ca.SX:
    """Return the gap of two features, seen from the first facet."""
    p = sheet.pattern
    first, second = touch.facets

    def seen(x: np.ndarray) -> ca.SX:
        """Move a point of the second facet as the folds between the two do."""
        here: ca.SX = ca.SX(ca.DM(x))
        for crease, sign in reversed(sheet.crossings.poses.path(first, second)):
            fold, point = _fold(sheet, turns, crease, sign)
            turned = quat.rotate(fold, ca.vertsplit(here - ca.DM(point)))
            here = ca.SX(ca.vertcat(*turned) + ca.DM(point))
        return here

    a, b, c, d = (p.corners[i] for i in touch.corners)
    if touch.type == "edge-edge":
        e, f = seen(c), seen(d)
        normal, off = ca.cross(ca.DM(b - a), f - e), e - ca.DM(a)
    else:
        normal = ca.SX(ca.DM(np.cross(c - b, d - b)))
        off = seen(np.array(touch.place) if isinstance(touch, Lying) else a) - ca.DM(b)
    return touch.sign * ca.dot(off, normal) / ca.norm_2(normal)
