"""Minima as a piece of HTML for Jupyter: table, figure, certificates, record of the search.

Static: no scripts, no links; the figure is an inline PNG.
"""

from __future__ import annotations

import math
from html import escape

from origami_nlp.chart import UNIT, landscape
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.picture import compose
from origami_nlp.minima.stability import (
    asked,
    barrier_head,
    count_words,
    isolated_foldings,
    not_asked_words,
    number_words,
    softest_words,
    stiffness_words,
    verdict,
)
from origami_nlp.minima.telling import (
    flag_lines,
    freedom_words,
    scene_lines,
    undecided_lines,
)
from origami_nlp.numerics import residual_words
from origami_nlp.pattern import Scene
from origami_nlp.show import KINDS, Cell, Table, Words, inline_image

SIZE, DPI = 301, 72
"""Cells along each coordinate, and dots an inch, of the inline picture: to keep notebooks small."""


def as_html(
    scene: Scene,
    minima: tuple[JudgedState, ...],
    freedom: int,
    search: SearchReport,
    completeness: Completeness | None,
    flags: ResultFlags,
    *,
    picture: bool = True,
) -> str:
    """Return the minima of a scene as HTML.

    Parameters
    ----------
    freedom
        Degrees of freedom of the symmetric states.
    picture
        Whether to draw the figure of `draw_minima` as well.
    """
    who = scene.label or repr(scene.vertex)
    count = count_words(scene, minima, "no")
    headline = f"{who}: {count}, symmetry {scene.group.name}, contact {scene.contact}"
    parts = ["<div>", f"<p><b>{escape(headline)}</b></p>"]
    if minima:
        parts.append(_table(scene, minima, freedom).html())
    if picture:
        figure = compose(landscape(scene, SIZE), minima, freedom)
        text = "Energy landscape with the minima marked, and a drawing of each state"
        parts.append(inline_image(figure, text, DPI))
    if minima:
        parts.append(_certificates(minima))
    more = [*(completeness.lines() if completeness else ()), *flag_lines(flags)]
    parts += [_search(scene, minima, search, more), "</div>"]
    return "\n".join(parts)


def _table(scene: Scene, minima: tuple[JudgedState, ...], freedom: int) -> Table:
    heads = [
        "#",
        f"energy [{UNIT}]",
        "kind",
        "dimension",
        "softest [N m/rad]",
        f"{barrier_head(scene)} [{UNIT}]",
    ]
    heads += ["fold angles [deg]", "contacts", "hits"]
    grouped = isolated_foldings(minima)
    noise = any(m.survival is not None for m in minima)
    if noise:
        heads.append("survives")
    full = asked(minima)
    if full:
        heads.insert(3, "full space")
    rows = []
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        row: list[Cell] = [
            str(number),
            f"{m.energy:.6g}",
            Words(m.kind, colour=KINDS[m.kind].colour),
            freedom_words(m.local_dimension, freedom),
            softest_words(m.softest),
            m.escape.words() if m.escape else "-",
            ", ".join(_degrees(a) for a in m.fold_angles),
            "\n".join(c.words() for c in m.contacts) or "none closed",
            str(m.hits),
        ]
        if full:
            row.insert(3, verdict(scene, m))
        if noise:
            row.append(str(m.survival))
        rows.append(row)
    if grouped:
        some = [minima[k - 1] for k in grouped]
        energies = f"{some[0].energy:.4g} to {some[-1].energy:.4g}"
        row = [number_words(grouped), energies, "isolated flat foldings", "0 isolated", "held"]
        row += ["isolated", "each crease open or shut", "", str(sum(m.hits for m in some))]
        if full:
            row.insert(3, "")
        rows.append(row + [""] * noise)
    columns = ("rrlllrrllr" if full else "rrllrrllr") + "r" * noise
    return Table(heads, rows, columns=columns)


def _degrees(angle: float) -> str:
    value = f"{math.degrees(angle):.1f}"
    return ("0.0" if value == "-0.0" else value).replace("-", "−")


def _certificates(minima: tuple[JudgedState, ...]) -> str:
    lines = ["<details><summary>Certificates and residuals</summary><ol>"]
    for m in minima:
        residuals = (
            f"closure {residual_words(m.closure_residual)}, KKT {residual_words(m.kkt_residual)}"
        )
        lines.append(
            f"<li>{escape(m.certificate)} [{escape(residuals)}]<br>{escape(stiffness_words(m))}</li>"
        )
    return "\n".join([*lines, "</ol></details>"])


def _search(scene: Scene, minima: tuple[JudgedState, ...], s: SearchReport, more: list[str]) -> str:
    not_asked = not_asked_words(scene, minima)
    lines = [
        *more,
        *s.words(),
        *[not_asked] * bool(not_asked),
        *undecided_lines(s),
        *scene_lines(scene),
    ]
    return "<p><small>" + "<br>".join(map(escape, lines)) + "</small></p>"
