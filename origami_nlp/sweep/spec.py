"""What a sweep file says: a scene, and parameters of it that take many values.

```toml
[scene]
example = "degree6"            # degree6 or degree8, or file = "scene.toml", or the tables of a scene file
alpha = "pi/3"
ratio = 1

[[axes]]
set = "ratio"                  # an argument of the example, or a place in the scene file
from = 0.01
to = 100
count = 41
scale = "log"                  # linear (default) or log; or values = [...] in place of from, to, count

[[axes]]
set = ["creases.stiffness[1]", "creases.stiffness[4]"]   # 1-based; several places take the same value
                               # angles: "creases.rest_angles[1]" in radians, "creases.rest_angles_deg[1]" in
                               # degrees, whichever the scene states
                               # of hinge laws and stops: "laws.NAME.energy", "laws.NAME.sum[2].at_deg",
                               # "laws.NAME.scale", "laws.NAME.shift_deg", "creases.limits_deg[1][2]" (the upper stop)
                               # of a load: "loads[1].force[3]", "loads[1].distance", "loads[1].torque"
values = ["pi/4", 1.2]

[search]
mode = "grid"                  # every combination (default), or list: axes run together
effort = "normal"              # quick, normal or thorough
starts = 0                     # random starts in a row that find nothing new; 0: as the effort says
max_starts = 100000
seed = 0
full = false                   # also decide each state in the full space
```
"""

from __future__ import annotations

import contextlib
import copy
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.errors import OrigamiError, SweepError
from origami_nlp.io import check_tables, read_toml
from origami_nlp.pattern import Scene, examples, parse_angle, scene_from_dict, with_symmetry_of
from origami_nlp.sweep.places import check_place, give_way, put

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult

MOST_SCENES = 10_000_000
MOST_COMPARED = 64
"""Scenes whose symmetries are compared where none can be made at generic values."""
LARGEST = 10_000_000
"""Bytes of a file."""
_EXAMPLES = {"degree6": examples.degree6, "degree8": examples.degree8}
_EXAMPLE_KEYS = ("example", "alpha", "ratio", "symmetry", "contact")
_AXIS_KEYS = ("name", "set", "values", "from", "to", "count", "scale")
_SEARCH = {
    "mode": "grid",
    "effort": "normal",
    "starts": 0,
    "max_starts": 100_000,
    "seed": 0,
    "full": False,
}


@dataclass(frozen=True)
class Axis:
    """One parameter of a sweep.

    Attributes
    ----------
    name
        For tables and figures.
    places
        What it sets.
    values
        [m] numbers (angles in radians).
    scale
        ``"linear"`` or ``"log"``.
    """

    name: str
    places: tuple[str, ...]
    values: tuple[float, ...] = field(repr=False)
    scale: str = "linear"


