"""The lattice that a FOLD file states for a cell that repeats, and how it is rolled up."""

from __future__ import annotations

from origami_nlp.arguments import shown
from origami_nlp.errors import FoldFileError

LATTICE_KEY = "origaminlp:lattice"
"""Both vectors by which a cell repeats, in the unit of the coordinates."""
ROLLED_KEY = "origaminlp:rolled"
"""Copies of a cell once round a tube, along either lattice vector; 0, 0: copies may curl."""
LEAST_ROUND, MOST_ROUND = 3, 100


def check_rolled(value: object, name: str = ROLLED_KEY) -> tuple[int, int] | None:
    """Return how many copies of a cell along either lattice vector lead once round a tube.

    Parameters
    ----------
    value
        One number, along the first vector, or two; 0: no tube, copies may curl; None: they stay in a plane.
    name
        What is said to be wrong.

    Returns
    -------
    tuple or None
        Copies along either vector, the first number that is not 0 positive.

    Raises
    ------
    FoldFileError
        If it is neither.

    Examples
    --------
    >>> from origami_nlp.pattern.lattice_stated import check_rolled
    >>> check_rolled(6), check_rolled([0, 5]), check_rolled(None)
    ((6, 0), (0, 5), None)
    """
    if value is None:
        return None
    given: list[object] = [*value] if isinstance(value, list | tuple) else [value, 0]
    pair = [n for n in given if isinstance(n, int) and not isinstance(n, bool)]
    good = len(pair) == len(given) == 2
    if not good or (any(pair) and not LEAST_ROUND <= max(map(abs, pair)) <= MOST_ROUND):
        span = f"{LEAST_ROUND} to {MOST_ROUND} copies once round a tube, such as 6 or [0, 6]; 0: they may curl"
        raise FoldFileError(f"{name} = {shown(value)} must be {span}")
    p, q = pair
    return (-p, -q) if p < 0 or (p == 0 and q < 0) else (p, q)
