"""`origami-nlp model`: print what a scene's nonlinear programme models, and what it leaves out."""

from __future__ import annotations

from origami_nlp.cli.minima import SceneFile
from origami_nlp.pattern import read_scene
from origami_nlp.programme import Model


def model(scene: SceneFile) -> None:
    """Print variables, equalities, inequalities, facet pairs in and out of the model of SCENE."""
    from origami_nlp.files import screen

    stated = read_scene(scene)
    screen().print(f"{stated!r}\n{Model(stated)}", highlight=False, soft_wrap=True)
