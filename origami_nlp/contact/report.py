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

from origami_nlp.contact.margin import CreaseMargin, LoadMargin, MarginCheck, load_margin
from origami_nlp.contact.segments import STIFFNESS, SegmentReport, add_segments, find_segments
from origami_nlp.contact.symmetry_blocks import breaking_stiffnesses
from origami_nlp.display import Content, Report, Section, Table, Viewable, Words
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import ContactForce, State, classify
from origami_nlp.minima import CELLS, MinimaResult, full_scene
from origami_nlp.pattern_problem import pose

HEADS = (
    "#",
    "energy [J]",
    "kind",
    "contacts",
    "tangential stiffness [N m/rad]",
    "load margin [N m]",
)
CREASE_HEADS = ("creases", "towards valley [N m]", "towards mountain [N m]")
SOFT = STIFFNESS
"""A state is soft along its contact where its smallest tangential stiffness / (sum k) is at most this."""


@dataclass(frozen=True, repr=False)
class PinnedState(ShortRepr):
    """One minimum with closed contacts.

    Attributes
    ----------
    number
        Of the minimum (1-based).
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

    number: int
    minimum: Any = field(metadata={"plain": False})
    contacts: tuple[ContactForce, ...]
    stiffness: tuple[float, ...]
    breaking: tuple[Unbounded, ...]
    softness: Unbounded
    margin: LoadMargin

    @property
    def soft(self) -> bool:
        """Whether the state is soft along its contact (scale-free, see `SOFT`)."""
        return self.softness <= SOFT

    def stiffness_words(self) -> str:
        """Give the tangential stiffness, and whether it is soft."""
        if not self.stiffness:
            return "none: no motion keeps the contacts closed"
        values = ", ".join(f"{v:.4g}" for v in self.stiffness)
        flag = f"soft, at most {SOFT:g}" if self.soft else f"not soft, above {SOFT:g}"
        return f"{values} (smallest / sum k = {self.softness:.3g}: {flag})"

    def creases_table(self) -> Table:
        """Return the margins under moments on one orbit of creases alone."""
        return Table(CREASE_HEADS, [crease_cells(c) for c in self.margin.creases], columns="LLL")


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
    >>> print(o.find_contacts(result, check=False).headline)
    degree 6, alpha_1 = pi/4, r_k = 0.01: 1 of 2 minima reported, each with closed contacts; symmetry D1, contact full
    """

    result: MinimaResult
    states: tuple[PinnedState, ...]
    segments: SegmentReport | None

    SCHEMA, READS = "origami-nlp/contacts/3", False

    @property
    def headline(self) -> str:
        """Which scene it is, and how many of its states are in contact."""
        many = f"{len(self.states)} of {len(self.result.minima)} minima reported, each with closed contacts"
        if self.result.is_pattern:
            return f"{self.result.title}: {many}"
        scene = self.result.scene
        return f"{self.result.title}: {many}; symmetry {scene.group.name}, contact {scene.contact}"

    @property
    def _label(self) -> str:
        """Name of the scene or the pattern."""
        return self.result.name

    def table(self) -> Table:
        """Return one row a state, for the terminal."""
        rows = [
            (
                str(state.number),
                f"{state.minimum.energy:.6g}",
                state.minimum.kind,
                ", ".join(f"{v:.4g}" for v in state.stiffness) or "none",
                f"{state.softness:.3g}" + (" soft" if state.soft else ""),
                margin_number(state.margin).replace(" (dependent contacts)", ""),
            )
            for state in self.states
        ]
        heads = ("#", "energy [J]", "kind", "stiffness [N m/rad]", "/ sum k", "margin [N m]")
        return Table(heads, rows, self.headline, "lllLll")

    def full_table(self) -> Table:
        """Return one row a state, with its contacts and in more words."""
        rows = [
            (
                str(state.number),
                f"{state.minimum.energy:.6g}",
                state.minimum.kind,
                "\n".join(c.words() for c in state.contacts),
                state.stiffness_words(),
                margin_number(state.margin),
            )
            for state in self.states
        ]
        return Table(HEADS, rows, columns="LLLLLL")

    def report_sections(self) -> Iterator[Section]:
        """Return the table, what holds each state, and the metastable segments."""
        yield self.table()
        for state in self.states:
            yield Words(f"#{state.number}", "bold")
            yield from (f"   contact {c.words()}" for c in state.contacts)
            if state.breaking:
                values = ", ".join(f"{v:.4g}" for v in state.breaking)
                yield f"   stiffness against motions that break the symmetry [N m/rad]: {values}"
            yield from (f"   {line}" for line in margin_lines(state.margin))
            for crease in state.margin.creases:
                names, up, down = crease_cells(crease)
                yield f"   moment on creases {names} alone: valley {up}; mountain {down}"
        if self.segments is not None:
            yield from self.segments.report_sections()

    def view_content(self) -> Content:
        """Return states with their contacts and the contact boundaries as plain data, see `view`."""
        from origami_nlp.chart import landscape

        one = not self.result.is_pattern
        chart: Any = landscape(self.result.scene, CELLS) if one else None
        content = self.result.view_content(chart) if one else self.result.view_content()
        stations = list(content.stations)
        for state in self.states:
            old = stations[state.number - 1]
            stiff = f"tangential stiffness: {state.stiffness_words()}"
            lines = (*old.lines, stiff, *margin_lines(state.margin))
            stations[state.number - 1] = replace(old, lines=lines)
        content = replace(content, stations=tuple(stations), pieces=tuple(self._pieces()))
        return content if self.segments is None else add_segments(content, chart, self.segments)

    def _pieces(self) -> Iterator[Section]:
        """Return the report with the margins of single creases as tables."""
        yield replace(self.full_table(), title=self.headline)
        for state in self.states:
            if state.margin.creases:
                title = f"State {state.number}: largest moment on the creases of one orbit alone"
                yield replace(state.creases_table(), title=title)
        if self.segments is not None:
            yield from self.segments.report_sections()

    def _rows(self) -> Iterator[dict[str, object]]:
        for state in self.states:
            row = {"scene": self._label, "state": state.number}
            row |= {"energy_J": state.minimum.energy, "kind": state.minimum.kind}
            last = {"margin_N_m": state.margin.norm, "margin_is": state.margin.status}
            for c in state.contacts:
                least, most = c.multiplier_range
                own = {"contact": c.text, "moment_N_m": c.multiplier}
                own |= {"least_N_m": least, "most_N_m": most}
                yield row | own | last


