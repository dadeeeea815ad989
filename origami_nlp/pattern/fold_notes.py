"""What is odd in a frame of a FOLD file: each oddity is noted, and dealt with in one stated way."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from origami_nlp.numerics import NOISE, NONZERO

LOOKS_LIKE_PI = 1e-3
"""Degrees beside pi that nobody means: who writes so means radians."""
SMALLEST_FOLD = 0.05
"""The largest fold of a file that is read as it stands and yet could be radians: 0.05 rad are 3 degrees."""
UP = (1e-6, 1e-3, 1.0)
"""Where a sheet without a side is seen from: above, and from somewhere where its normal lies in the plane."""


def once(
    pairs: np.ndarray, letters: list[str], angles: np.ndarray, notes: list[str]
) -> tuple[np.ndarray, list[int]]:
    """Return the edges to keep, each pair of vertices once, and which of them conflict with a copy."""
    first: dict[tuple[int, ...], int] = {}
    keep, twice, conflicts = list[int](), list[int](), list[int]()
    for e, ends in enumerate(map(tuple, np.sort(pairs, axis=1).tolist())):
        k = first.setdefault(ends, e)
        alike = letters[k] == letters[e] and str(angles[k]) == str(angles[e])
        (keep if k == e else twice if alike else conflicts).append(e if alike else k)
    if twice:
        notes.append(f"edges {listed(twice)} are the same lines as others: left out")
    if conflicts:
        notes.append(f"edges {listed(conflicts)} are stated twice with other letters or angles")
    return np.array(keep, dtype=int), conflicts


def compare_signs(letters: list[str], angles: np.ndarray, notes: list[str]) -> None:
    """Note mountains with a positive fold angle and valleys with a negative one."""
    each = enumerate(zip(letters, angles, strict=True))
    if wrong := [e for e, (a, phi) in each if phi * {"M": -1, "V": 1}.get(a, 0) < 0]:
        notes.append(f"edges {listed(wrong)}: the fold angle, not the letter M or V, is used")


def note_small(angles: np.ndarray, notes: list[str]) -> None:
    """Note fold angles so small that they look like radians."""
    largest = float(np.nanmax(np.abs(angles), initial=0.0))
    if SMALLEST_FOLD <= largest <= math.pi + LOOKS_LIKE_PI:
        notes.append(f"edges_foldAngle: {largest:.6g} at most, read as degrees: no radians?")


def listed(items: Sequence[int], most: int = 8) -> str:
    """Write the first numbers, and how many there are.

    Parameters
    ----------
    items
        The numbers.
    most
        Of them, the others are counted.

    Returns
    -------
    str
        Such as ``"1, 2, 3, ... (9)"``.
    """
    shown = ", ".join(str(i) for i in items[:most])
    return shown + (f", ... ({len(items)})" if len(items) > most else "")


def flattened(
    coords: np.ndarray, faces: tuple[tuple[int, ...], ...], folded: bool, notes: list[str]
) -> tuple[np.ndarray, bool]:
    """Lay a crease pattern given in space into the plane z = 0; coordinates in no plane are folded."""
    middle = coords.mean(axis=0)
    _, extent, axes = np.linalg.svd(coords - middle, full_matrices=False)
    if len(extent) == 3 and extent[2] > NOISE * max(extent[0], NONZERO):
        if not folded:
            notes.append("coordinates lie in no plane: read as a folded form")
        return coords, True
    if folded:
        return coords, True
    normal = axes[2] if len(axes) == 3 else np.array([0.0, 0.0, 1.0])
    sides = np.array([(f[i - 1], f[i]) for f in faces for i in range(len(f))], dtype=int)
    sides = sides.reshape(-1, 2)
    about = coords - middle
    areas = np.cross(about[sides[:, 0]], about[sides[:, 1]])
    area = areas.sum(axis=0)
    seen = np.linalg.norm(area) > NOISE * np.linalg.norm(areas, axis=1).sum()
    up = area if seen else np.array(UP)
    if (
        normal @ up < 0
    ):  # faces counter-clockwise as seen from above; without faces from +z (or +y, +x)
        normal = -normal
    x = axes[0] - (axes[0] @ normal) * normal
    x /= np.linalg.norm(x)
    if np.abs(normal - [0, 0, 1]).max() < NOISE:  # already flat: keep its axes
        x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    else:
        y = np.cross(normal, x)
    flat = np.stack([(coords - middle) @ x, (coords - middle) @ y, np.zeros(len(coords))], axis=1)
    return flat, False
