"""What every result can do: be drawn, turned, saved, read back, and become a data frame."""

from __future__ import annotations

import json
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import check_path, shown
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from origami_nlp.minima import MinimaResult
    from origami_nlp.show import TurnedPage

LARGEST = 200_000_000
"""Bytes of a file that is read back."""
_DRAWN = {
    "MinimaResult": ("minima", "draw_minima"),
    "Barriers": ("barriers", "draw_barriers"),
    "Space": ("space", "draw_space"),
    "ExactLandscape": ("landscape", "draw_landscape"),
    "SegmentReport": ("contact", "draw_segments"),
    "PhaseDiagram": ("cone", "draw_phase"),
}
_READ = {
    "origami-nlp/minima/1": ("minima", "result_from_dict"),
    "origami-nlp/critical/1": ("critical", "points_from_dict"),
}


def _of(table: dict[str, tuple[str, str]], key: str) -> Any:
    room, name = table[key]
    return getattr(import_module(f"origami_nlp.{room}"), name)


def draw(result: object, path: str | PathLike[str] | None = None) -> Figure:
    """Draw a result; the picture is the one that its command writes with ``--figure``.

    Parameters
    ----------
    result
        Minima, barriers, an admissible space, a landscape, metastable segments, or the phase diagram of a cone.
    path
        Where to save it (.png, .pdf or .svg), if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure; in Jupyter, after ``%matplotlib inline``, the last line of a cell shows it.

    Raises
    ------
    OptionError
        If there is no picture of such a thing, or the file cannot be written.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16)
    >>> len(o.draw(result).axes) > 1
    True
    """
    kind = type(result).__name__
    if kind not in _DRAWN:
        raise OptionError(
            f"result = {shown(result)} has no picture: use one of {', '.join(_DRAWN)}"
        )
    figure: Figure = _of(_DRAWN, kind)(result)
    if path is not None:
        from origami_nlp.files import save_figure

        check_path("path", path)
        save_figure(figure, path)
    return figure


def view(result: object, path: str | PathLike[str] | None = None) -> TurnedPage:
    """Return a result as a page that can be turned; it is the one that its command writes with ``--html``.

    The extra ``view`` is needed: ``pip install "origami_nlp[view]"``.

    Parameters
    ----------
    result
        Minima, barriers, a landscape, or a contact report.
    path
        Where to save it as one file that needs no network (.html), if anywhere.

    Returns
    -------
    TurnedPage
        The page; in Jupyter the last line of a cell shows it.

    Raises
    ------
    OptionError
        If there is nothing to turn, plotly is not installed, or the file cannot be written.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16)
    >>> o.view(result)
    TurnedPage(degree 6, alpha_1 = pi/3, r_k = 1: last line of a cell in Jupyter, or .save(file))
    """
    from origami_nlp.show import Turnable

    if not isinstance(result, Turnable):
        raise OptionError(
            f"result = {shown(result)} cannot be turned: use minima, barriers, a landscape or a contact report"
        )
    page = result.view()
    if path is not None:
        page.save(path)
    return page


def save(result: object, path: str | PathLike[str]) -> None:
    """Write a result as JSON, whole or not at all; `load` reads minima and critical points back.

    Parameters
    ----------
    result
        Anything that a `find_` function returned but a landscape (`landscape.landscape_to_dict` has it with its space,
        critical points and barriers, `landscape.to_arrays` for NumPy).
    path
        The file.

    Raises
    ------
    OptionError
        If there is no schema for such a thing, or the file cannot be written.

    Examples
    --------
    >>> import os, tempfile, origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16)
    >>> path = os.path.join(tempfile.mkdtemp(), "minima.json")
    >>> o.save(result, path)
    >>> [m.energy for m in o.load(path).minima] == [m.energy for m in result.minima]
    True
    """
    from origami_nlp.files import write_json

    if not hasattr(result, "to_dict"):
        raise OptionError(
            f"result = {shown(result)} has no schema: use a result of a find_ function"
        )
    check_path("path", path)
    write_json(result.to_dict(), Path(path))


def load(path: str | PathLike[str]) -> Any:
    """Read a result that `save`, or a command with ``--json``, has written.

    Parameters
    ----------
    path
        A JSON file of minima or critical points.

    Returns
    -------
    MinimaResult or CriticalPoints
        By the schema that the file names.

    Raises
    ------
    OptionError
        If the file is no JSON, or of no schema that can be read back.

    Examples
    --------
    >>> import os, tempfile, origami_nlp as o
    >>> path = os.path.join(tempfile.mkdtemp(), "minima.json")
    >>> o.save(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> type(o.load(path)).__name__
    'MinimaResult'
    """
    from origami_nlp.files import read_limited

    check_path("path", path)
    try:
        data = json.loads(read_limited(Path(path), LARGEST, "result", OptionError))
    except ValueError as error:
        raise OptionError(f"path = {shown(str(path))} is no JSON file: {error}") from None
    schema = data.get("schema") if isinstance(data, dict) else None
    if schema not in _READ:
        known = ", ".join(_READ)
        raise OptionError(f"schema = {shown(schema)} in {path} cannot be read back: use {known}")
    return _of(_READ, schema)(data)


def to_frame(*results: MinimaResult) -> pandas.DataFrame:
    """Return minima as a pandas data frame, one row each (extra ``sweep``: ``pip install "origami_nlp[sweep]"``).

    Parameters
    ----------
    results
        One or more results of `find_minima`.

    Returns
    -------
    pandas.DataFrame
        Columns scene, number (from 1), energy [the scene's units], kind, dimension, closure, kkt (residuals), hits,
        stable (None where the full space was not asked), phi_1 .. phi_N [rad].

    Raises
    ------
    OptionError
        If pandas is not installed.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16)
    >>> list(o.to_frame(result).columns[:4])
    ['scene', 'number', 'energy', 'kind']
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        why = 'pandas is not installed: pip install "origami_nlp[sweep]"'
        raise OptionError(why) from None
    rows = []
    for result in results:
        for number, m in enumerate(result.minima, start=1):
            stable = None if m.full_space is None else m.full_space.verdict
            row = {
                "scene": result.scene.label,
                "number": number,
                "energy": m.energy,
                "kind": m.kind,
            }
            row |= {"dimension": m.local_dimension, "closure": m.closure_residual}
            row |= {"kkt": m.kkt_residual, "hits": m.hits, "stable": stable}
            rows.append(row | {f"phi_{k}": v for k, v in enumerate(m.fold_angles, start=1)})
    return pandas.DataFrame(rows)
