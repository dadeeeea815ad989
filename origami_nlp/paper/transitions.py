"""Sweep the sector angle of a family of vertices and find every transition of its admissible space X.

Two searches that share only the geometry of the half-chain, and neither is given the places to look at:

- the sweep: X is analysed at many sector angles; where its signature (topology, corners, and the loops of its picture
  in the paper's chart) differs between neighbours, bisection closes in on the change;
- the events: KKT points of the sector angle (`events`), exact to rounding.

A transition is an event at which the signature differs, on its two sides or at the event (handles can exist at one
sector angle only).  Brackets without event, and events without change, are reported, not hidden.  The topology does not
depend on stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.chart import MeshError
from origami_nlp.display import Report, Section, Words, record_table, shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.paper.events import Event, find_events
from origami_nlp.paper.space import find_space
from origami_nlp.pattern import Scene, degree6, degree8, format_angle

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


@dataclass(frozen=True)
class Signature:
    """What a sweep compares.

    Attributes
    ----------
    picture_holes
        Loops of the picture in the paper's chart.
    corners
        States where several contacts close, by their contacts, with their number.
    components, holes, euler_characteristic, pinch_points, handle_ends, handles
        `Space.signature`.
    """

    picture_holes: int = field(metadata=shown("drawn holes"))
    corners: tuple[tuple[tuple[str, ...], int], ...]
    components: int = field(metadata=shown("components"))
    holes: int = field(metadata=shown("holes"))
    euler_characteristic: int = field(metadata=shown("chi"))
    pinch_points: int = field(metadata=shown("pinch points"))
    handle_ends: int = field(metadata=shown("handle ends"))
    handles: int = field(metadata=shown("handles"))

    @property
    def topology(self) -> tuple[int, ...]:
        """`Space.signature`."""
        return tuple(vars(self).values())[2:]


@dataclass(frozen=True)
class Transition:
    """A sector angle at which X changes.

    Attributes
    ----------
    alpha
        alpha_1 [rad], to rounding.
    bracket
        Where the sweep saw the change; None if only the event itself differs.
    below, at, above
        Signatures at alpha - SIDE, alpha, alpha + SIDE.
    changes
        What changes, ``"topology"`` (of X), ``"picture"`` (loops in the paper's chart), ``"corners"``.
    contacts
        The sets of contacts that become dependent, of admissible events only.
    events
        States at which contacts become dependent.
    """

    alpha: float
    bracket: tuple[float, float] | None
    below: Signature
    at: Signature
    above: Signature
    changes: tuple[str, ...]
    contacts: tuple[tuple[str, ...], ...]
    events: tuple[Event, ...]

    def report_sections(self) -> Iterator[Section]:
        """Return where the space changes, how, and what confirms it."""
        yield Words(
            f"alpha_1 = {self.alpha:.15f} = {format_angle(self.alpha)}: {', '.join(self.changes)}",
            "bold",
        )
        if self.bracket is None:
            yield "  not seen by the sweep: both sides are alike"
        else:
            half = (self.bracket[1] - self.bracket[0]) / 2
            yield f"  the sweep's bracket: {sum(self.bracket) / 2:.9f} +- {half:.0e}"
        yield record_table((self.below, self.at, self.above), "  below, at, above")
        before, after = dict(self.below.corners), dict(self.above.corners)
        for what, one, other in (("gone", before, after), ("new", after, before)):
            for contacts in sorted(c for c in one if other.get(c) != one[c]):
                yield f"  corner {what}: {'; '.join(contacts)}"
        yield "  contacts that become dependent:"
        for contacts in self.contacts:
            yield f"    {'; '.join(contacts)}"


@dataclass(frozen=True, repr=False)
class TransitionSweep(Report):
    """What a sweep over a family of vertices finds.

    Attributes
    ----------
    family
        Its name.
    samples
        Sector angles of the sweep with their signatures.
    transitions
        In order of the sector angle.
    unexplained
        Brackets in which no event lies.
    silent
        Sector angles of events at which nothing changes.
    """

    family: str
    samples: tuple[tuple[float, Signature], ...]
    transitions: tuple[Transition, ...]
    unexplained: tuple[tuple[float, float], ...]
    silent: tuple[float, ...]

    SCHEMA, READS = "origami-nlp/paper/1", False

    def report_sections(self) -> Iterator[Section]:
        """Return every transition, and what the two searches do not agree on."""
        count = len(self.transitions)
        yield f"{self.family}: {count} transition(s), {len(self.samples)} sector angles swept"
        for t in self.transitions:
            yield ""
            yield from t.report_sections()
        for a, b in self.unexplained:
            yield f"unexplained: the signature changes between {a:.9f} and {b:.9f}"
        for a in self.silent:
            yield f"silent: contacts become dependent at {a:.12f}, and nothing changes"


def signature_of(scene: Scene, rings: int) -> Signature:
    """Return what a sweep compares of a scene's space."""
    space = find_space(scene, rings=rings)
    return Signature(space.picture_holes, space.corners, *space.signature)


def find_transitions(
    family: str,
    samples: int = SAMPLES,
    rings: int = SWEEP_SIZE,
    seed: int = 0,
    report: OnProgress = lambda what, done: None,
) -> TransitionSweep:
    """Sweep the sector angle of a family of vertices, and find where the space X of admissible states changes.

    This takes minutes: events are solved for exactly.

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
    make = FAMILIES.get(family) if isinstance(family, str) else None
    if make is None:
        raise OptionError(f"family = {family!r} is unknown: use one of {', '.join(FAMILIES)}")
    check_whole("samples", samples, 3, 10_000)
    check_whole("seed", seed, 0)

    def look(alpha: float) -> Signature | None:
        try:
            return signature_of(make(alpha), rings)
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
        report("both sides", 0.0)
        below, at, above = (
            signature_of(make(a), rings) for a in (alpha - SIDE, alpha, alpha + SIDE)
        )
        changes = _changes(below, at, above)
        if not changes:
            silent.append(alpha)
            continue
        inside = [b for b in brackets if b[0] - BRACKET <= alpha <= b[1] + BRACKET]
        walls = {e.walls for e in group if e.admissible}
        contacts = tuple(sorted(walls, key=lambda w: (len(w), w)))
        bracket = inside[0] if inside else None
        transitions.append(
            Transition(alpha, bracket, below, at, above, changes, contacts, tuple(group))
        )
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
