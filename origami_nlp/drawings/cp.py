"""The ``.cp`` of ORIPA and its kin: a line of text for each line drawn, y downwards.

Code 4 is an auxiliary line (oriedita, CreasePatternReader).
"""

from __future__ import annotations

import math

from origami_nlp.drawings.lines import DrawingOptions, LineList, Lines
from origami_nlp.errors import DrawingError

CP_CODES = {1: "B", 2: "M", 3: "V", 4: "F"}


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
