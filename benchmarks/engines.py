"""Both engines of one search on one problem: what compiled descents and IPOPT find, against seconds."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import origami_nlp as o
from benchmarks.families import family_scene
from origami_nlp.display import Table
from origami_nlp.io import save_figure
from origami_nlp.pattern_states import METHODS

SHEETS = (
    *("miura:2x2", "miura:2x3", "metasheet:2x3", "metasheet:2x4", "squaretwist"),
    *("waterbomb:1x1", "waterbomb:1x2", "yoshimura:2x2", "yoshimura:2x3", "resch:1x1"),
)
APART = 1e-5
"""Minima are one whose fold angles are nearer to each other [rad]."""


def measure_engines(
    vertices: int, seconds: float, report: Callable[[str], object] = lambda text: None
) -> dict[str, Any]:
    """Search sheets and random vertices by each engine for some wall time each; times are of the processor."""
    scenes = {f"vertex {k}": family_scene("full-contact", k) for k in range(vertices)}
    rows = []
    every: dict[str, Any] = {s: s for s in SHEETS} | scenes
    for name, origami in every.items():
        report(name)
        row: dict[str, Any] = {"name": name}
        union: list[np.ndarray] = []
        for method in METHODS:
            since, at = time.process_time(), list[float]()

            def found(*_: Any, since: float = since, at: list[float] = at) -> None:
                at.append(round(time.process_time() - since, 3))

            asked: dict[str, Any] = {"method": method, "seconds": seconds, "found": found}
            listed = o.find_minima(origami, escape=False, prove=False, **asked).minima
            row[method] = {"found": len(listed), "seconds": at}
            for phi in (np.array(m.fold_angles) for m in listed):
                if all(np.abs(phi - x).max() > APART for x in union):
                    union.append(phi)
        rows.append(row | {"union": len(union)})
    return {"seconds": seconds, "rows": rows}


def engines_table(data: dict[str, Any]) -> Table:
    """Show what each engine found of all that both did."""
    rows = [
        (r["name"], str(r["union"]), *(str(r[method]["found"]) for method in METHODS))
        for r in data["rows"]
    ]
    return Table(("origami", "found by either", *METHODS), tuple(rows), columns="lrrr")


def draw_engines(data: dict[str, Any], target: str | Path) -> None:
    """Draw the share found, mean over all, against seconds of the processor."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 3.2), layout="constrained")
    axes, when = figure.subplots(), np.geomspace(0.05, data["seconds"], 200)
    for method, style in zip(METHODS, ("-", "--"), strict=True):
        shares = [
            (np.array(r[method]["seconds"])[:, None] <= when).sum(axis=0) / max(r["union"], 1)
            for r in data["rows"]
        ]
        share = 100 * np.minimum(np.mean(shares, axis=0), 1.0)
        axes.semilogx(when, share, linestyle=style, color="black", label=method)
    axes.set(xlabel="processor time [s]", ylabel="minima found [%]", ylim=(0, 105))
    axes.legend(loc="lower right", frameon=False)
    save_figure(figure, target, 150)
