"""Any result by one name: `read_result` finds its class by the schema in the file, `to_frame` joins several.

The methods of results (`display.Result`) do the rest; `draw`, `view` and `save` are those methods as functions.
"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from os import PathLike
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import check_type, shown
from origami_nlp.display import Result, read_data
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from origami_nlp.display import InteractivePage

_READ = (
    ("minima/6", "minima", "minima", "MinimaResult"),
    ("landscape/2", "points", "paper", "CriticalPoints"),
    ("path/2", "legs", "paths", "LoadPath"),
    ("landscape/2", "passes", "barriers", "Barriers"),
    ("path/2", "branches", "paths", "Atlas"),
    ("path/2", "curves", "paths", "BifurcationSet"),
    ("pattern/3", "motion", "pattern_states", "Motion"),
    ("pattern/3", "arc", "pattern_states", "Motion"),
    ("pattern/3", "facets", "pattern_states", "Mobility"),
    ("hinge/1", "law", "hinges", "MeasuredHinge"),
    ("layers/1", "components", "validity", "LayerOrders"),
    ("validity/1", "tests", "validity", "Validity"),
)
"""Room and class of what is read back: by its schema, and by a key of it; of several the first."""


def draw(result: Result, path: str | PathLike[str] | None = None) -> Figure:
    """Draw a result: ``result.draw(path)``.

    Parameters
    ----------
    result
        Minima, barriers, an admissible space, a landscape, metastable segments, a load path, or the phase
        diagram of a cone.
    path
        Where to save it (.png, .pdf or .svg), if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
        The figure; in Jupyter the last line of a cell shows it.

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
    check_type("result", result, Result)
    return result.draw(path)


def view(result: object, path: str | PathLike[str] | None = None) -> InteractivePage:
    """Return a result as an interactive page; it is the one that its command writes with ``-o FILE.html``.

    Parameters
    ----------
    result
        Minima, barriers, a landscape, a contact report, an atlas or a load path; of a design the minima
        that it is of.
    path
        Where to save it as one file that needs no network (.html), if anywhere.

    Returns
    -------
    InteractivePage
        The page; in Jupyter the last line of a cell shows it.

    Raises
    ------
    OptionError
        If there is nothing to show, or the file cannot be written.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16)
    >>> o.view(result)
    InteractivePage(degree 6, alpha_1 = pi/3, r_k = 1: last line of a cell in Jupyter, or .save(file))
    """
    from origami_nlp.display import Viewable

    if isinstance(result, Result) and not isinstance(result, Viewable):  # of a design
        of = getattr(result, "minima", None) or getattr(result, "result", None)
        result = of if isinstance(of, Viewable) else result
    if not isinstance(result, Viewable):
        more = "; draw(result) draws it" if getattr(result, "PICTURE", None) else ""
        raise OptionError(
            f"result = {shown(result)} cannot be turned: use minima, barriers, a landscape, a contact report, an atlas "
            f"or a load path{more}"
        )
    page = result.view()
    if path is not None:
        page.save(path)
    return page


def save(result: Result, path: str | PathLike[str]) -> None:
    """Write a result as JSON: ``result.save(path)``.

    Parameters
    ----------
    result
        Anything that a `find_` function returned.
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
    >>> [m.energy for m in o.read_result(path).minima] == [m.energy for m in result.minima]
    True
    """
    check_type("result", result, Result)
    result.save(path)


def read_result(path: str | PathLike[str]) -> Any:
    """Read a result that `save`, or a command with ``-o FILE.json``, has written, as the class of the file's schema.

    Parameters
    ----------
    path
        A JSON file of minima, critical points, barriers, a load path, an atlas or boundaries of a vertex, or of
        counts, stable states, a folding motion or a load path of a pattern.

    Returns
    -------
    Result
        By the schema that the file names.  Of what ``origami-nlp inspect`` writes: the motion if it is there, else the
        counts.

    Raises
    ------
    OptionError
        If the file is no JSON, or of no schema that can be read back.

    Examples
    --------
    >>> import os, tempfile, origami_nlp as o
    >>> path = os.path.join(tempfile.mkdtemp(), "minima.json")
    >>> o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16).save(path)
    >>> [m.full_space.verdict for m in o.read_result(path).minima]
    ['stable', 'stable']
    """
    data = read_data(path)
    schema = data.get("schema") if isinstance(data, dict) else None
    for wanted, key, room, name in _READ:
        if schema == f"origami-nlp/{wanted}" and key in data:
            inside = data[key] if key == "motion" else data
            if isinstance(inside, dict):  # of `inspect`
                inside = {k: v for k, v in inside.items() if k != "frames"}
            kind: Any = getattr(import_module(f"origami_nlp.{room}"), name)
            found = kind.from_dict(inside, repr(str(path)))
            try:
                for _ in found.report_sections():  # lists that should be equally long are not
                    pass
                with suppress(OptionError):  # of a class without rows
                    found.to_csv()
            except (LookupError, TypeError, ValueError, ArithmeticError, AttributeError) as error:
                raise OptionError(
                    f"{str(path)!r}: its entries do not fit together: {error}"
                ) from None
            return found
    if any(schema == f"origami-nlp/{wanted}" for wanted, *_ in _READ):
        raise OptionError(f"{path} holds a result of {schema} that cannot be read back")
    known = ", ".join(dict.fromkeys(f"origami-nlp/{wanted}" for wanted, *_ in _READ))
    raise OptionError(f"schema = {shown(schema)} in {path} cannot be read back: use {known}")


def to_frame(*results: Result) -> pandas.DataFrame:
    """Return the rows of several results in one pandas data frame: those of ``result.to_frame()``, one after the other.

    Parameters
    ----------
    results
        One or more results, such as those of `find_minima` for several scenes.

    Returns
    -------
    pandas.DataFrame
        Numbered from 0; of minima the columns are those that `MinimaResult` states.

    Raises
    ------
    OptionError
        If pandas is not installed (extra ``sweep``: ``pip install "origami_nlp[sweep]"``), or a result has no rows.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/3", ratio=1), max_starts=16)
    >>> list(o.to_frame(result).columns[:4])
    ['scene', 'number', 'energy_J', 'kind']
    """
    for k, result in enumerate(results, start=1):
        check_type(f"results[{k}]", result, Result)
    frames = [result.to_frame() for result in results]
    if not frames:
        raise OptionError("results is empty: give a result of a find_ function")
    joined: pandas.DataFrame = import_module("pandas").concat(frames, ignore_index=True)
    return joined
