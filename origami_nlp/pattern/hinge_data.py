"""Measured torques over fold angles: read from a table of text, checked, and divided into loading and unloading."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from os import PathLike
from pathlib import Path

import numpy as np

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
    weight.  Numbers have decimal points.

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
    what = f"hinge data {name!r}"
    raw = read_limited(source, LARGEST, "hinge data", SceneFileError)
    columns, rows = ["angle_deg", "torque_nm"], list[list[float]]()
    first = True
    for number, line in enumerate(as_text(raw, what, SceneFileError).splitlines(), start=1):
        if not (line := line.partition("#")[0].strip()):
            continue
        cells = line.split(next((mark for mark in ";\t," if mark in line), None))
        if first and not is_number(cells[0]):
            columns = [cell.strip(' "').lower() for cell in cells]
            _check_columns(columns, what)
        else:
            wrong = next((cell for cell in cells if not is_number(cell)), None)
            if wrong is not None or len(cells) != len(columns):
                row = f"{wrong!r} is no number" if wrong else f"{len(cells)} columns"
                raise SceneFileError(f"{what}, line {number}: {row}; it has {', '.join(columns)}")
            rows.append([float(cell) for cell in cells])
        first = False
    stated = dict(zip(columns, np.array(rows).reshape(-1, len(columns)).T, strict=True))
    if "angle_deg" in stated and 0 < np.abs(stated["angle_deg"]).max(initial=0.0) <= math.tau:
        most = np.abs(stated["angle_deg"]).max()
        raise SceneFileError(
            f"{what}: angles end at {most:.4g} degrees: radians? name it angle_rad"
        )
    read = {key.partition("_")[0]: UNITS[key] * column for key, column in stated.items()}
    return HingeData(read["angle"], read["torque"], read.get("weight", np.zeros(0)), name)


def _check_columns(columns: list[str], what: str) -> None:
    kinds = [key.partition("_")[0] for key in columns]
    known = {*columns} <= {*UNITS} and len({*kinds}) == len(kinds)
    if not known or not {"angle", "torque"} <= {*kinds}:
        names = "angle_deg or angle_rad, torque_Nm or torque_Nmm, and weight if wanted"
        raise SceneFileError(f"{what}: columns {', '.join(columns)}: name them {names}")
