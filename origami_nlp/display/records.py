"""Records: dataclasses whose fields say how they are shown, from which tables, rows of frames and of CSV are made."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any


@dataclass(frozen=True)
class Shown:
    """How a field of a record is shown.

    Attributes
    ----------
    title
        Head of its column; "" for what only frames and CSV have.
    unit
        Of its values; angles [rad] are read in degrees.
    spec
        Format of numbers, or a function of a number.
    missing
        What stands for None; nan and inf are "-".
    styles
        Of rich, by value.
    between
        Of several values.
    side
        Letter of its column in a `Table`; by default words stand to the left and wrap, numbers to the right.
    """

    title: str = ""
    unit: str = ""
    spec: str | Callable[[float], str] = ""
    missing: str = "-"
    styles: Mapping[Any, str] = field(default_factory=dict)
    between: str = ", "
    side: str = ""

    @property
    def head(self) -> str:
        """Title and unit."""
        unit = "deg" if self.unit == "rad" else self.unit
        return f"{self.title} [{unit}]".replace("\n ", "\n") if unit else self.title

    def text(self, value: Any) -> str:
        """Write a value."""
        if value is None:
            return self.missing
        if isinstance(value, bool):
            return "yes" if value else "no"
        if not isinstance(value, int | float | tuple):
            return str(value)
        if isinstance(value, tuple):
            return self.between.join(map(self.text, value)) or self.missing
        if isinstance(value, float) and not math.isfinite(value):
            return "-"
        if callable(self.spec):
            return self.spec(value)
        return format(math.degrees(value) if self.unit == "rad" else value, self.spec)


def shown(title: str = "", unit: str = "", spec: Any = "", **more: Any) -> dict[str, Any]:
    """Return the metadata of a field of a record that is shown.

    Parameters
    ----------
    title, unit, spec, **more
        As of `Shown`.

    Returns
    -------
    dict
        For `dataclasses.field`.

    Examples
    --------
    >>> from dataclasses import dataclass, field
    >>> from origami_nlp.display import record_row, record_table, shown
    >>> @dataclass(frozen=True)
    ... class Fold:
    ...     crease: int = field(metadata=shown("crease"))
    ...     angle: float = field(metadata=shown("fold angle", "rad", ".1f"))
    >>> print(record_table([Fold(1, 0.5)], "folds").markdown().rstrip())
    | crease | fold angle [deg] |
    |---:|---:|
    | 1 | 28.6 |
    >>> record_row(Fold(1, 0.5))
    {'crease': 1, 'angle_rad': 0.5}
    """
    return {"shown": Shown(title, unit, spec, **more)}


def record_row(record: Any) -> dict[str, object]:
    """Return the shown fields of a record as a row of a frame, names with their units.

    Parameters
    ----------
    record
        Of a dataclass.

    Returns
    -------
    dict
        Such as ``energy_J``; angles in radians.
    """
    row: dict[str, object] = {}
    for f in fields(record):
        if "shown" in f.metadata:
            words = re.sub(r"\W+", "_", f.metadata["shown"].unit.replace("/", " per "))
            row[f"{f.name}_{words}" if words else f.name] = getattr(record, f.name)
    return row
