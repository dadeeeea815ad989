"""The figure of a search, drawn and saved."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from origami_nlp.arguments import check_path, check_type
from origami_nlp.chart import landscape
from origami_nlp.files import save_figure
from origami_nlp.minima.picture import compose
from origami_nlp.minima.result import MinimaResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_minima(
    result: MinimaResult, path: str | os.PathLike[str] | None = None, *, size: int = 401
) -> Figure:
    """Draw the minima of a search, and save the figure if a path is given.

    Parameters
    ----------
    result
        Of `find_minima`.
    path
        Where to save (``.png``, ``.pdf``, ``.svg``, ...), or None.
    size
        Cells along each coordinate of the landscape.

    Returns
    -------
    matplotlib.figure.Figure
        The folded states, and their places on the landscape where the scene has one.

    Raises
    ------
    OptionError
        If the ending of `path` names no known picture format, or an argument is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> len(o.draw_minima(result, size=21).axes) > 1
    True
    """
    check_type("result", result, MinimaResult)
    if path is not None:
        check_path("path", path)
    figure = compose(landscape(result.scene, size), result.minima, result.model.freedom)
    if path is not None:
        save_figure(figure, path)
    return figure
