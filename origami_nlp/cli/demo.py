"""`origami-nlp paper demo`: the main job on the paper's 18 panels, with a table, figures and JSON."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search_panels
from origami_nlp.pattern import examples


def demo(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("origami_demo"),
    seed: o.Seed = 0,
) -> None:
    """Find the symmetric minima of the paper's degree-6 and degree-8 vertices, and which of them are stable."""
    from origami_nlp.files import make_folder, write_json
    from origami_nlp.minima import DEMO_HEADS, demo_rows, draw_minima, print_result, result_to_dict
    from origami_nlp.show import rows_table

    out = make_folder(out, "--out")
    files = [out / name for name in ("minima.json", "degree6.png", "degree8.png")]
    output = Output(*(("--out", file) for file in files))
    results = search_panels(seed, full=True)
    shown = [
        results[[r.scene.name for r in results].index(scene.name)]
        for scene in (examples.degree6("pi/3", 1.0), examples.degree8("pi/4", 1.0))
    ]
    for result in shown:
        print_result(result, output.console)
        output.say()
    seconds = sum(r.search.seconds for r in results)
    title = f"all panels of the paper: minima stable in the full space, {seconds:.1f} s in total"
    output.say(rows_table(DEMO_HEADS, demo_rows(results), title))
    write_json([result_to_dict(r) for r in results], files[0])
    for file, result in zip(files[1:], shown, strict=True):
        draw_minima(result, file)
    output.written(*files)
