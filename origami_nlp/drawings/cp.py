"""The ``.cp`` of ORIPA and its kin: a line of text for each line drawn, y downwards.

Code 4 is an auxiliary line (oriedita, CreasePatternReader).
"""

from __future__ import annotations

import math

from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines

CP_CODES: dict[float, str] = {1: "B", 2: "M", 3: "V", 4: "F"}


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
        where = f"in line {number}"
        try:
            code, x0, y0, x1, y1 = map(float, text.split() or ["nan"] * 5)
        except ValueError:
            found.broken.append(where)
            continue
        if not math.isnan(code):
            found.draw(f"code {code:g}", CP_CODES.get(code), ((x0, y0), (x1, y1)), where)
    return found.lines("codes", y_down=True)
