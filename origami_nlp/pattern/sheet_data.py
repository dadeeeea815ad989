"""A whole pattern as plain data and back, to the last bit: what results that are read back carry with them.

JSON schema ``origami-nlp/sheet/1``: corners from 0, angles in radians; FOLD files, which state them in degrees and may
need repair, are for exchange (`sheets.sheet_to_fold`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.errors import FoldFileError
from origami_nlp.pattern.sheet import Pattern, make_pattern

SCHEMA = "origami-nlp/sheet/1"


def pattern_to_dict(pattern: Pattern) -> dict[str, Any]:
    """Return a pattern as plain JSON data.

    Parameters
    ----------
    pattern
        The sheet.

    Returns
    -------
    dict
        With its schema under the key ``schema``.

    Examples
    --------
    >>> from origami_nlp.pattern import examples, pattern_from_dict, pattern_to_dict
    >>> sheet = examples.pattern("miura", 2, 2)
    >>> pattern_to_dict(pattern_from_dict(pattern_to_dict(sheet))) == pattern_to_dict(sheet)
    True
    """
    p = pattern
    return {
        "schema": SCHEMA,
        "name": p.name,
        "corners": p.corners.tolist(),
        "polygons": [list(q) for q in p.polygons],
        "joins": sorted(list(side) for side, many in p.other_sides.items() if many > 1),
        "creases": p.ends.tolist(),
        "assignment": p.assignment,
        "numbers": p.numbers.tolist(),
        "reference": p.reference.tolist(),
        "stiffness": p.stiffness.tolist(),
        "rest_angles": p.rest.tolist(),
        "file_angles": [None if np.isnan(a) else a for a in p.file_angles.tolist()],
        "notes": list(p.notes),
        "orders": [list(o) for o in p.orders],
    }


def pattern_from_dict(data: Any) -> Pattern:
    """Rebuild a pattern from `pattern_to_dict`.

    Parameters
    ----------
    data
        What it returned.

    Returns
    -------
    Pattern
        The same.

    Raises
    ------
    FoldFileError
        If it is of another schema, an entry is missing or wrong, or the facets are no sheet.
    """
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise FoldFileError(f"pattern: this reads schema {SCHEMA!r}")
    try:
        sides = [(int(a), int(b)) for a, b in data["creases"]]

        def of(key: str) -> dict[tuple[int, int], float]:
            pairs = zip(sides, data[key], strict=True)
            return {side: float(v) for side, v in pairs if v is not None}

        made = make_pattern(
            np.array(data["corners"], float),
            [tuple(map(int, q)) for q in data["polygons"]],
            assignment=dict(zip(sides, data["assignment"], strict=True)),
            joins=[(int(a), int(b)) for a, b in data["joins"]],
            fold_angles=of("reference"),
            numbers={s: int(k) for s, k in zip(sides, data["numbers"], strict=True)},
            stiffness=of("stiffness"),
            rest=of("rest_angles"),
            file_angles=of("file_angles"),
            name=str(data["name"]),
            notes=tuple(map(str, data["notes"])),
            orders=[(int(f), int(g), int(s)) for f, g, s in data["orders"]],
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise FoldFileError(f"pattern of schema {SCHEMA} is not whole: {error!r}") from None
    if made.ends.tolist() != [list(side) for side in sides]:
        raise FoldFileError(
            f"pattern of schema {SCHEMA}: its creases are not those of its polygons"
        )
    return made
