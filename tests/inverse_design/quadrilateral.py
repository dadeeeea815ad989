"""All states of a vertex with four creases, by spherical trigonometry alone: no code of the package.

The creases are four unit vectors, the facets arcs between them.  A fold angle gives the diagonal beside it,
the diagonal the two places of the crease across.
"""

import numpy as np


def states(sectors, count):
    """Admissible fold angles [m, 4] of a vertex with sector angles [4]: each crease turned in `count` steps."""
    out, steps = [], np.pi * ((2 * np.arange(count) + 1.0) / count - 1.0)
    for first in range(4):
        a = np.roll(np.asarray(sectors), -first)
        found = np.roll(_turned(a, steps), first, axis=-1)
        out.append(found[_apart(np.asarray(sectors), found)])
    return np.vstack(out)


def _turned(a, phi):
    """Fold angles [m, 4] where the first is given; crease i + 1 is a[i] after crease i."""
    one = np.tile([1.0, 0.0, 0.0], (len(phi), 1))
    two = np.tile([np.cos(a[0]), np.sin(a[0]), 0.0], (len(phi), 1))
    # the facet behind the first crease, turned about it: in the plane where phi = 0
    back = np.array([np.cos(a[3]), -np.sin(a[3]), 0.0])
    c, s = np.cos(phi), np.sin(phi)
    four = np.stack([back[0] + 0 * phi, c * back[1], -s * back[1]], axis=1)
    cos_d = np.einsum("ij,ij->i", two, four)
    ok = np.abs(cos_d) < 1 - 1e-9
    # crease 3 = u two + v four +- w (two x four), with its angles a[1] to two and a[2] to four
    sin2 = np.where(ok, 1 - cos_d**2, 1.0)
    u = (np.cos(a[1]) - cos_d * np.cos(a[2])) / sin2
    v = (np.cos(a[2]) - cos_d * np.cos(a[1])) / sin2
    rest = 1 - u**2 - v**2 - 2 * u * v * cos_d
    ok &= rest >= 0
    w = np.sqrt(np.where(ok, rest, 0.0) / sin2)
    both = []
    for side in (1.0, -1.0):
        three = u[:, None] * two + v[:, None] * four + side * w[:, None] * np.cross(two, four)
        both.append(_angles(np.stack([one, two, three, four], axis=1)[ok]))
    return np.vstack(both)


def _angles(creases):
    """Fold angles [m, 4] of creases [m, 4, 3]: how far each facet turns out of the plane of the one before."""
    before, after = np.roll(creases, 1, axis=1), np.roll(creases, -1, axis=1)
    n1, n2 = np.cross(before, creases), np.cross(creases, after)
    sine = np.einsum("mij,mij->mi", np.cross(n1, n2), creases)
    return np.arctan2(sine, np.einsum("mij,mij->mi", n1, n2))


def _creases(sectors, phi):
    """Unit vectors [m, 4, 3]: along a facet by its angle, then about the crease by its fold angle."""
    at, towards = (np.tile(v, (len(phi), 1)) for v in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
    out = [at]
    for i in range(3):
        at, towards = (
            np.cos(sectors[i]) * at + np.sin(sectors[i]) * towards,
            np.cos(sectors[i]) * towards - np.sin(sectors[i]) * at,
        )
        c, s = np.cos(phi[:, i + 1, None]), np.sin(phi[:, i + 1, None])
        towards = c * towards + s * np.cross(at, towards)
        out.append(at)
    return np.stack(out, axis=1)


def _apart(sectors, phi):
    """Which states have no two facets that intersect, [m]: arcs that do not cross."""
    c = _creases(sectors, phi)
    good = np.ones(len(phi), dtype=bool)
    for i in (0, 1):
        a, b, p, q = (c[:, (i + k) % 4] for k in range(4))
        n, m = np.cross(a, b), np.cross(p, q)
        meet = np.cross(n, m)
        size = np.linalg.norm(meet, axis=1, keepdims=True)
        meet = meet / np.maximum(size, 1e-12)
        for side in (1.0, -1.0):
            x = side * meet
            inside = [
                np.einsum("ij,ij->i", np.cross(normal, end) * sign, x) > 1e-6
                for normal, end, sign in ((n, a, 1), (n, b, -1), (m, p, 1), (m, q, -1))
            ]
            good &= ~np.all(inside, axis=0)
    return good


def lowest(sectors, energy, count=1500, near=0.02):
    """Places [l, 4] where no admissible state within `near` has less energy, one for each group of them."""
    from scipy.spatial import cKDTree

    at = states(sectors, count)
    e = energy(at)
    tree = cKDTree(at)
    pairs = tree.query_pairs(near, output_type="ndarray")
    low = np.ones(len(at), dtype=bool)
    a, b = pairs.T
    low[a[e[b] < e[a]]] = False
    low[b[e[a] < e[b]]] = False
    out = []
    for x in at[low]:
        if all(np.abs(x - y).max() > near for y in out):
            out.append(x)
    return np.array(out)


def crest(sectors, energy, a, b, count=3000, near=0.02):
    """Least energy at which samples next to each other join a to b [4]; inf where none do."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    at = states(sectors, count)
    e = energy(at)
    i, j = (int(np.abs(at - x).max(axis=1).argmin()) for x in (a, b))
    pairs = cKDTree(at).query_pairs(near, output_type="ndarray")
    height = np.maximum(e[pairs[:, 0]], e[pairs[:, 1]])
    levels = np.unique(height)

    def joined(level):
        some = pairs[height <= level]
        graph = coo_matrix((np.ones(len(some)), some.T), shape=(len(at),) * 2)
        label = connected_components(graph, directed=False)[1]
        return label[i] == label[j]

    if not joined(levels[-1]):
        return np.inf
    low, high = -1, len(levels) - 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if joined(levels[middle]) else (middle, high)
    return float(levels[high])
