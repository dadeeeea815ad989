"""The states of the landing page that turn: `{turning} NAME` finds the stable states of a pattern and shows them.

The states are found anew when the site is built; what is shown is what the package finds.
"""

from __future__ import annotations

import json
from html import escape
from typing import Any, ClassVar

import numpy as np
from docutils import nodes
from docutils.parsers.rst import Directive, directives

import origami_nlp as o
from origami_nlp.display import Poser
from origami_nlp.errors import OrigamiError

DIGITS = 4
"""Of coordinates on the page; a picture needs no more."""


def data(name: str, **options: Any) -> dict[str, Any]:
    """Return the stable states of a pattern as what the script of the page draws.

    Parameters
    ----------
    name
        An example by name, such as ``metasheet:3x3``.
    **options
        Of the search.

    Returns
    -------
    dict
        Facets by their corners, lines (corners, number of the crease or "B"), states with corners, view and caption.
    """
    found = o.find_minima(name, **options)
    if not found.minima:
        raise OrigamiError(f"{name}: no stable state was found to be shown")
    poser = Poser(found.pattern)
    body = poser.body
    edges = [
        tuple(sorted(pair)) for f in body.facets for pair in zip(f, (*f[1:], f[0]), strict=True)
    ]
    borders = sorted(edge for edge in set(edges) if edges.count(edge) == 1)
    states = []
    for state in found.minima:
        folded = poser.folded(state.fold_angles, state.energy)
        used = folded.corners[sorted({v for facet in body.facets for v in facet})]
        middle = (used.max(axis=0) + used.min(axis=0)) / 2
        states.append(
            {
                "corners": np.round(folded.corners - middle, DIGITS).tolist(),
                "view": np.round(poser.view(state.fold_angles), DIGITS).tolist(),
                "size": round(float(np.linalg.norm(used - middle, axis=1).max()), DIGITS),
                "letters": ["V" if phi > 0 else "M" for phi in state.fold_angles],
                "caption": f"energy {state.energy:.3g} J, {touching(state)}",
            }
        )
    lines = [
        *((c.start, c.end, k) for k, c in enumerate(body.creases)),
        *((a, b, "B") for a, b in borders),
    ]
    return {"facets": body.facets, "lines": lines, "states": states}


def touching(state: o.JudgedState) -> str:
    """Say whether something touches."""
    count = len(state.contacts)
    return f"{count} contact{'s' * (count > 1)} closed" if count else "nothing touches"


def page(name: str, shown: dict[str, Any]) -> str:
    """Return the part of a page that shows such states."""
    buttons = "".join(
        f'<button type="button" aria-pressed="{str(not k).lower()}">State {k + 1}</button>'
        for k in range(len(shown["states"]))
    )
    text = json.dumps(shown, separators=(",", ":")).replace("<", "\\u003c")
    return (
        f'<div class="turning"><canvas tabindex="0" role="img" '
        f'aria-label="Stable states of {escape(name)}; drag to turn"></canvas>'
        f'<div class="turning-row">{buttons}<span data-caption></span></div>'
        f'<script type="application/json">{text}</script></div>'
    )


class Turning(Directive):
    """`{turning} NAME`, with the number of random starts of the search."""

    required_arguments = 1
    option_spec: ClassVar = {"starts": directives.nonnegative_int}

    def run(self) -> list[nodes.Node]:
        """Find the states, and put them on the page."""
        name = self.arguments[0]
        return [nodes.raw("", page(name, data(name, **self.options)), format="html")]


def setup(app) -> dict:
    """Know the directive and its script."""
    app.add_directive("turning", Turning)
    app.add_js_file("turning.js", loading_method="defer")
    return {"parallel_read_safe": True, "parallel_write_safe": True}
