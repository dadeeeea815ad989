"""Flaps of a cone: assignments of valleys and mountains, read and written.

A cone is a uniform vertex of even degree N; its n = N/2 flaps (two facets that share an even
crease) are valleys (+1, V: partial fold angle rho_v >= 0) or mountains (-1, M).  Paper sections 4
and 5.  A *branch* is an assignment and a sign of the elevation: 2^(n+1) branches leave the flat
state.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError
from origami_nlp.paper.cone.rules import check_degree

Flaps = tuple[int, ...]
"""One entry a flap, +1 valley or -1 mountain."""
MEANING = "write +1 (valley) or -1 (mountain), one a flap"


def parse_flaps(text: str | Sequence[int]) -> Flaps:
    """Read an assignment of the flaps.

    Parameters
    ----------
    text
        Letters V and M such as "VVM" (runs may be written V2M), or +1 (valley) and -1 (mountain), one a flap.

    Returns
    -------
    tuple of int
        +1 or -1, one a flap.

    Raises
    ------
    OptionError
        If it is not an assignment.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.parse_flaps("V2M")
    (1, 1, -1)
    """
    if not isinstance(text, str):
        flaps = _signs(text)
    elif re.fullmatch(r"([VM]([1-9][0-9]{0,3})?)+", text.strip().upper()):
        runs = re.findall(r"([VM])(\d*)", text.upper())
        flaps = [1 if letter == "V" else -1 for letter, n in runs for _ in range(int(n or 1))]
    else:
        raise OptionError(
            f'flaps = {shown(text)}: write V and M, one a flap, such as "VVM", or runs, "V2M"'
        )
    check_degree(2 * len(flaps))
    return tuple(flaps)


def _signs(flaps: Any) -> list[int]:
    values = flaps.tolist() if isinstance(flaps, np.ndarray) else flaps
    if (
        not isinstance(values, Sequence)
        or isinstance(values, str)
        or not all(isinstance(f, Real) and f in (1, -1) for f in values)
    ):
        raise OptionError(f"flaps = {shown(flaps)}: {MEANING}")
    return [int(f) for f in values]


def write_flaps(flaps: Sequence[int]) -> str:
    """Write an assignment as letters V and M.

    Parameters
    ----------
    flaps
        +1 (valley) or -1 (mountain), one a flap.

    Returns
    -------
    str
        A letter a flap.

    Raises
    ------
    OptionError
        Unless `flaps` are +1 and -1.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.write_flaps((1, 1, -1))
    'VVM'
    """
    return "".join("V" if f > 0 else "M" for f in _signs(flaps))


def class_of(flaps: Sequence[int]) -> tuple[int, int]:
    """Count (valley flaps, changes around the ring) of an assignment: its class.

    Parameters
    ----------
    flaps
        +1 (valley) or -1 (mountain), one a flap.

    Returns
    -------
    tuple of int
        Both numbers.

    Raises
    ------
    OptionError
        Unless `flaps` are +1 and -1.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.class_of((1, -1, 1, -1))
    (2, 4)
    """
    signs = _signs(flaps)
    changes = sum(signs[i - 1] != signs[i] for i in range(len(signs)))
    return signs.count(1), changes


def symmetry_of(flaps: Sequence[int]) -> str:
    """Name the symmetry of the folded cone at any elevation but 0: "D3", "C2", "C1" ...

    Rotations about the axis that keep the assignment make C_m; with a reflection in a plane through
    the axis (through even or odd creases) it is D_m.  Nothing else can keep a folded cone: what turns
    it over reverses the elevation, and odd creases are never alike even ones.
    """
    word = tuple(flaps)
    turns = sum(word[k:] + word[:k] == word for k in range(len(word)))
    back = word[::-1]
    mirrored = any(back[k:] + back[:k] == word for k in range(len(word)))
    return f"{'D' if mirrored else 'C'}{turns}"
