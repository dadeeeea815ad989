"""Flat sheets in their own plane: a sheet that is turned in space is as flat as one in the plane z = 0."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from origami_nlp.pattern.sheet import Pattern


def in_plane(pattern: Pattern) -> np.ndarray:
    """Return the corners of a flat sheet in its plane.

    Parameters
    ----------
    pattern
        Its reference state is flat (`Pattern.is_flat`).

    Returns
    -------
    numpy.ndarray
        Corners, [V, 2]: x and y as they are where z is one number; else turned, so that facets run counter-clockwise.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import in_plane
    >>> in_plane(o.examples.pattern("miura", 2, 2))[0].tolist()
    [0.0, 0.0]
    """
    x = pattern.corners
    if not np.ptp(x[:, 2]):
        return x[:, :2]
    x = x - x[0]
    area = sum(np.cross(np.roll(x[[*p]], 1, axis=0), x[[*p]]).sum(axis=0) for p in pattern.polygons)
    normal = area / np.linalg.norm(area)
    # the longest side of a facet is known best
    ends = np.array([(p[i - 1], v) for p in pattern.polygons for i, v in enumerate(p)])
    sides = x[ends[:, 1]] - x[ends[:, 0]]
    one = sides[np.linalg.norm(sides, axis=1).argmax()]
    one = one - (one @ normal) * normal
    one /= np.linalg.norm(one)
    return np.stack([x @ one, x @ np.cross(normal, one)], axis=1)


def laid_flat(pattern: Pattern) -> Pattern:
    """Return a flat sheet with its corners in a plane z = constant.

    Parameters
    ----------
    pattern
        Any pattern.

    Returns
    -------
    Pattern
        The sheet laid in its plane; the pattern itself if it lies so, or if it is not flat.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import laid_flat
    >>> sheet = o.examples.pattern("miura", 2, 2)
    >>> laid_flat(sheet) is sheet
    True
    """
    if not pattern.is_flat or not np.ptp(pattern.corners[:, 2]):
        return pattern
    corners = np.column_stack([in_plane(pattern), np.zeros(len(pattern.corners))])
    return replace(pattern, corners=corners)
