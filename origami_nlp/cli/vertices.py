"""`origami-nlp vertices`: the interior vertices of a FOLD file, and what can be analysed."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError


@takes_scene(o.FoldFile)
def vertices(
    scene: Source,
    json: o.JsonFile = None,
    toml: o.SceneOut = None,
    figure: o.FigureFile = None,
) -> None:
    """List the interior vertices of a FOLD file: degree, angles, flat-foldability, diagnosis.

    With --scene, write the one of --vertex as a scene file; --figure draws the pattern with the numbers of vertices.
    """
    from origami_nlp.folding import list_vertices, print_vertices, vertices_to_dict
    from origami_nlp.pattern import format_scene
    from origami_nlp.show import draw_pattern

    out = Output(json=json, scene=toml, figure=figure)
    others = {name: value for name, value in scene.given.items() if name != "frame"}
    if toml is None and others:
        raise OptionError(
            f"--{next(iter(others)).replace('_', '-')}: the list has every vertex as it is in the file; "
            "give --scene FILE, to write one as a scene"
        )
    lists = [list_vertices(one) for one in scene.frames()]
    flat = [one.frame for one in lists if not one.frame.folded]
    if figure and not flat:
        raise OptionError(f"--figure = {str(figure)!r}: there is no crease pattern to draw")
    print_vertices(lists, out.console)
    out.write("json", vertices_to_dict, lists)
    out.write("scene", lambda: format_scene(scene.read()))
    out.write("figure", lambda: draw_pattern(flat[0]))
