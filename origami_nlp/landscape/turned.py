"""A landscape with its exact boundaries as a map under the pointer, beside its minima in space."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from origami_nlp.landscape.exact import ExactLandscape
from origami_nlp.minima import turn_minima
from origami_nlp.show import Content, Line

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers


def turn_landscape(exact: ExactLandscape, barriers: Barriers | None = None) -> Content:
    """Return a landscape with its minima, for a page that can be turned.

    Parameters
    ----------
    exact
        Of `find_landscape`.
    barriers
        Of `find_barriers`: with the paths over its passes.

    Returns
    -------
    Content
        As `minima.turn_minima` has it, with contact boundaries, 1-handles and metastable stretches on the map.
    """
    content = turn_minima(exact.result, exact.chart)
    told = [*exact.told(), *content.pieces]
    if barriers is not None:
        from origami_nlp.barriers import add_passes  # only who has barriers has loaded them

        content = add_passes(content, exact.chart, barriers)
        told[1:1] = barriers.told()
    content = replace(content, pieces=tuple(told))
    if exact.boundary is None:
        return content
    panels = [
        replace(panel, lines=tuple(_lines(exact, k))) for k, panel in enumerate(content.panels)
    ]
    return replace(content, panels=tuple(panels))


def _lines(exact: ExactLandscape, branch: int) -> list[Line]:
    assert exact.boundary is not None
    found = []
    for line in exact.boundary.lines:
        if line.branch == branch and not line.hidden:
            look, what = ("handle", "1-handle") if line.thin else ("contact", "contact")
            found.append(Line(line.points, f"{what}: {'; '.join(line.contacts)}", look))
    for part in exact.metastable:
        if part.branch == branch and not part.hidden:
            name = f"metastable, {part.length:.3g} rad: {'; '.join(part.contacts)}"
            found.append(Line(part.points, name, "metastable"))
    return found
