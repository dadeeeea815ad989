"""Examples by name: the two vertex families of the paper (sections 3.1, 3.2), and patterns that people know."""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Sequence
from typing import Any

from origami_nlp.arguments import check_whole, shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import example_patterns
from origami_nlp.pattern.example_vertices import (
    Angle,
    acute,
    bird_base as bird_base,
    miura as miura,
    positive,
    resch as resch,
    springs,
    square_twist as square_twist,
    waterbomb as waterbomb,
    waterbomb_base as waterbomb_base,
    yoshimura as yoshimura,
)
from origami_nlp.pattern.fold_file import parse_fold
from origami_nlp.pattern.fold_limits import Contact
from origami_nlp.pattern.lattice_stated import ROLLED_KEY, check_rolled
from origami_nlp.pattern.numbers_read import format_angle
from origami_nlp.pattern.pattern_file import frame_pattern
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.sheet import Pattern
from origami_nlp.pattern.vertex import Vertex

DEGREE6_ALPHAS = ("pi/4", "pi/3", "5*pi/12")
"""Sector angles alpha_1 of the columns of the paper's degree-6 figure."""
DEGREE8_ALPHAS = ("pi/12", "pi/6", "pi/4")
"""Sector angles alpha_1 of the columns of the paper's degree-8 figure."""
RATIOS = (0.01, 1.0, 100.0)
"""Stiffness ratios r_k = k_m / k_v of the rows of both figures."""


