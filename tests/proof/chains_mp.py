"""A folded chain in 50 digits, by Rodrigues' rotations: nothing shared with any code under test."""

import itertools

import mpmath

mp = mpmath.mp.clone()
mp.dps = 50
mpf = mp.mpf


def turn(axis, angle, v):
    """Turn v about a unit axis."""
    c, s = mp.cos(angle), mp.sin(angle)
    along = sum(a * b for a, b in zip(axis, v, strict=True))
    crossed = cross(axis, v)
    return [c * b + s * x + (1 - c) * along * a for a, b, x in zip(axis, v, crossed, strict=True)]


def cross(a, b):
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def flat_axes(sectors):
    azimuth, found = mpf(0), []
    for a in sectors:
        found.append([mp.cos(azimuth), mp.sin(azimuth), mpf(0)])
        azimuth += mpf(a)
    return found


def axes(sectors, angles, start=0):
    """Axes of all creases; the facet before crease `start` (0-based) stays where it is."""
    flat, n = flat_axes(sectors), len(sectors)
    found = [None] * n
    for i in range(start, n):  # turned by start .. i-1, last first
        v = flat[i]
        for j in reversed(range(start, i)):
            v = turn(flat[j], mpf(angles[j]), v)
        found[i] = v
    for i in range(start):  # backwards
        v = flat[i]
        for j in range(i, start):
            v = turn(flat[j], -mpf(angles[j]), v)
        found[i] = v
    return found


def quaternion(sectors, angles):
    """Product of (cos x/2, b sin x/2) over all creases."""
    w, v = mpf(1), [mpf(0)] * 3
    for b, x in zip(flat_axes(sectors), angles, strict=True):
        c, s = mp.cos(mpf(x) / 2), mp.sin(mpf(x) / 2)
        t = [s * e for e in b]
        w, v = (
            w * c - dot(v, t),
            [w * e + c * f + g for e, f, g in zip(t, v, cross(v, t), strict=True)],
        )
    return w, v


def unfolded(scene):
    """Sectors of the whole vertex, exactly symmetric, and for each of its creases the variable of a scene's piece."""
    group = scene.group
    if group.is_trivial:
        return [mpf(a) for a in scene.vertex.sector_angles], list(range(scene.degree))
    gaps = [mpf(ray.sector) for ray in group.rays]
    whole = (1 if group.kind == "D" else 2) * mp.pi / group.order
    places = [r for r, ray in enumerate(group.rays) if ray.crease is not None]
    at = [sum(gaps[:r], mpf(0)) for r in places]
    if group.kind == "D" and places[-1] == len(gaps) - 1:
        at[-1] = whole
    found = {}
    for turn in range(group.order):
        for variable, azimuth in enumerate(at):
            for way in (1, -1) if group.kind == "D" else (1,):
                angle = way * azimuth + 2 * mp.pi * turn / group.order
                angle -= 2 * mp.pi * mp.floor(angle / (2 * mp.pi) + mpf(10) ** -20)
                found[int(mp.nint(angle * 10**9))] = angle, variable
    creases = sorted(found.values())
    sectors = [b[0] - a[0] for a, b in itertools.pairwise(creases)]
    return [*sectors, 2 * mp.pi - creases[-1][0] + creases[0][0]], [v for _, v in creases]
