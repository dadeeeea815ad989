"""From a scene to all of its critical points."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.programme import Model
from origami_nlp.proof.boxes import SMALL, Boxes, Posed, prune, strata
from origami_nlp.proof.chains import Vertex
from origami_nlp.proof.flat import RADII, Flat, flat_lemma
from origami_nlp.proof.result import Cluster, CriticalPoint, Proof
from origami_nlp.proof.roots import Roots, System, certify, holds, newton
from origami_nlp.proof.tree import Kind, Recorder

TOGETHER = 20 * SMALL
"""Boxes of a stratum that are no further apart [rad] are one cluster."""
LOW = 1e-3
"""Smallest singular value of closure on the free variables, in a box of `SMALL`, from which on it counts as regular."""


def prove(model: Model, *, seconds: float | None = None, record: bool = False) -> Proof:
    """Find every critical point of a scene within fold limits, by branch and prune and certificates of all roots.

    Parameters
    ----------
    model
        Of a scene with contact "fold-limits".
    seconds
        Stop after this time; what is left then is undecided.
    record
        Whether to keep the tree of boxes.

    Returns
    -------
    Proof

    Raises
    ------
    OptionError
        If the scene has other contact, or is no flat sheet.

    Examples
    --------
    >>> from origami_nlp import Model, Scene, Vertex
    >>> vertex = Vertex.from_degrees((70, 80, 120, 90))
    >>> scene = Scene(vertex, (1, 2, 3, 2), (1.0, -0.5, 0.3, 0.8), "none", "fold-limits")
    >>> proof = prove(Model(scene))
    >>> proof.complete, len(proof.minima)
    (True, 2)
    """
    check_type("model", model, Model)
    started = time.perf_counter()
    if model.scene.contact == "full":
        from origami_nlp.proof.touches import with_touches  # built on what is below

        limits = prove(Model(replace(model.scene, contact="fold-limits")), seconds=seconds)
        rest = None if seconds is None else max(seconds - (time.perf_counter() - started), 0.0)
        return with_touches(model, limits, seconds=rest)
    posed, flat = pose(model)
    start = strata(posed.size)
    recorder = Recorder(len(start)) if record else None
    radius = flat.radius or RADII[0]
    left = prune(posed, start, flat=radius, seconds=seconds, recorder=recorder)
    system = System(model)
    roots, which, rest = _certified(system, left.candidates)
    order = np.argsort([model.energy(x) for x in roots.x], kind="stable")
    points = tuple(_point(model, roots, int(i)) for i in order)
    position = np.empty(len(order), dtype=int)
    position[order] = np.arange(len(order))
    done = which >= 0
    groups = list(_clusters(rest))
    singular, undecided, leaves = [], [], []
    for group in groups:
        reason, is_singular = _reason(system, rest[group])
        kept = singular if is_singular else undecided
        leaves.append((group, Kind.SINGULAR if is_singular else Kind.UNDECIDED, len(kept)))
        kept.append(_cluster(model, rest[group], reason))
    if recorder:
        nodes = left.candidates.node
        recorder.leaves(nodes[done], Kind.ROOT, position[which[done]])
        for group, kind, number in leaves:
            recorder.leaves(rest.node[group], kind, number)
    for group in _by_stratum(left.open):
        if recorder:
            recorder.leaves(left.open.node[group], Kind.UNDECIDED, len(undecided))
        undecided.append(_cluster(model, left.open[group], "time was up"))
    if left.flat and not flat.radius:
        undecided.append(_near_flat(model, radius))
    return Proof(
        points,
        tuple(singular),
        tuple(undecided),
        left.boxes + flat.boxes,
        time.perf_counter() - started,
        not len(left.open),
        flat.text,
        flat.radius,
        flat.minimum,
        recorder.tree(posed.size, posed.minor_creases, posed.twins) if recorder else None,
    )


def pose(model: Model) -> tuple[Posed, Flat]:
    """Return the rows of a model over boxes, and what is shown of its flat state.

    Parameters
    ----------
    model
        Of a scene with contact "fold-limits".

    Returns
    -------
    posed : Posed
    flat : Flat

    Raises
    ------
    OptionError
        If the scene has other contact, or is no flat sheet.
    """
    scene = model.scene
    if scene.contact != "fold-limits":
        raise OptionError(f"contact = {scene.contact!r}: proofs are for contact = 'fold-limits'")
    if not scene.vertex.flat:
        raise OptionError("the vertex is not flat: proofs are for flat sheets")
    p = model.parameters
    if not scene.group.is_trivial:
        raise OptionError(f"symmetry {scene.group.name}: proofs are for symmetry = 'none'")
    if model.size < 4:
        raise OptionError("a vertex of degree 3 has no freedom")
    vertex = Vertex(p.sectors, p.stiffness, p.rest)
    return vertex, flat_lemma(vertex)


def _certified(system: System, boxes: Boxes) -> tuple[Roots, np.ndarray, Boxes]:
    """Certify roots of candidates: the roots, which of them holds each box (-1: none), the boxes that none holds."""
    x = (0.5 * (boxes.lower + boxes.upper)).T
    pins = boxes.pins.T
    x = np.where(pins == 0, x, math.pi * pins)
    start, lam, converged = newton(system, x, pins)
    some = np.flatnonzero(converged)
    roots, _ = certify(system, start[some], lam[some], pins[some])
    roots = roots[_different(roots)]
    which = holds(system, roots, boxes)
    used = np.unique(which[which >= 0])
    number = np.full(len(roots) + 1, -1)
    number[used] = np.arange(len(used))
    return roots[used], number[which], boxes[which < 0]


def _different(roots: Roots) -> np.ndarray:
    """Choose one of all that are the same: of one stratum, each within the other's uniqueness box."""
    kept: list[int] = []
    for i in range(len(roots)):
        same = [
            j
            for j in kept
            if (roots.pins[i] == roots.pins[j]).all()
            and np.abs(roots.x[i] - roots.x[j]).max() + roots.radius[i] < roots.unique[j]
        ]
        if not same:
            kept.append(i)
    return np.array(kept, dtype=int)


