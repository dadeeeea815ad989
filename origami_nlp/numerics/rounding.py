"""Numbers with fewer digits, so that rounding decides nothing that follows from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.numerics.tolerances import CHOSEN, ROUNDED, STATIONARY

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def rank(energy: float, fold_angles: Sequence[float]) -> tuple[float, ...]:
    """Return what states are sorted by, energy and then fold angles, without the digits that rounding leaves.

    Parameters
    ----------
    energy
        Over the mean stiffness.
    fold_angles
        In radians.

    Returns
    -------
    tuple of float
        Nine digits of the energy, seven of each angle: those of states that are degenerate are known to some 1e-8.

    Examples
    --------
    >>> from origami_nlp.numerics import rank
    >>> rank(0.3, (1.0, -1e-17)) == rank(0.1 + 0.2, (1.0 + 1e-15, 0.0))
    True
    """
    return (round(energy, 9) + 0.0, *(round(float(a), 7) + 0.0 for a in fold_angles))


def energy_or_zero(energy: ArrayLike, stiffness: ArrayLike) -> Any:
    """Return energies of springs, as 0 where fold angles within `STATIONARY` of rest have more.

    Parameters
    ----------
    energy
        Shape [...].
    stiffness
        Of the springs, shape [n], in the unit of the energy a square radian.

    Returns
    -------
    ndarray
        Shape [...].

    Examples
    --------
    >>> from origami_nlp.numerics import energy_or_zero
    >>> energy_or_zero([1.2e-29, 1e-9], [1.0, 1.0])
    array([0.e+00, 1.e-09])
    """
    noise = 0.5 * np.sum(stiffness) * STATIONARY**2
    return np.where(np.abs(energy) <= noise, 0.0, energy)[()]  # a number stays one


def residual_words(residual: float) -> str:
    """Return a residual as it is printed: below what counts as zero its digits are what rounding leaves.

    Parameters
    ----------
    residual
        Of closure, or of balance relative to the largest torque; nan where there is none.

    Returns
    -------
    str
        One digit, the bound `STATIONARY` where it is no larger, or ``"-"``.

    Examples
    --------
    >>> from origami_nlp.numerics import residual_words
    >>> residual_words(3e-17), residual_words(2.4e-7), residual_words(float("nan"))
    ('<1e-11', '2e-07', '-')
    """
    if math.isnan(residual):
        return "-"
    return f"<{STATIONARY:.0e}" if residual <= STATIONARY else f"{residual:.0e}"


def first_largest(a: np.ndarray) -> np.ndarray:
    """Return where the largest entry of each row stands; of several that are equal but for rounding the first.

    Parameters
    ----------
    a
        Numbers, shape [..., n].

    Returns
    -------
    np.ndarray
        Positions, shape [...].

    Examples
    --------
    >>> import numpy as np
    >>> from origami_nlp.numerics import first_largest
    >>> int(first_largest(np.array([0.0, 0.3, 0.1 + 0.2])))
    1
    """
    most = a.max(axis=-1, keepdims=True)
    near = np.where(np.isfinite(most), CHOSEN * np.abs(most) + ROUNDED, 0.0)
    return np.asarray((a >= most - near).argmax(axis=-1))


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
    >>> bool(b[0] == -b[1]), bool(b[2] == 0), bool(abs(b - a).max() < 1e-5)
    (True, True, True)
    """
    size = np.abs(a).max(axis=-1, keepdims=True, initial=0.0)
    unit = np.ldexp(to, np.frexp(size)[1])
    return np.asarray(np.round(a / unit) * unit)


def last_place(coords: np.ndarray) -> float:
    """Return the last decimal place that numbers state, or single precision does; 0 where they are whole doubles.

    Parameters
    ----------
    coords
        Of any shape.

    Returns
    -------
    float
        Such as 0.001.

    Examples
    --------
    >>> last_place(np.array([0.25, 1.5])), last_place(np.array([1 / 3]))
    (0.01, 0.0)
    """
    for digits in range(13):
        if (np.round(coords, digits) == coords).all():
            return 10.0**-digits
    if (coords.astype(np.float32) == coords).all():
        return 2.0**-23 * float(np.abs(coords).max())
    return 0.0
