"""Full contact: every critical point of the states whose facets do not cross, also where facets touch.

A local minimum x has fold limits P and gaps T closed and is a minimum among {closure, P, T}, also where the admissible
set is a union near x.  So it is critical in the sense of Fritz John, without a constraint qualification: with f degrees
of freedom and |P| + |T| < f all minors of [G | C | W] with one column more than there are equations vanish on the free
creases (W the gradients of T).  Where |P| + |T| = f every closed state is a candidate; where more is closed, x is among
the candidates of some f of the contacts.  Strata with |P| + |T| <= f are therefore all.  Those with T empty are treated
within fold limits; for f = 2 there remain one touch with at most one closed crease, and two touches.  A touch that
follows from closed creases (all between the ray and the facet are fully folded) holds on all of {closure, P}: left out.

Two kinds of strata of a vertex of degree five are left out as well, since x is on another stratum too:
- Sectors e and e+1 equal, crease e between them fully folded: rays e-1 and e+1 coincide, and a gap of one of them off a
  facet that the other bounds vanishes on all of {closure, crease e fully folded}.
- Ray k on facet k+2 and ray k+2 on facet k+4, sectors k and k+1 together less than pi.  If the rays differ, the great
  circles of both facets coincide, and creases k+3 and k+4 are at 0 or +-pi: one at +-pi is a stratum with one touch;
  both at 0 is the flat state, as facets k+2 to k+4 are then an arc longer than pi.  If the rays are one, crease k+1 is
  fully folded between equal sectors: the case before.

Gaps are those of the model, which leaves out what cannot touch.  On D_1 (four rays) facets 1 and 3 meet where rays 1
and 4 do, or where one of them lies on the mirror, its crease closed: the row is that the rays meet.

At each critical point the signs of all rays off all facets are enclosed (`facet_separation`).  Where facets cross it is
dropped.  Where all are apart but for P and T, of independent gradients, the signs of the Lagrange multipliers and the
index decide as within fold limits.  What remains are stacks of facets: there the package's exact test decides whether
the layers have an order (`Model.refuses`) and its cone the verdict (`classify`); `judged` names this, and such a point
is not proved.

Undecided or refused, by name: more than two degrees of freedom, C_n, wedges of more rays, sectors of pi and more, sets
of dimension one that contacts hold.  Singular flat foldings are listed.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, classify
from origami_nlp.numerics import INPUT_TOL, RESOLVED, SUMMED
from origami_nlp.pattern_problem import pose
from origami_nlp.problem import Model
from origami_nlp.proof.boxes import Boxes, BoxProblem, prune, strata
from origami_nlp.proof.complete import (
    by_stratum,
    certified,
    cluster_of,
    clusters,
    prove as prove_within_limits,
    reason_of,
)
from origami_nlp.proof.facet_separation import APART, CROSSED, Signs
from origami_nlp.proof.options import DEFAULT, ProofOptions
from origami_nlp.proof.pieces import piece_of
from origami_nlp.proof.result import Cluster, Proof, ProvedCriticalPoint
from origami_nlp.proof.roots import Roots
from origami_nlp.proof.system import BoxKkt
from origami_nlp.proof.touching_rows import Row, TouchedPiece


@dataclass(frozen=True, eq=False)
class ContactStratum:
    """Touches, and the boxes of the fold limits that go with them.

    Attributes
    ----------
    touches
        Gaps that are closed.
    posed
        Their rows.
    start
        Boxes.
    """

    touches: tuple[Row, ...]
    posed: BoxProblem
    start: Boxes


def prove(
    model: Model,
    *,
    seconds: float | None = None,
    until: float = math.inf,
    options: ProofOptions = DEFAULT,
) -> Proof:
    """Find every critical point of a scene within fold limits or with full contact.

    Parameters
    ----------
    model
        Of a scene with contact "fold-limits" or "full".
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
        If the scene has no contact, no degree of freedom, or is no flat sheet.

    Examples
    --------
    >>> from origami_nlp import Scene, Vertex
    >>> from origami_nlp.problem import Model
    >>> vertex = Vertex.from_degrees((70, 80, 120, 90))
    >>> proof = prove(Model(Scene(vertex, (1, 2, 3, 2), (1.0, -0.5, 0.3, 0.8), "none", "full")))
    >>> proof.complete, len(proof.minima)
    (True, 2)
    """
    check_type("model", model, Model)
    model.scene.check_no_forces("a proof")
    if (stated := _as_stated(model)) is not model:
        found = prove(stated, seconds=seconds, until=until, options=options)
        flat = np.zeros(model.size)
        shift = model.energy(flat) - stated.energy(flat)
        points = tuple(replace(p, energy=p.energy + shift) for p in found.points)
        singular, undecided = (
            tuple(replace(c, energies=(c.energies[0] + shift, c.energies[1] + shift)) for c in some)
            for some in (found.singular, found.undecided)
        )
        return replace(found, points=points, singular=singular, undecided=undecided)
    asked: dict[str, Any] = {"seconds": seconds, "until": until, "options": options}
    if model.scene.contact != "full":
        return prove_within_limits(model, **asked)
    started = time.process_time()
    # strata without touches
    limits = prove_within_limits(Model(replace(model.scene, contact="fold-limits")), **asked)
    over = None if seconds is None else max(seconds - (time.process_time() - started), 0.0)
    return with_touches(model, limits, seconds=over, until=until, options=options)


def _as_stated(model: Model) -> Model:
    """Return the model of a scene that states all of a model: a load on its creases is preload.

    Raises
    ------
    OptionError
        If its springs or sectors are others than those of its scene.
    """
    known, own = model.parameters, Model(model.scene).parameters
    if not np.array_equal(replace(known, load=own.load).vector, own.vector):
        raise OptionError(
            "the problem has other springs or sectors than its scene: pose the scene that has them"
        )
    load = known.load - own.load
    if not load.any():
        return model
    each = model.expand(load * model.scale / model.multiplicity)
    preload = np.array(model.scene.preload or [0.0] * model.scene.degree) + each
    return Model(replace(model.scene, preload=tuple(preload.tolist())))


def why_not(model: Model) -> str:
    """Return why touches of a model are not proved here; "" where they are."""
    s, dof = model.structure, model.dof
    if max(model.scene.vertex.sector_angles) >= math.pi - INPUT_TOL:
        return "a sector of 180 degrees or more"
    rays = len(s.has_crease)
    if s.kind == "C" and s.order > 1:
        return f"touches with symmetry {model.symmetry} are not proved"
    if s.kind == "D" and rays < 3:
        return f"touches of a {model.symmetry} wedge of {rays} rays are not proved"
    if not s.gaps:
        return ""
    if dof > 2:
        return f"{dof} degrees of freedom: touches are proved for at most 2"
    if s.kind == "C":
        return ""
    if model.scene.limits:
        return f"touches with stops of a {model.symmetry} wedge are not proved"
    fits = rays <= 3 if s.order > 1 else rays == 4 and all(s.has_crease)
    return "" if fits else f"touches of a {model.symmetry} wedge of {rays} rays are not proved"


def contact_strata(model: Model) -> Iterator[ContactStratum]:
    """List the strata with touches of a model that `why_not` has nothing against."""
    dof, piece = model.dof, piece_of(model)
    patterns = strata(model.size, model.fold_limits)
    flat = model.fold_limits.folded_flat(patterns.pins.T).T
    at_limit = (patterns.pins != 0).sum(axis=0)
    for touches in _sets(model):
        # |P| + |T| <= f
        allowed = at_limit <= dof - len(touches)
        posed = TouchedPiece(piece, touches)
        if touches[0].kind == "meet":  # the gap off facet 0 is none where that lies on the mirror
            on = patterns.pins[0] != 0
            allowed &= on == (touches[0].rays == (0, 3))
        for crease in range(model.size if model.structure.kind == "C" else 0):
            if any(_says_nothing(model, t, crease) for t in touches):
                allowed &= flat[crease] == 0
        if allowed.any():
            yield ContactStratum(touches, posed, patterns[allowed])


def _sets(model: Model) -> Iterator[tuple[Row, ...]]:
    """Sets of gaps that may be closed at once."""
    first: dict[tuple[int, ...], int] = {}
    for i, gap in enumerate(model.structure.gaps):
        first.setdefault(gap.rays, i)
    if model.structure.kind == "C":
        n = model.size
        rows = [
            Row("facet", rays, i)
            for rays, i in first.items()
            if 3 <= (rays[0] - rays[1]) % n <= n - 2
        ]
        for count in range(1, model.dof + 1):
            for touches in itertools.combinations(rows, count):
                if not _on_each_other(model, touches):
                    yield touches
    elif model.structure.order == 1:
        for rays in ((3, 0), (0, 3)) if first else ():
            yield (Row("meet", rays, first[(3, 0) if rays == (3, 0) else (0, 2)]),)
    else:
        # both at once: rays 1 and 3 on each other, which is crease 2 fully folded between equal sectors
        for (r, side), i in first.items():
            yield (Row("end" if side else "start", (r,), i),)


def _says_nothing(model: Model, touch: Row, crease: int) -> bool:
    """Whether a ray lies on an edge of the facet it touches where a crease between equal sectors is fully folded."""
    a, n = model.parameters.sectors, model.size
    if abs(a[crease - 1] - a[crease]) > SUMMED:
        return False
    ray, facet = touch.rays
    met = {(crease - 1) % n, (crease + 1) % n} - {ray}
    return len(met) == 1 and met <= {facet, (facet + 1) % n}


def _on_each_other(model: Model, touches: tuple[Row, ...]) -> bool:
    """Whether two contacts close at once only with coincident rays, a fully folded crease, or all flat (degree 5)."""
    a, n = model.parameters.sectors, model.size
    if len(touches) != 2 or n != 5:
        return False
    one, two = touches[0].rays, touches[1].rays
    for (k, j), other in ((one, two), (two, one)):
        if j == (k + 2) % n and other == (j, (j + 2) % n):
            return bool(a[k] + a[(k + 1) % n] < math.pi - RESOLVED)
    return False


def with_touches(
    model: Model,
    limits: Proof,
    *,
    seconds: float | None = None,
    until: float = math.inf,
    options: ProofOptions = DEFAULT,
) -> Proof:
    """Turn a proof within fold limits into one with full contact.

    Parameters
    ----------
    model
        Of the scene with contact "full".
    limits
        The proof of the same scene with contact "fold-limits".
    seconds
        Stop after so much processor time; what is left then is undecided.
    until
        Stop then (`time.monotonic`), as after `seconds`.
    options
        Widths of boxes, how many at most (which, unlike a time, ends at the same place everywhere), how many together.

    Returns
    -------
    Proof
        Points that certainly cross are left out.
    """
    started = time.process_time()
    end = math.inf if seconds is None else started + seconds
    treated, finished = 0, limits.finished
    singular, undecided = list(limits.singular), list(limits.undecided)
    why = why_not(model)
    points: list[ProvedCriticalPoint | None] = []
    if why:  # some of these cross: none is called a minimum
        points += [
            replace(p, is_minimum=False if p.is_minimum is False else None) for p in limits.points
        ]
        undecided.append(cluster_of(model, strata(model.size, model.fold_limits)[:1], why))
    else:
        points += _judged(model, _as_roots(limits.points, model.size), limits.points, ())
    # gaps closed as equations, creases pinned: boxes are pruned until small, and the roots of the KKT system certified
    for stratum in () if why else contact_strata(model):
        touches, names = stratum.touches, _names(model, stratum.touches)
        left = prune(
            stratum.posed,
            stratum.start,
            most=options.touching_boxes - treated,
            options=options,
            seconds=max(end - time.process_time(), 0.0),
            until=until,
        )
        treated += left.boxes
        finished &= not len(left.open)
        for group in by_stratum(left.open):
            why = f"the time, or the number of boxes, was up; {names}"
            undecided.append(cluster_of(model, left.open[group], why))
        # critical points that are isolated leave few boxes
        if len(left.candidates) > options.isolated_boxes:
            for group in by_stratum(left.candidates):
                undecided.append(cluster_of(model, left.candidates[group], f"a curve; {names}"))
            continue
        system = BoxKkt(model, tuple(t.gap for t in touches))
        roots, _, _, rest, more = certified(system, stratum.posed, left.candidates, 0.0, options)
        treated += more
        found = [_point(model, roots, i, touches) for i in range(len(roots))]
        new = [i for i, p in enumerate(found) if not _again(model, p, touches, limits.points)]
        which = np.array(new, dtype=int)
        points += _judged(model, roots[which], tuple(found[i] for i in new), touches)
        for group in clusters(rest, options):
            reason, is_singular = reason_of(system, rest[group])
            cluster = cluster_of(model, rest[group], f"{reason}; {names}")
            cluster = replace(cluster, touches=tuple(t.gap for t in touches))
            (singular if is_singular else undecided).append(cluster)
    kept = [p for p in points if p is not None]
    refuses = lru_cache(maxsize=None)(lambda x: model.refuses(np.array(x)))
    return replace(
        limits,
        points=tuple(sorted(kept, key=lambda p: p.energy)),
        singular=tuple(_refused(c, options.smallest, refuses) for c in singular),
        undecided=tuple(undecided),
        boxes=limits.boxes + treated,
        seconds=limits.seconds + time.process_time() - started,
        finished=finished,
        crossing=len(points) - len(kept),
    )


def _refused(cluster: Cluster, size: float, refuses: Callable[[tuple[float, ...]], str]) -> Cluster:
    """Return of a singular state whether its layers have no order: the state at multiples of pi that the box holds."""
    middle = 0.5 * (np.array(cluster.lower) + np.array(cluster.upper))
    flat = math.pi * np.round(middle / math.pi)
    x = np.where(np.abs(middle - flat) < size, flat, middle)
    why = refuses(tuple(x.tolist()))
    return replace(cluster, reason=f"{cluster.reason}; not admissible: {why}") if why else cluster


def _names(model: Model, touches: tuple[Row, ...]) -> str:
    return ", ".join(model.gap_name(model.structure.gaps[t.gap]) for t in touches)


def _as_roots(points: tuple[ProvedCriticalPoint, ...], n: int) -> Roots:
    """The states of points, for `Signs`."""
    x = np.array([p.x for p in points]).reshape(-1, n)
    pins = np.array([p.stratum for p in points]).reshape(-1, n)
    radius = np.array([p.radius for p in points])
    none = np.zeros(len(points))
    return Roots(x, none, pins, radius, none, none, none, none)


def _again(
    model: Model,
    point: ProvedCriticalPoint,
    touches: tuple[Row, ...],
    known: tuple[ProvedCriticalPoint, ...],
) -> bool:
    """Whether a point has more creases fully folded that keep these gaps closed, so that it has been counted."""
    for other in known:
        apart = max(abs(a - b) for a, b in zip(point.x, other.x, strict=True))
        # the other point's stratum lies in the closure of this one's: more creases fully folded, to the same sides
        finer = all(s in (0, t) for s, t in zip(point.stratum, other.stratum, strict=True))
        if finer and point.stratum != other.stratum and apart + other.radius < point.unique_radius:
            if all(_kept_closed(model, t, other.stratum) for t in touches):
                return True
    return False


def _kept_closed(model: Model, touch: Row, stratum: tuple[int, ...]) -> bool:
    """Whether all creases between a ray and what it touches are fully folded, one way round."""
    has = model.structure.has_crease
    flat = model.fold_limits.folded_flat(np.array(stratum))
    at_limit = [bool(flat[sum(has[:r])]) if h else True for r, h in enumerate(has)]
    k, n = touch.rays[0], len(has)
    if touch.kind == "start":
        return all(at_limit[:k])
    if touch.kind == "end":
        return all(at_limit[k + 1 :])
    if touch.kind == "meet":
        return False
    j = touch.rays[1]
    ahead = [(j + i) % n for i in range(1, (k - j) % n)]
    back = [(j - i) % n for i in range((j - k) % n)]
    return all(at_limit[c] for c in ahead) or all(at_limit[c] for c in back)


def _point(model: Model, roots: Roots, i: int, touches: tuple[Row, ...]) -> ProvedCriticalPoint:
    """State a root with touches in the scene's units; whether it is a minimum is decided by `_judged`."""
    equations = piece_of(model).pivots
    half = 0.5 if equations == 3 else 1.0
    lam = model.scale * roots.lam[i]
    # as many contacts as degrees of freedom leave nothing to bend
    all_held = len(touches) + np.count_nonzero(roots.pins[i]) == model.dof
    index = 0 if all_held else None if roots.index[i] < 0 else int(roots.index[i])
    return ProvedCriticalPoint(
        tuple(roots.x[i].tolist()),
        tuple(roots.pins[i].tolist()),
        tuple((half * lam[:equations]).tolist()),
        float(roots.radius[i]),
        float(roots.unique[i]),
        float(model.scale * roots.spread[i]),
        index,
        tuple(roots.signs[i].tolist()),
        model.energy(roots.x[i]),
        None,
        tuple(t.gap for t in touches),
        tuple(lam[equations:].tolist()),
    )


