"""Hinge laws as tables of files: read with a type and its numbers, written as pieces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import OptionError, SceneError
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinge_types import TYPES, of_type, sum_of, table

KINDS: dict[str, dict[str, bool]] = {
    **{
        kind: {number.key or name: number.usual is None for name, number in numbers.items()}
        for kind, (_, numbers) in TYPES.items()
    },
    "table": {"angle_deg": True, "torque": True},
    "pieces": {"breaks": True, "coefficients": True},
}
"""Keys of each type of law in files, and whether they must be there."""
CHANGED = {"scale": 1.0, "shift_deg": 0.0}
"""Keys of every law, and what they are where they are not stated: a factor of its torque, and how far it is moved."""


EXTRAPOLATE = "extrapolate"
"""Key of a measured law: ``"linear"`` where it goes straight on to +-180 degrees."""


def read_law(given: object, name: str, folder: Path | None = None) -> HingeLaw:
    """Read a law from a table of a scene file: ``type`` and its numbers, ``data``, or ``sum = [...]`` of such tables.

    ``scale`` multiplies its torque, ``shift_deg`` moves it towards valley, as `follow` does over ``law_scale[1]`` and
    ``law_shift[1]``.

    Parameters
    ----------
    given
        The table.
    name
        Of the law.
    folder
        Where files of measured data are looked for; the working directory by default.

    Returns
    -------
    HingeLaw
        The law.

    Raises
    ------
    SceneError, SceneFileError
        If the type is unknown, a number is missing or does not fit, or data cannot be read.
    """
    if isinstance(given, HingeLaw):
        return given
    if not isinstance(given, Mapping):
        raise SceneError(
            f"laws.{name} = {shown(given)} must be a table with data, or a type: {', '.join(KINDS)}"
        )
    if EXTRAPOLATE in given:
        if given[EXTRAPOLATE] != "linear":
            raise SceneError(
                f"laws.{name}: extrapolate = {shown(given[EXTRAPOLATE])} must be 'linear': straight on from both ends"
            )
        from origami_nlp.pattern.hinge_fit import straight_on  # of measured laws: seldom needed

        rest = {key: value for key, value in given.items() if key != EXTRAPOLATE}
        return straight_on(read_law(rest, name, folder), -math.pi, math.pi)
    if changed := [key for key in CHANGED if key in given]:
        law = read_law({k: v for k, v in given.items() if k not in CHANGED}, name, folder)
        bounds = {"scale": (0.0, math.inf), "shift_deg": (-180.0, 180.0)}
        scale, shift = (
            check_number(f"laws.{name}.{key}", given[key], *bounds[key]) if key in changed else none
            for key, none in CHANGED.items()
        )
        return law.times(scale).shifted(math.radians(shift))
    if "sum" in given:
        parts = given["sum"]
        if set(given) != {"sum"} or not isinstance(parts, list) or not parts:
            raise SceneError(f"laws.{name}: sum = [...] of tables stands alone")
        return sum_of([read_law(part, name, folder) for part in parts], name)
    if "data" in given:
        return _measured(given, name, folder)
    kind = given.get("type")
    if not isinstance(kind, str) or kind not in KINDS:
        raise SceneError(
            f"laws.{name}: type = {shown(kind)} must be one of {', '.join(KINDS)}; or give data"
        )
    keys = KINDS[kind]
    wrong = sorted(set(given) - set(keys) - {"type"})
    missing = [key for key, needed in keys.items() if needed and key not in given]
    if wrong or missing:
        what = f"unknown {', '.join(wrong)}" if wrong else f"missing {', '.join(missing)}"
        raise SceneError(f"laws.{name} of type {kind!r}: {what}; it has {', '.join(keys)}")
    try:
        return replace(_stated(kind, given), name=name)
    except SceneError:
        raise
    except (TypeError, ValueError, OverflowError) as error:
        why = error if isinstance(error, OptionError) else f"its entries must be numbers ({error})"
        raise SceneError(f"laws.{name} of type {kind!r}: {why}") from None


def _stated(kind: str, given: Mapping[str, Any]) -> HingeLaw:
    """Return the law of a table with the keys of its type."""
    if kind == "pieces":
        return HingeLaw(tuple(given["breaks"]), tuple(map(tuple, given["coefficients"])))
    if kind == "table":
        return table(np.radians(np.array(given["angle_deg"], float)).tolist(), given["torque"])
    numbers: dict[str, Any] = {}
    for name, number in TYPES[kind][1].items():
        if name == "coefficients":
            each = enumerate(given[name], start=1)
            numbers |= {f"{name}[{i}]": value for i, value in each}
        elif (key := number.key or name) in given:
            numbers[name] = number.in_degrees(given[key]) if number.key else given[key]
    return of_type(kind, numbers)


def _measured(given: Mapping[str, Any], name: str, folder: Path | None) -> HingeLaw:
    """Fit the law to a table of measured torques."""
    from origami_nlp.pattern.hinge_data import read_hinge_data
    from origami_nlp.pattern.hinge_fit import fit_data

    if wrong := sorted(set(given) - {"data"}):
        raise SceneError(
            f"laws.{name} of data: unknown {', '.join(map(str, wrong))}; it has data, extrapolate"
        )
    file = given["data"]
    if not isinstance(file, str) or not file or file == "-":
        raise SceneError(f"laws.{name}: data = {shown(file)} must be the name of a file")
    # a scene of somebody else shows no file of ours
    if Path(file).is_absolute() or ".." in Path(file).parts:
        raise SceneError(
            f"laws.{name}: data = {shown(file)} must be a file beside the scene, or in a folder there"
        )
    return fit_data(read_hinge_data((folder or Path()) / file), name).law


def law_to_dict(law: HingeLaw) -> dict[str, Any]:
    """Return a law as plain data: its pieces, which `read_law` reads.

    Parameters
    ----------
    law
        The law.

    Returns
    -------
    dict
        ``type``, ``breaks`` and ``coefficients``.
    """
    return {
        "type": "pieces",
        "breaks": list(law.breaks),
        "coefficients": [list(c) for c in law.coefficients],
    }
