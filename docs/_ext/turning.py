"""The state of the landing page that turns: `{turning} NAME` finds the stable states of a pattern and shows them.

The states are found anew when the site is built, and shown by the interactive page of the package in a frame.
"""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import Directive, directives

import origami_nlp as o
from origami_nlp.errors import OrigamiError

FOLDER = "_static/turning"
"""Of the pages that are shown, in the site."""


def write_page(name: str, folder: Path, **options: Any) -> str:
    """Write the page of the stable states of a pattern.

    Parameters
    ----------
    name
        An example by name, such as ``metasheet:3x3``.
    folder
        Where to; it is made.
    **options
        Of the search.

    Returns
    -------
    str
        The name of the file.
    """
    found = o.find_minima(name, **options)
    if not found.minima:
        raise OrigamiError(f"{name}: no stable state was found to be shown")
    folder.mkdir(parents=True, exist_ok=True)
    file = name.replace(":", "_") + ".html"
    found.view().save(folder / file)
    return file


def frame(name: str, address: str) -> str:
    """Return the part of a page that shows such a page; a state alone turns in it."""
    return (
        f'<iframe class="turning" loading="lazy" title="stable states of {escape(name)}; drag to turn" '
        f'src="{escape(address)}#turning"></iframe>'
    )


class Turning(Directive):
    """`{turning} NAME`, with the number of random starts of the search; for pages at the top of the site."""

    required_arguments = 1
    option_spec: ClassVar = {"starts": directives.nonnegative_int}

    def run(self) -> list[nodes.Node]:
        """Find the states, and put them on the page."""
        name = self.arguments[0]
        app = self.state.document.settings.env.app
        file = write_page(name, Path(app.outdir) / FOLDER, **self.options)
        return [nodes.raw("", frame(name, f"{FOLDER}/{file}"), format="html")]


def setup(app) -> dict:
    """Know the directive."""
    app.add_directive("turning", Turning)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