@dataclass(frozen=True)
class Sweep:
    """A sweep: `scene(index)` is scene number `index` of `count`.

    Attributes
    ----------
    base
        The [scene] table.
    axes
        The parameters that take many values.
    search
        The [search] table, with defaults.
    """

    base: dict[str, Any] = field(repr=False)
    axes: tuple[Axis, ...]
    search: dict[str, Any]
    ONE, MANY = "scene", "scenes"

    def __post_init__(self) -> None:
        names = [a.name for a in self.axes]
        if len(set(names)) < len(names):
            name = max(names, key=names.count)
            raise SweepError(f"two axes are called {name!r}: give each a name")
        if self.search["mode"] == "list" and len({len(a.values) for a in self.axes}) > 1:
            lengths = ", ".join(f"{a.name}: {len(a.values)}" for a in self.axes)
            raise SweepError(f"axes of mode = 'list' must have equally many values, not {lengths}")
        if self.count > MOST_SCENES:
            what = f"{self.count:,} {self.MANY}"
            raise SweepError(f"the sweep has {what}: at most {MOST_SCENES:,}")

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
        where: tuple[Any, ...]
        if self.search["mode"] == "grid":
            where = tuple(np.unravel_index(index, self.shape))
        else:
            where = (index,) * len(self.axes)
        return {a.name: a.values[i] for a, i in zip(self.axes, where, strict=True)}

    def scene(self, index: int) -> Scene:
        """Make scene `index`.

        Raises
        ------
        OrigamiError
            If these values make no scene (sector angles that do not sum to 2 pi, say).
        """
        return self.scene_with(self.parameters(index))

    def minima(self, made: Scene) -> MinimaResult:
        """Search for the minima of one of its scenes."""
        from origami_nlp.pattern_states import find_states

        s = self.search
        more = {key: s[key] for key in ("effort", "max_starts", "full", "seed")}
        return find_states(made, starts=s["starts"] or None, escape=False, prove=False, **more)

    @cached_property
    def generic(self) -> Scene | None:
        """A scene at values that no symmetry asks for: all scenes keep its symmetry.  None where one is stated.

        A larger symmetry that single values happen to have (equal rest angles) is not imposed there: numbers of
        states along an axis would not count the same thing.
        """
        example = "example" in self.base
        table = self.base if example else self.base.get("model", {})
        if table.get("symmetry", "D" if example else "auto") != "auto":
            return None
        alike = self.search["mode"] == "list"
        values = {}
        for k, axis in enumerate(self.axes):
            a = axis.values[0]
            b = next((v for v in axis.values if v != a), a)
            share = math.exp(-1.0 - (0 if alike else k))  # no rational relation between axes
            values[axis.name] = a + share * (b - a)
        try:
            return self._scene(values)
        except OrigamiError:  # sector angles that sum to 2 pi at the values of the axes alone
            some = []
            for index in range(min(self.count, MOST_COMPARED)):
                with contextlib.suppress(OrigamiError):
                    some.append(self._scene(self.parameters(index)))
            return min(some, key=lambda scene: len(scene.group.elements), default=None)

    def scene_with(self, values: Mapping[str, float]) -> Scene:
        """Make the scene with these values of the axes, whether they are among theirs or not."""
        made = self._scene(values)
        return made if self.generic is None else with_symmetry_of(made, self.generic)

    def _scene(self, values: Mapping[str, float]) -> Scene:
        data = copy.deepcopy(self.base)
        for axis in self.axes:
            for place in axis.places:
                put(data, place, values[axis.name])
        if "example" in data:
            arguments = {k: v for k, v in data.items() if k != "example"}
            return _EXAMPLES[data["example"]](**arguments)
        give_way(data, {place for axis in self.axes for place in axis.places})
        return scene_from_dict(data)

    @property
    def normalized(self) -> float:
        """The largest change that ``normalize`` makes to sector angles of a scene [rad], with its sign."""
        if not dict(self.base.get("vertex", {})).get("normalize"):
            return 0.0
        sectors = any("sector_angles" in place for axis in self.axes for place in axis.places)
        changes = [0.0]
        for index in range(self.count if sectors else 1):
            with contextlib.suppress(
                OrigamiError
            ):  # such a scene has no states, and the store says why
                changes.append(self._scene(self.parameters(index)).vertex.normalized)
        return max(changes, key=abs)

    def fingerprint(self) -> str:
        """The whole sweep as text: two sweeps are the same when these agree."""
        axes = [[a.name, list(a.places), list(a.values), a.scale] for a in self.axes]
        whole = {self.ONE: self.base, "axes": axes, "search": self.search}
        return json.dumps(whole, sort_keys=True)


def parse_scenes(data: Mapping[str, Any], folder: Path | None) -> Sweep:
    """Make a sweep of scenes from tables ``scene``, ``axes`` and ``search``.

    Parameters
    ----------
    data
        The tables.
    folder
        Where a scene ``file`` is looked for.

    Returns
    -------
    Sweep
        The sweep.

    Raises
    ------
    SweepError
        If a key is unknown, missing or wrong.
    """
    base = _base(data.get("scene"), folder)
    axes = read_axes(data.get("axes"))
    for number, axis in enumerate(axes, start=1):
        for place in axis.places:
            check_place(place, f"axes[{number}]", base)
    sweep = Sweep(base, axes, checked_search(data.get("search", {}), _SEARCH, 0))
    sweep.scene(0)  # a mistake in the scene is found now, not in every worker
    return sweep


