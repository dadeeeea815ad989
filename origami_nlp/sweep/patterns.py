"""Sweeps of patterns: the stable states of many patterns.

```toml
[pattern]
example = "miura:4x4"          # or file = "sheet.fold"; its options, such as alpha = 1.1
stiffness = 0.01               # of every crease; without it as the file or the example states
rest_angle = "pi/3"            # size for mountains and valleys; without it as the file or the example states

[[axes]]
set = "mountains.stiffness"    # or "valleys.", "creases." for all, "creases.stiffness[3]" for one, "vertices.x[5]"
from = 0.001
to = 0.1
count = 21
scale = "log"

[[axes]]
set = "creases.rest_angles"    # size for mountains and valleys; of one class or one crease the angle itself
values = [0.5, 1.0, "pi/2"]

[[axes]]
set = "alpha"                  # an option of the example, or rows, columns
values = ["pi/4", "pi/3"]

[search]
mode = "grid"                  # every combination (default), or list: axes run together
starts = 40                    # random starts of a pattern
seed = 0
contact = true                 # whether facets must not cross
```
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import check_path, shown
from origami_nlp.errors import OptionError, SweepError
from origami_nlp.io import check_tables, read_toml
from origami_nlp.pattern import (
    Pattern,
    examples,
    is_place,
    parse_angle,
    pattern_from_dict,
    pattern_to_dict,
    read_pattern,
    with_places,
)
from origami_nlp.pattern_problem import PatternProblem, check_orders
from origami_nlp.sweep.spec import LARGEST, Sweep, checked_search, parse_scenes, read_axes

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult

_SEARCH = {"mode": "grid", "starts": 40, "seed": 0, "contact": True}
_SIZES = ("rows", "columns")


@dataclass(frozen=True)
class PatternSweep(Sweep):
    """A sweep of patterns: `scene(index)` is pattern number `index` of `count`.

    Attributes
    ----------
    base
        The [pattern] table; of a file, the pattern itself.
    axes
        The parameters that take many values.
    search
        The [search] table, with defaults.
    """

    ONE, MANY = "pattern", "patterns"

    def scene(self, index: int) -> Pattern:  # type: ignore[override]
        """Make pattern `index`.

        Parameters
        ----------
        index
            From 0.

        Returns
        -------
        Pattern
            With its springs.

        Raises
        ------
        OrigamiError
            If these values make no pattern.
        """
        values = self.parameters(index)
        given = {p: values[a.name] for a in self.axes for p in a.places}
        problem = self._drawn({p: v for p, v in given.items() if not is_place(p)})
        problem = problem.with_springs(self.base.get("stiffness"), self.base.get("rest_angle"))
        try:
            return with_places(problem, {p: v for p, v in given.items() if is_place(p)})
        except OptionError as error:
            raise SweepError(f"set = {error}") from None

    def minima(self, made: Pattern) -> MinimaResult:  # type: ignore[override]
        """Search for the minima of one of its patterns."""
        from origami_nlp.pattern_states import find_states

        more = {key: self.search[key] for key in ("starts", "contact", "seed")}
        return find_states(made, escape=False, prove=False, **more)

    def _drawn(self, options: Mapping[str, float]) -> Pattern:
        """Draw the example with these options, or return the sheet of the file."""
        if "sheet" in self.base:
            return pattern_from_dict(self.base["sheet"])
        own = {
            k: v for k, v in self.base.items() if k not in ("example", "stiffness", "rest_angle")
        }
        own |= options
        name, size = examples.split_size(self.base["example"])
        shape = dict(zip(_SIZES, size, strict=True))
        for key in _SIZES:
            if key in own:
                if own[key] != int(own[key]):
                    raise SweepError(f"{key} = {own[key]:g} must be a whole number")
                shape[key] = int(own.pop(key))
        return examples.pattern(name, shape["rows"], shape["columns"], **own)


def parse_pattern_sweep(data: Mapping[str, Any], folder: Path | None) -> PatternSweep:
    """Make a sweep from tables ``pattern``, ``axes`` and ``search``.

    Parameters
    ----------
    data
        The tables.
    folder
        Where a ``file`` is looked for.

    Returns
    -------
    PatternSweep
        The sweep.

    Raises
    ------
    SweepError
        If a key is unknown, missing or wrong.
    OrigamiError
        If the pattern is wrong.
    """
    base = _base(data["pattern"], folder)
    axes = read_axes(data.get("axes"))
    search = checked_search(data.get("search", {}), _SEARCH, 0, " of a pattern")
    sweep = PatternSweep(base, axes, search)
    for number, axis in enumerate(axes, start=1):
        for place in axis.places:
            if not is_place(place) and "sheet" in base:
                raise SweepError(
                    f'axes[{number}].set = {place!r} is no place of a pattern: write "creases.stiffness", '
                    '"mountains.rest_angles", "valleys.stiffness" or "creases.stiffness[3]"'
                )
    sweep.scene(0)  # a mistake is found now, not in every worker
    return sweep


def _base(stated: Any, folder: Path | None) -> dict[str, Any]:
    if not isinstance(stated, Mapping) or len({"example", "file"} & set(stated)) != 1:
        raise SweepError('[pattern] needs example = "miura:4x4" or file = "sheet.fold"')
    base = dict(stated)
    for key in ("stiffness", "rest_angle"):
        if key in base:
            base[key] = parse_angle(base[key], f"pattern.{key}")
    if "file" in base:
        for key in base:
            if key not in ("file", "stiffness", "rest_angle"):
                raise SweepError(f"unknown key {key!r} in [pattern]: file, stiffness, rest_angle")
        problem = read_pattern((folder or Path()) / str(base.pop("file")))
        check_orders(PatternProblem(problem))
        base["sheet"] = pattern_to_dict(problem)
    elif not isinstance(base["example"], str):
        raise SweepError(f"pattern.example = {base['example']!r} must be a name such as miura:4x4")
    return base


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
    known: dict[str, tuple[str, ...]] = {of: (), "axes": (), "search": ()}
    check_tables(data, known, "a sweep has", SweepError, ("axes",))
    return parse_pattern_sweep(data, folder) if of == "pattern" else parse_scenes(data, folder)
