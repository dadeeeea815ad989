"""Hinge laws as tables of files: read with a type and its numbers, written as pieces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import OptionError, SceneError, SceneFileError
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinge_types import TYPES, of_type, sum_of, table

KINDS: dict[str, dict[str, bool]] = {
    **{
        kind: {number.key or name: number.usual is None for name, number in numbers.items()}
        for kind, (_, numbers) in TYPES.items()
    },
    "table": {"angle_deg": True, "torque": True},
    "pieces": {"breaks": True, "coefficients": True},
    "sum": {"sum": True},
    "data": {"data": True},
}
"""Keys of each type of law in files, and whether they must be there."""
CHANGED = ("scale", "shift_deg", "extrapolate")
"""Keys of every law: a factor of its torque, how far it is moved, and ``"linear"`` to go straight on to +-180 deg."""


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
        raise SceneError(f"laws.{name} = {shown(given)} must be a table: data, sum, or type = ...")
    own = {key: value for key, value in given.items() if key not in CHANGED}
    scale, shift, on = (given.get(key) for key in CHANGED)
    law = _stated(own, name, folder)
    if scale is not None:
        law = law.times(check_number(f"laws.{name}.scale", scale, 0.0))
    if shift is not None:
        by = check_number(f"laws.{name}.shift_deg", shift, -180.0, 180.0)
        law = law.shifted(math.radians(by))
    if on is None:
        return law
    if on != "linear":
        raise SceneError(f"laws.{name}: extrapolate = {shown(on)} must be 'linear'")
    from origami_nlp.pattern.hinge_fit import straight_on  # of measured laws: seldom needed

    return straight_on(law, -math.pi, math.pi)


def _stated(given: dict[Any, Any], name: str, folder: Path | None) -> HingeLaw:
    """Return the law of a table as it stands there: of data, a sum, or a type."""
    kind = next((key for key in ("sum", "data") if key in given), given.get("type"))
    if not isinstance(kind, str) or kind not in KINDS:
        raise SceneError(f"laws.{name}: type = {shown(kind)} must be one of {', '.join(KINDS)}")
    keys = KINDS[kind]
    wrong = sorted(map(str, given.keys() - keys.keys() - {"type"}))
    missing = [key for key, needed in keys.items() if needed and key not in given]
    if wrong or missing:
        what = f"unknown {', '.join(wrong)}" if wrong else f"missing {', '.join(missing)}"
        raise SceneError(f"laws.{name} of type {kind!r}: {what}; it has {', '.join(keys)}")
    try:
        return replace(_of_kind(kind, given, name, folder), name=name)
    except (TypeError, ValueError, OverflowError) as error:
        if isinstance(error, SceneError | SceneFileError):
            raise
        why = error if isinstance(error, OptionError) else f"its entries must be numbers ({error})"
        raise SceneError(f"laws.{name} of type {kind!r}: {why}") from None


def _of_kind(kind: str, given: Mapping[str, Any], name: str, folder: Path | None) -> HingeLaw:
    if kind == "data":
        return _measured(given["data"], name, folder)
    if kind == "sum":
        return sum_of([read_law(part, name, folder) for part in given["sum"]])
    if kind == "pieces":
        return HingeLaw(tuple(given["breaks"]), tuple(map(tuple, given["coefficients"])))
    if kind == "table":
        return table(np.radians(np.array(given["angle_deg"], float)).tolist(), given["torque"])
    known = {n.key or number: (number, n) for number, n in TYPES[kind][1].items()}
    stated = [(*known[key], value) for key, value in given.items() if key in known]
    return of_type(kind, **{k: n.in_degrees(v) if n.key else v for k, n, v in stated})


def _measured(file: object, name: str, folder: Path | None) -> HingeLaw:
    """Fit the law to a table of measured torques."""
    from origami_nlp.pattern.hinge_data import read_hinge_data
    from origami_nlp.pattern.hinge_fit import fit_data

    if not isinstance(file, str) or not file or file == "-":
        raise SceneError(f"laws.{name}: data = {shown(file)} must be the name of a file")
    if Path(file).is_absolute() or ".." in Path(file).parts:
        raise SceneError(f"laws.{name}: data = {shown(file)} must be a file beside the scene")
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
