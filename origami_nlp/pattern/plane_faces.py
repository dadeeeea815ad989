"""Corners of a folded form moved so that its faces are planes: files give few digits, and rigid facets are plane.

Where a face is not plane, the place of its normal depends on the corner that it is measured from, and whether facets
that meet touch or cross depends on it too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import lsmr

ROUNDS = 5
"""Of Newton; heights of 1e-4 of a face are squared by each."""
PLANE = 4e-16
"""Heights over the size of the sheet that are rounding."""


def plane(corners: np.ndarray, polygons: Sequence[Sequence[int]]) -> tuple[np.ndarray, float]:
    """Move corners as little as makes all polygons plane.

    Parameters
    ----------
    corners
        Points, [V, 3].
    polygons
        Corners of each.

    Returns
    -------
    corners : numpy.ndarray
        Moved, [V, 3].
    moved : float
        How far the one that moved most did.

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([[0, 0, 1e-6], [1, 0, 0], [1, 1, 1e-6], [0, 1, 0]])
    >>> new, moved = plane(square, [(0, 1, 2, 3)])
    >>> float(np.ptp(new[:, 2])) < 1e-15, round(moved, 12)
    (True, 5e-07)
    """
    origin = corners.mean(axis=0)
    size = float(np.abs(corners - origin).max())
    x = (corners - origin) / size
    wide = [np.array(p) for p in polygons if len(p) > 3]
    for _ in range(ROUNDS):
        heights, blocks = [], []
        row = 0
        for p in wide:
            y = x[p] - x[p].mean(axis=0)
            vt = np.linalg.svd(y, full_matrices=False)[2]
            # heights above a plane, less what turning or lifting the plane takes away: [q - 3] of them
            flat = np.column_stack([np.ones(len(p)), y @ vt[0], y @ vt[1]])
            free = np.linalg.qr(flat, mode="complete")[0][:, 3:].T
            heights.append(free @ (y @ vt[2]))
            rows = np.repeat(row + np.arange(len(free)), 3 * len(p))
            columns = np.tile((3 * p[:, None] + np.arange(3)).ravel(), len(free))
            blocks.append((rows, columns, (free[:, :, None] * vt[2]).ravel()))
            row += len(free)
        if not row or max(np.abs(h).max() for h in heights) <= PLANE:
            break
        rows, columns, values = (np.concatenate(b) for b in zip(*blocks, strict=True))
        slopes = sparse.csr_array((values, (rows, columns)), shape=(row, 3 * len(x)))
        step = lsmr(slopes, np.concatenate(heights), atol=1e-12, btol=1e-12, maxiter=10 * row)[0]
        x = x - step.reshape(-1, 3)
    new = origin + size * x
    moved = float(np.linalg.norm(new - corners, axis=1).max(initial=0.0))
    return (new, moved) if moved > PLANE * size else (corners, 0.0)
