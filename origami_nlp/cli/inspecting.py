"""The command `inspect`: what a file says, whatever kind of file it is."""

from __future__ import annotations

import json
from typing import Any

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, writes
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError


@takes_scene(o.OrigamiFile, whole=True)
@writes("json", "scene", "fold", "figure")
def inspect(out: Output, scene: Source) -> None:
    """Print what ORIGAMI says: vertices of a FOLD file, or a scene and the variables and constraints of its model.

    Of a FOLD file: degree, angles, flat-foldability and diagnosis of each interior vertex; .json has the list, .png the
    pattern with the numbers of its vertices, .fold the pattern with its springs.  With --vertex: that vertex as a
    scene; .toml has it.  Springs given here are in the .toml or .fold, for all other commands.
    """
    if scene.is_whole:
        _pattern(scene, out)
    else:
        _vertex(scene, out)


def _vertex(scene: Source, out: Output) -> None:
    from origami_nlp.pattern import format_scene
    from origami_nlp.problem import Model

    out.refuse("one vertex is written as a scene: end the name in .toml", "json", "fold", "figure")
    stated = scene.read()
    out.say(f"{stated}\n{Model(stated)}", highlight=False, soft_wrap=True)
    out.write("scene", format_scene, stated)


def _pattern(scene: Source, out: Output) -> None:
    from origami_nlp.display import draw_pattern
    from origami_nlp.folding import list_vertices, print_vertices, vertices_to_dict
    from origami_nlp.pattern_problem import pattern_to_fold

    out.refuse("name one vertex with --vertex, to write it as a scene", "scene")
    others = [name for name in scene.given if name != "frame"]
    if others and not out.files("fold"):
        raise OptionError(
            f"--{others[0].replace('_', '-')}: the list has every vertex as it is in the file; give "
            "-o FILE.fold to write the pattern with it, or --vertex V -o FILE.toml for one vertex"
        )
    lists = [list_vertices(one) for one in scene.frames()]
    flat = [one.frame for one in lists if not one.frame.folded]
    if not flat:
        out.refuse("there is no crease pattern to draw", "figure")
    sheet: Any = scene.read_pattern() if out.files("fold") else None
    print_vertices(lists, out.console)
    out.write("json", vertices_to_dict, lists)
    out.write("figure", lambda: draw_pattern(flat[0]))
    out.write("fold", lambda: json.dumps(pattern_to_fold(sheet), indent=1) + "\n")
