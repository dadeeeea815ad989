"""Targets as TOML files: read with every mistake named; the file is data, nothing is evaluated."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_whole, did_you_mean, shown
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.targets import EnergyBounds, Target, Targets
from origami_nlp.io import check_tables, one_of, parse_toml, read_toml
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern import (
    LIMIT_KEYS,
    Pattern,
    Scene,
    as_pattern,
    parse_angles,
    scene_from_dict,
    stated_limits,
    thick_limits,
    vertex_from_dict,
)

NAMES = ("waitukaitis-five", "six-states", "switch", "flat-and-one", "three-equal")
_FOLDER = files("origami_nlp.inverse_design") / "example_files"
EXAMPLES = {name: (_FOLDER / f"{name}.toml").read_text("utf-8") for name in NAMES}
"""TOML by name."""


_ENERGY = ("energy_above", "energy_difference")
_KEYS = {
    "vertex": ("sector_angles", "sector_angles_deg", "flat", "normalize"),
    "pattern": ("example", "file", "equal"),
    "creases": LIMIT_KEYS,
    "model": ("symmetry", "contact", "mirror", "name"),
    "states": ("name", "fold_angles", "fold_angles_deg", "like", "margin", *_ENERGY),
    "barriers": ("from", "to", "at_least", "at_most", "exactly"),
    "springs": ("stiffness", "rest_angles", "rest_angles_deg", "preload"),
    "ask": ("full_space",),
}
_LARGEST = 1_000_000


def read_targets(source: str | Path) -> Targets:
    """Read what a design is asked for from a TOML file.

    Parameters
    ----------
    source
        The file, ``"-"`` for standard input, or the name of an example; states that are ``like`` those of an earlier
        run name its JSON file relative to this one.

    Returns
    -------
    Targets
        The question.

    Raises
    ------
    OptionError, VertexError, AngleError
        If the file cannot be read, or a value does not fit; the message names it.
    """
    name, path = str(source), Path(source)
    if name in EXAMPLES and not path.exists():
        return parse_targets(EXAMPLES[name], source=name)
    if name != "-" and not path.suffix and not path.exists():
        those = f"{', '.join(EXAMPLES)}{did_you_mean(name, EXAMPLES)}"
        raise OptionError(f"targets = {name!r} is no file, and no example: those are {those}")
    typed = "standard input" if name == "-" else name
    folder = Path() if name == "-" else path.parent
    return _targets(read_toml(source, _LARGEST, "targets", OptionError), folder, typed)


def parse_targets(text: str, folder: Path = Path("."), source: str = "") -> Targets:
    """Read what a design is asked for from TOML text that comes from `source`; see `read_targets`."""
    return _targets(parse_toml(text, "targets", OptionError), folder, source)


def _targets(data: Mapping[str, Any], folder: Path, source: str) -> Targets:
    check_tables(data, _KEYS, "targets have", OptionError, ("states", "barriers"))
    origami, more = _origami(data, folder)
    many = origami.creases
    entries = data.get("states", [])
    states = [_state(entry, i, folder, many) for i, entry in enumerate(entries, start=1)]
    gaps = zip(states, entries, strict=True)
    more |= data.get("springs", {}) | data.get("ask", {})
    if {"rest_angles", "rest_angles_deg"} <= set(more):
        raise OptionError("[springs] has rest_angles and rest_angles_deg: give one of them")
    for key in ("rest_angles", "rest_angles_deg"):
        if key in more:
            more["rest_angles"] = tuple(_angles(more.pop(key), f"[springs] {key}"))
    return Targets(
        origami,
        tuple(states),
        energies=tuple(_gap(e, t.name) for t, e in gaps if set(e) & set(_ENERGY)),
        barriers=tuple(map(_barrier, data.get("barriers", []))),
        source=source,
        **more,
    )


def _origami(data: Mapping[str, Any], folder: Path) -> tuple[Scene | Pattern, dict[str, Any]]:
    """Return what is asked about, and which creases of a pattern have equal springs."""
    creases, model = data.get("creases", {}), data.get("model", {})
    if "pattern" not in data:
        n = vertex_from_dict(vertex := data.get("vertex", {})).degree
        springs = {"stiffness": [1.0] * n, "rest_angles": [0.0] * n}
        model = {"symmetry": "none"} | model
        return scene_from_dict({"vertex": vertex, "creases": springs | creases, "model": model}), {}
    if "vertex" in data:
        raise OptionError("targets have [vertex] and [pattern]: give one of them")
    if odd := {"symmetry", "mirror"} & {*model}:
        raise OptionError(f"{min(odd)} is not for a pattern: equal says which springs are equal")
    stated = data["pattern"]
    given = one_of(stated, "[pattern]", ("example", "file"), OptionError)
    if not isinstance(stated[given], str):
        raise OptionError(f"[pattern] {given} = {shown(stated[given])} must be text")
    equal = stated.get("equal", "")
    if isinstance(equal, list):
        equal = tuple(check_whole("[pattern] equal", v, 0) for v in equal)
    file = stated[given] if given == "example" else folder / stated[given]
    origami = as_pattern(file, "[pattern]")
    if stops := stated_limits(creases, origami.creases):
        limits = stops.get("limits", origami.limits)
        made = thick_limits(limits, origami.creases, stops.get("panels"))
        origami = origami.with_limits(made)
    origami = origami.with_contact(model.get("contact", "full"))
    return replace(origami, name=model.get("name", origami.name)), {"equal": equal}


def _state(entry: Mapping[str, Any], i: int, folder: Path, degree: int) -> Target:
    name = entry.get("name", f"state {i}")
    keys = ("fold_angles", "fold_angles_deg", "like")
    given = one_of(entry, f"[[states]] {name!r}", keys, OptionError)
    phi: Sequence[float]
    if given == "like":
        phi = _like(entry["like"], folder, name)
    else:
        phi = _angles(entry[given], f"[[states]] {name!r}: {given}")
    if len(phi) != degree:
        raise OptionError(
            f"[[states]] {name!r} has {len(phi)} fold angles, there are {degree} creases"
        )
    return Target(name, tuple(phi), entry.get("margin", 1.0))


def _angles(values: Any, key: str) -> list[float]:
    """Read fold angles, which rest angles of wound springs exceed, as numbers or multiples of pi."""
    return list(parse_angles(values, key, degrees=key.endswith("_deg")))


def _like(words: Any, folder: Path, name: str) -> Sequence[float]:
    """Return the fold angles of a state of an earlier run: ``FILE#2`` is the second of its list."""
    who = f"[[states]] {name!r}"
    file, _, number = words.rpartition("#") if isinstance(words, str) else ("", "", "")
    if not file or not re.fullmatch("[1-9][0-9]{0,8}", number):
        must = "must be 'FILE#NUMBER', such as 'states.json#2'"
        raise OptionError(f"{who}: like = {shown(words)} {must}")
    states = MinimaResult.load(folder / file).minima
    if int(number) > len(states):
        many = len(states) or "no"
        raise OptionError(f"{who}: {file!r} has {many} minima, like asks for {number}")
    return states[int(number) - 1].fold_angles


def _gap(entry: Mapping[str, Any], name: str) -> EnergyBounds:
    if "energy_above" not in entry:
        raise OptionError(f"[[states]] {name!r}: energy_difference needs energy_above = 'STATE'")
    value = entry.get("energy_difference", [0.0, math.inf])
    least, most = value if isinstance(value, list) and len(value) == 2 else (value, value)
    return EnergyBounds(name, entry["energy_above"], least, most)


def _barrier(entry: Mapping[str, Any]) -> EnergyBounds:
    """Read what is asked of a barrier."""
    first, second = entry.get("from"), entry.get("to")
    least, most = entry.get("at_least", 0.0), entry.get("at_most", math.inf)
    if "exactly" in entry:
        if {"at_least", "at_most"} & set(entry):
            who = f"barrier from {first!r} to {second!r}"
            raise OptionError(f"{who}: give exactly alone, or at_least and at_most")
        least = most = entry["exactly"]
    return EnergyBounds(first, second, least, most)  # type: ignore[arg-type]
