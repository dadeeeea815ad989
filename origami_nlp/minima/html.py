"""A result as a piece of HTML for Jupyter: table, figure, certificates, record of the search.

Static: no scripts, no links; the figure is an inline PNG.
"""

from __future__ import annotations

import base64
import io
import math
from html import escape
from typing import TYPE_CHECKING

from origami_nlp.chart import UNIT
from origami_nlp.minima.figure import draw_minima
from origami_nlp.minima.marks import STYLE
from origami_nlp.minima.stability import asked, count_words, not_asked_words, verdict
from origami_nlp.minima.table import geometry_lines, undecided_lines

if TYPE_CHECKING:
    from origami_nlp.kkt import ContactForce
    from origami_nlp.minima.find import MinimaResult, Minimum

DPI = 72
"""Of the inline picture, to keep notebooks small."""
_CELL = "style='text-align:left;vertical-align:top;padding:2px 10px 2px 2px'"
_NUMBER = "style='text-align:right;vertical-align:top;padding:2px 10px 2px 2px'"


def as_html(result: MinimaResult, *, picture: bool = True) -> str:
    """Return the result as HTML.

    Parameters
    ----------
    picture
        Whether to draw the figure of `draw_minima` as well.
    """
    parts = ["<div>", f"<p><b>{escape(_headline(result))}</b></p>"]
    if result.minima:
        parts.append(_table(result))
    if picture:
        parts.append(_image(result))
    if result.minima:
        parts.append(_certificates(result))
    parts += [_search(result), "</div>"]
    return "\n".join(parts)


def _headline(result: MinimaResult) -> str:
    scene = result.scene
    who = scene.label or repr(scene.vertex)
    return (
        f"{who}: {count_words(result, 'no')}, symmetry {scene.group.name}, contact {scene.contact}"
    )


def _table(result: MinimaResult) -> str:
    heads = ["#", f"energy [{UNIT}]", "kind", "dimension", "fold angles [deg]", "contacts", "hits"]
    full = asked(result)
    if full:
        heads.insert(3, "full space")
    left = {"kind", "full space", "dimension", "fold angles [deg]", "contacts"}
    row = "".join(f"<th {_CELL if h in left else _NUMBER}>{escape(h)}</th>" for h in heads)
    lines = ["<table style='border-collapse:collapse'>", f"<thead><tr>{row}</tr></thead><tbody>"]
    for number, m in enumerate(result.minima, start=1):
        swatch = f"<span style='color:{STYLE[m.kind][0]}'>&#9632;</span> {escape(m.kind)}"
        cells = (
            (str(number), _NUMBER),
            (f"{m.energy:.6g}", _NUMBER),
            (swatch, _CELL),
            *([(escape(verdict(result.scene, m)), _CELL)] if full else []),
            (escape(_dimension(m, result.model.freedom)), _CELL),
            (", ".join(_degrees(a) for a in m.fold_angles), _CELL),
            ("<br>".join(escape(_contact(c)) for c in m.contacts) or "none closed", _CELL),
            (str(m.hits), _NUMBER),
        )
        lines.append(
            "<tr>" + "".join(f"<td {style}>{text}</td>" for text, style in cells) + "</tr>"
        )
    return "\n".join([*lines, "</tbody></table>"])


def _dimension(minimum: Minimum, freedom: int) -> str:
    d = minimum.local_dimension
    if d == freedom:
        return str(d)
    return {0: "0: isolated", 1: "1: handle"}.get(d, f"{d} of {freedom}")


def _degrees(angle: float) -> str:
    value = f"{math.degrees(angle):.1f}"
    return ("0.0" if value == "-0.0" else value).replace("-", "&minus;")


def _contact(contact: ContactForce) -> str:
    low, high = contact.multiplier_range
    text = f"{contact.text}: {contact.multiplier:.4g} N m"
    if math.isclose(low, high, rel_tol=1e-9, abs_tol=1e-300):
        return text
    return f"{text} (any of {low:.4g} to {'inf' if math.isinf(high) else f'{high:.4g}'})"


def _image(result: MinimaResult) -> str:
    buffer = io.BytesIO()
    figure = draw_minima(result, size=301)
    figure.savefig(buffer, format="png", dpi=DPI)
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    width = round(figure.get_size_inches()[0] * DPI)
    text = "Energy landscape with the minima marked, and a drawing of each state"
    return (
        f"<img alt='{text}' width='{width}' style='max-width:100%;height:auto' "
        f"src='data:image/png;base64,{data}'>"
    )


def _certificates(result: MinimaResult) -> str:
    lines = ["<details><summary>Certificates and residuals</summary><ol>"]
    for m in result.minima:
        residuals = f"closure {m.closure_residual:.0e}, KKT {m.kkt_residual:.0e}"
        lines.append(f"<li>{escape(m.certificate)} [{residuals}]</li>")
    return "\n".join([*lines, "</ol></details>"])


def _search(result: MinimaResult) -> str:
    s = result.search
    statuses = ", ".join(f"{name} {count}" for name, count in sorted(s.statuses.items()))
    stop = "" if s.stopped_by == "rule" else "; stopped at the cap on starts"
    text = (
        f"{s.starts} starts, {s.solves} IPOPT solves ({statuses}), {s.seconds:.2f} s, seed {s.seed}; "
        f"expected undiscovered minima {s.expected_undiscovered:.2g}{stop}"
    )
    more = not_asked_words(result)
    lines = [text, *[more] * bool(more), *undecided_lines(result), *geometry_lines(result)]
    return "<p><small>" + "<br>".join(map(escape, lines)) + "</small></p>"
