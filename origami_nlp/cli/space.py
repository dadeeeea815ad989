"""`origami-nlp space`: topology of the admissible space of a scene."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded


@bounded
@takes_scene(o.SceneFile)
def space(
    scene: Source,
    rings: o.Rings = 64,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
) -> None:
    """Find components, holes, pinch points and handles of SCENE's admissible symmetric states."""
    from origami_nlp.space import draw_space, find_space

    out = Output(json=json, figure=figure)
    stated = scene.read()
    with progress(f"{stated.label or scene.name}: mesh, walls, layers"):
        found = find_space(stated, rings)
    found.tell(out.console)
    out.write("json", found.to_dict)
    out.write("figure", draw_space, found)
