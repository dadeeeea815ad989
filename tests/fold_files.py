"""FOLD files that the tests write themselves, as data, with every oddity; and where those of other people are."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from origami_nlp import Vertex
from origami_nlp.chart import fold_vertex
from tests.independent.rotations import project, spin_sign

OTHERS = Path(__file__).resolve().parents[2] / "shared" / "fold"
"""Other people's files, beside the repository: they may not be copied into it."""


def others(pattern: str = "*.fold") -> list[Path]:
    """Return other people's files, one at least; the test is skipped where their folder is not."""
    if not OTHERS.is_dir():
        pytest.skip(f"other people's FOLD files are not here: {OTHERS}")
    found = sorted(OTHERS.glob(pattern))
    assert found, pattern
    return found


def disc(sectors_deg, letters=None, angles=None, turn=0.0, length=None):
    """One vertex (number 0) with a rim: creases 0..N-1 in file order, then the border."""
    n = len(sectors_deg)
    azimuth = math.radians(turn) + np.radians(np.concatenate([[0.0], np.cumsum(sectors_deg)[:-1]]))
    r = np.ones(n) if length is None else np.asarray(length)
    xy = np.stack([r * np.cos(azimuth), r * np.sin(azimuth)], axis=1)
    data = {
        "file_spec": 1.1,
        "vertices_coords": [[0.0, 0.0], *xy.tolist()],
        "edges_vertices": [[0, i] for i in range(1, n + 1)]
        + [[i, i % n + 1] for i in range(1, n + 1)],
        "edges_assignment": [*(letters or "U" * n), *"B" * n],
    }
    if angles is not None:
        data["edges_foldAngle"] = [*angles, *[0] * n]
    return data


def folded(sectors_deg, phi, flat=True, letters=None):
    """The folded form of one vertex, written from its fold angles [rad]."""
    vertex = Vertex.from_degrees(sectors_deg, flat)
    creases, q = fold_vertex(vertex, np.asarray(phi))
    assert np.abs(q[1:]).max() < 1e-9
    n = len(sectors_deg)
    data = disc([360 / n] * n, letters or ["V" if p > 0 else "M" if p < 0 else "U" for p in phi])
    data["vertices_coords"] = [[0, 0, 0], *creases.tolist()]
    data["faces_vertices"] = [[0, i, i % n + 1] for i in range(1, n + 1)]
    data["frame_classes"] = ["foldedForm"]
    return data


def closed_state(sectors, flat, seed):
    """A random closed embedded state, by the independent Gauss-Newton projection."""
    rng = np.random.default_rng(seed)
    a = np.radians(sectors)
    while True:
        x, r = project(a, np.arange(len(a)), rng.uniform(-1.5, 1.5, (20, len(a))))
        for phi in x[(r < 1e-13) & (np.abs(x).max(axis=1) < 2.5) & (np.abs(x).min(axis=1) > 0.05)]:
            if spin_sign(a, phi)[0] > 0:
                return phi


def in_space(data, seed, noise=0.0):
    """Turn a flat file into a random plane, numbers mixed up, noise added."""
    rng = np.random.default_rng(seed)
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.linalg.det(q))
    xy = np.array(data["vertices_coords"])
    xyz = np.column_stack([xy, np.zeros(len(xy))]) @ q.T + rng.normal(size=3)
    xyz += noise * rng.normal(size=xyz.shape)
    n = len(xy) - 1
    faces = [[0, i, i % n + 1] for i in range(1, n + 1)]
    return {**data, "vertices_coords": xyz.tolist(), "faces_vertices": faces}


def miura(rows=3, columns=3, angle=70.0):
    """A Miura sheet, vertices in rows; interior vertices have degree 4."""
    shift = 1 / math.tan(math.radians(angle))
    coords = [[c + (r % 2) * shift, float(r)] for r in range(rows + 1) for c in range(columns + 1)]
    at = lambda r, c: r * (columns + 1) + c  # noqa: E731
    edges, letters = [], []
    for r in range(rows + 1):
        for c in range(columns):
            edges.append([at(r, c), at(r, c + 1)])
            letters.append("B" if r in (0, rows) else "VM"[(r + c) % 2])
    for r in range(rows):
        for c in range(columns + 1):
            edges.append([at(r, c), at(r + 1, c)])
            letters.append("B" if c in (0, columns) else "VM"[c % 2])
    return {"vertices_coords": coords, "edges_vertices": edges, "edges_assignment": letters}