def _base(scene: Any, folder: Path | None) -> dict[str, Any]:
    if not isinstance(scene, Mapping):
        raise SweepError(
            "a sweep needs [scene]: example = ..., file = ..., or the tables of a scene file"
        )
    data = copy.deepcopy(dict(scene))
    if "example" in data:
        check_tables({"scene": data}, {"scene": _EXAMPLE_KEYS}, "a sweep has", SweepError)
        if data["example"] not in _EXAMPLES:
            raise SweepError(
                f"example = {data['example']!r} is unknown: use {', '.join(_EXAMPLES)}"
            )
    if "file" not in data:
        return data
    if len(data) > 1 or not isinstance(data["file"], str):
        raise SweepError('[scene] with file = "..." takes nothing else')
    return read_toml((folder or Path()) / data["file"], LARGEST, "scene", SweepError)


def read_axes(stated: Any) -> tuple[Axis, ...]:
    """Read the [[axes]] of a sweep file, whatever their places are.

    Raises
    ------
    SweepError
        If there is none, or a key is unknown, missing or wrong.
    """
    if not stated or not isinstance(stated, list):
        raise SweepError(
            "a sweep needs at least one [[axes]] with set and values (or from, to, count)"
        )
    check_tables({"axes": stated}, {"axes": _AXIS_KEYS}, "a sweep has", SweepError, ("axes",))
    return tuple(_axis(one, f"axes[{number}]") for number, one in enumerate(stated, start=1))


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
    spaced = [key for key in ("from", "to", "count") if key in stated]
    if "values" not in stated:
        return Axis(name, tuple(places), tuple(_spaced(stated, where, scale)), scale)
    if spaced:
        raise SweepError(f"{where} has both values and {', '.join(spaced)}: give one")
    if not isinstance(stated["values"], list) or not stated["values"]:
        raise SweepError(f"{where}.values must be a list of one or more numbers or angles")
    values = [parse_angle(v, f"{where}.values[{k}]") for k, v in enumerate(stated["values"], 1)]
    return Axis(name, tuple(places), tuple(values), scale)


def _spaced(stated: Mapping[str, Any], where: str, scale: str) -> list[float]:
    for key in ("from", "to", "count"):
        if key not in stated:
            raise SweepError(f"{where}.{key} is missing: give values, or from, to and count")
    low, high = (parse_angle(stated[key], f"{where}.{key}") for key in ("from", "to"))
    count = stated["count"]
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_SCENES:
        raise SweepError(
            f"{where}.count = {count!r} must be a whole number from 1 to {MOST_SCENES:,}"
        )
    if scale == "linear":
        return np.linspace(low, high, count).tolist()
    if low <= 0 or high <= 0:
        raise SweepError(f"{where}: a log scale needs from and to above 0")
    return np.geomspace(low, high, count).tolist()


def checked_search(
    stated: Any, known: Mapping[str, Any], starts: int, of: str = ""
) -> dict[str, Any]:
    """Return a [search] table with what it leaves out from `known`, which says its kinds; starts: the fewest."""
    least = {"starts": starts, "max_starts": 1, "seed": 0}
    check_tables({"search": stated}, {"search": known}, f"a sweep{of} has", SweepError)
    search = {**known, **stated}
    words = {"mode": ("grid", "list"), "effort": ("quick", "normal", "thorough")}
    for key, value in search.items():
        what = f"search.{key} = {value!r} must be "
        if key in words:
            if value not in words[key]:
                raise SweepError(what + " or ".join(words[key]))
        elif isinstance(known[key], bool):
            if not isinstance(value, bool):
                raise SweepError(what + "true or false")
        elif isinstance(value, bool) or not isinstance(value, int) or value < least[key]:
            raise SweepError(f"{what}a whole number, at least {least[key]}")
    return search
