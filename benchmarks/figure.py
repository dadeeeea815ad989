"""Work-precision diagrams: seconds a start against error, appendix A against the exact Hessian, and scaling."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from benchmarks.digest import Contact, Spread, rows
from benchmarks.methods_ours import OURS
from origami_nlp.io import save_figure

STYLES = {  # Okabe and Ito's colours, distinguished by marker too
    OURS: ("#000000", "*", 13),
    "IPOPT alone": ("#0072B2", "o", 6),
    "IPOPT L-BFGS": ("#56B4E9", "s", 6),
    "IPOPT, its defaults": ("#0072B2", "P", 7),
    "SLSQP": ("#D55E00", "^", 7),
    "SLSQP, raw starts": ("#D55E00", "1", 9),
    "trust-constr": ("#CC79A7", "v", 7),
    "trust-constr, raw starts": ("#CC79A7", "2", 9),
    "sqpmethod": ("#009E73", "D", 6),
    "feasiblesqpmethod": ("#009E73", "d", 6),
    "fatrop": ("#E69F00", "X", 7),
    "uno": ("#999933", "h", 7),
    "sleqp": ("#882255", "p", 7),
    "alpaqa": ("#777777", "<", 6),
}
ROUNDING = 1e-17
"""Smaller errors are drawn here."""


def draw_bench(data: dict[str, Any], target: Path) -> None:
    """Draw the figure of a run to a .png, .pdf or .svg file."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 8.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 2)
    families = [f for f in ("panel", "random") if rows(data, f)]
    titles = {"panel": "The paper's panels", "random": "Random vertices, degree 4 to 12"}
    for ax, family in zip(axes[0], families, strict=False):
        _work_precision(ax, rows(data, family), titles[family])
    if len(families) == 2:
        low, high = zip(*(ax.get_ylim() for ax in axes[0]), strict=True)
        for ax in axes[0]:
            ax.set_ylim(min(low), max(high))
    handles = {
        label: handle
        for ax in axes[0]
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside upper center",
        ncols=5,
        frameon=False,
        fontsize=8,
    )
    _hessians(axes[1][0], data)
    _scaling(axes[1][1], data)
    figure.get_layout_engine().set(h_pad=0.12)
    save_figure(figure, target, 150)


def _work_precision(ax: Any, found: list[Contact], title: str) -> None:
    """Draw one line a family of methods, one point a tolerance; whiskers are quartiles over problems."""
    families: dict[str, list[Contact]] = {}
    for row in found:
        if row.seconds and row.errors["angle"]:
            families.setdefault(row.family, []).append(row)
    for family, of in families.items():
        of.sort(key=lambda r: -r.accuracy)
        colour, marker, size = STYLES.get(family, ("#777777", ".", 6))
        x = [max(_spread(r.errors["angle"]).median, ROUNDING) for r in of]
        y = [1e3 * _spread(r.seconds).median for r in of]
        low = [b - 1e3 * _spread(r.seconds).low for r, b in zip(of, y, strict=True)]
        high = [1e3 * _spread(r.seconds).high - b for r, b in zip(of, y, strict=True)]
        ax.errorbar(
            x,
            y,
            yerr=[low, high],
            color=colour,
            marker=marker,
            markersize=size,
            linewidth=1.2,
            elinewidth=0.5,
            label=family,
            zorder=3 if family == OURS else 2,
        )
    ax.set(xscale="log", yscale="log", title=title)
    ax.set_xlabel("median error of the fold angles [rad]  (exact to the left)")
    ax.set_ylabel("time a start [ms]  (fast at the bottom)")
    ax.yaxis.set_minor_formatter("")
    ax.grid(alpha=0.3, which="major")


def _spread(value: Spread | None) -> Spread:
    assert value is not None
    return value


def _hessians(ax: Any, data: dict[str, Any]) -> None:
    """Draw each interior state: time against the error of the reduced Hessian's eigenvalues."""
    states = data["hessian"]
    exact_x = [max(h["error_exact"], ROUNDING) for h in states]
    exact_y = [1e3 * _median(h["seconds"]["exact"]) for h in states]
    ax.plot(exact_x, exact_y, "*", color="#000000", markersize=10, label="exact Hessian")
    steps = list(states[0]["error_appendix"]) if states else []
    colours = ("#CC79A7", "#D55E00", "#E69F00")
    for step, colour, marker in zip(steps, colours, ("v", "^", "s"), strict=False):
        chosen = [h for h in states if h["error_appendix"][step] is not None]
        x = [h["error_appendix"][step] for h in chosen]
        y = [1e3 * _median(h["seconds"]["appendix A"]) for h in chosen]
        label = f"appendix A, h = {step} (time of all steps)"
        ax.plot(x, y, marker, color=colour, markersize=5, label=label)
    ax.set(
        xscale="log", yscale="log", title="Test of a state: the paper's against the exact Hessian"
    )
    ax.set_xlabel("relative error of the reduced Hessian's eigenvalues")
    ax.set_ylabel("time a state [ms]")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8, frameon=False, loc="center left")


def _scaling(ax: Any, data: dict[str, Any]) -> None:
    """Draw time against the degree: compiling, and one solve with its polish."""
    for contact, colour in (("none", "#0072B2"), ("full", "#D55E00")):
        of = [d for d in data["scaling"]["degrees"] if d["contact"] == contact and "pairs" in d]
        if not of:
            continue
        n = [d["degree"] for d in of]
        words = "without contact" if contact == "none" else "full contact"
        ax.plot(
            n,
            [d["compile_seconds"] for d in of],
            "--s",
            color=colour,
            markersize=4,
            label=f"compile, {words}",
        )
        ax.plot(
            n,
            [_median(d["solve_seconds"]) for d in of],
            "-o",
            color=colour,
            markersize=5,
            label=f"solve + polish, {words}",
        )
    ax.set(xscale="log", yscale="log", title="Scaling with the degree (no symmetry)")
    ticks = sorted({d["degree"] for d in data["scaling"]["degrees"]})
    shown = [t for t in ticks if t in (4, 6, 8, 12, 20, 30, 40, 60)]
    ax.set_xticks(shown, [str(t) for t in shown])
    ax.minorticks_off()
    ax.set_xlabel("degree N")
    ax.set_ylabel("time [s]")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8, frameon=False)


def _median(values: list[float]) -> float:
    spread = Spread.of(values)
    return math.nan if spread is None else spread.median