def _point(model: Model, roots: Roots, i: int) -> CriticalPoint:
    """State a root in the scene's units."""
    index = None if roots.index[i] < 0 else int(roots.index[i])
    signs = roots.signs[i]
    x, pins = roots.x[i], roots.pins[i]
    inside = np.abs(x) + roots.radius[i] < math.pi
    decided: bool | None = None
    if bool((signs > 0).any()) or (index is not None and index > 0):
        decided = False
    elif index == 0 and (signs[pins != 0] < 0).all():
        decided = True
    if not inside[pins == 0].all():  # a free angle at its limit
        decided = None
    half = 0.5 if model.equation_count == 3 else 1.0
    return CriticalPoint(
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


def _clusters(boxes: Boxes) -> Iterator[np.ndarray]:
    """Group boxes of one stratum that are close to each other."""
    for group in _by_stratum(boxes):
        open_ = list(group)
        while open_:
            found = [open_.pop(0)]
            for i in found:
                near = (
                    np.maximum(
                        boxes.lower[:, open_] - boxes.upper[:, [i]],
                        boxes.lower[:, [i]] - boxes.upper[:, open_],
                    ).max(axis=0)
                    <= TOGETHER
                )
                found += [j for j, n in zip(open_, near, strict=True) if n]
                open_ = [j for j, n in zip(open_, near, strict=True) if not n]
            yield np.array(sorted(found))


def _by_stratum(boxes: Boxes) -> Iterator[np.ndarray]:
    """Numbers of the boxes of each stratum that has some."""
    if not len(boxes):
        return
    _, inverse = np.unique(boxes.pins.T, axis=0, return_inverse=True)
    for s in range(int(inverse.max()) + 1):
        yield np.flatnonzero(inverse.ravel() == s)


def _reason(system: System, boxes: Boxes) -> tuple[str, bool]:
    """Say why no root was certified, and whether that is because closure loses rank."""
    pins = boxes.pins[:, 0]
    free = pins == 0
    if free.sum() < system.m:
        return f"{int(free.sum())} free variables, {system.m} closure equations", True
    x = 0.5 * (boxes.lower.min(axis=1) + boxes.upper.max(axis=1))
    x = np.where(free, x, np.pi * pins)[None]
    a = system.constraints(x)[1][0][:, free]
    least = float(np.linalg.svd(a, compute_uv=False)[-1])
    if least < LOW:
        return f"closure loses rank (singular value {least:.1e})", True
    return "no root was certified", False


def _cluster(model: Model, boxes: Boxes, reason: str) -> Cluster:
    """Describe boxes of one stratum."""
    free = boxes.pins[:, 0] == 0
    sides = np.where(boxes.pins == 0, (boxes.upper - boxes.lower) / (2 * math.pi), 1.0)
    k, rest = model.parameters.stiffness[:, None], model.parameters.rest[:, None]
    far = np.maximum(np.abs(boxes.lower - rest), np.abs(boxes.upper - rest))
    near = np.maximum(np.maximum(boxes.lower - rest, rest - boxes.upper), 0.0)
    low, high = (0.5 * model.scale * (k * v**2).sum(axis=0) for v in (near, far))
    return Cluster(
        tuple(boxes.lower.min(axis=1).tolist()),
        tuple(boxes.upper.max(axis=1).tolist()),
        tuple(boxes.pins[:, 0].tolist()),
        reason,
        len(boxes),
        float(sides.prod(axis=0).sum()) if free.any() else 1.0,
        (float(low.min()), float(high.max())),
    )


def _near_flat(model: Model, radius: float) -> Cluster:
    n = model.size
    box = Boxes(
        np.full((n, 1), -radius),
        np.full((n, 1), radius),
        np.zeros((n, 1), np.int8),
        np.zeros(1, int),
    )
    return _cluster(model, box, "near the flat state")
