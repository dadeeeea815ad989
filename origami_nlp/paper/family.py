"""What a sweep over a family of vertices finds: where the space X changes, and how that was confirmed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from origami_nlp.display import Report, Section, Table, Words
from origami_nlp.paper.events import Event
from origami_nlp.paper.space import angle_words
from origami_nlp.pattern import format_angle

TOPOLOGY = ("components", "holes", "euler_characteristic", "pinch_points", "handle_ends", "handles")
"""Names of the numbers in `Signature.topology`."""


@dataclass(frozen=True)
class Signature:
    """What a sweep compares.

    Attributes
    ----------
    topology
        `Space.signature` (components, holes, Euler characteristic, pinch points, handle ends, handles).
    picture_holes
        Loops of the picture in the paper's chart.
    corners
        States where several contacts close, by their contacts, with their number.
    """

    topology: tuple[int, ...] = field(metadata={"plain": False})
    picture_holes: int
    corners: tuple[tuple[tuple[str, ...], int], ...]

    ALSO = ("counts",)

    @property
    def counts(self) -> dict[str, int]:
        """The numbers of `topology` by their names."""
        return dict(zip(TOPOLOGY, self.topology, strict=True))

    @property
    def shape(self) -> tuple[int, ...]:
        """Topology and loops of the picture, without corners."""
        return (*self.topology, self.picture_holes)


@dataclass(frozen=True)
class Witness:
    """A state that is admissible on one side of a transition only.

    Attributes
    ----------
    kept
        Contacts of the event that stay closed.
    fold_angles, admissible
        At alpha - SIDE, alpha and alpha + SIDE.
    """

    kept: tuple[str, ...]
    fold_angles: tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]
    admissible: tuple[bool, bool, bool]


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
    creases
        Pairs of creases that coincide at the event, and do not beside it.
    events
        States at which contacts become dependent.
    witnesses
        States that are admissible on one side only.
    """

    alpha: float
    bracket: tuple[float, float] | None
    below: Signature
    at: Signature
    above: Signature
    changes: tuple[str, ...]
    contacts: tuple[tuple[str, ...], ...]
    creases: tuple[tuple[int, int], ...]
    events: tuple[Event, ...]
    witnesses: tuple[Witness, ...]

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
        rows = []
        for name, s in (("below", self.below), ("at", self.at), ("above", self.above)):
            cells = (*s.topology[:3], s.topology[5], s.picture_holes)
            corners = "-" if s.topology[5] else str(sum(n for _, n in s.corners))
            rows.append((name, *map(str, cells), corners))
        heads = ("", "components", "holes", "chi", "handles", "drawn holes", "corners")
        yield Table(heads, rows, columns="LLLLLLL")
        before, after = dict(self.below.corners), dict(self.above.corners)
        for what, one, other in (("gone", before, after), ("new", after, before)):
            for contacts in sorted(c for c in one if other.get(c) != one[c]):
                yield f"  corner {what}: {'; '.join(contacts)}"
        if self.creases:
            yield f"  creases that meet: {', '.join(f'{i} on {j}' for i, j in self.creases)}"
        yield "  contacts that become dependent:"
        for contacts in self.contacts:
            yield f"    {'; '.join(contacts)}"
        yield f"  states admissible on one side only: {len(self.witnesses)}"
        for w in self.witnesses:
            side = "below" if w.admissible[0] else "above"
            yield f"    {side}, with {'; '.join(w.kept)} held: {angle_words(w.fold_angles[1])}"


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
