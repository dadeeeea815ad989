"""The paper's figures anew, by name.

To add one, write a function such as those below, import what it needs inside it, and add a line to `FIGURES`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

Progress = Callable[..., Any]
"""Called with the parts that are done and how many there are."""


@dataclass(frozen=True)
class Drawn:
    """A figure, and what was found on the way.

    print_to: prints the latter on a console.
    """

    figure: Figure
    print_to: Callable[[Console], None]


def _sheet(name: str, seed: int, progress: Progress) -> Drawn:
    from studies.sheets import draw_panels, find_panels, sheet_table

    panels = find_panels(name, seed=seed, progress=progress)
    return Drawn(
        draw_panels(name, panels),
        lambda console: console.print(sheet_table(panels)),
    )


def _grid_convergence(name: str, seed: int, progress: Progress) -> Drawn:
    from origami_nlp.minima import MinimaResult, find_minima
    from origami_nlp.pattern import panels
    from studies.grid_convergence import (
        GridCount,
        GridErrors,
        count_grid_minima,
        grid_errors,
    )
    from studies.grid_convergence_figure import (
        draw_grid_convergence,
        print_convergence,
    )

    scenes = panels()
    results: list[MinimaResult] = []
    errors: list[GridErrors] = []
    counts: dict[str, tuple[GridCount, ...]] = {}
    for number, scene in enumerate(scenes):
        results.append(find_minima(scene, seed=seed, escape=False))
        errors += grid_errors(results[-1], seed=seed)
        progress(number + 1, len(scenes) + 2)
    for degree in (6, 8):
        those = [r for r in results if r.scene.degree == degree]
        counts[f"degree {degree}"] = count_grid_minima(those)
        progress(len(scenes) + len(counts), len(scenes) + 2)
    return Drawn(
        draw_grid_convergence(tuple(errors), counts),
        lambda console: print_convergence(errors, counts, console),
    )


def _cones(name: str, seed: int, progress: Progress) -> Drawn:
    from studies.cone_figures import draw_cone_figure

    return Drawn(draw_cone_figure(name), lambda console: None)


FIGURES: dict[str, Callable[[str, int, Progress], Drawn]] = {
    "figure3": _sheet,
    "figure4": _sheet,
    "grid-convergence": _grid_convergence,
    "cones": _cones,
    "cone-3": _cones,
    "cone-3-firing": _cones,
    "cone-4": _cones,
    "cone-4-firing": _cones,
    "cone-56": _cones,
}
"""What can be drawn: name in the paper (or of ours), and the function of name, seed and progress that draws it."""
