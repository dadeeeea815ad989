"""Measured torques over fold angles: read from a table of text, checked, and divided into loading and unloading."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from itertools import pairwise
from os import PathLike
from pathlib import Path

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import SceneFileError
from origami_nlp.io import ShortRepr, as_text, is_number, read_limited
from origami_nlp.numerics import INPUT_TOL
from origami_nlp.pattern.hinge_types import FEWEST_ROWS

LARGEST = 10_000_000
"""Bytes of a file."""
MOST_ROWS = 50_000
UNITS = {
    "angle_deg": math.pi / 180,
    "angle_rad": 1.0,
    "torque_nm": 1.0,
    "torque_nmm": 1e-3,
    "weight": 1.0,
}
"""Columns that there may be, with their unit in radians and N m."""
TURNED = 0.05
"""Of the range of angles: by how much the angle must come back for loading to have become unloading."""


@dataclass(frozen=True, eq=False, repr=False)
class HingeData(ShortRepr):
    """Torques of a hinge, as measured.

    Parameters
    ----------
    angle
        Fold angles in the order of the measurement, valley positive, [n] [rad].
    torque
        dU/dphi there: what holds the hinge at the angle, positive towards valley, [n] [N m].
    weight
        Of each row, [n]; () for equal ones.
    name
        Of the file.

    Attributes
    ----------
    sweep
        1 where the angle grows, -1 where it falls, [n].

    Raises
    ------
    SceneFileError
        If there are fewer than six angles, or one is not finite or beyond +-180 degrees, or a weight is not positive.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> angle = np.radians(np.linspace(-90, 90, 13))
    >>> o.HingeData(angle, 0.01 * (angle - 0.2)).name
    'data'
    """

    angle: np.ndarray
    torque: np.ndarray
    weight: np.ndarray = ()  # type: ignore[assignment]
    name: str = "data"

    def __post_init__(self) -> None:
        try:
            x, y, w = (np.array(v, float) for v in (self.angle, self.torque, self.weight))
        except (TypeError, ValueError):
            raise self._wrong("angles, torques and weights must be numbers") from None
        w = w if w.size else np.ones(x.shape)
        if x.ndim != 1 or x.shape != y.shape or x.shape != w.shape:
            raise self._wrong("give as many torques, and weights, as angles")
        if len(x) > MOST_ROWS:
            raise self._wrong(f"{len(x):,} rows: at most {MOST_ROWS:,}; average some")
        for what, good in {
            "angle": np.abs(x) <= math.pi * (1 + INPUT_TOL),
            "torque": np.isfinite(y),
            "weight": (w > 0) & np.isfinite(w),
        }.items():
            if not good.all():
                where = f"the {what} of measurement {int(np.argmin(good)) + 1}"
                raise self._wrong(f"{where} must be finite, angles to +-180 degrees, weights > 0")
        if len(np.unique(x)) < FEWEST_ROWS:
            raise self._wrong(f"a law needs {FEWEST_ROWS} different angles at least")
        if not np.ptp(y) > 0:
            raise self._wrong("the torque is the same everywhere: that is a preload")
        for key, values in (("angle", x), ("torque", y), ("weight", w)):
            values.setflags(write=False)
            object.__setattr__(self, key, values)

    def _wrong(self, why: str) -> SceneFileError:
        return SceneFileError(f"hinge data {self.name!r}: {why}")

    @property
    def sweep(self) -> np.ndarray:
        """1 where the angle grows, -1 where it falls, [n]."""
        x, enough = self.angle, TURNED * np.ptp(self.angle)
        way = np.zeros(len(x))
        turns, direction, best = [0], 0, 0
        for i, angle in enumerate(x):
            ahead = angle - x[best]
            if direction == 0:
                if abs(ahead) > enough:
                    direction, best = int(math.copysign(1, ahead)), i
            elif ahead * direction >= 0:
                best = i
            elif abs(ahead) > enough:  # it has come back: the farthest was where it turned
                turns.append(best)
                direction, best = -direction, i
        turns.append(len(x) - 1)
        for a, b in pairwise(turns):
            way[a : b + 1] = math.copysign(1, x[b] - x[a])
        return way


def read_hinge_data(source: str | PathLike[str]) -> HingeData:
    """Read measured torques from a table of text: columns angle_deg, torque_Nm and, if wanted, weight.

    Columns are separated by commas, semicolons, tabs or spaces; ``#`` begins a remark.  Without a line of names there
    are angles [deg] and torques [N m] alone.  Names may be angle_deg or angle_rad, torque_Nm or torque_Nmm, and
    weight, also written ``Angle [deg]``.  Decimal commas are read where semicolons or tabs separate the columns.

    Parameters
    ----------
    source
        The file, or ``"-"`` for standard input.

    Returns
    -------
    HingeData
        The rows, in their order.

    Raises
    ------
    SceneFileError
        If the file cannot be read; with the line and its value if a row is no row of numbers; if angles in degrees
        look like radians.
    """
    name = "standard input" if str(source) == "-" else Path(source).name
    text = as_text(
        read_limited(source, LARGEST, "hinge data", SceneFileError),
        f"hinge data {name!r}",
        SceneFileError,
    )
    columns, rows = ["angle_deg", "torque_nm"], list[tuple[int, list[str]]]()
    first = True
    for number, line in enumerate(text.splitlines(), start=1):
        cells = _cells(line.partition("#")[0])
        if not cells:
            continue
        if first and not is_number(cells[0].replace(",", ".")):
            columns, first = [_column(cell) for cell in cells], False
            _check_columns(columns, cells, name)
            continue
        first = False
        if len(cells) != len(columns):
            commas = (
                "; weights need a line of names, decimal commas semicolons or tabs between columns"
            )
            raise SceneFileError(
                f"hinge data {name!r}, line {number}: {len(cells)} columns, where {len(columns)} are expected: "
                f"{', '.join(columns)}{commas * (len(columns) < len(cells) <= 2 * len(columns))}"
            )
        rows.append((number, cells))
    values = np.array([_numbers(row, name) for row in _with_points(rows)]).reshape(-1, len(columns))
    stated = dict(zip(columns, values.T, strict=True))
    if "angle_deg" in stated and 0 < np.abs(stated["angle_deg"]).max(initial=0.0) <= math.tau:
        raise SceneFileError(
            f"hinge data {name!r}: angles end at {np.abs(stated['angle_deg']).max():.4g} degrees: radians? name the "
            "column angle_rad; a range as narrow as this in degrees is stated in radians too"
        )
    read = {key.partition("_")[0]: UNITS[key] * column for key, column in stated.items()}
    return HingeData(read["angle"], read["torque"], read.get("weight", np.zeros(0)), name)


def _column(cell: str) -> str:
    """Return the name of a column, however it is written: ``Angle [deg]`` and ``torque (N mm)``, too."""
    known = {key.replace("_", ""): key for key in UNITS}
    return known.get(re.sub(r"[\W_]", "", cell.lower()), cell.lower())


def _with_points(rows: list[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """Return rows with decimal points for decimal commas, where these cannot part thousands."""
    some = [cell for _, cells in rows for cell in cells if "," in cell]
    if not some or any("." in cell for _, cells in rows for cell in cells):
        return rows
    if all(re.fullmatch(r"[+-]?[1-9]\d{0,2}(,\d{3})+", cell) for cell in some):
        return rows
    return [(number, [cell.replace(",", ".") for cell in cells]) for number, cells in rows]


def _numbers(row: tuple[int, list[str]], name: str) -> list[float]:
    number, cells = row
    for cell in cells:
        if not is_number(cell):
            raise SceneFileError(
                f"hinge data {name!r}, line {number}: {shown(cell)} is not a number (no unit, no separator of "
                "thousands, points or commas throughout)"
            )
    return [float(cell) for cell in cells]


def _check_columns(columns: list[str], cells: list[str], name: str) -> None:
    kinds = [key.partition("_")[0] for key in columns]
    if (
        not set(columns) <= set(UNITS)
        or len(set(kinds)) < len(kinds)
        or not {"angle", "torque"} <= set(kinds)
    ):
        raise SceneFileError(
            f"hinge data {name!r}: columns {', '.join(cells)}: name them angle_deg (or angle_rad), torque_Nm (or "
            "torque_Nmm) and, if wanted, weight"
        )


def _cells(line: str) -> list[str]:
    for separator in ";", "\t", ",":
        if separator in line:
            return [cell.strip().strip('"') for cell in line.split(separator)]
    return line.split()
