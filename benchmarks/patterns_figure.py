"""Error against time on patterns, a panel each: distinguished by marker and line as well as by colour."""

from __future__ import annotations

import math
from os import PathLike
from typing import TYPE_CHECKING, Any

from benchmarks.pattern_methods import OURS
from benchmarks.patterns import ELSEWHERE, PatternBench, PatternPoint
from origami_nlp.display import INKS
from origami_nlp.io import save_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOOKS: dict[str, dict[str, Any]] = {
    OURS: {"color": "black", "marker": "*", "markersize": 11, "linewidth": 2.0, "zorder": 5},
    "gradient and projection": {"color": INKS[1], "marker": "^", "linestyle": "--"},
    "bars and hinges, L-BFGS": {"color": INKS[2], "marker": "s", "linestyle": "-."},
    "IPOPT, elastic rows": {"color": INKS[0], "marker": "o", "linestyle": ":"},
    "IPOPT, all rows": {"color": INKS[4], "marker": "D", "linestyle": ":"},
}
"""Of each method."""
COLUMNS = 4
LIMITS = 1e-18, 1e1
ROUNDING = 1e-16
"""Smaller errors are drawn here."""


def draw_patterns(bench: PatternBench, target: str | PathLike[str] | None = None) -> Figure:
    """Draw the largest error of a fold angle against processor time, one panel a pattern.

    Parameters
    ----------
    bench
        The measurement.
    target
        Where to save it (.png, .pdf or .svg), if anywhere.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    many = len(bench.cases)
    columns = min(many, COLUMNS) if many > 1 else 2
    rows = math.ceil((many + 1) / columns)  # one place is the legend's
    figure = Figure(figsize=(3.2 * columns, 2.9 * rows + 0.4), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    for ax, case in zip(axes, bench.cases, strict=False):
        words = []
        for method in bench.methods:
            of = bench.of(case.name, method)
            if not of:
                words.append(f"{method}: none in {bench.budget:g} s")
            elif any(math.isnan(p.angle) for p in of):
                words.append(f"{method}: refused")
            else:
                _line(ax, method, _falling(of))
        ax.set(xscale="log", yscale="log", ylim=LIMITS)
        ax.set_title(f"{case.name}  ({case.facets:,} facets)", fontsize=10)
        ax.grid(alpha=0.3)
        for k, line in enumerate(words):
            ax.text(0.03, 0.03 + 0.07 * k, line, transform=ax.transAxes, fontsize=8)
        ax.tick_params(labelsize=8, labelleft=True, labelbottom=True)
    for ax in axes[many:]:
        ax.axis("off")
    lines = {method: _line(axes[-1], method, []) for method in bench.methods}
    axes[-1].legend(
        lines.values(), lines.keys(), loc="center", frameon=False, fontsize=9,
        title="medians of rounds;\nhollow: at another state", title_fontsize=8,
    )  # fmt: skip
    figure.supxlabel("processor time from the same start [s]", fontsize=10)
    figure.supylabel("largest error of a fold angle [rad]", fontsize=10)
    if target is not None:
        save_figure(figure, target, 150)
    return figure


def _falling(of: tuple[PatternPoint, ...]) -> list[PatternPoint]:
    """Return the answers of a method up to its best; all of them where it ends at another state."""
    best = min(of, key=lambda p: p.angle)
    return list(of[: of.index(best) + 1] if best.angle <= ELSEWHERE else of)


def _line(ax: Any, method: str, of: list[PatternPoint]) -> Any:
    look = {"markersize": 5, "linewidth": 1.3, **LOOKS.get(method, {"color": INKS[7]})}
    if of and min(p.angle for p in of) > ELSEWHERE:
        look["markerfacecolor"] = "white"
    x, y = [p.seconds for p in of], [max(p.angle, ROUNDING) for p in of]
    return ax.plot(x, y, label=method, **look)[0]
