"""What a sweep file says: a scene or a pattern, and parameters of it that take many values.

```toml
[scene]
example = "degree6"            # of one vertex, with its options; or file = "scene.toml", or the tables of one
alpha = "pi/3"
ratio = 1

[[axes]]
set = "ratio"                  # an argument of the example, or a number as `follow` names it
from = 0.01
to = 100
count = 41
scale = "log"                  # linear (default) or log; or values = [...] in place of from, to, count

[[axes]]
set = ["creases.stiffness[1]", "creases.stiffness[4]"]   # 1-based; several places take the same value
                               # angles: "creases.rest_angles[1]" in radians, "creases.rest_angles_deg[1]" in
                               # degrees, whichever the scene states
                               # of hinge laws "law_scale[1]", "law_shift[1]"; of loads "loads[1]", a factor
values = ["pi/4", 1.2]

[search]
mode = "grid"                  # every combination (default), or list: axes run together
effort = "normal"              # quick, normal or thorough
starts = 0                     # random starts in a row that find nothing new; 0: as the effort says
seed = 0
max_starts = 0                 # random starts at most; 0: as the effort says
full = false                   # also decide each state of a scene without its symmetry
contact = "fold-limits"        # in place of the one that is stated
```

With ``[pattern]`` in place of ``[scene]`` it is of sheets:

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

[[axes]]
set = "creases.rest_angles"    # size for mountains and valleys; of one class or one crease the angle itself
values = [0.5, 1.0, "pi/2"]

[[axes]]
set = "alpha"                  # an option of the example, or rows, columns
values = ["pi/4", "pi/3"]
```
"""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple, get_args

import numpy as np

from origami_nlp.arguments import check_flag, check_path, check_whole, shown
from origami_nlp.errors import OrigamiError, SweepError
from origami_nlp.io import check_tables, read_toml
from origami_nlp.pattern import (
    Contact,
    Example,
    Pattern,
    Scene,
    parse_angle,
    pattern_from_dict,
    pattern_to_dict,
    read_pattern,
    scene_from_dict,
    with_numbers,
    with_symmetry_of,
)
from origami_nlp.pattern_problem import PatternProblem, check_orders

LARGEST = 10_000_000
"""Bytes of a file."""
MOST_SCENES = 10_000_000
SPRINGS = ("stiffness", "rest_angle")
_AXIS_KEYS = ("name", "set", "values", "from", "to", "count", "scale")
_MODES: dict[str, tuple[str, ...]] = {
    "mode": ("grid", "list"),
    "effort": ("quick", "normal", "thorough"),
}
_MODES["contact"] = ("", *get_args(Contact))
_SEARCH: dict[str, Any] = {"mode": "grid", "effort": "normal", "starts": 0, "seed": 0}
_SEARCH |= {"max_starts": 0, "full": False, "contact": ""}
"""Of [search], with what holds where they are left out."""


class Axis(NamedTuple):
    """One parameter of a sweep.

    Attributes
    ----------
    name
        For tables and figures.
    places
        What it sets.
    values
        [m] numbers (angles in radians).
    """

    name: str
    places: tuple[str, ...]
    values: tuple[float, ...]


