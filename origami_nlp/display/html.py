"""Pictures inside a page: nothing to load, nothing to run."""

from __future__ import annotations

import base64
from html import escape
from typing import TYPE_CHECKING

from origami_nlp.io import figure_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def inline_image(figure: Figure, text: str, dpi: int) -> str:
    """Return a figure as an HTML image that holds its own PNG, shown as wide as it was made.

    Parameters
    ----------
    figure
        Of matplotlib.
    text
        What it shows, for those who cannot see it.
    dpi
        Dots an inch.

    Returns
    -------
    str
        An ``img`` element.
    """
    data = base64.b64encode(figure_bytes(figure, "png", dpi)).decode("ascii")
    width = round(figure.get_size_inches()[0] * dpi)
    look = f"width='{width}' style='max-width:100%;height:auto'"
    return f"<img alt='{escape(text)}' {look} src='data:image/png;base64,{data}'>"
