"""Sweep the sector angle of a family of vertices and find every transition of its admissible space X.

Two searches that share only the geometry of the half-chain, and neither is given the places to look at:

- the sweep: X is analysed at many sector angles; where its signature (topology, corners, and the loops of its picture
  in the paper's chart) differs between neighbours, bisection closes in on the change;
- the events: KKT points of the sector angle (`events`), exact to rounding.

A transition is an event at which the signature differs, on its two sides or at the event (handles can exist at one
sector angle only).  Brackets without event, and events without change, are reported, not hidden.  Each transition is
confirmed by witnesses: states that keep all but one of the event's contacts closed while alpha moves, and that are
admissible on one side only.  The topology does not depend on stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from origami_nlp.chart import MeshError, chain_of
from origami_nlp.errors import OptionError
from origami_nlp.folding import check_admissible, fold_vertex
from origami_nlp.numerics import CLOSURE_TOL, INPUT_TOL, RANK, RESOLVED, ROUNDED, SETTLED
from origami_nlp.paper.events import ContactKkt, Event, find_events, walls_of
from origami_nlp.paper.family import Signature, Transition, TransitionSweep, Witness
from origami_nlp.paper.space import Space, find_space
from origami_nlp.pattern import Scene, degree6, degree8

FAMILIES: dict[str, Callable[[float], Scene]] = {"degree6": degree6, "degree8": degree8}
"""The paper's families of vertices, by name; sector angle alpha_1 in (0, pi/2)."""
SIDE = 1e-5
"""Distance from a transition at which its two sides are looked at [rad]."""
BRACKET = 1e-6
"""Width to which the sweep's bisection closes in [rad]."""
SWEEP_SIZE = 16
"""Rings of the meshes of a sweep."""
SAMPLES = 25
MARGIN = 0.05
"""The sweep keeps this far from 0 and pi/2 [rad], where facets degenerate."""

OnProgress = Callable[[str, float], None]


def signature_of(space: Space) -> Signature:
    """Return what a sweep compares of a space."""
    return Signature(space.signature, space.picture_holes, space.corners)


def find_transitions(
    family: str,
    samples: int = SAMPLES,
    rings: int = SWEEP_SIZE,
    seed: int = 0,
    report: OnProgress = lambda what, done: None,
) -> TransitionSweep:
    """Sweep the sector angle of a family of vertices, and find where the space X of admissible states changes.

    This takes minutes: events are solved for exactly, and confirmed by states on either side.

    Parameters
    ----------
    family
        ``"degree6"`` or ``"degree8"``.
    samples
        Sector angles of the sweep, at least 3, spread over (0, pi/2) less `MARGIN` with jitter from `seed`.
    rings
        Rings of the meshes.
    seed
        Of the jitter and of the search for events.
    report
        Called with what is done and the fraction of it.

    Returns
    -------
    TransitionSweep
        The transitions, and what the sweep saw that no event explains.

    Raises
    ------
    OptionError
        If `family` is unknown, `samples` is out of range, or `rings` is too coarse.

    Examples
    --------
    >>> import origami_nlp as o
    >>> sweep = o.paper.find_transitions("degree6", samples=5)  # doctest: +SKIP
    >>> o.paper.find_transitions("degree7")
    Traceback (most recent call last):
        ...
    origami_nlp.errors.OptionError: family = 'degree7' is unknown: use one of degree6, degree8
    """
    make = FAMILIES.get(family)
    if make is None:
        raise OptionError(f"family = {family!r} is unknown: use one of {', '.join(FAMILIES)}")
    if isinstance(samples, bool) or not isinstance(samples, int) or not 3 <= samples <= 10_000:
        raise OptionError(f"samples = {samples!r} must be a whole number from 3 to 10000")

    def look(alpha: float) -> Signature | None:
        try:
            return signature_of(find_space(make(alpha), rings=rings))
        except MeshError:  # features thinner than the mesh resolves
            return None

    low, high = MARGIN, math.pi / 2 - MARGIN
    rng = np.random.default_rng(seed)
    step = (high - low) / samples
    # drawn within their cells: nothing special happens just at a sample
    angles = low + step * (np.arange(samples) + rng.uniform(0.2, 0.8, samples))
    signatures = []
    for k, alpha in enumerate(angles):
        report("sweep", k / samples)
        here = look(float(alpha))
        if here is None:
            raise OptionError(
                f"rings = {rings}: too coarse at alpha_1 = {alpha:.6g}; use more rings"
            )
        signatures.append(here)
    brackets: list[tuple[float, float]] = []
    for k in range(samples - 1):
        report("bisection", k / samples)
        ends = (float(angles[k]), float(angles[k + 1]))
        brackets += _bisect(look, ends, (signatures[k], signatures[k + 1]))
    report("events", 0.0)
    events = find_events(make, low, high, seed)
    transitions, silent = [], []
    # events at one angle are one transition if X differs on the two sides or at it, else silent
    for group in _grouped(events):
        alpha = float(np.median([e.alpha for e in group]))
        report("confirmation", 0.0)
        around = tuple(
            signature_of(find_space(make(a), rings=rings))
            for a in (alpha - SIDE, alpha, alpha + SIDE)
        )
        changes = _changes(around[0], around[1], around[2])
        if not changes:
            silent.append(alpha)
            continue
        inside = [b for b in brackets if b[0] - BRACKET <= alpha <= b[1] + BRACKET]
        transitions.append(_transition(make, alpha, group, around, changes, inside))
    explained = {t.bracket for t in transitions}
    unexplained = tuple(b for b in brackets if b not in explained)
    pairs = tuple(zip(angles.tolist(), signatures, strict=True))
    return TransitionSweep(family, pairs, tuple(transitions), unexplained, tuple(silent))


