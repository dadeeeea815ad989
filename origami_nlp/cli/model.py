"""`origami-nlp model`: print what a scene's nonlinear programme models, and what it leaves out."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, takes_scene


@takes_scene(o.SceneFile)
def model(scene: Source) -> None:
    """Print variables, equalities, inequalities, facet pairs in and out of the model of SCENE."""
    from origami_nlp.programme import Model

    stated = scene.read()
    Output().say(f"{stated}\n{Model(stated)}", highlight=False, soft_wrap=True)
