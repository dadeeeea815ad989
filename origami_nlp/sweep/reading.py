"""Sweep files, of scenes (`sweep.spec`) and of patterns (`sweep.patterns`)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_path, shown
from origami_nlp.errors import SweepError
from origami_nlp.files import read_toml
from origami_nlp.sweep.patterns import parse_pattern_sweep
from origami_nlp.sweep.spec import LARGEST, Sweep, parse_scenes


def read_sweep(path: str | Path) -> Sweep:
    """Read a sweep file.

    Parameters
    ----------
    path
        TOML, as the modules `sweep.spec` and `sweep.patterns` describe it; a ``file`` in it is found beside it.

    Returns
    -------
    Sweep
        The sweep.

    Raises
    ------
    SweepError
        If the file cannot be read, or a key is unknown, missing or wrong.
    AngleError, VertexError, SceneError, SceneFileError, FoldFileError, OptionError
        If its scene or pattern is wrong.
    """
    return parse_sweep(read_toml(path, LARGEST, "sweep", SweepError), Path(path).parent)


def parse_sweep(data: Mapping[str, Any], folder: Path | None = None) -> Sweep:
    """Make a sweep from the tables of a sweep file.

    Parameters
    ----------
    data
        Tables ``scene`` or ``pattern``, ``axes`` and ``search``.
    folder
        Where a ``file`` is looked for.

    Returns
    -------
    Sweep
        The sweep.

    Raises
    ------
    SweepError
        If a key is unknown, missing or wrong.

    Examples
    --------
    >>> from origami_nlp.sweep import parse_sweep
    >>> sweep = parse_sweep({
    ...     "scene": {"example": "degree6", "alpha": "pi/4"},
    ...     "axes": [{"set": "ratio", "from": 0.01, "to": 100, "count": 5, "scale": "log"}],
    ... })
    >>> sweep.count, sweep.scene(0).label
    (5, 'degree 6, alpha_1 = pi/4, r_k = 0.01')
    """
    if not isinstance(data, Mapping):
        raise SweepError(f"data = {shown(data)} must be the tables of a sweep file")
    if folder is not None:
        check_path("folder", folder)
        folder = Path(folder)
    of = "pattern" if "pattern" in data else "scene"
    for key in data:
        if key not in (of, "axes", "search"):
            raise SweepError(
                f"unknown table [{key}]: a sweep has [scene] or [pattern], [[axes]], [search]"
            )
    return parse_pattern_sweep(data, folder) if of == "pattern" else parse_scenes(data, folder)
