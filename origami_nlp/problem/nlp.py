"""The problem as CasADi symbols, for any solver: with planes that keep facets apart, or with every gap as a row."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from origami_nlp.numerics import INDEPENDENT, cross
from origami_nlp.pattern import HingeLaw
from origami_nlp.problem.compiled import Structure, compile_structure
from origami_nlp.problem.gaps import separation_rows

Pairs = tuple[tuple[int, int], ...]
PLANE_ROWS = 5
"""Rows of a separating plane: its normal has length 1, and four corners are on their sides."""


@dataclass(frozen=True, eq=False)
class Nlp:
    """Symbols of min f(x, p) subject to lower <= g(x, p) <= upper; bounds on x are the caller's."""

    x: ca.SX
    p: ca.SX
    f: ca.SX
    g: ca.SX
    lower: np.ndarray
    upper: np.ndarray


def pose_apart(structure: Structure, pairs: Pairs, laws: tuple[HingeLaw | None, ...] = ()) -> Nlp:
    """Closure, mirrors, the axis, and for each of `pairs` a plane (three more unknowns) between two facets.

    Parameters are `Parameters.vector`; laws: those of the variables (`HingeLaws.laws`), where there are any.
    """
    f = compile_structure(structure)
    p, energy = f.with_laws(laws)
    walls = [f.gaps[i] for i, gap in enumerate(structure.gaps) if gap.type != "facet-pair"]
    unknowns, rows = [f.x], [f.piece.equations, *walls]
    lower, upper = (
        [0.0] * (f.piece.equations.shape[0] + len(walls)),
        [0.0] * f.piece.equations.shape[0],
    )
    upper += [math.inf] * len(walls)
    for i, j in pairs:
        normal = ca.SX.sym(f"n_{i}_{j}", 3)
        unknowns.append(normal)
        planes = separation_rows(f.piece, (i, j), [*ca.vertsplit(normal)])
        # without |n| = 1 the plane n = 0 would separate everything
        rows += [ca.dot(normal, normal) - 1, planes]
        lower += [0.0] * PLANE_ROWS
        upper += [0.0] + [math.inf] * (PLANE_ROWS - 1)
    return Nlp(
        ca.vertcat(*unknowns), p, energy, ca.vertcat(*rows), np.array(lower), np.array(upper)
    )


def pose_with_gaps(structure: Structure, gaps: tuple[int, ...]) -> Nlp:
    """Closure, then some gaps as rows (the last ones), each on either side: a caller says which.

    Parameters are `Parameters.at` a state: of laws its pieces there.
    """
    f = compile_structure(structure)
    m = f.piece.equations.shape[0]
    rows = ca.vertcat(f.piece.equations, *(f.gaps[i] for i in gaps))
    # no side is imposed: facets that touch may pass on either side, and a caller bounds the rows it has chosen
    free = [math.inf] * len(gaps)
    lower, upper = np.array([0.0] * m + [-v for v in free]), np.array([0.0] * m + free)
    return Nlp(f.x, f.p, f.energy, rows, lower, upper)


def separating_normal(rays: np.ndarray, pair: tuple[int, int]) -> np.ndarray:
    """Return the unit normal that best separates two facets, among the planes through two of their
    rays.

    If they cross there is none; the best of these planes is still where IPOPT starts.
    """
    i, j = pair
    n = len(rays)
    corners = rays[[i, (i + 1) % n, j, (j + 1) % n]]
    # a best separating plane of two arcs contains two of their four ends, or only keeps clear of both
    a, b = np.triu_indices(4, 1)
    normals = cross(corners[a], corners[b])
    length = np.linalg.norm(normals, axis=1)
    normals = normals[length > INDEPENDENT] / length[length > INDEPENDENT, None]
    # planes that only touch both facets on one side are as good as the bisector of the two groups
    middle = corners[:2].sum(axis=0) - corners[2:].sum(axis=0)
    if np.linalg.norm(middle) > INDEPENDENT:
        normals = np.vstack([normals, middle / np.linalg.norm(middle)])
    normals = np.vstack([normals, -normals])
    margin = np.min(normals @ (corners * np.array([1, 1, -1, -1])[:, None]).T, axis=1)
    return normals[int(margin.argmax())]
