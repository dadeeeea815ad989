"""Vertices of crease patterns that people know, as scenes: exact sector angles, springs by mountain and valley."""

from __future__ import annotations

import math

from origami_nlp.arguments import check_number
from origami_nlp.errors import OptionError
from origami_nlp.pattern.fold_limits import Contact
from origami_nlp.pattern.numbers_read import format_angle, parse_angle
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.vertex import Vertex

STIFFNESS = 0.025
"""Geometric mean of mountain and valley stiffness in the paper [N m/rad]."""


def acute(alpha: float | str) -> float:
    """Return `alpha` [rad] as a number in (0, pi/2)."""
    a = parse_angle(alpha, "alpha")
    if not 0 < a < math.pi / 2:
        raise OptionError(f"alpha = {alpha!r} must lie between 0 and pi/2 [rad]")
    return a


def positive(ratio: float) -> float:
    """Return a stiffness ratio as a positive number."""
    return check_number("ratio", ratio, math.ulp(0.0))


def springs(rest: tuple[float, ...], ratio: float) -> tuple[float, ...]:
    """k_m = 0.025 sqrt(r_k) on creases with a mountain rest angle, k_v = 0.025 / sqrt(r_k) else."""
    root = math.sqrt(ratio)
    return tuple(STIFFNESS * root if phi < 0 else STIFFNESS / root for phi in rest)


Angle = float | str
"""An angle [rad]: a number, or text such as ``"pi/4"``."""


def miura(
    alpha: Angle = "pi/3", ratio: float = 1.0, *, symmetry: str = "auto", contact: Contact = "full"
) -> Scene:
    """Make a vertex of the Miura fold: sector angles (a, pi - a, pi - a, a), degree 4.

    Creases 1 and 3 are one straight line, 2 and 4 a zigzag; crease 1, on the acute side, is the mountain.  As the two
    halves of the straight line pull unequally, the vertex is stable folded as in the sheet, and in half along the line.

    Parameters
    ----------
    alpha
        Acute angle of the parallelograms, in (0, pi/2) [rad].
    ratio
        Stiffness ratio k_m / k_v > 0; the geometric mean is 0.025 N m/rad.
    symmetry, contact
        As for `Scene`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError
        If `alpha` or `ratio` is out of range.
    AngleError
        If an angle is not a number.
    SceneError, SymmetryError
        If `symmetry` or `contact` is none of this vertex.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.miura("pi/4").vertex
    Vertex(degree 4, sector_angles=[pi/4, 3*pi/4, 3*pi/4, pi/4])
    """
    a = acute(alpha)
    b = math.pi - a
    title = f"Miura, alpha = {format_angle(a)}"
    return _scene(title, (a, b, b, a), "MVVV", ratio, -math.pi / 4, math.pi / 2, symmetry, contact)


def waterbomb(ratio: float = 1.0, *, symmetry: str = "auto", contact: Contact = "full") -> Scene:
    """Make the middle of a cell of the waterbomb tessellation: (pi/4, pi/2, pi/4, pi/4, pi/2, pi/4), degree 6.

    Creases 1 and 4 are one straight mountain, the others are diagonals and valleys.  It is stable folded up, and folded
    along the straight line alone, diagonals flat.

    Parameters
    ----------
    ratio, symmetry, contact
        As for `miura`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `miura`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.waterbomb().group.name
    'D2'
    """
    a, b = math.pi / 4, math.pi / 2
    sectors = (a, b, a, a, b, a)
    return _scene(
        "waterbomb", sectors, "MVVMVV", ratio, -math.pi / 2, math.pi / 2, symmetry, contact
    )


def waterbomb_base(
    ratio: float = 1.0, *, symmetry: str = "auto", contact: Contact = "full"
) -> Scene:
    """Make the middle of the waterbomb base: eight sectors of pi/4, mountains and valleys in turn, degree 8.

    It pops: a cone that stands on its mountains, or, inside out, on its valleys; unequal rest angles make one of the
    two lower.

    Parameters
    ----------
    ratio, symmetry, contact
        As for `miura`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `miura`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.waterbomb_base().group.name
    'D4'
    """
    sectors = (math.pi / 4,) * 8
    title = "waterbomb base"
    return _scene(title, sectors, "MV" * 4, ratio, -math.pi / 3, math.pi / 2, symmetry, contact)


