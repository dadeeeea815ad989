"""The contact report as a terminal table, Markdown, JSON and static HTML.

JSON schema ``origami-nlp/contacts/1``: indices 1-based, angles in radians, moments in the scene's units; a number
that does not exist or never ends is null.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.contact.margin import Check, CreaseMargin, LoadMargin
from origami_nlp.contact.pinned import SOFT, ContactReport, PinnedState
from origami_nlp.contact.segments import SegmentReport, segments_to_dict
from origami_nlp.minima import contact_words
from origami_nlp.pattern import scene_to_dict

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


def headline(report: ContactReport) -> str:
    """Say in a line which scene it is and how many of its states are in contact."""
    scene, count = report.result.scene, len(report.states)
    who = scene.label or repr(scene.vertex)
    return (
        f"{who}: {count} of {len(report.result.minima)} minima reported, each with closed "
        f"contacts; symmetry {scene.group.name}, contact {scene.contact}"
    )


def stiffness_words(state: PinnedState) -> str:
    """Give the tangential stiffness, and whether it is soft."""
    if not state.stiffness:
        return "none: no motion keeps the contacts closed"
    values = ", ".join(f"{v:.4g}" for v in state.stiffness)
    flag = f"soft, at most {SOFT:g}" if state.soft else f"not soft, above {SOFT:g}"
    return f"{values} (smallest / sum k = {state.softness:.3g}: {flag})"


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


def segment_lines(report: SegmentReport) -> list[str]:
    """List the metastable segments, or say that there are none."""
    if not report.curves:
        return ["no contact boundary to follow"]
    lines = [
        f"{len(report.curves)} contact boundaries followed, "
        f"{sum(c.length for c in report.curves):.2f} rad; metastable: |dU/ds| / (pi sum k) <= "
        f"{report.slope:g}, |d2U/ds2| / (sum k) <= {report.stiffness:g}, every contact pushes"
    ]
    for s in report.segments:
        where = " and ".join(report.curves[s.curve].contacts)
        at = f", with state {', '.join(map(str, s.states))}" if s.states else ""
        lines.append(
            f"segment of {s.length:.3f} rad (s = {s.start:.3f} to {s.end:.3f}) on {where}{at}: "
            f"energy changes by {s.energy_change:.3g} J, slope up to {s.slope:.2g}, stiffness up to "
            f"{s.stiffness:.2g} (springs alone {s.springs:.2g})"
        )
    if not report.segments:
        lines.append("no metastable segment")
    return lines


def print_contacts(report: ContactReport, console: Console) -> None:
    """Print the report."""
    table = Table(title=Text(headline(report)), title_justify="left")
    for head in ("#", "energy [J]", "kind", "stiffness [N m/rad]", "/ sum k", "margin [N m]"):
        table.add_column(Text(head), no_wrap=head != "stiffness [N m/rad]")
    for state in report.states:
        table.add_row(
            str(state.number),
            f"{state.minimum.energy:.6g}",
            state.minimum.kind,
            ", ".join(f"{v:.4g}" for v in state.stiffness) or "none",
            f"{state.softness:.3g}" + (" soft" if state.soft else ""),
            margin_number(state.margin).replace(" (dependent contacts)", ""),
        )
    console.print(table)
    for state in report.states:
        console.print(f"#{state.number}", style="bold", highlight=False)
        for contact in state.minimum.contacts:
            text = f"   contact {contact_words(contact)}"
            console.print(text, highlight=False, markup=False, soft_wrap=True)
        for line in margin_lines(state.margin):
            console.print("   " + line, highlight=False, markup=False, soft_wrap=True)
        for crease in state.margin.creases:
            names, up, down = crease_cells(crease)
            text = f"   moment on creases {names} alone: valley {up}; mountain {down}"
            console.print(text, highlight=False, markup=False, soft_wrap=True)
    if report.segments is not None:
        for line in segment_lines(report.segments):
            console.print(line, highlight=False, markup=False, soft_wrap=True)


def _cells(state: PinnedState) -> tuple[str, ...]:
    m = state.minimum
    contacts = "\n".join(contact_words(c) for c in m.contacts)
    number = margin_number(state.margin)
    stiffness = stiffness_words(state)
    return (str(state.number), f"{m.energy:.6g}", m.kind, contacts, stiffness, number)


def as_markdown(report: ContactReport) -> str:
    """Return the report as Markdown."""

    def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
        body = [[c.replace("|", "\\|").replace("\n", "<br>") for c in row] for row in rows]
        lines = [" | ".join(heads), " | ".join("---" for _ in heads)]
        return [f"| {line} |" for line in (*lines, *(" | ".join(row) for row in body))]

    lines = [f"# {headline(report)}", ""]
    lines += table(HEADS, [_cells(state) for state in report.states])
    for state in report.states:
        lines += ["", f"## State {state.number}", ""]
        lines += [f"- {line}" for line in margin_lines(state.margin)]
        if state.margin.creases:
            lines += ["", "Largest moment on the creases of one orbit alone:", ""]
            lines += table(CREASE_HEADS, [crease_cells(c) for c in state.margin.creases])
    if report.segments is not None:
        lines += ["", "## Metastable segments", ""]
        lines += [f"- {line}" for line in segment_lines(report.segments)]
    return "\n".join(lines) + "\n"


def contacts_to_dict(report: ContactReport) -> dict[str, Any]:
    """Return the report as plain JSON data."""
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "scene": scene_to_dict(report.result.scene),
        "softness_threshold": SOFT,
        "states": [_state_to_dict(state) for state in report.states],
    }
    if report.segments is not None:
        data["segments"] = segments_to_dict(report.segments)
    return data


def _state_to_dict(state: PinnedState) -> dict[str, Any]:
    m, margin = state.minimum, state.margin
    return {
        "state": state.number,
        "energy": m.energy,
        "kind": m.kind,
        "fold_angles": list(m.fold_angles),
        "contacts": [
            {
                "type": c.type,
                "creases": list(c.creases),
                "facets": list(c.facets),
                "moment": c.multiplier,
                "moment_range": [_finite(v) for v in c.multiplier_range],
                "text": c.text,
            }
            for c in m.contacts
        ],
        "tangential_stiffness": list(state.stiffness),
        "softness": _finite(state.softness),
        "soft": state.soft,
        "load_margin": {
            "status": margin.status,
            "norm": _finite(margin.norm),
            "first_order": _finite(margin.first_order),
            "moments": list(margin.moments),
            "opens": margin.opens,
            "ends": margin.ends,
            "symmetry": margin.symmetry,
            "cap": margin.cap,
            "creases": [
                {
                    "creases": list(c.creases),
                    "positive": _finite(c.positive),
                    "negative": _finite(c.negative),
                    "first_order": [_finite(v) for v in c.first_order],
                    "ends": list(c.ends),
                }
                for c in margin.creases
            ],
            "below": _check_to_dict(margin.below),
            "above": _check_to_dict(margin.above),
            "checked": margin.checked,
            "reason": margin.reason,
        },
    }


def _check_to_dict(check: Check | None) -> dict[str, Any] | None:
    if check is None:
        return None
    return {
        "factor": check.factor,
        "by": check.by,
        "gap": check.gap,
        "multiplier": check.multiplier,
        "moved": check.moved,
        "closed": check.closed,
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


STYLE = (
    "body{font:15px/1.45 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;"
    "color:#1c2733;background:#fff}table{border-collapse:collapse}td,th{text-align:left;"
    "vertical-align:top;padding:.25rem .8rem .25rem 0;border-bottom:1px solid #dde3e8}"
    ".state{display:flex;flex-wrap:wrap;gap:1.5rem;align-items:flex-start}img{max-width:100%}"
)


def as_html(report: ContactReport) -> str:
    """Return the report as one static page: no scripts, no links, pictures inline."""
    from origami_nlp.contact.figure import draw_contacts

    title = escape(headline(report))
    parts = [
        "<!doctype html>",
        f"<html lang='en'><head><meta charset='utf-8'><title>{title}</title>",
        f"<style>{STYLE}</style></head><body><h1 style='font-size:1.3rem'>{title}</h1>",
        _html_table(HEADS, [_cells(state) for state in report.states]),
    ]
    model = report.result.model
    for state in report.states:
        m = state.minimum
        figure = draw_contacts(model, m.fold_angles, m.contacts)
        degrees = ", ".join(f"{a + 0.0:.2f}" for a in np.degrees(m.fold_angles))
        lines = "".join(f"<li>{escape(line)}</li>" for line in margin_lines(state.margin))
        parts.append(
            f"<h2 style='font-size:1.1rem'>State {state.number}</h2><div class='state'>"
            f"{_image(figure, f'State {state.number} with its contacts')}<div>"
            f"<p>Fold angles [deg]: {degrees}</p><ul>{lines}</ul>"
        )
        if state.margin.creases:
            rows = [crease_cells(c) for c in state.margin.creases]
            parts.append("<p>Largest moment on the creases of one orbit alone:</p>")
            parts.append(_html_table(CREASE_HEADS, rows))
        parts.append("</div></div>")
    if report.states:
        parts.append(
            "<p><small>Thick magenta lines are creases in contact, magenta outlines facets in contact, "
            "images under the symmetry included; grey contacts carry nothing.</small></p>"
        )
    if report.segments is not None:
        from origami_nlp.contact.segments_figure import draw_segments

        lines = "".join(f"<li>{escape(line)}</li>" for line in segment_lines(report.segments))
        parts.append(f"<h2 style='font-size:1.1rem'>Metastable segments</h2><ul>{lines}</ul>")
        parts.append(_image(draw_segments(report.segments), "Energy along each contact boundary"))
    return "\n".join([*parts, "</body></html>"]) + "\n"


def _html_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(h)}</th>" for h in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(c).replace(chr(10), '<br>')}</td>" for c in row) + "</tr>"
        for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _image(figure: Any, text: str) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=80, bbox_inches="tight")
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    return f"<img alt='{escape(text)}' src='data:image/png;base64,{data}'>"
