"""From a scene to all of its critical points."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CURVED, groups, pairs_within
from origami_nlp.problem import Model
from origami_nlp.proof.boxes import Boxes, BoxProblem, joined, prune, strata
from origami_nlp.proof.flat import RADII, Flat, flat_lemma
from origami_nlp.proof.law_torques import energy_bounds
from origami_nlp.proof.options import DEFAULT, ProofOptions
from origami_nlp.proof.pieces import Piece, VertexPiece, piece_of
from origami_nlp.proof.result import Cluster, Proof, ProvedCriticalPoint
from origami_nlp.proof.roots import (
    Roots,
    certify,
    different,
    holds,
    joined_roots,
    newton,
    none_certified,
)
from origami_nlp.proof.system import BoxKkt

NEAR = 0.05
"""Boxes this near to the flat state [rad], beyond its lemma, are made smaller too."""
LOW = 1e-4
"""Smallest singular value of closure on the free variables, in the smallest boxes, that counts as regular."""


def prove(
    model: Model,
    *,
    seconds: float | None = None,
    until: float = math.inf,
    options: ProofOptions = DEFAULT,
) -> Proof:
    """Find every critical point of a scene within its fold limits, by branch and prune and certificates of all roots.

    Parameters
    ----------
    model
        Of a scene with contact "fold-limits".
    seconds
        Stop after so much processor time; what is left then is undecided.
    until
        Stop then (`time.monotonic`), as after `seconds`.
    options
        Widths of boxes, how many at most (which, unlike a time, ends at the same place everywhere), how many together.

    Returns
    -------
    Proof

    Raises
    ------
    OptionError
        If the scene has other contact or dead loads, or is no flat sheet.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> from origami_nlp.problem import Model
    >>> vertex = Vertex.from_degrees((70, 80, 120, 90))
    >>> scene = Scene(vertex, (1, 2, 3, 2), (1.0, -0.5, 0.3, 0.8), "none", "fold-limits")
    >>> proof = prove(Model(scene))
    >>> proof.complete, len(proof.minima)
    (True, 2)
    """
    check_type("model", model, Model)
    started = time.process_time()
    posed, flat = pose(model)
    start = strata(posed.size, model.fold_limits)
    near = flat.radius or (RADII[0] if model.scene.group.is_trivial else 0.0)
    within = model.fold_limits
    limits = {"most": options.boxes, "seconds": seconds, "until": until}
    left = prune(posed, start, flat=near, options=options, **limits)  # type: ignore[arg-type]
    system = BoxKkt(model)
    roots, held, number, rest, more = certified(system, posed, left.candidates, near, options)
    # a root with a free angle at its limit is none of the open stratum: the state belongs to others
    # between the limits for certain on the open stratum
    inside = (within.room(roots.x) > roots.radius[:, None]) | (roots.pins != 0)
    ends = np.flatnonzero(~inside.all(axis=1))
    order = np.argsort([model.energy(x) for x in roots.x], kind="stable")
    order = order[inside.all(axis=1)[order]]
    points = tuple(_point(model, roots, int(i)) for i in order)
    singular: list[Cluster] = []
    undecided: list[Cluster] = []
    for i in ends:
        reason = "free angles at their limits: a state of other strata"
        singular.append(cluster_of(model, held[number == i], reason))
    for group in [rest[g] for g in clusters(rest, options)]:
        reason, is_singular = reason_of(system, group)
        (singular if is_singular else undecided).append(cluster_of(model, group, reason))
    for group in [left.open[g] for g in by_stratum(left.open)]:
        undecided.append(cluster_of(model, group, "time was up"))
    if left.flat and not flat.radius:
        undecided.append(_near_flat(model, near))
    return Proof(
        points,
        tuple(singular),
        tuple(undecided),
        left.boxes + flat.boxes + more,
        time.process_time() - started,
        not len(left.open),
        flat.text,
        flat.radius,
        flat.minimum,
        left=most_left(model, left.open),
    )


def pose(model: Model) -> tuple[Piece, Flat]:
    """Return the rows of a model over boxes, and what is shown of its flat state.

    Parameters
    ----------
    model
        Of a scene with contact "fold-limits".

    Returns
    -------
    piece : Piece
    flat : Flat

    Raises
    ------
    OptionError
        If the scene has other contact or dead loads, or is no flat sheet.
    """
    scene = model.scene
    scene.check_no_forces("a proof")
    if scene.contact != "fold-limits":
        raise OptionError(f"contact = {scene.contact!r}: proofs are for contact = 'fold-limits'")
    if not scene.vertex.flat:
        raise OptionError("the vertex is not flat: proofs are for flat sheets")
    if model.dof < 1 and model.structure.winding == 1:
        raise OptionError("the scene has no degree of freedom: its closed states are finitely many")
    piece = piece_of(model)
    if scene.group.is_trivial and isinstance(piece, VertexPiece):
        return piece, _within_stops(flat_lemma(piece), model)
    return piece, Flat(0.0, 0, None)


def _within_stops(flat: Flat, model: Model) -> Flat:
    """Return what is shown of the flat state where it may be at stops, or beyond one: its neighbours are others."""
    low, high = model.fold_limits.low, model.fold_limits.high
    if ((low < 0) & (high > 0)).all():
        return flat
    return replace(flat, minimum=False if (low > 0).any() or (high < 0).any() else None)


def certified(
    system: BoxKkt,
    posed: BoxProblem,
    boxes: Boxes,
    flat: float,
    options: ProofOptions,
) -> tuple[Roots, Boxes, np.ndarray, Boxes, int]:
    """Certify roots of candidates; boxes that none holds, and where closure has full rank, are made smaller.

    Returns
    -------
    roots : Roots
        Different ones, each held by some box.
    held : Boxes
    number : numpy.ndarray
        Of the root of each of these.
    rest : Boxes
        Those that no root holds.
    more : int
        Boxes treated.
    """
    found, more = none_certified(system), 0
    fresh = boxes
    held, numbers = [boxes[:0]], [np.zeros(0, dtype=int)]
    for small in (0.0, *options.smaller):
        if small:
            which = _regular(system, boxes, flat, options.smallest)
            if not which.any():
                continue  # the same boxes would give the same roots
            again = prune(
                posed,
                boxes[which],
                flat=flat,
                small=small,
                options=options,
                most=options.smaller_boxes,
            )
            fresh = joined([again.candidates, again.open])
            boxes, more = joined([boxes[~which], fresh]), more + again.boxes
        roots = different(joined_roots([found, _roots_of(system, fresh)]), len(found))
        number = holds(system, roots, boxes)
        used = np.array(sorted({*range(len(found)), *number[number >= 0].tolist()}), dtype=int)
        place = np.full(len(roots), -1)
        place[used] = np.arange(len(used))
        found = roots[used]
        held.append(boxes[number >= 0])
        numbers.append(place[number[number >= 0]])
        boxes = boxes[number < 0]
        if not len(boxes):
            break
    return found, joined(held), np.concatenate(numbers), boxes, more


def _roots_of(system: BoxKkt, boxes: Boxes) -> Roots:
    """Newton from the middle of every box, and certificates of what converged."""
    pins = boxes.pins.T
    x = 0.5 * (boxes.lower + boxes.upper).T
    x, lam, converged = newton(system, x, pins)
    some = np.flatnonzero(converged)
    # most boxes lead to the same few states
    cells = np.concatenate([pins[some], np.rint(x[some] / CURVED)], axis=1)
    some = some[np.sort(np.unique(cells, axis=0, return_index=True)[1])]
    return certify(system, x[some], lam[some], pins[some])[0]


def _regular(system: BoxKkt, boxes: Boxes, flat: float, size: float) -> np.ndarray:
    """Return at which boxes closure has full rank, on the free variables and for their size, [K]."""
    pins = boxes.pins.T
    x = 0.5 * (boxes.lower + boxes.upper).T
    near = (np.abs(x).max(axis=1) < NEAR) & (flat > 0)  # beyond the flat state's lemma
    return near | (system.least_slope(x, pins) > 3 * size)


def _point(model: Model, roots: Roots, i: int) -> ProvedCriticalPoint:
    """State a root in the scene's units."""
    index = None if roots.index[i] < 0 else int(roots.index[i])
    signs = roots.signs[i]
    x, pins = roots.x[i], roots.pins[i]
    decided: bool | None = None
    if bool((signs > 0).any()) or (index is not None and index > 0):
        decided = False
    # strict complementarity and a positive definite reduced Hessian: second-order sufficiency (theorem 12.6)
    elif index == 0 and (signs[pins != 0] < 0).all():
        decided = True
    # the moment is half of the multipliers of vec q (`kkt.moment`): dq/dphi = c q / 2
    half = 0.5 if piece_of(model).pivots == 3 else 1.0
    return ProvedCriticalPoint(
        tuple(x.tolist()),
        tuple(pins.tolist()),
        tuple((half * model.scale * roots.lam[i]).tolist()),
        float(roots.radius[i]),
        float(roots.unique[i]),
        float(half * model.scale * roots.spread[i]),
        index,
        tuple(signs.tolist()),
        model.energy(x),
        decided,
    )


