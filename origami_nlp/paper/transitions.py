"""Every transition of the admissible space X of a family of vertices, as their sector angle changes.

Where X changes, contacts become dependent: at KKT points of the sector angle (`events`), exact to rounding.  X itself
is analysed on both sides of each, and at it (handles can exist at one sector angle only): a transition is an event at
which its signature (topology, and corners) differs.  Between two events
it must not change: intervals in which it does, and events without change, are reported, not hidden.  The topology does
not depend on stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.display import Report, Section, record_table, shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import RESOLVED
from origami_nlp.paper.events import MARGIN, Event, find_events
from origami_nlp.paper.space import find_space
from origami_nlp.pattern import Scene, degree6, degree8, format_angle

FAMILIES: dict[str, Callable[[float], Scene]] = {"degree6": degree6, "degree8": degree8}
"""The paper's families of vertices, by name; sector angle alpha_1 in (0, pi/2)."""
SIDE = 1e-5
"""Distance from a transition at which its two sides are looked at [rad]."""
RINGS = 16
"""Of the meshes."""

OnProgress = Callable[[str, float], None]


@dataclass(frozen=True)
class Signature:
    """What is compared of two spaces.

    Attributes
    ----------
    corners
        States where several contacts close, by their contacts, with their number.
    components, holes, euler_characteristic, pinch_points, handle_ends, handles
        `Space.signature`.
    """

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
        return tuple(vars(self).values())[1:]


@dataclass(frozen=True)
class Transition:
    """A sector angle at which X changes.

    Attributes
    ----------
    alpha
        alpha_1 [rad], to rounding.
    changes
        What changes, ``"topology"`` (of X), ``"corners"``.
    contacts
        The sets of contacts that become dependent.
    below, at, above
        Signatures at alpha - SIDE, alpha, alpha + SIDE.
    events
        States at which contacts become dependent.
    """

    alpha: float = field(metadata=shown("alpha_1", spec=format_angle))
    changes: tuple[str, ...] = field(metadata=shown("changes"))
    contacts: tuple[str, ...] = field(metadata=shown("become dependent", between="\n", side="L"))
    below: Signature
    at: Signature
    above: Signature
    events: tuple[Event, ...]


@dataclass(frozen=True, repr=False)
class Transitions(Report):
    """The transitions of a family of vertices.

    Attributes
    ----------
    family
        Its name.
    transitions
        In order of the sector angle.
    unexplained
        Pairs of sector angles between which X changes without an event.
    silent
        Sector angles of events at which nothing changes.
    """

    family: str
    transitions: tuple[Transition, ...]
    unexplained: tuple[tuple[float, float], ...]
    silent: tuple[float, ...]

    SCHEMA, READS, ROWS = "origami-nlp/paper/1", False, "transitions"

    def report_sections(self) -> Iterator[Section]:
        """Return every transition, and what the events do not explain."""
        yield record_table(
            self.transitions, f"{self.family}: {len(self.transitions)} transition(s)"
        )
        for t in self.transitions:
            title = f"{format_angle(t.alpha)}: below, at, above"
            yield record_table((t.below, t.at, t.above), title)
        for a, b in self.unexplained:
            yield f"unexplained: the space changes between {a:.9f} and {b:.9f}"
        for a in self.silent:
            yield f"silent: contacts become dependent at {a:.12f}, and nothing changes"


def find_transitions(
    family: str,
    rings: int = RINGS,
    seed: int = 0,
    report: OnProgress = lambda what, done: None,
) -> Transitions:
    """Find where the space X of admissible states of a family of vertices changes with the sector angle.

    Events are solved for exactly, which takes some ten seconds.

    Parameters
    ----------
    family
        ``"degree6"`` or ``"degree8"``.
    rings
        Rings of the meshes.
    seed
        Of the search for events.
    report
        Called with what is done and the fraction of it.

    Returns
    -------
    Transitions
        The transitions, and changes that no event explains.

    Raises
    ------
    OptionError
        If `family` or `seed` is unknown.
    MeshError
        If `rings` are too few.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.paper.find_transitions("degree6")  # doctest: +SKIP
    >>> o.paper.find_transitions("degree7")
    Traceback (most recent call last):
        ...
    origami_nlp.errors.OptionError: family = 'degree7' is unknown: use one of degree6, degree8
    """
    make = FAMILIES.get(family) if isinstance(family, str) else None
    if make is None:
        raise OptionError(f"family = {family!r} is unknown: use one of {', '.join(FAMILIES)}")
    check_whole("seed", seed, 0)

    def look(alpha: float) -> Signature:
        space = find_space(make(alpha), rings=rings)
        return Signature(space.corners, *space.signature)

    low, high = MARGIN, math.pi / 2 - MARGIN
    report("events", 0.0)
    events = find_events(make, seed)
    # events at one angle are one transition if X differs on the two sides or at it
    jumps = np.flatnonzero(np.diff([e.alpha for e in events]) >= RESOLVED) + 1
    transitions, silent, unexplained = [], [], []
    last, before = low, look(low)
    for group in np.split(np.arange(len(events)), jumps):
        here = [events[k] for k in group.tolist()]
        alpha = float(np.median([e.alpha for e in here]))
        report("both sides", (alpha - low) / (high - low))
        below, at, above = (look(a) for a in (alpha - SIDE, alpha, alpha + SIDE))
        if _changes(before, below, below):
            unexplained.append((last, alpha))
        last, before = alpha, above
        if changes := _changes(below, at, above):
            walls = sorted({e.walls for e in here}, key=lambda w: (len(w), w))
            names = tuple("; ".join(w) for w in walls)
            transitions.append(Transition(alpha, changes, names, below, at, above, tuple(here)))
        else:
            silent.append(alpha)
    if _changes(before, end := look(high), end):
        unexplained.append((last, high))
    return Transitions(family, tuple(transitions), tuple(unexplained), tuple(silent))


def _changes(below: Signature, at: Signature, above: Signature) -> tuple[str, ...]:
    """What differs between the two sides, or at the event (where corners along handles do not count)."""
    changes = []
    if len({below.topology, at.topology, above.topology}) > 1:
        changes.append("topology")
    if below.corners != above.corners:
        changes.append("corners")
    return tuple(changes)
