"""Places of a scene file by name, as axes of a sweep set them: keys with points between, entries of lists from 1."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from origami_nlp.errors import SweepError
from origami_nlp.pattern import CHANGED, parse_angle

_PLACE = re.compile(r"(vertex|creases|model|loads\[\d{1,3}\]|laws\.[\w-]+)(\.[\w-]+|\[\d{1,4}\])+")
_DEGREES = "_deg"
"""Of keys: angles in degrees."""


def _twin(table: Any, key: Any) -> Any:
    """Return a key, or what a table has in its place: the same angles in degrees, or in radians."""
    if not isinstance(table, Mapping) or key in table:
        return key
    other = key.removesuffix(_DEGREES) if key.endswith(_DEGREES) else key + _DEGREES
    return other if other in table else key


def _found(data: Mapping[str, Any], place: str) -> tuple[Any, Any, float]:
    """Return the table or list of a place, its key or index there, and what a value is multiplied with."""
    words = re.findall(r"[\w-]+|\[\d+\]", place)
    keys = [int(word[1:-1]) - 1 if word[0] == "[" else word for word in words]
    if -1 in keys:
        raise LookupError
    table: Any = data
    factor = 1.0
    for k, key in enumerate(keys):
        own: Any = _twin(table, key) if isinstance(key, str) else key
        if own != key:
            factor = math.degrees(1.0) if own.endswith(_DEGREES) else math.radians(1.0)
        if k == len(keys) - 1:
            return table, own, factor
        table = table[own]
    raise LookupError


def check_place(place: str, where: str, base: dict[str, Any]) -> None:
    """Raise an error unless a scene has a place that an axis sets.

    Raises
    ------
    SweepError
        With the place.
    """
    what = f"{where}.set = {place!r}"
    if "example" in base:
        if place not in ("alpha", "ratio"):
            raise SweepError(f"{what}: an example takes alpha or ratio")
        return
    creases = base.get("creases")
    if place.startswith("creases.preload[") and isinstance(creases, dict):  # none stated: zeros
        creases.setdefault("preload", [0.0] * len(creases.get("stiffness", ())))
    entry: Any = None
    if _PLACE.fullmatch(place):
        try:
            table, key, _ = _found(base, place)
            if isinstance(table, list) and key >= len(table):
                raise SweepError(f"{what}: the list has {len(table)} entries, numbered from 1")
            entry = 0.0 if _is_change(place, table, key) else table[key]
        except (LookupError, TypeError):
            entry = None
    if isinstance(entry, list):
        raise SweepError(f"{what} is a list: say which entry, {place}[1] to [{len(entry)}]")
    if isinstance(entry, Mapping) or entry is None:
        raise SweepError(
            f'{what} is not in the scene: write a place such as "creases.stiffness[1]", "loads[1].torque", '
            '"laws.NAME.energy", a number of a law as it is stated, its scale or shift_deg, "creases.limits_deg[1][2]"'
        )


def _is_change(place: str, table: Any, key: Any) -> bool:
    """Return whether a place is what every law has, stated or not."""
    return place.startswith("laws.") and isinstance(table, Mapping) and key in CHANGED


def put(data: dict[str, Any], place: str, value: float) -> None:
    """Set a place of a scene, or of an example, in place."""
    table, key, factor = (data, place, 1.0) if "example" in data else _found(data, place)
    table[key] = value * factor


def give_way(data: dict[str, Any], places: set[str]) -> None:
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
