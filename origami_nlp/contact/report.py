"""The contact report: what holds each minimum in contact, as a terminal table, Markdown, JSON and static HTML.

JSON schema ``origami-nlp/contacts/1``: indices 1-based, angles in radians, moments in the scene's units; a number
that does not exist or never ends is null.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from origami_nlp.contact.margin import Check, CreaseMargin, LoadMargin
from origami_nlp.contact.segments import STIFFNESS, SegmentReport
from origami_nlp.files import Brief
from origami_nlp.minima import MinimaResult, Minimum, contact_words
from origami_nlp.pattern import scene_to_dict
from origami_nlp.show import Piece, Table, Told, Words, inline_image, pick, to_plain

SCHEMA = "origami-nlp/contacts/1"
HEADS = (
    "#",
    "energy [J]",
    "kind",
    "contacts",
    "tangential stiffness [N m/rad]",
    "load margin [N m]",
)
CREASE_HEADS = ("creases", "towards valley [N m]", "towards mountain [N m]")
CREASES = "Largest moment on the creases of one orbit alone:"
STYLE = (
    "body{font:15px/1.45 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;"
    "color:#1c2733;background:#fff}table{border-collapse:collapse}td,th{border-bottom:1px solid #dde3e8}"
    ".state{display:flex;flex-wrap:wrap;gap:1.5rem;align-items:flex-start}img{max-width:100%}"
)
SOFT = STIFFNESS
"""A state is soft along its contact where its smallest tangential stiffness / (sum k) is at most this."""


@dataclass(frozen=True, repr=False)
class PinnedState(Brief):
    """One minimum with closed contacts.

    Attributes
    ----------
    number
        Of the minimum (1-based).
    minimum
        The minimum.
    stiffness
        Tangential stiffness [N m/rad], eigenvalues of the Hessian on the space that keeps the loaded contacts
        closed, per unit length in the space of all N fold angles; empty where that space is a point.
    softness
        The smallest over the sum of all k; inf where there is none.
    margin
        How large a load the contacts bear [N m].
    """

    number: int
    minimum: Minimum
    stiffness: tuple[float, ...]
    softness: float
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

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data."""
        contact = (
            "type",
            "creases",
            "facets",
            "moment=multiplier",
            "moment_range=multiplier_range",
        )
        return {
            "state": self.number,
            **pick(self.minimum, "energy", "kind", "fold_angles"),
            "contacts": [pick(c, *contact, "text") for c in self.minimum.contacts],
            **pick(self, "tangential_stiffness=stiffness", "softness", "soft"),
            "load_margin": to_plain(self.margin),
        }


@dataclass(frozen=True, repr=False)
class ContactReport(Told):
    """The minima of a result that are in contact, and, if asked for, its metastable segments.

    Attributes
    ----------
    result
        All minima.
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

    @property
    def headline(self) -> str:
        """Which scene it is, and how many of its states are in contact."""
        scene, count = self.result.scene, len(self.states)
        who = scene.label or repr(scene.vertex)
        return (
            f"{who}: {count} of {len(self.result.minima)} minima reported, each with closed "
            f"contacts; symmetry {scene.group.name}, contact {scene.contact}"
        )

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
                "\n".join(contact_words(c) for c in state.minimum.contacts),
                state.stiffness_words(),
                margin_number(state.margin),
            )
            for state in self.states
        ]
        return Table(HEADS, rows, columns="LLLLLL")

    def told(self) -> Iterator[Piece]:
        """Return the table, what holds each state, and the metastable segments."""
        yield self.table()
        for state in self.states:
            yield Words(f"#{state.number}", "bold")
            yield from (f"   contact {contact_words(c)}" for c in state.minimum.contacts)
            yield from (f"   {line}" for line in margin_lines(state.margin))
            for crease in state.margin.creases:
                names, up, down = crease_cells(crease)
                yield f"   moment on creases {names} alone: valley {up}; mountain {down}"
        if self.segments is not None:
            yield from self.segments.told()

    def to_markdown(self) -> str:
        """Return the report as a page of Markdown."""
        parts = [f"# {self.headline}\n", self.full_table().markdown()]
        for state in self.states:
            parts += [f"## State {state.number}\n", _bullets(margin_lines(state.margin))]
            if state.margin.creases:
                parts += [f"{CREASES}\n", state.creases_table().markdown()]
        if self.segments is not None:
            parts += ["## Metastable segments\n", _bullets(self.segments.told())]
        return "\n".join(parts)

    def to_html(self) -> str:
        """Return the report as one static page: no scripts, no links, pictures inline."""
        from origami_nlp.contact.figure import draw_contacts  # pictures are slow to import
        from origami_nlp.contact.segments_figure import draw_segments

        title = escape(self.headline)
        parts = [
            "<!doctype html>",
            f"<html lang='en'><head><meta charset='utf-8'><title>{title}</title>",
            f"<style>{STYLE}</style></head><body><h1 style='font-size:1.3rem'>{title}</h1>",
            self.full_table().html(),
        ]
        for state in self.states:
            m = state.minimum
            figure = draw_contacts(self.result.model, m.fold_angles, m.contacts)
            degrees = ", ".join(f"{a + 0.0:.2f}" for a in np.degrees(m.fold_angles))
            parts += [
                f"<h2 style='font-size:1.1rem'>State {state.number}</h2><div class='state'>",
                inline_image(figure, f"State {state.number} with its contacts", 80, crop=True),
                f"<div><p>Fold angles [deg]: {degrees}</p>{_items(margin_lines(state.margin))}",
            ]
            if state.margin.creases:
                parts += [f"<p>{CREASES}</p>", state.creases_table().html()]
            parts.append("</div></div>")
        if self.states:
            parts.append(
                "<p><small>Thick magenta lines are creases in contact, magenta outlines facets in contact, "
                "images under the symmetry included; dashed grey contacts carry nothing.</small></p>"
            )
        if self.segments is not None:
            parts += [
                "<h2 style='font-size:1.1rem'>Metastable segments</h2>",
                _items(self.segments.told()),
                inline_image(
                    draw_segments(self.segments),
                    "Energy along each contact boundary",
                    80,
                    crop=True,
                ),
            ]
        return "\n".join([*parts, "</body></html>"]) + "\n"

    def _rows(self) -> Iterator[dict[str, object]]:
        for state in self.states:
            row = {"scene": self.result.scene.label, "state": state.number}
            row |= {"energy": state.minimum.energy, "kind": state.minimum.kind}
            last = {"margin": state.margin.norm, "margin_is": state.margin.status}
            for c in state.minimum.contacts:
                least, most = c.multiplier_range
                own = {"contact": c.text, "moment": c.multiplier, "least": least, "most": most}
                yield row | own | last

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data."""
        data: dict[str, Any] = {
            "schema": SCHEMA,
            "scene": scene_to_dict(self.result.scene),
            "softness_threshold": SOFT,
            "states": [state.to_dict() for state in self.states],
        }
        if self.segments is not None:
            data["segments"] = self.segments.to_dict()
        return data


print_contacts, contacts_to_dict = ContactReport.tell, ContactReport.to_dict
as_markdown, as_html = ContactReport.to_markdown, ContactReport.to_html


def _bullets(lines: Iterable[str]) -> str:
    return "".join(f"- {line}\n" for line in lines)


def _items(lines: Iterable[str]) -> str:
    return f"<ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>"


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


def _check_words(check: Check) -> str:
    head = f"re-solved at {100 * check.factor:.1f} % of it ({check.by})"
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
