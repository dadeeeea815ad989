"""The contact report: what holds each minimum in contact, as a terminal table, Markdown and JSON.

In JSON indices are 1-based, angles in radians, moments in the scene's units; a number that does not exist or never ends
is null.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from origami_nlp.arguments import check_flag, check_type, check_whole
from origami_nlp.contact.margin import LoadMargin, load_margin
from origami_nlp.contact.segments import STIFFNESS, SegmentReport, find_segments
from origami_nlp.contact.symmetry_blocks import breaking_stiffnesses
from origami_nlp.display import (
    Content,
    Report,
    Section,
    Table,
    Viewable,
    field_table,
    record_table,
    shown,
)
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import ContactForce, State, classify
from origami_nlp.minima import KINDS, MinimaResult
from origami_nlp.pattern import Pattern

SOFT = STIFFNESS
"""A state is soft along its contact where its smallest tangential stiffness / (sum k) is at most this."""


@dataclass(frozen=True, repr=False)
class PinnedState(ShortRepr):
    """One minimum with closed contacts.

    Attributes
    ----------
    number, energy, kind
        Number of the minimum (1-based), and of it.
    minimum
        The minimum, of a vertex or a pattern.
    contacts
        What its closed contacts carry.
    stiffness
        Tangential stiffness [N m/rad], eigenvalues of the Hessian on the space that keeps the loaded contacts
        closed, per unit length in the space of all N fold angles; empty where that space is a point.
    breaking
        Stiffness against motions that break the symmetry which the search kept, with the loaded contacts closed
        [N m/rad]: the eigenvalues of that block of the Hessian, see `breaking_stiffnesses`; empty where there is
        none.
    softness
        The smallest over the sum of all k; inf where there is none.
    margin
        How large a load the contacts bear [N m].
    """

    ALSO = ("soft",)

    number: int = field(metadata=shown("#"))
    energy: float = field(metadata=shown("energy", "J", ".6g"))
    kind: str = field(metadata=shown("kind", styles=KINDS))
    minimum: Any = field(metadata={"plain": False})
    contacts: tuple[ContactForce, ...]
    stiffness: tuple[float, ...] = field(metadata=shown("stiffness\n", "N m/rad", ".4g", side="r"))
    breaking: tuple[Unbounded, ...] = field(
        metadata=shown("breaking the symmetry\n", "N m/rad", ".4g", side="r")
    )
    softness: Unbounded = field(metadata=shown("/ sum k", spec=".3g"))
    margin: LoadMargin = field(metadata=shown("load margin\n", "N m", "", side="r"))

    @property
    def soft(self) -> bool:
        """Whether the state is soft along its contact (scale-free, see `SOFT`)."""
        return self.softness <= SOFT


@dataclass(frozen=True)
class ContactRow:
    """A closed contact as it is listed.

    Attributes
    ----------
    scene, state, energy, kind
        What is folded, number of the minimum, and of it.
    contact, moment_N_m, least_N_m, most_N_m, unit
        What touches, and what it carries, as of `ContactForce`: where facets of a pattern touch a force.
    margin, margin_is
        Norm and status of the state's `LoadMargin`.
    """

    scene: str = field(metadata=shown())
    state: int = field(metadata=shown("#"))
    energy: float = field(metadata=shown("", "J"))
    kind: str = field(metadata=shown())
    contact: str = field(metadata=shown("contact"))
    moment_N_m: float = field(metadata=shown("moment or force", spec=".4g"))
    least_N_m: float = field(metadata=shown("at least", spec=".4g"))
    most_N_m: float = field(metadata=shown("at most", spec=".4g"))
    unit: str = field(metadata=shown("unit"))
    margin: float = field(metadata=shown("", "N m"))
    margin_is: str = field(metadata=shown())


@dataclass(frozen=True, repr=False)
class ContactReport(Report, Viewable):
    """The minima of a result that are in contact, and, if asked for, its metastable segments.

    Attributes
    ----------
    result
        All minima, of `find_minima`.
    states
        Those with closed contacts, in order of energy.
    segments
        Of `find_segments`, or None.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> print(o.find_contacts(result).headline)
    degree 6, alpha_1 = pi/4, r_k = 0.01: 1 of 2 minima reported, each with closed contacts
    """

    result: MinimaResult
    states: tuple[PinnedState, ...]
    segments: SegmentReport | None

    SCHEMA, READS, ROWS = "origami-nlp/contacts/4", False, "contacts"

    @property
    def headline(self) -> str:
        """Which scene it is, and how many of its states are in contact."""
        many = f"{len(self.states)} of {len(self.result.minima)} minima reported, each with closed contacts"
        return f"{self.result.title}: {many}"

    @property
    def contacts(self) -> list[ContactRow]:
        """The contacts as tables, frames and CSV have them."""
        return [
            ContactRow(
                *(self.result.name, s.number, s.energy, s.kind, c.text, c.multiplier),
                *c.multiplier_range,
                "N m/length" if c.is_force else "N m",
                *(s.margin.norm, s.margin.status),
            )
            for s in self.states
            for c in s.contacts
        ]

    def table(self) -> Table:
        """Return one row a state."""
        return record_table(self.states, self.headline, narrow=True)

    def report_sections(self) -> Iterator[Section]:
        """Return the states, what holds each, what it bears, and the metastable segments."""
        yield self.table() if self.states else self.headline
        if self.states:
            yield record_table(self.contacts, "what contacts carry", narrow=True)
        for s in self.states:
            yield field_table(s.margin, f"#{s.number}: load margin")
            if s.margin.creases:
                yield record_table(s.margin.creases, f"#{s.number}: moment on some creases alone")
        if self.segments is not None:
            yield from self.segments.report_sections()

    def view_content(self) -> Content:
        """Return states with their contacts as plain data, see `view`."""
        content = self.result.view_content()
        stations = list(content.stations)
        for s in self.states:
            said = field_table(s.margin, "").rows
            lines = (f"load margin: {name}: {value}" for name, value in said)
            old = stations[s.number - 1]
            stations[s.number - 1] = replace(old, lines=(*old.lines, *lines))
        return replace(content, stations=tuple(stations), pieces=tuple(self.report_sections()))


def find_contacts(
    result: MinimaResult, *, state: int | None = None, segments: bool = False
) -> ContactReport:
    """Describe what holds each minimum that has closed contacts: moments, stiffness along the contact, load margin.

    Parameters
    ----------
    result
        Of `find_minima`.
    state
        Number (1-based) of the only minimum to report on.
    segments
        Whether to follow the contact boundaries as well (`find_segments`): of vertices.

    Returns
    -------
    ContactReport
        The states in contact, in order of energy.

    Raises
    ------
    OptionError
        If there is no minimum of that number, or segments of a pattern are asked for.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> report = o.find_contacts(result)
    >>> [(s.number, s.margin.status) for s in report.states]
    [(2, 'zero')]
    """
    check_type("result", result, MinimaResult)
    if state is not None:
        check_whole("state", state, 1, len(result.minima))
    check_flag("segments", segments)
    if segments and isinstance(result.origami, Pattern):
        raise OptionError(
            "segments = True: contact boundaries are followed for one vertex, not a pattern"
        )
    states = tuple(
        _pinned(result, number)
        for number, minimum in enumerate(result.minima, start=1)
        if minimum.contacts and state in (None, number)
    )
    return ContactReport(result, states, find_segments(result) if segments else None)


def _pinned(result: MinimaResult, number: int) -> PinnedState:
    """Describe what holds a minimum by its number."""
    minimum = result.minima[number - 1]
    at = result.state_of(minimum)
    margin = load_margin(at)
    breaking: tuple[float, ...] = ()
    if isinstance(result.origami, Pattern):
        judged = classify(at)
        contacts, stiffness = judged.contacts, judged.eigenvalues
        alone = judged.local_dimension == 0
    else:
        contacts, stiffness = minimum.contacts, minimum.hessian_eigenvalues
        alone = minimum.local_dimension == 0
        if result.model.orbits is not None:
            whole = State(result.model.whole, np.array(minimum.fold_angles))
            breaking = breaking_stiffnesses(whole, result.model)
    if alone:
        why = f"no admissible state nearby, so that no contact can open ({minimum.certificate})"
        margin = replace(margin, status="unbounded", norm=math.inf, reason=why)
    total = at.problem.scale * float(np.sum(at.problem.parameters.stiffness))
    softness = min(stiffness, default=math.inf) / total
    about = number, minimum.energy, minimum.kind, minimum, contacts
    return PinnedState(*about, stiffness, breaking, softness, margin)
