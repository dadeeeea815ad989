"""A scene, one vertex with its springs, as a pattern: its facets are cut out as triangles."""

from __future__ import annotations

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import SceneError
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.sheet import Pattern, make_pattern


def scene_pattern(scene: Scene) -> Pattern:
    """Make a pattern with one interior vertex of a scene.

    Parameters
    ----------
    scene
        A vertex that lies flat, with its springs; symmetry and contact are no part of a pattern.

    Returns
    -------
    Pattern
        Corner 0 is the vertex, corner i the end of crease i, at distance 1; creases in their order.

    Raises
    ------
    SceneError
        If the paper does not lie flat, or forces pull at it.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.pattern import scene_pattern
    >>> scene_pattern(o.examples.waterbomb())
    Pattern('waterbomb': 6 facets, 6 creases, 1 interior vertices)
    """
    check_type("scene", scene, Scene)
    if not scene.vertex.flat:
        raise SceneError(
            "the vertex does not lie flat: write a folded state of it as FOLD, and read that"
        )
    if scene.loads or scene.preload:
        raise SceneError("preload and loads of a scene are not part of a pattern: leave them out")
    n, a = scene.degree, scene.vertex.azimuths
    corners = np.vstack([[0.0, 0.0], np.column_stack([np.cos(a), np.sin(a)])])
    triangles = [(0, i, i % n + 1) for i in range(1, n + 1)]
    sides = [(0, i) for i in range(1, n + 1)]
    return make_pattern(
        corners,
        triangles,
        assignment={
            s: "M" if r < 0 else "V" if r > 0 else "U"
            for s, r in zip(sides, scene.rest_angles, strict=True)
        },
        numbers={s: i for i, s in enumerate(sides)},
        stiffness=dict(zip(sides, scene.stiffness, strict=True)),
        rest=dict(zip(sides, scene.rest_angles, strict=True)),
        name=scene.name or "",
    )
