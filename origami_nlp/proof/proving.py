"""From an origami to its proof: a vertex by boxes of fold angles, a sheet of vertices of degree four along curves."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CURVED
from origami_nlp.pattern import Pattern, Scene, in_plane
from origami_nlp.proof.boxes import SMALLEST, Boxes, BoxProblem, by_stratum, clusters, prune, strata
from origami_nlp.proof.certificate import (
    Certificate,
    CertifiedState,
    OpenRegion,
    Proof,
    ProofOptions,
    ProvedState,
    Region,
    StatedSheet,
)
from origami_nlp.proof.flat import RADII, Flat, FlatVertex, flat_lemma
from origami_nlp.proof.pieces import Piece, ReducedVertex, piece_of
from origami_nlp.proof.products import FoldingSheet, as_folding
from origami_nlp.proof.quads import QuadSheet, as_quads
from origami_nlp.proof.roots import (
    BoxKkt,
    Roots,
    certify as certify_roots,
    different,
    holds,
    newton,
)
from origami_nlp.proof.rows import Gap, joined
from origami_nlp.proof.sheets import Budget, flat_sheet, precision
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
LOW = 1e-4
"""Smallest singular value of closure on the free variables, in the smallest boxes, that counts as regular."""
WIDTHS, MOST_SMALLER = (SMALLEST, 1e-7, 1e-9, 1e-11), 20_000
"""Widths [rad] to which candidates that hold no root are cut, and boxes for each."""
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


def prove(
    *vertices: ReducedVertex, until: float = math.inf, boxes: int = ProofOptions().boxes
) -> Proof:
    """Find every critical point of a scene within fold limits or with full contact.

    Parameters
    ----------
    *vertices
        Of a scene with contact "fold-limits" or "full", one for each of its windings.
    until
        Stop then (`time.monotonic`); what is left is undecided.
    boxes
        At most so many for each (which, unlike a time, ends at the same place everywhere).

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
    started = time.process_time()
    searches = [BoxSearch(vertex, boxes, until) for vertex in vertices]
    for one in searches:
        one.run()
    return Proof(
        points=tuple(p for one in searches for p in sorted(one.points, key=one.energy)),
        regions=tuple(r for one in searches for r in one.open),
        boxes=sum(one.looked for one in searches),
        seconds=time.process_time() - started,
        over=_ranges_over(vertices[0].scene),
        finished=all(one.finished for one in searches),
        crossing=sum(one.crossing for one in searches),
    )


def _ranges_over(scene: Scene) -> str:
    """Say over which states a proof ranges, where a symmetry is imposed."""
    if scene.group.is_trivial:
        return ""
    wind = ""
    if scene.windings != (1,):
        wind = f", winding {' or '.join(map(str, scene.windings))} times round its axis"
    return f"among closed states that keep {scene.group.name}{wind}"


