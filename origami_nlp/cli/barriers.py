"""`origami-nlp barriers`: the lowest pass between every two minima of a scene."""

from __future__ import annotations

from typing import Any

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene, examples


@bounded
@takes_scene(o.OrigamiUnlessPanels, whole=True)
def barriers(
    scene: Source | None = None,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    full: o.Full = False,
    panels: o.Panels = False,
    markdown: o.MarkdownFile = None,
    fold: o.PathsFold = None,
    html: o.HtmlFile = None,
    animate: o.AnimateFile = None,
) -> None:
    """Find the lowest pass between every two minima of ORIGAMI, and a path through it.

    Of a vertex with up to two freedoms, or of a pattern with one.  With --full the barriers without the symmetry are
    bounded as well.
    """
    from origami_nlp.barriers import (
        barriers_table,
        check_freedoms,
        draw_barriers,
        find_barriers,
    )

    given = scene.name if scene else None
    if panels == (scene is not None):
        raise OptionError(f"ORIGAMI = {given!r}: give a file, an example or --panels, and not both")
    out = Output(json=json, figure=figure, markdown=markdown, fold=fold, html=html, animate=animate)
    if panels and fold is not None:
        raise OptionError(
            f"--fold = {fold!r}: paths of one ORIGAMI make a file, those of --panels do not"
        )
    if panels and animate:
        raise OptionError("--animate is for one ORIGAMI, not for --panels")
    stated: list[Any] = [scene.read_whole()] if scene else [*examples.panels()]
    for one in stated:
        if isinstance(one, Scene):
            check_freedoms(one)
    found = []
    for one in stated:
        result = search(one, given, seed=seed, full=full or None, escape=False)
        with progress(f"{getattr(one, 'label', given) or given}: passes between the minima"):
            found.append(find_barriers(one, result, full=full or None, seed=seed))
        found[-1].tell(out.console)
    documents = [b.to_dict() for b in found]
    out.write("json", lambda: documents if panels else documents[0])
    out.write("markdown", lambda: barriers_table(found).markdown())
    out.write("fold", lambda: found[0].to_fold())
    out.write("figure", draw_barriers, *found)
    out.turn(*found)
