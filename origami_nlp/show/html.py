"""Pictures inside a page: nothing to load, nothing to run."""

from __future__ import annotations

import base64
import io
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def inline_image(figure: Figure, text: str, dpi: int, *, crop: bool = False) -> str:
    """Return a figure as an HTML image that holds its own PNG.

    Parameters
    ----------
    figure
        Of matplotlib.
    text
        What it shows, for those who cannot see it.
    dpi
        Dots an inch.
    crop
        Cut the picture to what is drawn; else it is shown as wide as it was made.

    Returns
    -------
    str
        An ``img`` element.
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, bbox_inches="tight" if crop else None)
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    width = round(figure.get_size_inches()[0] * dpi)
    look = "" if crop else f"width='{width}' style='max-width:100%;height:auto' "
    return f"<img alt='{escape(text)}' {look}src='data:image/png;base64,{data}'>"
