"""The paper's 3x3 sheets of landscapes: figure 3 (degree 6) and figure 4 (degree 8).

Columns are sector angles, rows stiffness ratios.  The boundary depends on the column alone and is traced once for each;
searches, boundaries and pictures are spread over processes.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from origami_nlp.chart import coordinate_label, trace_boundary
from origami_nlp.display import Table, angle_ticks, short_label
from origami_nlp.errors import OptionError
from origami_nlp.landscape import (
    ExactLandscape,
    PanelStyle,
    draw_panel,
    find_landscape,
    legend_of,
)
from origami_nlp.minima import find_minima
from origami_nlp.pattern import Scene, examples
from origami_nlp.workers import worker_pool

Progress = Callable[[int, int], None]
"""Called as progress(tasks done, tasks in all)."""


@dataclass(frozen=True)
class PanelGrid:
    """Which vertices a sheet shows: maker of scenes, and sector angles of the columns."""

    make: Callable[[str, float], Scene]
    alphas: tuple[str, ...]
    ratios: tuple[float, ...] = examples.RATIOS

    @property
    def scenes(self) -> list[Scene]:
        """The nine scenes, row by row."""
        return [self.make(alpha, ratio) for ratio in self.ratios for alpha in self.alphas]


SHEETS = {
    "figure3": PanelGrid(examples.degree6, examples.DEGREE6_ALPHAS),
    "figure4": PanelGrid(examples.degree8, examples.DEGREE8_ALPHAS),
}
STYLE = PanelStyle(star=9.5, line=0.75, text=7.5, numbers=False)


def find_panels(
    name: str,
    *,
    seed: int = 0,
    size: int = 301,
    workers: int | None = None,
    progress: Progress | None = None,
) -> list[ExactLandscape]:
    """Find, judge and map the nine panels of a sheet, row by row.

    Parameters
    ----------
    name
        ``"figure3"`` or ``"figure4"``.
    seed
        Of the random starts.
    size
        Cells along each coordinate of every landscape.
    workers
        Processes; 1 works in this one (scripts without a ``__main__`` guard must).  Default: one a core.

    Raises
    ------
    OptionError
        If there is no sheet of that name.
    """
    if name not in SHEETS:
        raise OptionError(f"sheet = {name!r} must be one of {', '.join(SHEETS)}")
    scenes = SHEETS[name].scenes
    columns = len(SHEETS[name].alphas)
    count = min(workers or os.cpu_count() or 1, len(scenes))
    total, done = 2 * len(scenes) + columns, 0

    def finished(_: Any = None) -> None:
        nonlocal done
        done += 1
        if progress:
            progress(done, total)

    if count == 1:
        boundaries = []
        for scene in scenes[:columns]:
            boundaries.append(trace_boundary(scene))
            finished()
        panels = []
        for k, scene in enumerate(scenes):
            result = find_minima(scene, seed=seed, full=True, escape=False)
            finished()
            panels.append(find_landscape(result, size=size, boundary=boundaries[k % columns]))
            finished()
        return panels
    with worker_pool(count) as pool:
        # longest first: the boundaries, then the searches; a panel as soon as both are there
        traced = [_submit(pool, finished, trace_boundary, scene) for scene in scenes[:columns]]
        searched = [
            _submit(pool, finished, find_minima, scene, seed=seed, full=True, escape=False)
            for scene in scenes
        ]
        waiting = []
        for k, future in enumerate(searched):
            result, boundary = future.result(), traced[k % columns].result()
            waiting.append(
                _submit(pool, finished, find_landscape, result, size=size, boundary=boundary)
            )
        return [panel.result() for panel in waiting]


def _submit(
    pool: Executor, finished: Callable[[Any], None], what: Any, *arguments: Any, **options: Any
) -> Future[Any]:
    future = pool.submit(what, *arguments, **options)
    future.add_done_callback(finished)
    return future


def draw_panels(name: str, panels: list[ExactLandscape]) -> Figure:
    """Draw the nine panels of a sheet, two columns of a journal wide (183 mm)."""
    sheet = SHEETS[name]
    rows, columns = len(sheet.ratios), len(sheet.alphas)
    width, height = 7.2, 7.6
    side, bar, left, top = 1.74, 0.07, 0.68, 0.58
    step_x, step_y = 2.15, 2.13
    figure = Figure(figsize=(width, height), dpi=150, facecolor="white")

    def box(x: float, y: float, w: float, h: float) -> Any:
        return figure.add_axes((x / width, 1 - (y + h) / height, w / width, h / height))

    for k, panel in enumerate(panels):
        row, column = divmod(k, columns)
        x, y = left + column * step_x, top + row * step_y
        axes = box(x, y, side, side)
        branches = list(range(len(panel.chart.branches)))
        image = draw_panel(axes, panel, branches, STYLE)
        _ticks(axes, panel, bottom=row == rows - 1, first=column == 0)
        _bar(box(x + side + 0.05, y + 0.08, bar, side - 0.16), image)
        above = {"transform": axes.transAxes, "fontsize": 8}
        axes.text(0.0, 1.05, f"({chr(97 + k)})", weight="bold", **above)
        axes.text(1.0, 1.05, _counts(panel), ha="right", **above)
        if row == 0:
            title = r"$\alpha_1 = " + _formula(sheet.alphas[column]) + "$"
            axes.text(
                0.5, 1.16, title, transform=axes.transAxes, fontsize=10, ha="center", va="bottom"
            )
        if column == 0:
            power = f"{sheet.ratios[row]:g}"
            axes.text(
                -0.345,
                0.5,
                rf"$r_k = {power}$",
                transform=axes.transAxes,
                fontsize=10,
                rotation=90,
                va="center",
                ha="center",
            )
    figure.text(0.995, 1 - 0.14 / height, "energy U [J]", fontsize=7, ha="right", va="center")
    entries = legend_of(panels, STYLE)
    figure.legend(
        handles=entries,
        loc="lower center",
        ncols=4,
        fontsize=7,
        frameon=False,
        columnspacing=1.4,
        handletextpad=0.5,
        borderaxespad=0.3,
    )
    return figure


def _counts(panel: ExactLandscape) -> str:
    """Report how many minima there are, and how many of them are stable."""
    every, possible, stable = panel.counts
    words = f"{every} minim{'um' if every == 1 else 'a'}"
    if stable is not None and possible is not None:
        words += f", {stable} stable"
        words += f", {possible - stable} undecided" if possible > stable else ""
    return words


def _formula(alpha: str) -> str:
    return alpha.replace("*", "").replace("pi", r"\pi")


def _ticks(axes: Any, panel: ExactLandscape, *, bottom: bool, first: bool) -> None:
    """Angle ticks on every panel; names and numbers on the outer ones only."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    angle_ticks(axes.xaxis, x0, x1)
    angle_ticks(axes.yaxis, y0, y1)
    axes.tick_params(labelsize=7, length=2.5, pad=2, labelbottom=bottom, labelleft=first)
    axes.set(xlabel="", ylabel="")
    if bottom:
        axes.set_xlabel(coordinate_label(panel.chart.coordinates[0]), fontsize=8, labelpad=1)
    if first:
        axes.set_ylabel(coordinate_label(panel.chart.coordinates[1]), fontsize=8, labelpad=0)


def _bar(axes: Any, image: Any) -> None:
    bar = axes.figure.colorbar(image, cax=axes)
    bar.outline.set_linewidth(0.4)
    bar.ax.yaxis.set_major_locator(MaxNLocator(4))
    bar.ax.tick_params(labelsize=6.5, length=1.5, width=0.4, pad=1)


def sheet_table(panels: list[ExactLandscape]) -> Table:
    """Tabulate the panels: minima, those not ruled out (open) and stable in the full space, metastable length."""
    rows = []
    for panel in panels:
        lines = panel.boundary.lines if panel.boundary else ()
        length = sum(part.length for part in panel.metastable)
        rows.append(
            (
                short_label(panel.result.scene.label),
                *("?" if n is None else str(n) for n in panel.counts),
                f"{length:.2f}" if panel.metastable else "-",
                str(sum(line.thin for line in lines)),
            )
        )
    heads = ("scene", "N_sym", "open", "N_full", "metastable [rad]", "1-handles")
    return Table(heads, rows, f"{len(panels)} panels", "lrrrrr")
