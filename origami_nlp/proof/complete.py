"""From a scene to all of its critical points."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CURVED, groups, pairs_within
from origami_nlp.pattern import Scene
from origami_nlp.proof.boxes import SMALLEST, Boxes, BoxProblem, joined, prune, strata
from origami_nlp.proof.flat import RADII, Flat, FlatVertex, flat_lemma
from origami_nlp.proof.pieces import Piece, piece_of
from origami_nlp.proof.reduced import Gap, ReducedVertex
from origami_nlp.proof.result import (
    Proof,
    ProofOptions,
    ProvedState,
    Region,
    joined as joined_proofs,
)
from origami_nlp.proof.roots import (
    BoxKkt,
    Roots,
    certify,
    different,
    holds,
    joined_roots,
    newton,
)
from origami_nlp.proof.touches import (
    APART,
    CROSSED,
    ContactStratum,
    contact_strata,
    separation,
    why_no_touches,
)

MOST_DOF = 4
"""Degrees of freedom up to which it is tried: each multiplies boxes by about 11."""
NEAR = 0.05
"""Boxes this near to the flat state [rad], beyond its lemma, are made smaller too."""
LOW = 1e-4
"""Smallest singular value of closure on the free variables, in the smallest boxes, that counts as regular."""
SMALLER = (1e-7, 1e-9, 1e-11)
"""Widths [rad] to which candidates that hold no certified root are cut once more where closure has full rank."""
MOST_SMALLER = 20_000
"""Boxes for each of these."""
BESIDE, FEW = 1e-4, 300
"""Radius [rad], and boxes, in which it is asked whether a state folded flat is alone."""
ISOLATED = 5_000
"""Candidates of a set of touches up to which they are taken for isolated points, and not for a curve."""


def why_not(vertex: ReducedVertex) -> str:
    """Return why boxes do not prove the list of a vertex; "" where they may."""
    scene = vertex.scene
    if scene.loads:
        return "dead loads: proofs know springs and torques on creases only"
    if not vertex.problem.has_limits:
        return "without fold limits fold angles are not bounded by +-pi"
    if not scene.vertex.flat:
        return "the paper does not lie flat: proofs are for flat sheets"
    if vertex.dof > MOST_DOF:
        return f"{vertex.dof} degrees of freedom (at most {MOST_DOF})"
    if vertex.dof <= 0 and vertex.winding == 1:
        return "nothing can move: the states listed are all that were looked for"
    if scene.laws:
        return "hinge laws: proofs know linear springs"
    return why_no_touches(vertex) if scene.contact == "full" else ""


def prove_each(
    vertices: Sequence[ReducedVertex],
    *,
    until: float = math.inf,
    boxes: int = ProofOptions().boxes,
) -> Proof:
    """Find every critical point of a scene, of all its windings; in so many boxes each, otherwise as `prove`."""
    return joined_proofs([prove(vertex, until=until, boxes=boxes) for vertex in vertices])


def prove(
    vertex: ReducedVertex, *, until: float = math.inf, boxes: int = ProofOptions().boxes
) -> Proof:
    """Find every critical point of a scene within fold limits or with full contact.

    Parameters
    ----------
    vertex
        Of a scene with contact "fold-limits" or "full".
    until
        Stop then (`time.monotonic`); what is left is undecided.
    boxes
        At most so many (which, unlike a time, ends at the same place everywhere).

    Returns
    -------
    Proof

    Raises
    ------
    OptionError
        If `why_not` names a reason.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> vertex = Vertex.from_degrees((70, 80, 120, 90))
    >>> scene = Scene(vertex, (1, 2, 3, 2), (1.0, -0.5, 0.3, 0.8), "none", "full")
    >>> proof = prove(ReducedVertex(scene))
    >>> proof.finished, len(proof.minima)
    (True, 2)
    """
    check_type("vertex", vertex, ReducedVertex)
    started = time.process_time()
    posed, flat = pose(vertex)
    near = flat.radius or (RADII[0] if vertex.scene.group.is_trivial else 0.0)
    full = vertex.scene.contact == "full"
    within = ContactStratum((), posed, strata(vertex.size, vertex.problem.fold_limits))
    treated, crossing, finished = flat.boxes, 0, True
    points: list[ProvedState] = []
    left: list[Region] = []
    region = partial(_region, vertex)
    if flat.radius and flat.minimum is None:
        left.append(region(_box(np.zeros(vertex.size), 0.0), flat.text, singular=True, alone=True))
    for stratum in (within, *(contact_strata(vertex) if full else ())):
        touches, most = stratum.touches, boxes - (treated - flat.boxes)
        names = "".join(f"; {t.text}" for t in touches)
        beside = 0.0 if touches else near
        found = prune(stratum.posed, stratum.start, flat=beside, most=most, until=until)
        treated += found.boxes
        finished &= not len(found.open)
        late = "time was up, or the number of boxes" + names
        left += [region(found.open[g], late) for g in by_stratum(found.open)]
        if found.flat and not flat.radius:
            left.append(region(_box(np.zeros(vertex.size), near), "near the flat state"))
        # critical points that are isolated leave few boxes
        if touches and len(found.candidates) > ISOLATED:
            some = (found.candidates[g] for g in by_stratum(found.candidates))
            left += [region(one, "a curve" + names) for one in some]
            continue
        system = BoxKkt(vertex, touches)
        roots, rest, more = certified(system, stratum.posed, found.candidates, beside)
        treated += more
        # a root with a free angle at its limit is none of the open stratum: the state belongs to others
        room = vertex.problem.fold_limits.room(roots.x)
        inside = ((room > roots.radius[:, None]) | (roots.pins != 0)).all(axis=1)
        for i in np.flatnonzero(~inside).tolist():
            reason = "free angles at their limits: a state of other strata" + names
            box = _box(roots.x[i], roots.radius[i])
            left.append(region(box, reason, singular=True, alone=True))
        for group in (rest[g] for g in clusters(rest)):
            reason, singular, alone = reason_of(system, group)
            if singular and not (alone or touches):
                lemma = lemma_at(vertex, group)
                alone, treated = lemma.radius > 0, treated + lemma.boxes
            left.append(region(group, reason + names, singular, alone))
        roots = roots[np.flatnonzero(inside)]
        pins = vertex.problem.fold_limits.folded_flat(roots.pins)
        verdicts, sides = (
            separation(vertex, roots.x, roots.radius, pins, touches)
            if full and len(roots)
            else (np.full(len(roots), APART), np.zeros((len(roots), 0)))
        )
        for i, verdict in enumerate(verdicts.tolist()):
            if verdict == CROSSED or (verdict != APART and vertex.problem.refuses(roots.x[i])):
                crossing += 1
                continue
            point = _point(vertex, roots, i, touches, sides[i])
            # layers may hold what would leave, whatever else is said of it
            if verdict != APART and (touches or not point.is_minimum):
                point = replace(point, is_minimum=None)
            points.append(point)
    return Proof(
        points=tuple(sorted(points, key=lambda p: _energy(vertex, p.fold_angles))),
        regions=tuple(left),
        boxes=treated,
        seconds=time.process_time() - started,
        over=_ranges_over(vertex.scene),
        finished=finished,
        crossing=crossing,
    )


def _energy(vertex: ReducedVertex, fold_angles: np.ndarray) -> float:
    """Return the energy of a state."""
    return float(vertex.problem.energy(vertex.problem.reduce(fold_angles)))


def _ranges_over(scene: Scene) -> str:
    """Say over which states a proof ranges, where a symmetry is imposed."""
    if scene.group.is_trivial:
        return ""
    wind = ""
    if scene.windings != (1,):
        wind = f", winding {' or '.join(map(str, scene.windings))} times round its axis"
    return f"among closed states that keep {scene.group.name}{wind}"


def pose(vertex: ReducedVertex) -> tuple[Piece, Flat]:
    """Return the rows of a vertex over boxes, and what is shown of its flat state.

    Parameters
    ----------
    vertex
        That `why_not` has nothing against.

    Raises
    ------
    OptionError
        If it has.
    """
    if why := why_not(vertex):
        raise OptionError(why)
    piece = piece_of(vertex)
    if vertex.winding == 1:
        return piece, _within_stops(flat_lemma(FlatVertex(vertex)), vertex)
    return piece, Flat(0.0, 0, None)


def _within_stops(flat: Flat, vertex: ReducedVertex) -> Flat:
    """Return what is shown of the flat state where it may be at stops, or beyond one: its neighbours are others."""
    low, high = vertex.problem.fold_limits.low, vertex.problem.fold_limits.high
    if ((low < 0) & (high > 0)).all():
        return flat
    return replace(flat, minimum=False if (low > 0).any() or (high < 0).any() else None)


def certified(
    system: BoxKkt, posed: BoxProblem, boxes: Boxes, flat: float
) -> tuple[Roots, Boxes, int]:
    """Certify roots of candidates; boxes that none holds, and where closure has full rank, are made smaller.

    Returns
    -------
    roots : Roots
        Different ones, each held by some box.
    rest : Boxes
        Those that no root holds.
    more : int
        Boxes treated.
    """
    found, more = _roots_of(system, boxes[:0]), 0
    fresh = boxes
    for small in (0.0, *SMALLER):
        if small:
            which = _regular(system, boxes, flat)
            if not which.any():
                continue  # the same boxes would give the same roots
            again = prune(posed, boxes[which], flat=flat, small=small, most=MOST_SMALLER)
            fresh = joined([again.candidates, again.open])
            boxes, more = joined([boxes[~which], fresh]), more + again.boxes
        roots = different(joined_roots([found, _roots_of(system, fresh)]), len(found))
        number = holds(system, roots, boxes)
        found = roots[np.array(sorted({*range(len(found)), *number[number >= 0].tolist()}), int)]
        boxes = boxes[number < 0]
    return found, boxes, more


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


def _regular(system: BoxKkt, boxes: Boxes, flat: float) -> np.ndarray:
    """Return at which boxes closure has full rank, on the free variables and for their size, [K]."""
    pins = boxes.pins.T
    x = 0.5 * (boxes.lower + boxes.upper).T
    near = (np.abs(x).max(axis=1) < NEAR) & (flat > 0)  # beyond the flat state's lemma
    return near | (system.least_slope(x, pins) > 3 * SMALLEST)


def _point(
    vertex: ReducedVertex, roots: Roots, i: int, touches: tuple[Gap, ...], sides: np.ndarray
) -> ProvedState:
    """State a root in the scene's units, and decide it by the signs of all multipliers and its index.

    Strict complementarity and a positive definite reduced Hessian: second-order sufficiency (Nocedal & Wright, theorem
    12.6).
    """
    pins, signs, scale = roots.pins[i], roots.signs[i], vertex.problem.scale
    equations = piece_of(vertex).pivots
    # the moment is half of the multipliers of vec q (`kkt.moment`): dq/dphi = c q / 2
    half = 0.5 if equations == 3 else 1.0
    lam = scale * roots.lam[i]
    # side times multiplier: below 0 the energy falls as the contact opens
    forces = lam[equations:] * np.where(sides == 0, 1, sides)
    # known to the share of the uniqueness box that the root may lie in
    doubt = scale * roots.spread[i] * roots.radius[i] / roots.unique[i]
    # as many contacts as degrees of freedom leave nothing to bend
    all_held = bool(touches) and len(touches) + np.count_nonzero(pins) == vertex.dof
    index = 0 if all_held else None if roots.index[i] < 0 else int(roots.index[i])
    decided: bool | None = None
    if (signs > 0).any() or (forces < -doubt).any() or index:
        decided = False
    elif index == 0 and (signs[pins != 0] < 0).all() and (forces > doubt).all():
        decided = True
    return ProvedState(
        vertex.problem.expand(roots.x[i]),
        float(roots.radius[i]),
        decided,
        index,
        float(roots.unique[i]),
        tuple(pins.tolist()),
        tuple((half * lam[:equations]).tolist()),
        tuple(signs.tolist()),
        touches,
        tuple(forces.tolist()),
    )


def clusters(boxes: Boxes) -> Iterator[np.ndarray]:
    """Group boxes of one stratum that are close to each other: cells of twenty times the smallest are no two apart."""
    middle = 0.5 * (boxes.lower + boxes.upper)
    # other strata are far away
    cells = np.concatenate([np.floor(middle / (20 * SMALLEST)), 9.0 * boxes.pins]).T
    cells, cell = np.unique(cells, axis=0, return_inverse=True)
    label = groups(len(cells), pairs_within(cells, 2))[cell.ravel()] if len(boxes) else np.zeros(0)
    return (np.flatnonzero(label == k) for k in range(int(label.max(initial=-1)) + 1))


def by_stratum(boxes: Boxes) -> Iterator[np.ndarray]:
    """Numbers of the boxes of each stratum that has some."""
    strata_, which = np.unique(boxes.pins.T, axis=0, return_inverse=True)
    return (np.flatnonzero(which.ravel() == s) for s in range(len(strata_)))


def reason_of(system: BoxKkt, boxes: Boxes) -> tuple[str, bool, bool]:
    """Return why no root was certified, whether as closure loses rank, and whether one state at most is there.

    One is in a convex set over which slopes of closure, and of what creases on one line ask for, by the free variables
    are independent columns.
    """
    piece, pins = system.piece, boxes.pins[:, 0]
    free = pins == 0
    low, high = boxes.lower.min(axis=1), boxes.upper.max(axis=1)
    x = 0.5 * (low + high)
    twins = [row[None] / np.abs(row).max() for _, row in piece.twins_on(pins)]
    columns = np.concatenate([system.vanishing(x[None])[1][0], *twins])[:, free]
    change = system.beta.sum() ** 2 * (high - low).max() + system.noise
    slopes = np.linalg.svd(columns, compute_uv=False)
    enough = len(columns) >= free.sum()
    alone = bool(enough and slopes.min(initial=np.inf) > LOW + system.m * change)
    if free.sum() < system.m:
        return f"{int(free.sum())} free variables, {system.m} closure equations", True, alone
    least = system.least_slope(x[None], pins[None])[0]
    if least < LOW:
        return f"closure loses rank (singular value {least:.1e})", True, alone
    return "no root was certified", False, False


def lemma_at(vertex: ReducedVertex, boxes: Boxes) -> Flat:
    """Return what is shown of the state folded flat that boxes of a stratum are round."""
    base = math.pi * np.rint(boxes.lower.mean(axis=1) / math.pi)[:, None]
    reach = max(np.abs(boxes.lower - base).max(), np.abs(boxes.upper - base).max())
    if reach > BESIDE or vertex.winding != 1:
        return Flat(0.0, 0, None)
    return flat_lemma(FlatVertex(vertex, base[:, 0], boxes.pins[:, 0]), (BESIDE,), FEW)


def _box(x: np.ndarray, radius: float) -> Boxes:
    """Return the box within a radius of a state."""
    x = x[:, None]
    return Boxes(x - radius, x + radius, np.zeros(x.shape, np.int8))


def _region(
    vertex: ReducedVertex, boxes: Boxes, reason: str, singular: bool = False, alone: bool = False
) -> Region:
    """Return the hull of boxes as fold angles of all creases."""
    ends = boxes.lower.min(axis=1), boxes.upper.max(axis=1)
    low, high = (vertex.problem.expand(x) for x in ends)
    return Region(np.minimum(low, high), np.maximum(low, high), reason, singular, alone)
