"""The exact boundaries of a landscape on its map, for a page that can be turned."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from origami_nlp.chart import Boundary
from origami_nlp.display import Content, Line


def add_boundary(
    content: Content, boundary: Boundary, stretches: Sequence[Sequence[Line]]
) -> Content:
    """Put contact boundaries, 1-handles and metastable stretches on the map of a scene.

    Parameters
    ----------
    content
        Of `MinimaResult.view_content`: a panel for each branch of the chart.
    boundary
        Of the scene.
    stretches
        Metastable ones, for each branch.

    Returns
    -------
    Content
        With these lines instead of the grid's.
    """
    panels = [
        replace(panel, lines=(*_lines(boundary, k), *stretches[k]))
        for k, panel in enumerate(content.panels)
    ]
    return replace(content, panels=tuple(panels))


def _lines(boundary: Boundary, branch: int) -> Iterator[Line]:
    for line in boundary.lines:
        if line.branch == branch and not line.hidden:
            look, what = ("handle", "1-handle") if line.thin else ("contact", "contact")
            yield Line(line.points, f"{what}: {'; '.join(line.contacts)}", look)