def clusters(boxes: Boxes, options: ProofOptions) -> Iterator[np.ndarray]:
    """Group boxes of one stratum that are close to each other: cells of twenty times the smallest are no two apart."""
    for group in by_stratum(boxes):
        middle = 0.5 * (boxes.lower[:, group] + boxes.upper[:, group])
        cells = np.floor(middle.T / (20 * options.smallest))
        if np.ptp(cells, axis=0).max() <= 2:  # all are next to each other
            yield group
            continue
        cells, cell = np.unique(cells, axis=0, return_inverse=True)
        label = groups(len(cells), pairs_within(cells, 2))
        for k in range(label.max() + 1):
            yield group[label[cell.ravel()] == k]


def most_left(model: Model, boxes: Boxes) -> str:
    """Return which creases are at +-pi in most of the boxes that were left; "" where none are, or no box was left."""
    if not len(boxes):
        return ""
    at_limit, count = np.unique(boxes.pins.T != 0, axis=0, return_counts=True)
    creases = np.flatnonzero(at_limit[int(count.argmax())][model.variable_of_crease]) + 1
    numbers = ", ".join(map(str, creases.tolist()))
    return (
        f"most are left with crease{'s' * (len(creases) > 1)} {numbers} at +-pi" if numbers else ""
    )