def bird_base(ratio: float = 1.0, *, symmetry: str = "auto", contact: Contact = "full") -> Scene:
    """Make a petal corner of the bird base: (pi/4, 5 pi/8, 3 pi/4, 3 pi/8), degree 4, no two sectors equal.

    Crease 1 is the fold line of the petal, the only valley; mountains fold it half way only.  It is stable near
    the base, and nearly flat on the other branch of its motion, where the long creases 2 and 4 hardly fold.

    Parameters
    ----------
    ratio, symmetry, contact
        As for `miura`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `miura`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.bird_base().degree
    4
    """
    e = math.pi / 8
    sectors = (2 * e, 5 * e, 6 * e, 3 * e)
    return _scene("bird base", sectors, "VMMM", ratio, -math.pi / 2, math.pi, symmetry, contact)


def square_twist(
    alpha: Angle = "pi/4", ratio: float = 1.0, *, symmetry: str = "auto", contact: Contact = "full"
) -> Scene:
    """Make a corner of the square twist: sector angles (pi/2, pi - a, pi/2, a), degree 4.

    Creases 1 and 2 are sides of the square, 3 and 4 pleats.  Valleys that pull harder than the mountain give a second
    stable state on the other branch of the vertex.

    Parameters
    ----------
    alpha
        Angle between a pleat and the side of the square, in (0, pi/2) [rad].
    ratio, symmetry, contact
        As for `miura`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `miura`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.square_twist("pi/3").degree
    4
    """
    a = acute(alpha)
    title = f"square twist, alpha = {format_angle(a)}"
    sectors = (math.pi / 2, math.pi - a, math.pi / 2, a)
    return _scene(title, sectors, "VVVM", ratio, -math.pi / 4, 0.75 * math.pi, symmetry, contact)


def yoshimura(
    alpha: Angle = "pi/6", ratio: float = 1.0, *, symmetry: str = "auto", contact: Contact = "full"
) -> Scene:
    """Make a vertex of the Yoshimura pattern: sector angles (a, pi - 2a, a, a, pi - 2a, a), degree 6.

    Creases 1 and 4 are one straight valley, the others mountains.  It is stable as a part of the buckled tube, and
    fully folded flat along the straight line, where facets touch.

    Parameters
    ----------
    alpha
        Base angle of the triangles, in (0, pi/2) [rad].
    ratio, symmetry, contact
        As for `miura`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `miura`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.yoshimura("pi/6").group.name
    'D2'
    """
    a = acute(alpha)
    b = math.pi - 2 * a
    title = f"Yoshimura, alpha = {format_angle(a)}"
    return _scene(
        title, (a, b, a, a, b, a), "VMMVMM", ratio, -math.pi / 2, math.pi, symmetry, contact
    )


def resch(ratio: float = 0.1, *, symmetry: str = "auto", contact: Contact = "full") -> Scene:
    """Make a vertex of Resch's triangles: (pi/2, pi/2, pi/3, pi/6, pi/6, pi/3), degree 6, which does not fold flat.

    Crease 5 is the valley in which a tuck closes; creases 1, 3, 4 and 6 are sides of triangles.  In the finished sheet
    triangles lie in a plane, tucks hang from them, and the fold angles are (-90, -60, -90, -90, 180, -90) degrees: a
    state that facets which touch hold up.

    Parameters
    ----------
    ratio, symmetry, contact
        As for `miura`.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `miura`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.resch().group.name
    'D1'
    """
    e = math.pi / 6
    sectors = (3 * e, 3 * e, 2 * e, e, e, 2 * e)
    return _scene("Resch", sectors, "MMMMVM", ratio, -math.pi / 2, math.pi, symmetry, contact)


def _scene(
    title: str,
    sectors: tuple[float, ...],
    letters: str,
    ratio: float,
    mountain: float,
    valley: float,
    symmetry: str,
    contact: Contact,
) -> Scene:
    """Make a scene of a vertex whose creases are mountains and valleys."""
    r = positive(ratio)
    rest = tuple(mountain if letter == "M" else valley for letter in letters)
    name = title + (f", r_k = {r:g}" if r != 1 else "")
    return Scene(Vertex(sectors), springs(rest, r), rest, symmetry, contact, name=name)
