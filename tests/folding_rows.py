"""Rows of vertices that fold flat, no creases in line, with springs that rest anywhere."""

import math

import numpy as np

from origami_nlp.pattern import make_pattern


def folding_row(seed, k=2, reach=0.9):
    """Facets on both sides of a zigzag with k vertices inside, as far as they reach."""
    rng = np.random.default_rng(seed)
    while True:
        spine = [complex(i, 0.3 * (-1) ** i + 0.2 * rng.uniform(-1, 1)) for i in range(k + 2)]
        points, faces = list(spine), []
        ends = {"up": [spine[0] + 1j * reach], "down": [spine[0] - 1j * reach]}
        for i in range(1, k + 1):
            ahead, back = spine[i + 1] - spine[i], spine[i - 1] - spine[i]
            above = np.angle(back / ahead) % (2 * math.pi)
            first = rng.uniform(0.3, 0.7) * above
            # sectors first, above - first, pi - first, pi - (above - first)
            unit = ahead / abs(ahead)
            ends["up"].append(spine[i] + reach * unit * np.exp(1j * first))
            ends["down"].append(spine[i] + reach * unit * np.exp(1j * (above - first - math.pi)))
        for side, lift in (("up", 1j), ("down", -1j)):
            ends[side].append(spine[-1] + lift * reach)
            start = len(points)
            points += ends[side]
            for i in range(k + 1):
                ring = (i, i + 1, start + i + 1, start + i)
                faces.append(ring if side == "up" else ring[::-1])
        if all(_is_convex([points[v] for v in ring]) for ring in faces):
            break
    sheet = make_pattern(np.array([[z.real, z.imag] for z in points]), faces)
    return sheet.with_springs(
        stiffness=(10 ** rng.uniform(-1, 1, sheet.creases)).tolist(),
        rest_angles=rng.uniform(-3, 3, sheet.creases).tolist(),
    )


def _is_convex(ring):
    n = len(ring)
    sides = [ring[(i + 1) % n] - ring[i] for i in range(n)]
    return all((sides[i].conjugate() * sides[(i + 1) % n]).imag > 0.02 for i in range(n))
