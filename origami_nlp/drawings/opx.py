"""The ``.opx`` of ORIPA: Java beans as XML, y downwards.  Java writes no property that is 0.

Code 4 is an unassigned crease (ORIPA, OriLine).
"""

from __future__ import annotations

import math

from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines
from origami_nlp.drawings.svg import parse_xml

OPX_CODES = {0: "F", 1: "B", 2: "M", 3: "V", 4: "U", 9: "C"}


def read_opx(raw: bytes, name: str, options: DrawingOptions) -> Lines:
    """Read an ``.opx`` file of ORIPA, as data: no bean is made.

    Parameters
    ----------
    raw
        The file.
    name
        How messages call it.
    options
        What else is known of it.

    Returns
    -------
    Lines
        Of the file; those without finite coordinates are left out and noted.

    Raises
    ------
    DrawingError
        If it is no XML, or there is no line in it.
    """
    root = parse_xml(raw, name)
    found, title = LineList(name, options), ""
    for number, bean in enumerate(root.iter("object")):
        own = {void.get("property"): (void.findtext("*") or "") for void in bean.findall("void")}
        kind = bean.get("class", "").rpartition(".")[2]
        if kind == "DataSet":
            title = own.get("title", "")
        if kind != "OriLineProxy":
            continue
        where = f"line {number}"
        try:
            code = int(own.get("type", "0"))
            x0, y0, x1, y1 = (float(own.get(key, "0")) for key in ("x0", "y0", "x1", "y1"))
        except ValueError:  # Java writes such numbers otherwise, or not at all
            found.broken.append(where)
            continue
        letter = found.letter(f"type {code}", lambda _, code=code: OPX_CODES.get(code))  # type: ignore[misc]
        if letter is not None:
            found.add([(x0, y0), (x1, y1)], letter, math.nan, where)
    return found.lines("types", y_down=True, title=title)
