"""The same sheet otherwise put down: corners and facets renumbered, turned in space, mirrored, seen from behind."""

import numpy as np

from origami_nlp.pattern import Pattern, make_pattern


def relabelled(pattern: Pattern, seed: int, mirror: bool = False, over: bool = False):
    """Return a copy with other labels, and where its creases [n] and the sign of fold angles come from.

    Fold angles of the copy are sign * phi[creases].
    """
    rng = np.random.default_rng(seed)
    to = rng.permutation(len(pattern.corners))
    corners = np.empty_like(pattern.corners)
    x = pattern.corners * (-1.0, 1.0, 1.0) if mirror else pattern.corners
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    corners[to] = x @ turn.T + rng.normal(size=3)
    polygons = []
    for k in rng.permutation(len(pattern.polygons)):
        ring = [int(to[v]) for v in pattern.polygons[k]]
        if mirror != over:  # counter-clockwise again; or, seen from behind, clockwise
            ring = ring[::-1]
        shift = int(rng.integers(len(ring)))
        polygons.append(ring[shift:] + ring[:shift])
    sign = -1.0 if over else 1.0
    sides = [tuple(sorted((int(to[a]), int(to[b])))) for a, b in pattern.ends]

    def of(values):
        return dict(zip(sides, values.tolist(), strict=True))

    number = dict(zip(sides, rng.permutation(len(sides)).tolist(), strict=True))
    swap = {"M": "V", "V": "M"} if over else {}
    copy = make_pattern(
        corners,
        polygons,
        assignment={s: swap.get(a, a) for s, a in zip(sides, pattern.assignment, strict=True)},
        fold_angles=of(sign * pattern.reference),
        numbers=number,
        stiffness=of(pattern.stiffness),
        rest=of(sign * pattern.rest),
        file_angles=of(sign * pattern.file_angles),
        limits=of(pattern.limit_angles.T if sign > 0 else -pattern.limit_angles[::-1].T)
        if pattern.limits
        else None,
        name=pattern.name,
    )
    place = {s: i for i, s in enumerate(sides)}
    creases = np.array([place[tuple(sorted(map(int, e)))] for e in copy.ends])
    if pattern.laws:
        laws = (pattern.laws[k] for k in creases)
        copy = copy.with_laws([law and (law.turned() if over else law) for law in laws])
    return copy, creases, sign