class BoxSearch:
    """All strata of limits and touches of a vertex, and its critical points on them.

    Attributes
    ----------
    points, open
        What is shown, and what is left.
    looked, crossing, finished
        As of `Proof`.
    """

    def __init__(self, vertex: ReducedVertex, boxes: int, until: float) -> None:
        self.vertex, self.until = vertex, until
        self.posed, self.flat = pose(vertex)
        self.looked, self.most = self.flat.boxes, boxes + self.flat.boxes
        self.near = self.flat.radius or (RADII[0] if vertex.scene.group.is_trivial else 0.0)
        self.points, self.open = list[ProvedState](), list[Region]()
        self.crossing, self.finished = 0, True

    def run(self) -> None:
        """Go through all strata."""
        vertex, flat = self.vertex, self.flat
        if flat.radius and flat.minimum is None:
            self._leave(_box(np.zeros(vertex.size), 0.0), flat.text, singular=True, alone=True)
        self._on(ContactStratum((), self.posed, strata(vertex.size, vertex.problem.fold_limits)))
        if vertex.scene.contact == "full":
            for stratum in contact_strata(vertex):
                self._on(stratum)

    def energy(self, point: ProvedState) -> float:
        """Return the energy of a state."""
        problem = self.vertex.problem
        return float(problem.energy(problem.reduce(point.fold_angles)))

    def _on(self, stratum: ContactStratum) -> None:
        """Find the critical points of strata that have their touches in common."""
        vertex, touches = self.vertex, stratum.touches
        names = "".join(f"; {t.text}" for t in touches)
        beside, most = 0.0 if touches else self.near, self.most - self.looked
        found = prune(stratum.posed, stratum.start, flat=beside, most=most, until=self.until)
        self.looked += found.boxes
        self.finished &= not len(found.open)
        late = "time was up, or the number of boxes" + names
        for some in by_stratum(found.open):
            self._leave(some, late)
        if found.flat and not self.flat.radius:
            self._leave(_box(np.zeros(vertex.size), self.near), "near the flat state")
        # critical points that are isolated leave few boxes
        if touches and len(found.candidates) > ISOLATED:
            for some in by_stratum(found.candidates):
                self._leave(some, "a curve" + names)
            return
        system = BoxKkt(vertex, touches)
        roots, rest, more = certified(system, stratum.posed, found.candidates, beside)
        self.looked += more
        # a root with a free angle at its limit is none of the open stratum: the state belongs to others
        room = vertex.problem.fold_limits.room(roots.x)
        inside = ((room > roots.radius[:, None]) | (roots.pins != 0)).all(axis=1)
        for i in np.flatnonzero(~inside).tolist():
            reason = "free angles at their limits: a state of other strata" + names
            self._leave(_box(roots.x[i], roots.radius[i]), reason, singular=True, alone=True)
        for some in clusters(rest):
            reason, singular, alone = reason_of(system, some)
            if singular and not (alone or touches):
                lemma = lemma_at(vertex, some)
                alone, self.looked = lemma.radius > 0, self.looked + lemma.boxes
            self._leave(some, reason + names, singular, alone)
        self._judge(roots[np.flatnonzero(inside)], touches)

    def _judge(self, roots: Roots, touches: tuple[Gap, ...]) -> None:
        """Note what critical points are, but those at which facets cross."""
        vertex, limits = self.vertex, self.vertex.problem.fold_limits
        verdicts, sides = np.full(len(roots), APART), np.zeros((len(roots), 0))
        if vertex.scene.contact == "full" and len(roots):
            pins = limits.folded_flat(roots.pins)
            verdicts, sides = separation(vertex, roots.x, roots.radius, pins, touches)
        for i, verdict in enumerate(verdicts.tolist()):
            if verdict == CROSSED or (verdict != APART and vertex.problem.refuses(roots.x[i])):
                self.crossing += 1
                continue
            point = _point(vertex, roots, i, touches, sides[i])
            # layers may hold what would leave, whatever else is said of it
            if verdict != APART and (touches or not point.is_minimum):
                point = replace(point, is_minimum=None)
            self.points.append(point)

    def _leave(
        self, boxes: Boxes, reason: str, singular: bool = False, alone: bool = False
    ) -> None:
        """Leave the hull of boxes open, as fold angles of all creases."""
        ends = boxes.lower.min(axis=1), boxes.upper.max(axis=1)
        low, high = (self.vertex.problem.expand(x) for x in ends)
        low, high = np.minimum(low, high), np.maximum(low, high)
        self.open.append(Region(low, high, reason, singular, alone))


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
    check_type("vertex", vertex, ReducedVertex)
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
    """Return different roots that candidates hold, the boxes that hold none, and how many more were treated.

    Where closure has full rank, boxes that hold none are made smaller.
    """
    roots, used, more = _roots_of(system, boxes[:0]), set[int](), 0
    for small in WIDTHS:
        middle = 0.5 * (boxes.lower + boxes.upper).T
        which = system.least_slope(middle, boxes.pins.T) > 3 * SMALLEST
        if small < SMALLEST and not which.any():
            break  # the same boxes would give the same roots
        again = prune(posed, boxes[which], flat=flat, small=small, most=MOST_SMALLER)
        boxes = joined([boxes[~which], again.candidates, again.open], -1)
        roots, more = different(joined([roots, _roots_of(system, boxes)])), more + again.boxes
        number = holds(system, roots, boxes)
        used |= {*number[number >= 0].tolist()}
        boxes = boxes[number < 0]
    return roots[np.array(sorted(used), int)], boxes, more


def _roots_of(system: BoxKkt, boxes: Boxes) -> Roots:
    """Newton from the middle of every box, and certificates of what converged, each root once."""
    pins = boxes.pins.T
    x, lam, converged = newton(system, 0.5 * (boxes.lower + boxes.upper).T, pins)
    some = np.flatnonzero(converged)
    # most boxes lead to the same few states
    cells = np.concatenate([pins[some], np.rint(x[some] / CURVED)], axis=1)
    some = some[np.sort(np.unique(cells, axis=0, return_index=True)[1])]
    return different(certify_roots(system, x[some], lam[some], pins[some]))


def _point(
    vertex: ReducedVertex, roots: Roots, i: int, touches: tuple[Gap, ...], sides: np.ndarray
) -> ProvedState:
    """State a root in the scene's units, and decide it by the signs of all multipliers and its index.

    Strict complementarity and a positive definite reduced Hessian: second-order sufficiency (Nocedal & Wright, theorem
    12.6).
    """
    pins, signs, scale = roots.pins[i], roots.signs[i], vertex.problem.scale
    equations = piece_of(vertex).rank
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


def as_sheet(pattern: Pattern) -> tuple[FoldingSheet | QuadSheet | None, str]:
    """Return the sheet of a pattern as its proof reads it, or None and why its closed states are not enumerated."""
    sheet, why = flat_sheet(pattern)
    if sheet is None:
        return None, why
    with precision():
        return as_folding(sheet) if sheet.folds_flat else as_quads(sheet)


