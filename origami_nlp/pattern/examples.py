"""The two vertex families of the paper, with its rest angles and stiffnesses (sections 3.1, 3.2)."""

from __future__ import annotations

import math
import sys
from numbers import Real

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CLOSES
from origami_nlp.pattern.angles import format_angle, parse_angle
from origami_nlp.pattern.scene import Contact, Scene
from origami_nlp.pattern.vertex import Vertex

STIFFNESS = 0.025
"""Geometric mean of mountain and valley stiffness in the paper [N m/rad]."""

DEGREE6_ALPHAS = ("pi/4", "pi/3", "5*pi/12")
"""Sector angles alpha_1 of the columns of the paper's degree-6 figure."""
DEGREE8_ALPHAS = ("pi/12", "pi/6", "pi/4")
"""Sector angles alpha_1 of the columns of the paper's degree-8 figure."""
RATIOS = (0.01, 1.0, 100.0)
"""Stiffness ratios r_k = k_m / k_v of the rows of both figures."""


def degree6(
    alpha: float | str = "pi/4",
    ratio: float = 1.0,
    *,
    symmetry: str = "D1",
    contact: Contact = "full",
) -> Scene:
    """Make the paper's degree-6 vertex: sector angles (a, pi - 2a, a, a, pi - 2a, a), section 3.1.

    Parameters
    ----------
    alpha
        alpha_1 in (0, pi/2) [rad], a number or text such as ``"pi/4"``.
    ratio
        Stiffness ratio r_k = k_m / k_v > 0.
    symmetry, contact
        As for `Scene`.

    Returns
    -------
    Scene
        With stiffnesses of geometric mean 0.025 N m/rad; mountains rest at -pi and valleys at pi/2.

    Raises
    ------
    OptionError
        If `alpha` or `ratio` is out of range.
    AngleError
        If `alpha` is no angle.
    SceneError
        If `symmetry` or `contact` is none of this vertex.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.degree6("pi/3", ratio=100).label
    'degree 6, alpha_1 = pi/3, r_k = 100'
    """
    a, ratio = _between(alpha, math.pi / 2, "pi/2"), _positive(ratio)
    m, v = -math.pi, math.pi / 2
    # alpha <= pi/3 decides the assignment; "pi/3" and nearby roundings of it count as equal
    rest = (m, v, v, m, v, v) if a <= math.pi / 3 + CLOSES else (v, v, m, v, m, v)
    b = math.pi - 2 * a
    title = f"degree 6, alpha_1 = {format_angle(a)}, r_k = {ratio:g}"
    return Scene(
        Vertex((a, b, a, a, b, a)), _springs(rest, ratio), rest, symmetry, contact, name=title
    )


def degree8(
    alpha: float | str = "pi/4",
    ratio: float = 1.0,
    *,
    symmetry: str = "D2",
    contact: Contact = "full",
) -> Scene:
    """Make the paper's degree-8 vertex: sector angles (a, b, b, a, a, b, b, a), b = pi/2 - a, section 3.2.

    Parameters
    ----------
    alpha
        alpha_1 in (0, pi/2) [rad], a number or text such as ``"pi/4"``.
    ratio
        Stiffness ratio r_k = k_m / k_v > 0.
    symmetry, contact
        As for `Scene`.

    Returns
    -------
    Scene
        With stiffnesses of geometric mean 0.025 N m/rad; mountains rest at -pi/2 and valleys at pi/2.

    Raises
    ------
    OptionError
        If `alpha` or `ratio` is out of range.
    AngleError
        If `alpha` is no angle.
    SceneError
        If `symmetry` or `contact` is none of this vertex.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.degree8("pi/6").group.name
    'D2'
    """
    a, ratio = _between(alpha, math.pi / 2, "pi/2"), _positive(ratio)
    b = math.pi / 2 - a
    rest = (-math.pi / 2, math.pi / 2) * 4
    title = f"degree 8, alpha_1 = {format_angle(a)}, r_k = {ratio:g}"
    vertex = Vertex((a, b, b, a, a, b, b, a))
    return Scene(vertex, _springs(rest, ratio), rest, symmetry, contact, name=title)


def panels() -> list[Scene]:
    """Make the 18 panels of the paper's two landscape figures, figure 3 first, row by row.

    Returns
    -------
    list of Scene
        Nine of degree 6, then nine of degree 8.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> [scene.degree for scene in examples.panels()].count(8)
    9
    """
    return [
        make(alpha, ratio)
        for make, alphas in ((degree6, DEGREE6_ALPHAS), (degree8, DEGREE8_ALPHAS))
        for ratio in RATIOS
        for alpha in alphas
    ]


def _between(alpha: float | str, upper: float, upper_text: str) -> float:
    a = parse_angle(alpha, "alpha")
    if not 0 < a < upper:
        raise OptionError(f"alpha = {alpha!r} must lie between 0 and {upper_text} [rad]")
    return a


def _positive(ratio: float) -> float:
    number = isinstance(ratio, Real) and not isinstance(ratio, bool)
    if not number or not 0 < ratio <= sys.float_info.max:
        raise OptionError(f"ratio = {shown(ratio)} must be a positive number")
    return float(ratio)


def _springs(rest: tuple[float, ...], ratio: float) -> tuple[float, ...]:
    """k_m = 0.025 sqrt(r_k) on creases with a mountain rest angle, k_v = 0.025 / sqrt(r_k) else."""
    root = math.sqrt(ratio)
    return tuple(STIFFNESS * root if phi < 0 else STIFFNESS / root for phi in rest)