def margin_number(margin: LoadMargin) -> str:
    """Give the margin as one number, or the reason for none."""
    if margin.status == "exact":
        return f"{margin.norm:.5g}" if margin.ends == "opens" else f"at least {margin.norm:.5g}"
    if margin.status == "bound":
        return f"{margin.norm:.5g} (dependent contacts)"
    return {"zero": "0", "unbounded": "unbounded", "none": "not given"}[margin.status]


def margin_lines(margin: LoadMargin) -> list[str]:
    """Explain the margin: what opens, the worst load, first order, the re-solves."""
    loads = "every load" if margin.symmetry == "none" else f"loads with symmetry {margin.symmetry}"
    lines = [f"load margin {margin_number(margin)}: {margin.reason} ({loads})"]
    if margin.opens:
        lines.append(f"{'opens first' if margin.status == 'exact' else 'contacts'}: {margin.opens}")
    if margin.moments:
        worst = ", ".join(f"{m:.4g}" for m in margin.moments)
        lines.append(f"worst load on creases 1..{len(margin.moments)} [N m]: {worst}")
    if margin.status == "exact":
        lines.append(f"first-order estimate {margin.first_order:.5g}")
    for check in (margin.below, margin.above):
        if check is not None:
            lines.append(_check_words(check))
    if margin.status in ("exact", "bound"):
        lines.append("checked by re-solving" if margin.checked else "NOT confirmed by re-solving")
    return lines


def _check_words(check: MarginCheck) -> str:
    head = f"re-solved at {100 * check.factor:.1f} % of it"
    if check.closed:
        return f"{head}: contact closed, moment {check.multiplier:.3g} N m"
    return f"{head}: contact open by {check.gap:.3g} rad"


def crease_cells(margin: CreaseMargin) -> tuple[str, str, str]:
    """Return creases and the two margins of one orbit in words."""
    cells = []
    for value, end in zip((margin.positive, margin.negative), margin.ends, strict=True):
        why = {
            "opens": f"{value:.4g}",
            "cap": "never opens",
            "closes": f"{value:.4g}, then another contact closes",
            "softens": f"{value:.4g}, then the state goes soft",
            "lost": f"followed to {value:.4g}",
        }
        cells.append(why[end])
    return ", ".join(map(str, margin.creases)), cells[0], cells[1]


def find_contacts(
    result: MinimaResult, *, state: int | None = None, segments: bool = False, check: bool = True
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
    check
        Whether to re-solve beside each critical load: of vertices.

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
    >>> report = o.find_contacts(result, check=False)
    >>> [(s.number, s.margin.status) for s in report.states]
    [(2, 'zero')]
    """
    count = len(result.minima)
    if state is not None and not 1 <= state <= count:
        raise OptionError(f"state = {state} must be the number of a minimum, 1 to {count}")
    one = not result.is_pattern
    if segments and not one:
        raise OptionError(
            "segments = True: contact boundaries are followed for one vertex, not a pattern"
        )
    states = []
    for number, minimum in enumerate(result.minima, start=1):
        if not minimum.contacts or state not in (None, number):
            continue
        at = result.state_of(minimum)
        what: Any = minimum if one else classify(at)
        margin = load_margin(at, check=check and one)
        if what.local_dimension == 0:
            why = f"no admissible state nearby, so that no contact can open ({minimum.certificate})"
            margin = replace(margin, status="unbounded", norm=math.inf, reason=why)
        stiffness = what.hessian_eigenvalues if one else what.eigenvalues
        total = at.problem.scale * float(np.sum(at.problem.parameters.stiffness))
        softness = min(stiffness, default=math.inf) / total
        breaking: tuple[float, ...] = ()
        if one and not result.scene.group.is_trivial:
            whole = State(pose(full_scene(result.scene)), np.array(minimum.fold_angles))
            breaking = breaking_stiffnesses(whole, result.scene)
        states.append(
            PinnedState(number, minimum, what.contacts, stiffness, breaking, softness, margin)
        )
    found = find_segments(result) if segments else None
    return ContactReport(result, tuple(states), found)
