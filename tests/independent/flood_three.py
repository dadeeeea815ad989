"""Vertices of degree 6 on a lattice: three fold angles are stated, the others follow by spherical trigonometry.

Min-max heights between states over all steps of the lattice, by union and find; shares nothing with the package.
"""

import math

import numpy as np


def about_x(angles: np.ndarray) -> np.ndarray:
    """Rotations about the first axis, [K, 3, 3]."""
    c, s, one, none = np.cos(angles), np.sin(angles), np.ones_like(angles), np.zeros_like(angles)
    return np.stack([one, none, none, none, c, -s, none, s, c], axis=-1).reshape(-1, 3, 3)


def about_z(angle: float) -> np.ndarray:
    """The rotation by a sector, [3, 3]."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def completed(sectors: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Both states [2, K, 6] with the first three fold angles given, [K, 3]; nan where there is none."""
    turn = np.eye(3)
    for k in range(3):
        turn = turn @ about_x(first[:, k]) @ about_z(sectors[k])
    rest = np.swapaxes(turn, 1, 2) @ about_z(sectors[5]).T
    a, b = sectors[3], sectors[4]
    cosine = (math.cos(a) * math.cos(b) - rest[:, 0, 0]) / (math.sin(a) * math.sin(b))
    out = []
    for side in (1, -1):
        middle = side * np.arccos(np.clip(cosine, -1, 1))
        bare = about_z(a) @ about_x(middle) @ about_z(b)
        one = np.arctan2(rest[:, 2, 0], rest[:, 1, 0]) - np.arctan2(bare[:, 2, 0], bare[:, 1, 0])
        two = np.arctan2(bare[:, 0, 2], bare[:, 0, 1]) - np.arctan2(rest[:, 0, 2], rest[:, 0, 1])
        turned = [(x + math.pi) % (2 * math.pi) - math.pi for x in (one, two)]
        phi = np.column_stack([first, turned[0], middle, turned[1]])
        phi[np.abs(cosine) > 1] = math.nan
        out.append(phi)
    return np.array(out)


def heights(
    sectors: np.ndarray,
    stiffness: np.ndarray,
    rest: np.ndarray,
    states: np.ndarray,
    many: int,
    longest: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Min-max energies [S, S] between states [S, 6] over steps no longer than `longest`, and the lattice [L, 6]."""
    axis = np.linspace(-math.pi, math.pi, many)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    both = completed(sectors, grid)
    at, size, steps = np.arange(many**3).reshape(many, many, many), many**3, []
    pairs = [
        (np.take(at, range(many - 1), k).ravel(), np.take(at, range(1, many), k).ravel())
        for k in range(3)
    ]
    pairs.append((at.ravel(), at.ravel()))
    for a, b in pairs:
        for s in (0, 1):
            for t in (0, 1):
                near = np.abs(both[s, a] - both[t, b]).max(axis=1) <= longest
                steps.append(np.column_stack([s * size + a[near], t * size + b[near]]))
    lattice = both.reshape(-1, 6)
    for k, x in enumerate(states):
        near = np.flatnonzero(np.abs(lattice - x).max(axis=1) <= longest)
        steps.append(np.column_stack([np.full(len(near), 2 * size + k), near]))
    nodes, edges = np.concatenate([lattice, states]), np.concatenate(steps)
    energy = 0.5 * (nodes - rest) ** 2 @ stiffness
    height = energy[edges].max(axis=1)
    parent, seen = list(range(len(nodes))), {2 * size + k: [k] for k in range(len(states))}
    out = np.full((len(states),) * 2, math.inf)

    def root(v: int) -> int:
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for edge in np.argsort(height, kind="stable").tolist():
        a, b = (root(v) for v in edges[edge].tolist())
        if a != b:
            one, two = seen.pop(a, []), seen.pop(b, [])
            for i in one:
                out[i, two] = out[two, i] = height[edge]
            parent[b], seen[a] = a, one + two
    return out, lattice[~np.isnan(lattice).any(axis=1)]
