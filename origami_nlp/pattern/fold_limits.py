"""Fold limits that are stated: stops before facets meet, and those that follow from the thickness of panels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import SceneError
from origami_nlp.numerics import CONTACT_TOL, EPS, RESOLVED
from origami_nlp.pattern.numbers_read import parse_angles, read_list

Limits = tuple[tuple[float, float], ...]
LIMIT_KEYS = ("limits", "limits_deg", "thickness_mm", "taper_mm")
"""Keys of tables of files that state fold limits, or panels that have them."""


def read_limits(given: object, degree: int, *, degrees: bool = False) -> Limits:
    """Read fold limits: one pair for all creases, or a pair for each; () where all are +-pi.

    Parameters
    ----------
    given
        ``[low, high]``, or a list of these [N]; numbers or text, in radians (`degrees`: degrees).
    degree
        Number of creases N.
    degrees
        Whether numbers are degrees.

    Returns
    -------
    tuple
        (low, high) of each crease [rad], -pi <= low < high <= pi.

    Raises
    ------
    SceneError
        If they do not fit; the message names the crease and the fix.
    AngleError
        If an entry is no angle.

    Examples
    --------
    >>> from origami_nlp.pattern.fold_limits import read_limits
    >>> read_limits([-90, 90], 2, degrees=True) == read_limits([["-pi/2", "pi/2"]] * 2, 2)
    True
    """
    key, unit = ("limits_deg", "deg") if degrees else ("limits", "rad")
    wrong = f"{key} = {shown(given)} must be one pair [low, high], or a list of them, one for each crease"
    items = read_list(given, wrong)
    rows: list[Any] = [
        r if isinstance(r, str | int | float) else read_list(r, wrong) for r in items
    ]
    if not rows:
        return ()
    if not any(isinstance(row, list) for row in rows):
        rows = [rows] * degree
    if len(rows) != degree or any(not isinstance(row, list) or len(row) != 2 for row in rows):
        raise SceneError(wrong)
    out = []
    for i, row in enumerate(rows, start=1):
        low, high = parse_angles(row, f"{key}[{i}]", degrees=degrees)
        named = f"{key}[{i}] = [{', '.join(f'{a:.6g}' if isinstance(a, float | int) else str(a) for a in row)}]"
        if max(abs(low), abs(high)) > math.pi * (1 + 4 * EPS):
            raise SceneError(f"{named} {unit} is outside +-180 degrees: valley is positive")
        low, high = max(low, -math.pi), min(high, math.pi)
        if high - low < RESOLVED:
            raise SceneError(
                f"{named} {unit} leaves the crease no room: the lower limit comes first, and is smaller; facets at a "
                "crease that does not fold are one facet: merge them"
            )
        out.append((_at_flat(low), _at_flat(high)))
    return () if all(pair == (-math.pi, math.pi) for pair in out) else tuple(out)


def stated_limits(table: Mapping[str, Any], degree: int) -> dict[str, Any]:
    """Read `LIMIT_KEYS` of a table: what a scene takes as `limits` and `panels`; nothing where none is given.

    Parameters
    ----------
    table
        Of a file.
    degree
        Number of creases N.

    Returns
    -------
    dict
        Limits (`read_limits`), and thickness and taper (`read_panels`).

    Raises
    ------
    SceneError, AngleError
        If they do not fit, or one is given twice.
    """
    out: dict[str, Any] = {}
    given = [key for key in LIMIT_KEYS[:2] if key in table]
    if len(given) == 2:
        raise SceneError("limits and limits_deg are the same: give one of them")
    for key in given:
        out["limits"] = read_limits(table[key], degree, degrees=key.endswith("_deg"))
    thick = [key for key in LIMIT_KEYS[2:] if key in table]
    if len(thick) == 1:
        raise SceneError(
            f"{thick[0]} = {shown(table[thick[0]])} stands alone: panels have a thickness_mm, and a taper_mm beside "
            "their hinges, from which their stops follow; give both"
        )
    if thick:
        out["panels"] = read_panels([table[key] for key in thick])
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
