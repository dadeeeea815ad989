"""Numbers that a scene states for its creases: read, or an error about the field by its name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from origami_nlp.arguments import check_number, shown
from origami_nlp.errors import SceneError
from origami_nlp.numerics import EPS, INPUT_TOL
from origami_nlp.pattern.angles import parse_angles

LARGEST_RATIO = 1e8
"""Largest ratio of two stiffnesses.  At 1e12 the torque of a soft spring is below the rounding of a stiff one's: along
a line of states that only soft springs order, every point seems to balance, and a search never ends."""
MOST_WOUND = 1e3
"""Largest |wound angle| [rad]: the energy of such a spring is 1e6 times that of one radian, and loses 6 digits."""
SMALLEST, LARGEST = 1e-300, 1e300
"""Bounds of a stiffness, in any unit: energies beyond them overflow, or lose digits."""


def check_range(stiffness: Sequence[float]) -> None:
    """Raise an error for stiffnesses that cannot be computed with, or not together."""
    for i, k in enumerate(stiffness, start=1):
        if not SMALLEST <= k <= LARGEST:
            raise SceneError(
                f"stiffness[{i}] = {k:.6g} is not within {SMALLEST:g} to {LARGEST:g} N m/rad"
            )
    soft, stiff = min(stiffness), max(stiffness)
    i, j = stiffness.index(soft) + 1, stiffness.index(stiff) + 1
    if stiff > LARGEST_RATIO * soft * (1 + INPUT_TOL):
        raise SceneError(
            f"stiffness[{j}] = {stiff:.6g} is more than {LARGEST_RATIO:g} times stiffness[{i}] = {soft:.6g}: "
            f"soft springs would be lost in rounding; bring the ratio to {LARGEST_RATIO:g} or less, or merge "
            "the facets at the stiff crease"
        )


def read_rest_angles(values: object, degree: int) -> tuple[float, ...]:
    """Read rest angles [rad]; degrees and texts as `parse_angles`."""
    rest = check_length(parse_angles(values, "rest_angles"), "rest_angles", degree)
    for i, a in enumerate(rest, start=1):
        if abs(a) > math.pi * (1 + 4 * EPS):
            raise SceneError(
                f"rest_angles[{i}] = {a:.6g} rad is outside [-pi, pi]: fold angles are radians, valley positive "
                "(degrees: rest_angles_deg); a torque beyond is stated as preload"
            )
    return rest


def read_preload(
    values: object, stiffness: Sequence[float], rest: Sequence[float]
) -> tuple[float, ...]:
    """Read the preload [N m] of each crease; () where there is none."""
    if isinstance(values, tuple) and not values:
        return ()
    preload = read_numbers(values, "preload", len(stiffness))
    for i, (m, k, a) in enumerate(zip(preload, stiffness, rest, strict=True), start=1):
        if abs(a + m / k) > MOST_WOUND:
            raise SceneError(
                f"preload[{i}] = {m:.6g} N m winds a spring of {k:.6g} N m/rad to {a + m / k:.6g} rad: at most "
                f"{MOST_WOUND:g} rad, beyond which energies lose digits"
            )
    return preload if any(preload) else ()


def check_length(values: tuple[float, ...], name: str, degree: int) -> tuple[float, ...]:
    """Return values, of which there must be one for each crease."""
    if len(values) != degree:
        raise SceneError(
            f"{name} has {len(values)} entries, but the vertex has {degree} creases: give one each"
        )
    return values


def read_numbers(values: object, name: str, degree: int) -> tuple[float, ...]:
    """Read `degree` floats, or raise an error about field `name`."""
    items = read_list(
        values, f"{name} = {shown(values)} must be a list of numbers, one for each crease"
    )
    numbers = (check_number(f"{name}[{i}]", v, error=SceneError) for i, v in enumerate(items, 1))
    return check_length(tuple(numbers), name, degree)


def read_list(values: object, wrong: str, count: int | None = None) -> list[Any]:
    """Return the entries of a list, so many if a number is given, or raise an error."""
    try:
        items = None if isinstance(values, str | bytes) else list(values)  # type: ignore[call-overload]
    except TypeError:
        items = None
    if items is None or len(items) != (len(items) if count is None else count):
        raise SceneError(wrong)
    return items