@dataclass(frozen=True)
class Sweep:
    """A sweep: `scene(index)` is scene, or pattern, number `index` of `count`.

    Attributes
    ----------
    of
        ``"scene"`` or ``"pattern"``.
    base
        That table; of a file, what is in it.
    axes
        The parameters that take many values.
    search
        The [search] table, with defaults.
    """

    of: str
    base: dict[str, Any] = field(repr=False)
    axes: tuple[Axis, ...]
    search: dict[str, Any]

    def __post_init__(self) -> None:
        names = [a.name for a in self.axes]
        if len(set(names)) < len(names):
            name = max(names, key=names.count)
            raise SweepError(f"two axes are called {name!r}: give each a name")
        if self.search["mode"] == "list" and len({len(a.values) for a in self.axes}) > 1:
            many = ", ".join(f"{a.name}: {len(a.values)}" for a in self.axes)
            raise SweepError(f"axes of mode = 'list' must have equally many values, not {many}")
        if self.count > MOST_SCENES:
            raise SweepError(f"the sweep has {self.count:,} {self.of}s: at most {MOST_SCENES:,}")

    @property
    def shape(self) -> tuple[int, ...]:
        """Scenes along each dimension."""
        lengths = tuple(len(a.values) for a in self.axes)
        return lengths if self.search["mode"] == "grid" else lengths[:1]

    @property
    def count(self) -> int:
        """Number of scenes."""
        return math.prod(self.shape)

    def parameters(self, index: int) -> dict[str, float]:
        """Values of the axes of scene `index`; the last axis runs fastest."""
        where = np.unravel_index(index, self.shape)
        where = where if self.search["mode"] == "grid" else where * len(self.axes)
        return {a.name: a.values[i] for a, i in zip(self.axes, where, strict=True)}

    def scene(self, index: int) -> Scene | Pattern:
        """Make scene, or pattern, number `index`.

        Raises
        ------
        OrigamiError
            If these values make none (sector angles that do not sum to 2 pi, say).
        """
        made, generic = self._made(self.parameters(index)), self.generic
        return made if generic is None else with_symmetry_of(made, generic)  # type: ignore[arg-type]

    def minima(self, made: Scene | Pattern) -> Any:
        """Search for the minima of one of its scenes."""
        from origami_nlp.pattern_states import find_states

        options = {key: value for key, value in self.search.items() if key != "mode"}
        options |= {key: options[key] or None for key in ("starts", "max_starts")}
        contact = options.pop("contact")
        made = made.with_contact(contact) if contact else made
        return find_states(made, escape=False, prove=False, **options)

    @cached_property
    def stated(self) -> Scene | Pattern | Example:
        """What the axes change."""
        base = dict(self.base)
        springs = [base.pop(key, None) for key in SPRINGS] if self.of == "pattern" else []
        if "sheet" in base:
            return pattern_from_dict(base["sheet"]).with_springs(*springs)
        if "example" not in base:
            return scene_from_dict(base)
        made = Example.of(base.pop("example"), self.of == "pattern", **base)
        return replace(made, make=partial(_sprung, made.make, *springs)) if springs else made

    @cached_property
    def generic(self) -> Scene | None:
        """A scene at values that no symmetry asks for: all scenes keep its symmetry.  None where one is stated.

        A larger symmetry that single values happen to have (equal rest angles) is not imposed there: numbers of
        states along an axis would not count the same thing.
        """
        values, each = {}, self.search["mode"] == "grid"
        for k, axis in enumerate(self.axes):
            a, b = min(axis.values), max(axis.values)
            # no rational relation between axes
            values[axis.name] = a + math.exp(-1.0 - k * each) * (b - a)
        with contextlib.suppress(OrigamiError):
            if getattr(made := self._made(values), "symmetry", "") == "auto":
                return made  # type: ignore[return-value]
        return None

    def _made(self, values: Mapping[str, float]) -> Scene | Pattern:
        given = {place: values[axis.name] for axis in self.axes for place in axis.places}
        return with_numbers(self.stated, given)

    @property
    def normalized(self) -> float:
        """The change that ``normalize`` makes to sector angles of a vertex [rad], with its sign."""
        return self.stated.vertex.normalized if isinstance(self.stated, Scene) else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return the whole sweep as plain data: two sweeps are the same when these agree."""
        rest = {"axes": self.axes, "search": self.search, "shape": self.shape}
        return dict(json.loads(json.dumps({self.of: self.base, **rest})))


def read_sweep(path: str | Path) -> Sweep:
    """Read a sweep file.

    Parameters
    ----------
    path
        TOML, as the module `sweep.spec` describes it; a ``file`` in it is found beside it.

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
    of = "pattern" if "pattern" in data else "scene"
    known: dict[str, Any] = {of: (), "axes": _AXIS_KEYS, "search": _SEARCH}
    check_tables(data, known, "a sweep has", SweepError, ("axes",))
    if not isinstance(data.get(of), Mapping) or not data.get("axes"):
        raise SweepError("a sweep needs [scene] or [pattern], and [[axes]] with set and values")
    axes = tuple(_axis(one, f"axes[{number}]") for number, one in enumerate(data["axes"], 1))
    base = _read(of, data[of], Path(folder or ""))
    sweep = Sweep(of, base, axes, _checked(_SEARCH | data.get("search", {})))
    sweep.scene(0)  # a mistake is found now, not in every worker
    return sweep


