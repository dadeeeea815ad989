"""Numbers with fewer digits, so that rounding decides nothing that follows from them."""

from __future__ import annotations

import numpy as np

from origami_nlp.numerics.tolerances import CHOSEN


def coarse(a: np.ndarray, to: float = CHOSEN) -> np.ndarray:
    """Round the rows of an array to a grid relative to the largest entry of each.

    Processors and kernels of linear algebra sum in orders of their own, and answers differ by some 1e-16.  What an
    iteration goes on from, and what is compared, has these differences wiped out: on a grid of `to` they survive with
    probability 1e-16 / to only.

    Parameters
    ----------
    a
        Numbers, shape [..., n].
    to
        Width of the grid, over a power of two at or above the largest entry of a row; a power of two.

    Returns
    -------
    np.ndarray
        Rounded numbers, exact multiples of the width, shape [..., n].

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.numerics import coarse
    >>> a = np.array([0.1 + 0.2, -0.3, 1e-17])
    >>> b = coarse(a)
    >>> bool(b[0] == -b[1]), bool(b[2] == 0), bool(abs(b - a).max() < 1e-6)
    (True, True, True)
    """
    size = np.abs(a).max(axis=-1, keepdims=True, initial=0.0)
    unit = np.ldexp(to, np.frexp(size)[1])
    return np.asarray(np.round(a / unit) * unit)
