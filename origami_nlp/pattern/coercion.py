"""What is folded, however it is stated: itself, the name of an example, or a file."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.numerics import PLACES
from origami_nlp.pattern import examples
from origami_nlp.pattern.fold_file import frame_of
from origami_nlp.pattern.pattern_file import frame_pattern, read_pattern
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.scene_file import read_scene
from origami_nlp.pattern.sheet import Pattern
from origami_nlp.pattern.vertex import Vertex

Stated = Scene | Pattern | Mapping[str, Any] | str | PathLike[str]
"""How an origami may be stated: itself, FOLD data as a dict, the name of an example, or a file."""


def as_origami(stated: Stated) -> Scene | Pattern:
    """Return what is folded, one vertex as a scene or a whole pattern, however it is stated.

    Parameters
    ----------
    stated
        A scene, or a scene file (``.toml``); or what `as_pattern` takes.

    Returns
    -------
    Scene or Pattern
        The one or the other.

    Raises
    ------
    OptionError, FoldFileError, SceneFileError
        As `as_pattern` and `read_scene`.

    Examples
    --------
    >>> from origami_nlp.pattern import as_origami, examples
    >>> as_origami("metasheet:2x3")
    Pattern('metasheet': 6 facets, 7 creases, 2 interior vertices)
    >>> as_origami(examples.waterbomb()).degree
    6
    """
    if isinstance(stated, Scene):
        return stated
    if isinstance(stated, str | PathLike) and Path(fspath(stated)).suffix.lower() == ".toml":
        return read_scene(fspath(stated))
    return as_pattern(stated, "origami")


def as_scene(stated: Stated, asked: str = "this", instead: str = "") -> Scene:
    """Return the one vertex that a question is asked of, however it is stated.

    Parameters
    ----------
    stated
        As `as_origami` takes it.  A pattern is taken as the scene that it equals, without symmetry and with full
        contact: where it has one interior vertex with all its creases, and no paper beyond the sectors between them.
    asked, instead
        What is asked of one vertex alone, and what takes a pattern: for what is said of others.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError
        If it is a pattern that equals no scene; and as `as_origami`.

    Examples
    --------
    >>> from origami_nlp.pattern import as_scene
    >>> as_scene("waterbombbase").degree
    8
    """
    if not isinstance(stated, Pattern | str | PathLike):
        check_type("scene", stated, Scene)
    origami = as_origami(stated)
    scene = origami if isinstance(origami, Scene) else _equal_scene(origami)
    if scene is None:
        more = f"; {instead}" if instead else ""
        raise OptionError(
            f"scene = {origami!r}: {asked} is for one vertex: read_fold_scene(file, vertex=K) takes one of a file{more}"
        )
    return scene


def _equal_scene(pattern: Pattern) -> Scene | None:
    """Return the scene that a pattern equals; None where there is none."""
    n = pattern.creases
    if len(pattern.vertices) != 1 or pattern.holes or pattern.cell:
        return None
    loop = pattern.vertices[0]
    first = loop.creases.index(0) if 0 in loop.creases else 0
    if loop.creases[first:] + loop.creases[:first] != tuple(range(n)):
        return None
    ends, x = pattern.ends, pattern.corners
    along = x[ends.sum(axis=1) - loop.vertex] - x[loop.vertex]

    def angle(a: np.ndarray, b: np.ndarray) -> float:
        return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))

    sectors = []
    for i in range(n):
        j = (i + 1) % n
        (facet,) = {pattern.left[i], pattern.right[i]} & {pattern.left[j], pattern.right[j]}
        sectors.append(angle(along[i], along[j]))
        pieces = (p for p, f in zip(pattern.polygons, pattern.facet_of, strict=True) if f == facet)
        for corner in {c for piece in pieces for c in piece} - {loop.vertex}:
            way = x[corner] - x[loop.vertex]
            if angle(along[i], way) + angle(way, along[j]) - sectors[i] > PLACES:
                return None
    springs = tuple(pattern.stiffness.tolist()), tuple(pattern.rest.tolist())
    vertex = Vertex(tuple(sectors))
    limits, laws = pattern.limits, pattern.laws
    return Scene(vertex, *springs, "none", "full", name=pattern.name, limits=limits, laws=laws)


def as_pattern(
    stated: Pattern | Mapping[str, Any] | str | PathLike[str], name: str = "pattern"
) -> Pattern:
    """Return a pattern, however it is stated.

    Parameters
    ----------
    stated
        The pattern itself, the name of an example with its size, such as ``"miura:4x6"``, a FOLD file, or what one
        holds as a dict.
    name
        Of the argument, for what is said of a wrong one.

    Returns
    -------
    Pattern
        The sheet with its springs.

    Raises
    ------
    OptionError
        If it is neither of these, or the example has no such size.
    FoldFileError
        If the file is no FOLD file, or its frame is no sheet of rigid facets.

    Examples
    --------
    >>> from origami_nlp.pattern import as_pattern
    >>> as_pattern("metasheet:2x3")
    Pattern('metasheet': 6 facets, 7 creases, 2 interior vertices)
    """
    if isinstance(stated, str) and examples.is_example(stated):
        return examples.pattern(stated)
    if isinstance(stated, str | PathLike):
        return read_pattern(Path(stated))
    if isinstance(stated, Mapping):
        return frame_pattern(frame_of(stated))
    check_type(name, stated, Pattern)
    return stated