def by_stratum(boxes: Boxes) -> Iterator[np.ndarray]:
    """Numbers of the boxes of each stratum that has some."""
    if not len(boxes):
        return
    _, inverse = np.unique(boxes.pins.T, axis=0, return_inverse=True)
    for s in range(int(inverse.max()) + 1):
        yield np.flatnonzero(inverse.ravel() == s)


def reason_of(system: BoxKkt, boxes: Boxes) -> tuple[str, bool]:
    """Return why no root was certified, and whether that is because closure loses rank."""
    pins = boxes.pins[:, 0]
    free = pins == 0
    if free.sum() < system.m:
        return f"{int(free.sum())} free variables, {system.m} closure equations", True
    x = 0.5 * (boxes.lower.min(axis=1) + boxes.upper.max(axis=1))
    least = system.least_slope(x[None], pins[None])[0]
    if least < LOW:
        return f"closure loses rank (singular value {least:.1e})", True
    return "no root was certified", False


def cluster_of(model: Model, boxes: Boxes, reason: str) -> Cluster:
    """Describe boxes of one stratum."""
    free = boxes.pins[:, 0] == 0
    sides = np.where(boxes.pins == 0, (boxes.upper - boxes.lower) / (2 * math.pi), 1.0)
    k, rest = model.parameters.stiffness[:, None], model.parameters.rest[:, None]
    far = np.maximum(np.abs(boxes.lower - rest), np.abs(boxes.upper - rest))
    near = np.maximum(np.maximum(boxes.lower - rest, rest - boxes.upper), 0.0)
    low, high = (0.5 * model.scale * (k * v**2).sum(axis=0) for v in (near, far))
    lower, upper = (tuple(v.tolist()) for v in (boxes.lower.min(axis=1), boxes.upper.max(axis=1)))
    energies = float(low.min()), float(high.max())
    return Cluster(
        lower,
        upper,
        tuple(boxes.pins[:, 0].tolist()),
        reason,
        len(boxes),
        float(sides.prod(axis=0).sum()) if free.any() else 1.0,
        energies if model.parameters.laws is None else energy_bounds(model, lower, upper),
    )


def _near_flat(model: Model, radius: float) -> Cluster:
    n = model.size
    box = Boxes(
        np.full((n, 1), -radius),
        np.full((n, 1), radius),
        np.zeros((n, 1), np.int8),
    )
    return cluster_of(model, box, "near the flat state")
