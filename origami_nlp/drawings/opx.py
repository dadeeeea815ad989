"""The ``.opx`` of ORIPA: Java beans as XML, y downwards.  Java writes no property that is 0.

Code 4 is an unassigned crease (ORIPA, OriLine).
"""

from __future__ import annotations

from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines
from origami_nlp.drawings.svg import parse_xml

OPX_CODES: dict[float, str] = {0: "F", 1: "B", 2: "M", 3: "V", 4: "U", 9: "C"}


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
        kind, where = bean.get("class", "").rpartition(".")[2], f"line {number}"
        if kind == "DataSet":
            title = own.get("title", "")
        if kind != "OriLineProxy":
            continue
        try:
            code, *ends = (float(own.get(key, "0")) for key in "type x0 y0 x1 y1".split())
        except ValueError:  # Java writes such numbers otherwise, or not at all
            found.broken.append(where)
            continue
        found.draw(f"type {code:g}", OPX_CODES.get(code), (ends[:2], ends[2:]), where)
    return found.lines("types", y_down=True, title=title)
