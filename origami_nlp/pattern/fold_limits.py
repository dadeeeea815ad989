"""Fold limits that are stated: stops before facets meet, and those that follow from the thickness of panels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Real
from typing import Any, Literal

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import SceneError
from origami_nlp.numerics import CONTACT_TOL, EPS, RESOLVED
from origami_nlp.pattern.numbers_read import parse_angles, read_list

Contact = Literal["full", "fold-limits", "none"]
Limits = tuple[tuple[float, float], ...]
LIMIT_KEYS = ("limits", "limits_deg", "thickness_mm", "taper_mm")
"""Keys of tables of files that state fold limits, or panels that have them."""


def read_limits(given: object, degree: int, *, degrees: bool = False) -> Limits:
    """Read fold limits [rad], one pair for all creases or one for each; () where all are +-pi."""
    key, unit = ("limits_deg", "deg") if degrees else ("limits", "rad")
    wrong = f"{key} = {shown(given)} must be one pair [low, high], or a list of them, one for each crease"
    items = read_list(given, wrong)
    rows: list[Any] = [r if isinstance(r, str | Real) else read_list(r, wrong, 2) for r in items]
    if len(rows) == 2 and not any(isinstance(row, list) for row in rows):
        rows = [rows] * degree
    if len(rows) not in (0, degree) or not all(isinstance(row, list) for row in rows):
        raise SceneError(wrong)
    out = []
    for i, row in enumerate(rows, start=1):
        low, high = parse_angles(row, f"{key}[{i}]", degrees=degrees)
        beyond = max(abs(low), abs(high)) > math.pi * (1 + 4 * EPS)
        low, high = max(low, -math.pi), min(high, math.pi)
        if beyond or high - low < RESOLVED:
            raise SceneError(
                f"{key}[{i}] = {shown(row)} {unit} must be the lower and then the upper limit, within +-180 degrees, "
                "valley positive, with room between"
            )
        out.append((_at_flat(low), _at_flat(high)))
    return () if all(pair == (-math.pi, math.pi) for pair in out) else tuple(out)


def stated_limits(table: Mapping[str, Any], degree: int) -> dict[str, Any]:
    """Read the keys of a table that state stops: ``limits`` and ``panels`` of a `Scene`."""
    given = [key for key in LIMIT_KEYS if key in table]
    if {*LIMIT_KEYS[:2]} <= {*given} or len({*given} & {*LIMIT_KEYS[2:]}) == 1:
        which = "limits or limits_deg, and thickness_mm with taper_mm"
        raise SceneError(f"[creases] has {', '.join(given)}: give {which}")
    out: dict[str, Any] = {}
    for key in given:
        if key in LIMIT_KEYS[:2]:
            out["limits"] = read_limits(table[key], degree, degrees=key.endswith("_deg"))
        else:
            out["panels"] = read_panels([table[each] for each in LIMIT_KEYS[2:]])
    return out


def _at_flat(angle: float) -> float:
    """Return 0 or +-pi for what is as near as contacts are closed."""
    near = math.pi * round(angle / math.pi)
    return near if abs(angle - near) <= CONTACT_TOL else angle


def limit_angles(limits: Limits, degree: int) -> np.ndarray:
    """Return low and high fold limits.

    Parameters
    ----------
    limits
        Of `read_limits`.
    degree
        Number of creases N.

    Returns
    -------
    numpy.ndarray
        Shape [2, N] [rad]; +-pi where none are stated.
    """
    if not limits:
        return np.tile([[-math.pi], [math.pi]], degree)
    return np.array(limits, dtype=float).T


def tapered_limit(thickness: float, width: float) -> float:
    """Return the largest fold angle of panels that keep their hinge in the middle surface and are tapered beside it.

    A panel of the given thickness lies half above and half below the surface that folds.  Beside the hinge it is cut
    by a slope that reaches the outer face at a distance `width`: the slope stands at delta/2 to the surface with
    tan(delta/2) = (thickness/2)/width.  Two panels touch where both slopes meet in the plane that halves the angle pi -
    |phi| between them: |phi| = pi - delta.

    Parameters
    ----------
    thickness
        Of a panel, > 0, in any unit.
    width
        Of the slope, from the hinge, >= 0, in the same unit.

    Returns
    -------
    float
        Fold angle [rad], 0 to pi.

    Notes
    -----
    T. Tachi, "Rigid-foldable thick origami", Origami 5 (2011): panels trimmed by the planes that halve the dihedral
    angle of the wanted fold.  Kinematics stay those of paper without thickness, since all hinges lie in one surface.

    Examples
    --------
    >>> import math
    >>> from origami_nlp.pattern.fold_limits import tapered_limit
    >>> round(math.degrees(tapered_limit(6.0, 10.0)), 1)
    146.6
    """
    return math.pi - 2 * math.atan2(thickness / 2, width)


def read_panels(given: object) -> tuple[float, float] | None:
    """Read thickness and taper of panels [mm]; None where there is none.

    Raises
    ------
    SceneError
        If they are not a positive thickness and a taper of 0 or more.
    """
    if given is None:
        return None
    wrong = f"panels = {shown(given)} must be thickness and taper [mm], both given"
    thick, taper = read_list(given, wrong, 2)
    thickness = check_number("panels, thickness [mm]", thick, math.ulp(0.0), error=SceneError)
    return thickness, check_number("panels, taper [mm]", taper, 0.0, error=SceneError)


def thick_limits(limits: Limits, degree: int, panels: tuple[float, float] | None) -> Limits:
    """Narrow fold limits to those of tapered panels (`tapered_limit`).

    Parameters
    ----------
    limits
        Of `read_limits` [rad]; () for 180 degrees.
    degree
        Number of creases.
    panels
        Thickness and taper [mm], of `read_panels`; None: paper.

    Returns
    -------
    tuple
        Of `read_limits`: the narrower ones of both.
    """
    if panels is None:
        return limits
    most = tapered_limit(*panels)
    low, high = limit_angles(limits, degree)
    return read_limits(np.clip([low, high], -most, most).T.tolist(), degree)


def limit_words(limits: Limits) -> str:
    """Name stops in degrees, for reports.

    Parameters
    ----------
    limits
        Of `read_limits`.

    Returns
    -------
    str
        Of all creases alike, or crease by crease.
    """
    shown_pairs = [f"{math.degrees(low):.4g} to {math.degrees(high):.4g}" for low, high in limits]
    if len(set(shown_pairs)) == 1:
        return f"{shown_pairs[0]} degrees at each crease"
    named = [f"crease {i}: {pair}" for i, pair in enumerate(shown_pairs, start=1)]
    return ", ".join(named) + " degrees"