def degree6(
    alpha: Angle = "pi/4", ratio: float = 1.0, *, symmetry: str = "D1", contact: Contact = "full"
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
    a, ratio = acute(alpha), positive(ratio)
    m, v = -math.pi, math.pi / 2
    rest = (m, v, v, m, v, v) if a <= math.pi / 3 + CLOSURE_TOL else (v, v, m, v, m, v)
    b = math.pi - 2 * a
    title = f"degree 6, alpha_1 = {format_angle(a)}, r_k = {ratio:g}"
    vertex = Vertex((a, b, a, a, b, a))
    return Scene(vertex, springs(rest, ratio), rest, symmetry, contact, name=title)


def degree8(
    alpha: Angle = "pi/4", ratio: float = 1.0, *, symmetry: str = "D2", contact: Contact = "full"
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
    a, ratio = acute(alpha), positive(ratio)
    b = math.pi / 2 - a
    rest = (-math.pi / 2, math.pi / 2) * 4
    title = f"degree 8, alpha_1 = {format_angle(a)}, r_k = {ratio:g}"
    vertex = Vertex((a, b, b, a, a, b, b, a))
    return Scene(vertex, springs(rest, ratio), rest, symmetry, contact, name=title)


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
    families = (degree6, DEGREE6_ALPHAS), (degree8, DEGREE8_ALPHAS)
    return [make(a, ratio) for make, alphas in families for ratio in RATIOS for a in alphas]


MAKERS = (miura, waterbomb, waterbomb_base, bird_base, square_twist, yoshimura, resch)
BY_NAME: dict[str, Callable[..., Scene]] = {
    make.__name__.replace("_", ""): make for make in (*MAKERS, degree6, degree8)
}
"""What makes each example, by the name that the command has for it."""
SIZES = {
    "miura": (4, 4),
    "waterbomb": (2, 3),
    "yoshimura": (6, 3),
    "resch": (2, 2),
    "metasheet": (3, 3),
}
"""Rows and columns of cells of patterns that have them, as they are drawn without others."""
WITH_SPRINGS = {"metasheet": example_patterns.metasheet}
"""Patterns that come with their springs, which are more than mountains and valleys."""
MOST_CELLS = 100
"""Rows or columns of a pattern."""


def names() -> tuple[str, ...]:
    """List all examples.

    Returns
    -------
    tuple
        Of `BY_NAME` and of `WITH_SPRINGS`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.names()[:2]
    ('miura', 'waterbomb')
    """
    return (*BY_NAME, *WITH_SPRINGS)


def is_example(name: str) -> bool:
    """Return whether a name, with or without a size, is that of an example.

    Parameters
    ----------
    name
        Such as ``"miura:4x6"``.

    Returns
    -------
    bool
        True where there is one.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.is_example("miura:4x6"), examples.is_example("miura.fold")
    (True, False)
    """
    word = name.partition(":")[0]
    return word in BY_NAME or word in WITH_SPRINGS


def maker(name: str) -> Callable[..., Any]:
    """Return what makes an example of one vertex.

    Parameters
    ----------
    name
        One of `BY_NAME`.

    Returns
    -------
    Callable
        With the options of the example as its parameters.

    Raises
    ------
    OptionError
        If there is no such example.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.maker("miura") is examples.miura
    True
    """
    if name not in BY_NAME:
        raise OptionError(f"name = {shown(name)} is no example: use one of {', '.join(names())}")
    return BY_NAME[name]


def by_name(name: str, **options: Any) -> Scene:
    """Make an example by its name.

    Parameters
    ----------
    name
        One of `BY_NAME`.
    options
        Of its function.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError
        If there is no such example, or it has no such option, or a value is out of range.
    AngleError, SceneError, SymmetryError
        If a value does not fit.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.by_name("birdbase") == examples.bird_base()
    True
    """
    if name in WITH_SPRINGS:
        raise OptionError(f"name = {shown(name)} is a sheet, no vertex: -o FILE.fold writes it")
    make = maker(name)
    known = inspect.signature(make).parameters
    for option in options.keys() - known.keys():
        raise OptionError(f"{name} has no option {option}: it has {', '.join(known)}")
    made: Scene = make(**options)
    return made


def split_size(name: str) -> tuple[str, tuple[int, int] | tuple[None, None]]:
    """Split the name of an example from the size of its crease pattern.

    Parameters
    ----------
    name
        Such as ``"miura"`` or ``"miura:4x6"``.

    Returns
    -------
    name : str
        Without the size.
    size : tuple
        Rows and columns of cells; None, None where no size is given.

    Raises
    ------
    OptionError
        If the size is not valid.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.split_size("miura:4x6")
    ('miura', (4, 6))
    """
    word, colon, size = name.partition(":")
    shape = re.fullmatch(r"(\d{1,6})x(\d{1,6})", size)
    if colon and not shape:
        raise OptionError(f"NAME = {name!r}: write the size as ROWSxCOLUMNS, such as miura:4x6")
    return (word, (int(shape[1]), int(shape[2]))) if shape else (word, (None, None))


def pattern(
    name: str,
    rows: int | None = None,
    columns: int | None = None,
    *,
    cell: bool = False,
    rolled: int | Sequence[int] | None = None,
    **options: Any,
) -> Pattern:
    """Make the crease pattern of an example as a sheet of rigid facets, all its vertices coupled.

    Parameters
    ----------
    name, rows, columns, cell, rolled, options
        As for `crease_pattern`.

    Returns
    -------
    Pattern
        With the springs of its scene on every mountain and valley.

    Raises
    ------
    OptionError, AngleError, SceneError, SymmetryError
        As `crease_pattern`.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.pattern("metasheet", 4, 4)
    Pattern('metasheet': 16 facets, 24 creases, 9 interior vertices)
    """
    typed = name if ":" in name else ""
    drawn = crease_pattern(name, rows, columns, cell=cell, rolled=rolled, **options)
    (frame,) = parse_fold(drawn, source=typed)
    return frame_pattern(frame)


def crease_pattern(
    name: str,
    rows: int | None = None,
    columns: int | None = None,
    *,
    cell: bool = False,
    rolled: int | Sequence[int] | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Draw the crease pattern of an example, with the springs of its scene on every mountain and valley.

    Parameters
    ----------
    name
        One of `names`, also with its size, such as ``"miura:4x6"``; of the paper's families, and of
        the waterbomb base, the vertex alone.
    rows, columns
        Cells of a pattern in `SIZES`, 1 to 100.
    cell
        A cell that repeats, of so many rows and columns of what repeats in the pattern; of one if no size is given.
    rolled
        How many copies of a cell lead once round a tube: along the first lattice vector, or two numbers along either;
        0: copies may curl; None: they stay in a plane.
    options
        Of its function, as for `by_name`.

    Returns
    -------
    dict
        FOLD 1.1, for `json.dump`; vertices of a sheet are coupled, which a scene of one vertex does not know.

    Raises
    ------
    OptionError
        As `by_name`, and if a size is out of range, or the pattern has no cells.
    AngleError, SceneError, SymmetryError
        If a value does not fit.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> examples.crease_pattern("miura", 2, 3)["edges_assignment"].count("B")
    10
    """
    if ":" in name:
        if (rows, columns) != (None, None):
            raise OptionError(f"name = {shown(name)} has a size: leave out rows and columns")
        name, (rows, columns) = split_size(name)
    if cell and name not in example_patterns.UNITS:
        raise OptionError(f"{name} does not repeat: {', '.join(example_patterns.UNITS)} do")
    round_ = check_rolled(rolled, "rolled")
    if round_ is not None and not cell:
        raise OptionError("rolled is for cells that repeat: give cell as well")
    sprung = WITH_SPRINGS.get(name)
    for option in options if sprung else ():
        raise OptionError(f"{name} has no option {option}: it has rows and columns")
    made: Any = sprung or by_name(name, **options)
    if name not in SIZES and (rows, columns) != (None, None):
        raise OptionError(f"{name} has no rows and columns: those of {', '.join(SIZES)} do")
    many, more = (1, 1) if cell else SIZES.get(name, (1, 1))
    size = [
        check_whole("rows", many if rows is None else rows, 1, MOST_CELLS),
        check_whole("columns", more if columns is None else columns, 1, MOST_CELLS),
    ]
    data = example_patterns.sheet_to_fold(name, made, *size, cell=cell)
    return data if round_ is None else data | {ROLLED_KEY: list(round_)}
