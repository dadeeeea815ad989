"""A scene that keeps the symmetry of another one."""

from __future__ import annotations

import contextlib
from dataclasses import replace

from origami_nlp.errors import SymmetryError
from origami_nlp.pattern.scene import Scene


def with_symmetry_of(scene: Scene, other: Scene) -> Scene:
    """Return a scene that keeps the symmetry of another, the same rotations and mirrors, and no larger one.

    Parameters
    ----------
    scene
        Which may have a larger symmetry.
    other
        Of the same degree.

    Returns
    -------
    Scene
        With the group of the other.

    Raises
    ------
    SymmetryError
        If it does not have them.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import with_symmetry_of
    >>> vertex = o.Vertex(("pi/2",) * 4)
    >>> equal, one = (o.Scene(vertex, (1, 1, 1, 1), (t, 0.2, 0.2, 0.2)) for t in (0.2, 0.3))
    >>> equal.group.name, one.group.name, with_symmetry_of(equal, one).group.name
    ('D4', 'D1', 'D1')
    """
    wanted, name = set(other.group.elements), other.group.name
    if set(scene.group.elements) == wanted:
        return scene
    mirrors = [None, *range(1, scene.degree + 1)] if name.startswith("D") else [None]
    for mirror in mirrors:
        with contextlib.suppress(SymmetryError):
            made = replace(scene, symmetry=name, mirror=mirror, winding=None)
            if set(made.group.elements) == wanted:
                return made
    why = f"is kept by the other scenes, and not so by this one, of group {scene.group.name}"
    raise SymmetryError(f'symmetry = {name!r} {why}: state symmetry = "none"')
