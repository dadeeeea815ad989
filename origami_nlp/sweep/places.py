"""Origami with places set by name: keys of a scene file with points between, entries of lists from 1; of patterns, and
options of examples."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from origami_nlp.errors import OptionError, SweepError
from origami_nlp.io import read_toml
from origami_nlp.pattern import (
    CHANGED,
    Pattern,
    Scene,
    examples,
    is_place,
    parse_angle,
    pattern_from_dict,
    pattern_to_dict,
    read_pattern,
    scene_from_dict,
    with_places,
)
from origami_nlp.pattern_problem import PatternProblem, check_orders

LARGEST = 10_000_000
"""Bytes of a file."""
_PLACE = re.compile(r"(vertex|creases|model|loads\[\d{1,3}\]|laws\.[\w-]+)(\.[\w-]+|\[\d{1,4}\])+")
_DEGREES = "_deg"
"""Of keys: angles in degrees."""
_SPRINGS = ("stiffness", "rest_angle")


def read_scene(stated: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the tables of a scene, or the options of an example, that [scene] states."""
    data = copy.deepcopy(dict(stated))
    if "file" in data:
        if len(data) > 1 or not isinstance(data["file"], str):
            raise SweepError('[scene] with file = "..." takes nothing else')
        data = read_toml(folder / data["file"], LARGEST, "scene", SweepError)
    return data


def make_scene(base: Mapping[str, Any], given: Mapping[str, float]) -> Scene:
    """Return a scene in which places have values."""
    if "example" in base:
        options = {k: v for k, v in base.items() if k != "example"}
        return examples.by_name(base["example"], **options | dict(given))
    data = copy.deepcopy(dict(base))
    for place, value in given.items():
        _put(data, place, value)
    _give_way(data, given)
    return scene_from_dict(data)


def read_pattern_base(stated: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return what [pattern] states; of a file, the pattern itself."""
    if len({"example", "file"} & set(stated)) != 1:
        raise SweepError('[pattern] needs example = "miura:4x4" or file = "sheet.fold"')
    base = dict(stated)
    base |= {k: parse_angle(base[k], f"pattern.{k}") for k in _SPRINGS if k in base}
    if "file" in base:
        for key in base.keys() - {"file", *_SPRINGS}:
            raise SweepError(f"unknown key {key!r} in [pattern]: file, stiffness, rest_angle")
        sheet = read_pattern(folder / str(base.pop("file")))
        check_orders(PatternProblem(sheet))
        base["sheet"] = pattern_to_dict(sheet)
    return base


def make_pattern(base: Mapping[str, Any], given: Mapping[str, float]) -> Pattern:
    """Return a pattern in which places, and options of an example, have values."""
    places = {k: v for k, v in given.items() if is_place(k) or "sheet" in base}
    if "sheet" in base:
        made = pattern_from_dict(base["sheet"])
    else:
        own = {k: v for k, v in base.items() if k not in ("example", *_SPRINGS)}
        own |= {k: v for k, v in given.items() if k not in places}
        name, size = examples.split_size(base["example"])
        shape = dict(zip(("rows", "columns"), size, strict=True)) | own
        for key in {"rows", "columns"} & own.keys():
            shape[key] = int(own[key]) if own[key] == int(own[key]) else own[key]
        made = examples.pattern(name, **shape)
    made = made.with_springs(base.get("stiffness"), base.get("rest_angle"))
    try:
        return with_places(made, places)
    except OptionError as error:
        raise SweepError(f"set = {error}") from None


def _twin(table: Any, key: Any) -> Any:
    """Return a key, or what a table has in its place: the same angles in degrees, or in radians."""
    if not isinstance(table, Mapping) or key in table:
        return key
    other = key.removesuffix(_DEGREES) if key.endswith(_DEGREES) else key + _DEGREES
    return other if other in table else key


def _put(data: dict[str, Any], place: str, value: float) -> None:
    """Set a place of a scene, in place."""
    if not _PLACE.fullmatch(place):
        raise _unknown(place)
    creases = data.get("creases")
    if place.startswith("creases.preload[") and isinstance(creases, dict):  # none stated: zeros
        creases.setdefault("preload", [0.0] * len(creases.get("stiffness", ())))
    table: Any = None
    own: Any = None
    factor = 1.0
    try:
        for word in re.findall(r"[\w-]+|\[\d+\]", place):
            table = data if own is None else table[own]
            key = int(word[1:-1]) - 1 if word[0] == "[" else word
            own = _twin(table, key) if isinstance(key, str) else key
            if own != key:
                factor = math.degrees(1.0) if own.endswith(_DEGREES) else math.radians(1.0)
        if isinstance(table, list) and not 0 <= own < len(table):
            what = f"the list has {len(table)} entries, numbered from 1"
            raise SweepError(f"set = {place!r}: {what}")
        free = place.startswith("laws.") and isinstance(table, Mapping) and own in CHANGED
        entry = 0.0 if free else table[own]
    except (LookupError, TypeError):
        raise _unknown(place) from None
    if isinstance(entry, list):
        raise SweepError(
            f"set = {place!r} is a list: say which entry, {place}[1] to [{len(entry)}]"
        )
    if isinstance(entry, Mapping):
        raise _unknown(place)
    table[own] = value * factor


def _unknown(place: str) -> SweepError:
    return SweepError(
        f'set = {place!r} is not in the scene: write a place such as "creases.stiffness[1]", "loads[1].force[3]", '
        '"laws.NAME.energy", a number of a law as it is stated, its scale or shift_deg, "creases.limits_deg[1][2]"'
    )


def _give_way(data: dict[str, Any], places: Mapping[str, float]) -> None:
    """Let sectors that no axis sets give way alike, so that a flat sheet goes once round: as in `follow`."""
    table = data.get("vertex", {})
    key = _twin(table, "sector_angles")
    stated = (re.fullmatch(r"vertex\.sector_angles(_deg)?\[(\d+)\]", place) for place in places)
    entries = {int(match[2]) - 1 for match in stated if match}
    if not entries or table.get("flat", True) is not True:
        return
    unit = math.degrees(1.0) if key.endswith(_DEGREES) else 1.0
    whole = [v if unit != 1.0 else parse_angle(v, key) for v in table[key]]
    others = [i for i in range(len(whole)) if i not in entries]
    for i in others:
        table[key][i] = whole[i] + (2 * math.pi * unit - math.fsum(whole)) / len(others)
