"""Numbers of a pattern by name: what a sweep sets, and what states are followed over.

``creases.stiffness[3]`` is that of one crease (from 1), ``mountains.stiffness``, ``valleys.stiffness`` and
``creases.stiffness`` those of all of a kind; the same for ``rest_angles``, where ``creases.rest_angles`` is the size
for mountains and valleys and the others are angles.  ``law_scale`` multiplies a hinge law, ``law_shift`` moves it by an
angle, both from what is stated.  ``vertices.x[5]`` and ``vertices.y[5]`` are coordinates of a
vertex of flat paper, numbered from 0 as in the file.  ``creases.`` before an entry and ``vertices.`` may be left out.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern.hinges_stated import LAW_PLACES, check_law_place, law_at
from origami_nlp.pattern.sheet import Pattern

PLACE = re.compile(
    r"(?:(?:(?P<which>creases|mountains|valleys)\.)?(?P<what>stiffness|rest_angles|law_scale|law_shift)(?:\[(?P<crease>\d{1,5})\])?"
    r"|(?:vertices\.)?(?P<axis>[xy])\[(?P<vertex>\d{1,6})\])"
)
"""What such a name looks like."""


def is_place(name: str) -> bool:
    """Return whether a name is that of numbers of a pattern.

    Parameters
    ----------
    name
        Such as ``creases.stiffness[3]``, ``mountains.rest_angles`` or ``x[5]``.

    Returns
    -------
    bool
        Whether it is one, see the module; ``stiffness`` alone is none.
    """
    match = PLACE.fullmatch(name)
    return match is not None and bool(match["which"] or match["crease"] or match["axis"])


def with_places(pattern: Pattern, values: Mapping[str, float]) -> Pattern:
    """Return a pattern with other numbers.

    Parameters
    ----------
    pattern
        The pattern.
    values
        By name, see the module, set one after the other.

    Returns
    -------
    Pattern
        With these.

    Raises
    ------
    OptionError
        If the pattern has no such place.
    SceneError
        If a value does not fit.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import with_places
    >>> sheet = with_places(o.examples.pattern("miura:2x2"), {"mountains.stiffness": 0.5})
    >>> sorted(set(sheet.stiffness.tolist()))
    [0.025, 0.5]
    """
    k, rest, corners = pattern.stiffness.copy(), pattern.rest.copy(), pattern.corners
    laws, of_laws = list(pattern.laws), dict[tuple[int, str], float]()
    for name, value in values.items():
        match = PLACE.fullmatch(name) if is_place(name) else None
        if match is None:
            how = "creases.stiffness, mountains.rest_angles, creases.stiffness[3] or vertices.x[0]"
            raise OptionError(f"{name!r} is no place of a pattern: write {how}")
        if match["axis"]:
            corners = _moved(pattern, corners, match, value)
            continue
        which, what = _creases(pattern, match), match["what"]
        for i in which.tolist():
            check_law_place(pattern.laws, what, i)
        if what in LAW_PLACES:
            of_laws |= {(i, what): value for i in which.tolist()}
        elif what == "stiffness":
            k[which] = value
        else:
            sized = match["which"] == "creases" and match["crease"] is None
            rest[which] = value * pattern.signs[which] if sized else value
    for (i, what), value in of_laws.items():
        laws[i] = law_at(laws[i], what, value)
    sprung = pattern.with_springs(k.tolist(), rest.tolist())
    sprung = sprung.with_laws(laws) if laws else sprung
    return sprung if corners is pattern.corners else replace(sprung, corners=corners)


def _creases(pattern: Pattern, match: re.Match[str]) -> np.ndarray:
    """Return the creases that a place names (0-based)."""
    if match["crease"] is not None:
        number = int(match["crease"])
        if match["which"] not in (None, "creases") or not 1 <= number <= pattern.creases:
            raise OptionError(f"{match[0]!r}: write {match['what']}[1] to [{pattern.creases}]")
        return np.array([number - 1])
    sign = {"mountains": -1.0, "valleys": 1.0}.get(match["which"])
    every = np.arange(pattern.creases)
    which = every if sign is None else np.flatnonzero(pattern.signs == sign)
    if not len(which):
        raise OptionError(f"{match[0]!r}: the pattern has no {match['which']}")
    return which


def _moved(pattern: Pattern, corners: np.ndarray, match: re.Match[str], value: float) -> np.ndarray:
    """Return corners with a coordinate of one of them changed."""
    number = int(match["vertex"])
    if not pattern.is_flat or np.ptp(corners[:, 2]):
        raise OptionError(f"{match[0]!r}: vertices are moved in the plane z = 0 of flat paper")
    if number >= len(corners):
        raise OptionError(f"{match[0]!r}: vertices are numbered from 0 to {len(corners) - 1}")
    out = corners.copy()
    out[number, "xy".index(match["axis"])] = value
    return out
