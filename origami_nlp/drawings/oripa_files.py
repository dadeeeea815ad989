"""Files of ORIPA and its kin: ``.cp``, a line of text for each line drawn, and ``.opx``, Java beans as XML.

Both have y downwards.  Code 4 is an auxiliary line in ``.cp`` (oriedita, CreasePatternReader) and an unassigned crease
in ``.opx`` (ORIPA, OriLine).  Java writes no property that is 0.
"""

from __future__ import annotations

import math

from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines
from origami_nlp.drawings.xml_tree import parse_xml
from origami_nlp.errors import DrawingError

CP_CODES = {1: "B", 2: "M", 3: "V", 4: "F"}
OPX_CODES = {0: "F", 1: "B", 2: "M", 3: "V", 4: "U", 9: "C"}
_ENDS = ("x0", "y0", "x1", "y1")


def read_cp(raw: bytes, name: str, options: DrawingOptions) -> Lines:
    """Read the text of a ``.cp`` file: ``code x1 y1 x2 y2`` a line.

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
        Of the file; those that are none of this form are left out and noted.

    Raises
    ------
    DrawingError
        If there is no line in it.

    Examples
    --------
    >>> read_cp(b"1 0 0 4 0\\n2 0 0 2.5 1e0", "it", DrawingOptions()).letters
    ('B', 'M')
    """
    found = LineList(name, options)
    for number, text in enumerate(raw.decode("utf-8", "replace").splitlines(), start=1):
        words = text.split()
        if not words:
            continue
        try:
            code = int(words[0])
            x0, y0, x1, y1 = map(float, words[1:])
        except ValueError:
            found.broken.append(f"in line {number}")
            continue
        letter = found.letter(f"code {code}", lambda _, code=code: CP_CODES.get(code))  # type: ignore[misc]
        if letter is not None:
            found.add([(x0, y0), (x1, y1)], letter, math.nan, f"in line {number}")
    if found.broken and not (found.ends or found.unknown):
        raise DrawingError(
            f'{name} is no .cp file: its lines are not "code x1 y1 x2 y2", first {found.broken[0]}'
        )
    return found.lines("codes", y_down=True)


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
            x0, y0, x1, y1 = (float(own.get(key, "0")) for key in _ENDS)
        except ValueError:  # Java writes such numbers otherwise, or not at all
            found.broken.append(where)
            continue
        letter = found.letter(f"type {code}", lambda _, code=code: OPX_CODES.get(code))  # type: ignore[misc]
        if letter is not None:
            found.add([(x0, y0), (x1, y1)], letter, math.nan, where)
    return found.lines("types", y_down=True, title=title)