def _judged(
    model: Model, roots: Roots, points: tuple[ProvedCriticalPoint, ...], touches: tuple[Row, ...]
) -> list[ProvedCriticalPoint | None]:
    """Give points that are admissible a verdict; None for those that cross, or have layers without an order."""
    if not points:
        return []
    # at a stop facets do not touch: its crease is as a free one
    signs = Signs(model, roots.x, roots.radius, model.fold_limits.folded_flat(roots.pins))
    return [_verdict(model, signs, i, point, touches) for i, point in enumerate(points)]


def _verdict(
    model: Model, signs: Signs, i: int, point: ProvedCriticalPoint, touches: tuple[Row, ...]
) -> ProvedCriticalPoint | None:
    contacts = signs.contacts(i, touches)
    if contacts.verdict == CROSSED:
        return None
    if contacts.verdict == APART:
        point = _decided(model, point, contacts.sides)
    elif model.refuses(np.array(point.x)):
        return None
    elif point.is_minimum:
        return replace(point, judged="admissible by the test of its layers")
    elif touches and touches[0].kind == "meet" and signs.turn[i] and 1 in point.pinned_signs:
        # a crease leaves its limit while the rays stay on each other: two triangles with a ray in common
        return replace(point, is_minimum=False)
    else:
        point = replace(point, is_minimum=None)
    if point.is_minimum is not None:
        return point
    what = classify(State(pose(model.scene), np.array(point.x)))
    return replace(point, judged=f"{what.verdict}: {what.reason}")


def _decided(
    model: Model, point: ProvedCriticalPoint, sides: tuple[int, ...]
) -> ProvedCriticalPoint:
    """Decide by signs of all multipliers and the index."""
    if not point.touches:
        return point
    pushes = tuple(side * force for side, force in zip(sides, point.forces, strict=True))
    # the multiplier is known to `doubt`: the share of the uniqueness box that the root may lie in
    doubt = point.unique_moment * point.radius / point.unique_radius
    # side times multiplier: below 0 the energy falls as the contact opens
    leaves = any(push < -doubt for push in pushes)
    holds = all(push > doubt for push in pushes)
    room = model.fold_limits.room(np.array(point.x))
    inside = all(s or r > point.radius for r, s in zip(room, point.stratum, strict=True))
    decided: bool | None = None
    if leaves or 1 in point.pinned_signs or point.index:
        decided = False
    elif holds and point.index == 0:
        pinned = [g for g, s in zip(point.pinned_signs, point.stratum, strict=True) if s]
        decided = True if all(g < 0 for g in pinned) else None
    return replace(point, forces=pushes, is_minimum=decided if inside else None)