def _bisect(
    look: Callable[[float], Signature | None],
    ends: tuple[float, float],
    signatures: tuple[Signature, Signature],
) -> list[tuple[float, float]]:
    """Brackets of width `BRACKET` around every change of signature that bisection sees between two angles."""
    (a, b), (at_a, at_b) = ends, signatures
    if at_a == at_b:
        return []
    if b - a <= BRACKET:
        return [(a, b)]
    middle = 0.5 * (a + b)
    here = look(middle)
    if here is None:  # this close to the change its features are thinner than rounding
        return [(a, b)]
    return _bisect(look, (a, middle), (at_a, here)) + _bisect(look, (middle, b), (here, at_b))


def _grouped(events: list[Event]) -> list[list[Event]]:
    """Events by sector angle."""
    groups: list[list[Event]] = []
    for event in sorted(events, key=lambda e: e.alpha):
        if groups and event.alpha - groups[-1][-1].alpha < RESOLVED:
            groups[-1].append(event)
        else:
            groups.append([event])
    return groups


def _changes(below: Signature, at: Signature, above: Signature) -> tuple[str, ...]:
    """What differs between the two sides, or at the event (where corners along handles do not count)."""
    changes = []
    if len({below.topology, at.topology, above.topology}) > 1:
        changes.append("topology")
    if len({below.picture_holes, at.picture_holes, above.picture_holes}) > 1:
        changes.append("picture")
    if below.corners != above.corners:
        changes.append("corners")
    return tuple(changes)


def _transition(
    make: Callable[[float], Scene],
    alpha: float,
    events: list[Event],
    around: tuple[Signature, ...],
    changes: tuple[str, ...],
    brackets: list[tuple[float, float]],
) -> Transition:
    real = [e for e in events if e.admissible]
    witnesses = [w for e in real for w in _witnesses(make, alpha, e)]
    distinct = {(w.kept, w.admissible): w for w in witnesses}
    contacts = tuple(sorted({e.walls for e in real}, key=lambda w: (len(w), w)))
    return Transition(
        alpha,
        brackets[0] if brackets else None,
        around[0],
        around[1],
        around[2],
        changes,
        contacts,
        _coincident(make, alpha, real),
        tuple(events),
        tuple(distinct.values()),
    )


def _coincident(
    make: Callable[[float], Scene], alpha: float, events: list[Event]
) -> tuple[tuple[int, int], ...]:
    """Pairs of creases of the wedge that coincide at every state of some event because of its sector angle."""
    pairs = set()
    scene = make(alpha)
    n = len(scene.group.rays)
    for event in events:
        c, _ = fold_vertex(scene.vertex, np.array(event.fold_angles))
        beside, _ = fold_vertex(make(alpha + SIDE).vertex, np.array(event.fold_angles))
        for i in range(n):
            for j in range(i + 1, n):
                here = np.linalg.norm(c[i] - c[j])
                # on each other at this sector angle, apart at the next one with the same fold angles
                if here < SETTLED and np.linalg.norm(beside[i] - beside[j]) > SIDE / 2:
                    pairs.add((i + 1, j + 1))
    return tuple(sorted(pairs))


def _witnesses(make: Callable[[float], Scene], alpha: float, event: Event) -> list[Witness]:
    """Let go of one contact of an event, move alpha to both sides, and examine what the others hold."""
    chain = chain_of(make(alpha))
    walls = {w.name: w for w in walls_of(chain)}
    x = np.array([event.fold_angles[chain.orbit.index(v)] for v in range(chain.size)])
    found = []
    for gone in range(len(event.walls)):
        kept = tuple(w for k, w in enumerate(event.walls) if k != gone)
        # one contact let go: the others hold states on both sides of the transition
        system = ContactKkt(make, alpha, chain, [walls[w] for w in kept])
        states = [_held(system, x, a) for a in (alpha - SIDE, alpha, alpha + SIDE)]
        if any(s is None for s in states):
            continue
        full = [s[chain.orbit] for s in states if s is not None]
        verdicts = tuple(
            check_admissible(
                make(a).vertex, phi, tolerance=INPUT_TOL, elements=chain.scene.group.elements
            ).admissible
            for a, phi in zip((alpha - SIDE, alpha, alpha + SIDE), full, strict=True)
        )
        if verdicts[0] != verdicts[2]:
            a, b, c = (tuple(phi.tolist()) for phi in full)
            found.append(Witness(kept, (a, b, c), (verdicts[0], verdicts[1], verdicts[2])))
    return found


def _held(system: ContactKkt, x: np.ndarray, alpha: float) -> np.ndarray | None:
    """Newton onto closure with walls held, at a sector angle; None where that does not converge."""
    for _ in range(40):
        value, jacobian = system.gradients(x, alpha)
        if np.abs(value).max() <= ROUNDED:
            break
        x = x - np.linalg.lstsq(jacobian[:, :-1], value, rcond=RANK)[0]
    value, _ = system.gradients(x, alpha)
    if np.abs(value).max() > CLOSURE_TOL:
        return None
    near = np.abs(np.abs(x) - math.pi) < CLOSURE_TOL
    return np.where(near, np.sign(x) * math.pi, x)
