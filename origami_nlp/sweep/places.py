"""Places of a scene file by name, as the axes of a sweep set them."""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Mapping
from typing import Any

from origami_nlp.errors import SweepError
from origami_nlp.pattern import CHANGED, parse_angle

_PLACE = re.compile(r"(vertex|creases|model)\.([a-z_]+)(?:\[(\d{1,4})\])?")
_LOAD = re.compile(r"loads\[(\d{1,3})\]\.([a-z_]+)(?:\[(\d)\])?")
_LAW = re.compile(r"laws\.([A-Za-z0-9_-]+)\.(?:sum\[(\d{1,2})\]\.)?([a-z_]+)(?:\[(\d{1,4})\])?")
_STOP = re.compile(r"creases\.limits(?:_deg)?\[(\d{1,4})\]\[([12])\]")
_DEGREES = "_deg"
"""Of keys: angles in degrees."""


def _key_in(table: Any, key: str) -> str:
    """Return a key, or what a table has in its place: the same angles in degrees, or in radians."""
    other = key.removesuffix(_DEGREES) if key.endswith(_DEGREES) else key + _DEGREES
    has = isinstance(table, Mapping) and key not in table and other in table
    return other if has else key


def check_place(place: str, where: str, base: dict[str, Any]) -> None:
    """Raise an error unless a scene has a place that an axis sets.

    Raises
    ------
    SweepError
        With the place.
    """
    if "example" in base:
        if place not in ("alpha", "ratio"):
            raise SweepError(f"{where}.set = {place!r}: an example takes alpha or ratio")
        return
    if _LAW.fullmatch(place) or _STOP.fullmatch(place):
        try:
            put(copy.deepcopy(base), place, math.nan)
        except (LookupError, TypeError):
            raise SweepError(
                f'{where}.set = {place!r} is not in the scene: write "laws.NAME.energy", a number of a law as '
                '[laws.NAME] states it, its scale or shift_deg, or "creases.limits_deg[1][2]"'
            ) from None
        return
    match = _PLACE.fullmatch(place)
    table = base.get(match[1], {}) if match else None
    if (load := _LOAD.fullmatch(place)) is not None:
        loads = base.get("loads")
        if not isinstance(loads, list) or not 1 <= int(load[1]) <= len(loads):
            many = len(loads) if isinstance(loads, list) else 0
            raise SweepError(f"{where}.set = {place!r}: the scene has {many} [[loads]]")
        match, table = load, loads[int(load[1]) - 1]
    if place.startswith("creases.preload[") and isinstance(table, dict):  # none stated: zeros
        table.setdefault("preload", [0.0] * len(table.get("stiffness", ())))
    key = match and _key_in(table, match[2])
    if match is None or not isinstance(table, Mapping) or key not in table:
        raise SweepError(
            f'{where}.set = {place!r} is not in the scene: write a place such as "creases.stiffness[1]"'
        )
    entry = table[key]
    if match[3] is None:
        if isinstance(entry, list):
            raise SweepError(
                f"{where}.set = {place!r} is a list: say which entry, {place}[1] to [{len(entry)}]"
            )
    elif not isinstance(entry, list) or not 1 <= int(match[3]) <= len(entry):
        size = len(entry) if isinstance(entry, list) else 0
        raise SweepError(f"{where}.set = {place!r}: the list has {size} entries, numbered from 1")


def put(data: dict[str, Any], place: str, value: float) -> None:
    """Set a place of a scene, in place."""
    if (law := _LAW.fullmatch(place)) is not None:
        table = data["laws"][law[1]]
        table = table if law[2] is None else table["sum"][int(law[2]) - 1]
        if law[4] is not None:
            table[law[3]][int(law[4]) - 1] = value
        elif law[3] in CHANGED or isinstance(table[law[3]], int | float):
            table[law[3]] = value
        else:
            raise KeyError(law[3])
        return
    if (stop := _STOP.fullmatch(place)) is not None:
        key = place.partition("[")[0].removeprefix("creases.")
        data["creases"][key][int(stop[1]) - 1][int(stop[2]) - 1] = value
        return
    match = _PLACE.fullmatch(place)
    if (load := _LOAD.fullmatch(place)) is not None:
        table = data["loads"][int(load[1]) - 1]
        if load[3] is None:
            table[load[2]] = value
        else:
            table[load[2]][int(load[3]) - 1] = value
    elif match is None:
        data[place] = value
    elif match[3] is None:
        data[match[1]][match[2]] = value
    else:
        table, key = data[match[1]], _key_in(data[match[1]], match[2])
        if key != match[2]:
            value = math.degrees(value) if key.endswith(_DEGREES) else math.radians(value)
        table[key][int(match[3]) - 1] = value


def give_way(data: dict[str, Any], places: set[str]) -> None:
    """Let sectors that no axis sets give way alike, so that a flat sheet goes once round: as in `follow`."""
    table = data.get("vertex", {})
    key = _key_in(table, "sector_angles")
    entries = {
        int(m[3]) - 1
        for p in places
        if (m := _PLACE.fullmatch(p)) and m[2].startswith("sector_angles")
    }
    if not entries or table.get("flat", True) is not True:
        return
    unit = math.degrees(1.0) if key.endswith(_DEGREES) else 1.0
    whole = [v if unit != 1.0 else parse_angle(v, key) for v in table[key]]
    others = [i for i in range(len(whole)) if i not in entries]
    for i in others:
        table[key][i] = whole[i] + (2 * math.pi * unit - math.fsum(whole)) / len(others)
