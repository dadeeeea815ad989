"""The link of a vertex by matrices of its own: closed states, and whether facets cross by arcs on the sphere."""

import math

import numpy as np


def corners(sectors: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions of the creases of a chain of facets, [d, 3], and the rotation that it ends with: 1 where it closes."""
    turn, out = np.eye(3), []
    for sector, fold in zip(sectors, phi, strict=True):
        c, s = math.cos(fold), math.sin(fold)
        turn = turn @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        out.append(turn[:, 0])
        c, s = math.cos(sector), math.sin(sector)
        turn = turn @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return np.array(out), turn


def closed(sectors: np.ndarray, start: np.ndarray) -> np.ndarray | None:
    """Newton to a closed state; creases are axes of the derivative."""
    phi = start.copy()
    for _ in range(30):
        axes, turn = corners(sectors, phi)
        off = 0.5 * np.array(
            [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
        if np.abs(turn - np.eye(3)).max() < 1e-13:
            return phi if np.abs(phi).max() < math.pi else None
        step = np.linalg.pinv(axes.T, rcond=1e-9) @ off
        phi = phi - step * min(1.0, 0.5 / max(np.abs(step).max(), 1e-300))
    return None


def crosses(points: np.ndarray) -> bool:
    """Whether sides of a polygon on the sphere that are no neighbours meet: arcs shorter than half a turn."""
    ends = np.roll(points, -1, axis=0)
    normals = np.cross(points, ends)
    d = len(points)
    for i in range(d):
        for j in range(i + 2, d - (i == 0)):
            meet = np.cross(normals[i], normals[j])
            size = np.linalg.norm(meet)
            if size < 1e-12:
                continue
            for x in (meet / size, -meet / size):
                inside = (
                    np.cross(normals[k], points[k]) @ x >= -1e-12
                    and np.cross(ends[k], normals[k]) @ x >= -1e-12
                    for k in (i, j)
                )
                if all(inside):
                    return True
    return False
