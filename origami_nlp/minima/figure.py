"""The figure of a search, drawn and saved."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from origami_nlp.arguments import check_path, check_type
from origami_nlp.chart import landscape
from origami_nlp.errors import OptionError
from origami_nlp.io import save_figure
from origami_nlp.minima.picture import compose
from origami_nlp.minima.result import MinimaResult
from origami_nlp.pattern import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_minima(
    result: MinimaResult, path: str | os.PathLike[str] | None = None, *, size: int = 257
) -> Figure:
    """Draw the minima of a search, and save the figure if a path is given.

    On the landscape, white is excluded; with full contact its border is traced, not a matter of cells.  States that
    exist only at a fold angle of +-pi exactly (1-handles) take no area.  Where a scene has two panels, they are the two
    solutions of loop closure; an elevation above 0 lowers the crease that the axis names.  A ring marks a point of the
    chart that a family of states shares.  Curves of one degree of freedom are named by the folds of their creases.

    In the drawings mountain creases are red and solid, valleys blue and dashed, both wider and darker for larger
    |phi|; the upper side of the paper is warm, the lower side cool; numbers of hidden creases are pale, and facets that
    lie on each other are drawn apart.  Where facets of a pattern touch there is a ring, filled where they push, half
    filled where how they share it is open; these facets are tinted.  A red title: a symmetric minimum that is not
    stable when the symmetry may break.  Energies are in the units of the springs, J for stiffness in N m/rad.

    Parameters
    ----------
    result
        Of `find_minima`.
    path
        Where to save (``.png``, ``.pdf``, ``.svg``, ...), or None.
    size
        Cells along each coordinate of the landscape, of a vertex.

    Returns
    -------
    matplotlib.figure.Figure
        The folded states, and their places on the landscape where the scene has one.

    Raises
    ------
    OptionError
        If the ending of `path` names no known picture format, an argument is not what it must be, or a pattern has no
        minimum.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> len(o.draw_minima(result, size=21).axes) > 1
    True
    """
    check_type("result", result, MinimaResult)
    if not (result.minima or isinstance(result.origami, Scene)):
        raise OptionError("no stable state was found: there is nothing to draw")
    if path is not None:
        check_path("path", path)
    chart = None if result.is_pattern else landscape(result.scene, size)
    figure = compose(result.origami, result.minima, chart)
    if path is not None:
        save_figure(figure, path)
    return figure