def _read(of: str, stated: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what [scene] or [pattern] states; of a file, what is in it."""
    base = dict(stated)
    if of == "scene":
        if "file" in base and (len(base) > 1 or not isinstance(base["file"], str)):
            raise SweepError('[scene] with file = "..." takes nothing else')
        return read_toml(folder / base["file"], LARGEST, of, SweepError) if "file" in base else base
    if len({"example", "file"} & set(base)) != 1:
        raise SweepError('[pattern] needs example = "miura:4x4" or file = "sheet.fold"')
    base |= {k: parse_angle(base[k], f"pattern.{k}") for k in SPRINGS if k in base}
    if "file" in base:
        for key in base.keys() - {"file", *SPRINGS}:
            raise SweepError(f"unknown key {key!r} in [pattern]: file, stiffness, rest_angle")
        sheet = read_pattern(folder / str(base.pop("file")))
        check_orders(PatternProblem(sheet))
        base["sheet"] = pattern_to_dict(sheet)
    return base


def _sprung(make: Any, *springs: Any, **options: Any) -> Any:
    return make(**options).with_springs(*springs)


def _axis(stated: Mapping[str, Any], where: str) -> Axis:
    """Read one of the [[axes]]."""
    places = stated.get("set")
    places = [places] if isinstance(places, str) else places
    if not isinstance(places, list) or not places or not all(isinstance(p, str) for p in places):
        raise SweepError(f'{where}.set must name what it changes, such as "creases.stiffness[1]"')
    scale, name = stated.get("scale", "linear"), stated.get("name", places[0])
    if scale not in ("linear", "log"):
        raise SweepError(f"{where}.scale = {scale!r} must be linear or log")
    if not isinstance(name, str) or not name:
        raise SweepError(f"{where}.name = {name!r} must be text")
    spaced = {"from", "to", "count"} & {*stated}
    if len(spaced) not in (0, 3) or ("values" in stated) == bool(spaced):
        raise SweepError(f"{where} needs values, or from, to and count")
    if spaced:
        low, high = (parse_angle(stated[key], f"{where}.{key}") for key in ("from", "to"))
        count = check_whole(f"{where}.count", stated["count"], 1, MOST_SCENES)
        if scale == "log" and min(low, high) <= 0:
            raise SweepError(f"{where}: a log scale needs from and to above 0")
        numbers = (np.geomspace if scale == "log" else np.linspace)(low, high, count).tolist()
    else:
        if not (isinstance(values := stated["values"], list) and values):
            raise SweepError(f"{where}.values must be a list of one or more numbers or angles")
        numbers = [parse_angle(v, f"{where}.values[{k}]") for k, v in enumerate(values, 1)]
    return Axis(name, tuple(places), tuple(numbers))


def _checked(search: dict[str, Any]) -> dict[str, Any]:
    """Return a [search] table; its defaults say of what kind its values are."""
    for key, value in search.items():
        name, words = f"search.{key}", _MODES.get(key, ())
        if words and value not in words:
            raise SweepError(f"{name} = {shown(value)} must be {' or '.join(words)}")
        if not words:
            check_flag(name, value) if isinstance(_SEARCH[key], bool) else check_whole(
                name, value, 0
            )
    return search