def why_no_sheet(pattern: Pattern) -> str:
    """Return why not all closed states of a pattern are known as those of a sheet; "" where they are.

    Parameters
    ----------
    pattern
        Of any number of vertices.

    Returns
    -------
    str
        The first vertex that is in the way, and why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_sheet
    >>> why_no_sheet(o.examples.pattern("metasheet", 3, 3))
    ''
    >>> why_no_sheet(o.examples.pattern("waterbomb", 2, 2))
    'vertex 0 has not four creases'
    """
    return as_sheet(pattern)[1]


def why_no_contact(pattern: Pattern) -> str:
    """Return why a list of a sheet that is proved within fold limits is not one with contact; "" where it is.

    Facets round a vertex do not cross where it closes turned by no full turn and no crease is beyond +-pi: each is
    convex and so within the cone of its sector.  The four sectors are a closed curve of length 2 pi on the sphere, so
    within a hemisphere; seen from its centre that is a quadrangle in the plane, of whose two pairs of opposite sides
    one crosses at most.  A crossing would be a full turn more, and such states are none of the sheet's.

    Parameters
    ----------
    pattern
        A sheet of which `why_no_sheet` says nothing.
    """
    sheet, _ = as_sheet(pattern)
    if sheet is not None and sheet.folds_flat:
        return "contact of sheets that fold flat is not proved"
    if len(pattern.vertices) > 1:
        return "contact of sheets of several vertices is not proved"
    if len(pattern.polygons) != pattern.facets:
        return "a facet is of several pieces"
    if not all(_is_convex(in_plane(pattern)[list(p)]) for p in pattern.polygons):
        return "a facet is not convex"
    return ""


def _is_convex(x: np.ndarray) -> bool:
    """Return whether a polygon [q, 2] is convex, exactly; corners of 180 degrees may be."""
    p = [[Fraction(a) for a in row] for row in x.tolist()]
    turns = [
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
        for a, b, c in zip(p, p[1:] + p[:1], p[2:] + p[:2], strict=True)
    ]
    return min(turns) >= 0 or max(turns) <= 0


def prove_sheet(pattern: Pattern, *, boxes: int = 1_000_000, until: float = math.inf) -> Proof:
    """Find every minimum of the energy of a sheet of vertices of degree four within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Flat vertices of degree four, in any order, with cycles; all fold flat, or none does and no opposite creases of
        one are in a line.
    boxes
        At most so many intervals of curves; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    Proof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such sheet: `why_no_sheet` says why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import prove_sheet
    >>> proof = prove_sheet(o.examples.pattern("metasheet", 3, 3))
    >>> len(proof.minima), proof.complete
    (3, True)
    >>> proof = prove_sheet(o.examples.pattern("miura", 2, 3))
    >>> len(proof.minima), proof.complete
    (14, True)
    """
    started = time.process_time()
    sheet, why = as_sheet(pattern)
    if sheet is None:
        raise OptionError(f"pattern = {pattern.title}: no sheet that can be proved: {why}")
    budget = Budget(boxes, lambda: time.monotonic() > until)
    with precision():
        search = sheet.search(budget)
        search.run()
    over, moved = f"all closed states within fold limits are {search.over}", sheet.sheet.moved
    if sheet.deviation:
        over += f"; of the sheet whose relations of sectors are exact, as the file's are to {sheet.deviation:.2g} rad"
    over += f"; laid into its plane to {moved:.2g} rad" * bool(moved)
    seconds = time.process_time() - started
    return Proof(tuple(search.minima), tuple(search.open), budget.looked, seconds, over)


def certify(origami: Scene | Pattern, boxes: int) -> Certificate:
    """Prove the list of an origami within fold limits, in the form that is written to a file.

    Parameters
    ----------
    origami
        A scene, or a sheet of which `why_no_sheet` says nothing.
    boxes
        That a proof may take.

    Returns
    -------
    Certificate
        Of all windings of a scene.

    Raises
    ------
    OptionError
        If facets may touch, a facet is of several pieces, or a sheet has stops or hinge laws: the check knows none.
    """
    if isinstance(origami, Scene):
        if origami.contact == "full":
            raise OptionError(
                "a certificate names no touches of facets: it is for contact = 'fold-limits'"
            )
        proof = prove(*map(ReducedVertex, origami.of_each_winding), boxes=boxes)
        stated: dict[str, Any] = {"scene": origami}
    else:
        sheet, _ = as_sheet(origami)
        stated = {"sheet": StatedSheet.of(origami, sheet.deviation if sheet else 0.0)}
        proof = prove_sheet(origami, boxes=boxes)
    return Certificate(
        proof.over or "all closed states within fold limits",
        tuple(CertifiedState(tuple(m.fold_angles.tolist()), m.radius) for m in proof.minima),
        tuple(
            OpenRegion(tuple(r.lower.tolist()), tuple(r.upper.tolist()), r.reason)
            for r in proof.regions
        ),
        **stated,
    )
