"""`origami-nlp vertices`: the interior vertices of a FOLD file, and what can be analysed."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.pattern import read_fold


def vertices(
    fold: o.FoldFile,
    frame: o.FrameNumber = None,
    json: o.JsonFile = None,
) -> None:
    """List the interior vertices of a FOLD file: degree, angles, flat-foldability, diagnosis."""
    from origami_nlp.folding import list_vertices, print_vertices, vertices_to_dict

    out = Output(json=json)
    lists = [list_vertices(one) for one in read_fold(fold, frame)]
    print_vertices(lists, out.console)
    out.write("json", vertices_to_dict, lists)
