"""`origami-nlp demo`: the main job on the paper's 18 panels, with a table, figures and JSON."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from origami_nlp.pattern import examples

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult


def search_panels(seed: int, full: bool = False) -> list[MinimaResult]:
    """Find the minima of all 18 panels of the paper's two landscape figures."""
    from origami_nlp.cli.minima import progress_bar
    from origami_nlp.cli.progress import progress
    from origami_nlp.minima import check_options, find_minima

    check_options(seed, 1)
    results: list[MinimaResult] = []
    scenes = examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            with progress_bar(scene.label) as report:
                results.append(find_minima(scene, seed=seed, full=full, progress=report))
            done(len(results))
    return results


def demo(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("origami_demo"),
    seed: Annotated[int, typer.Option(help="Seed of the random starts.")] = 0,
) -> None:
    """Find the symmetric minima of the paper's degree-6 and degree-8 vertices, and which of them are stable."""
    from origami_nlp.files import check_outputs, make_folder, screen, write_json
    from origami_nlp.minima import DEMO_HEADS, demo_rows, draw_minima, print_result, result_to_dict
    from origami_nlp.show import rows_table

    out = make_folder(out, "--out")
    check_outputs(
        *(("--out", out / name) for name in ("minima.json", "degree6.png", "degree8.png"))
    )
    console = screen()
    results = search_panels(seed, full=True)
    shown = [
        results[[r.scene.name for r in results].index(scene.name)]
        for scene in (examples.degree6("pi/3", 1.0), examples.degree8("pi/4", 1.0))
    ]
    for result in shown:
        print_result(result, console)
        console.print()
    seconds = sum(r.search.seconds for r in results)
    title = f"all panels of the paper: minima stable in the full space, {seconds:.1f} s in total"
    console.print(rows_table(DEMO_HEADS, demo_rows(results), title))
    write_json([result_to_dict(r) for r in results], out / "minima.json")
    for name, result in zip(("degree6", "degree8"), shown, strict=True):
        draw_minima(result, out / f"{name}.png")
    console.print(f"written: {out}/minima.json, {out}/degree6.png, {out}/degree8.png")
