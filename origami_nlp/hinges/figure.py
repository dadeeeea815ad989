"""The picture of a measured hinge: torque with data, band and loop above, energy with wells below."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS
from origami_nlp.hinges.result import MeasuredHinge

WIDE, TALL = 7.4, 5.4
"""Of the figure, and of both panels together [inches]."""
LAW, LOADING, UNLOADING, FALLING = INKS[6], INKS[0], INKS[1], "#F4D6DE"


def draw_hinge(hinge: MeasuredHinge) -> Figure:
    """Draw torque with its data and band, and beneath it the energy with its wells.

    Parameters
    ----------
    hinge
        Of `fit_hinge`.

    Returns
    -------
    matplotlib.figure.Figure
        Hatched is what was not measured, and shaded where the stiffness is negative for certain.

    Raises
    ------
    OptionError
        If `hinge` is not of its type.
    """
    check_type("hinge", hinge, MeasuredHinge)
    x, data = np.degrees(hinge.angle), hinge.data
    scale, unit = (1e3, "m") if np.abs(hinge.torque).max() < 0.1 else (1.0, "")
    two = not math.isnan(hinge.loop_area)
    figure = Figure((WIDE, TALL), layout="constrained")
    upper, lower = figure.subplots(2, sharex=True, height_ratios=(3, 2))
    way = data.sweep if two else np.ones(len(data.angle))
    told = {1: "angle growing" if two else "data", -1: "angle falling"}
    dots: Any = {"ms": max(1.0, min(3.5, 60 / math.sqrt(len(way)))), "mew": 0, "alpha": 0.55}
    for sign, colour in ((1, LOADING), (-1, UNLOADING)):
        rows = way == sign
        torque = scale * data.torque[rows]
        label = told[sign] if rows.any() else None
        upper.plot(np.degrees(data.angle[rows]), torque, "o", color=colour, label=label, **dots)
    if np.isfinite(hinge.band).all():
        above, below = (scale * (hinge.torque + s * hinge.band) for s in (1, -1))
        upper.fill_between(x, below, above, color=LAW, alpha=0.2, lw=0, label="95 % band")
    for s, label in ((1, "law and half-gap"), (-1, None)) if two else ():
        gap = scale * (hinge.torque + s * hinge.gap)
        upper.plot(x, gap, color=LAW, lw=0.9, ls=(0, (4, 2)), label=label)
    upper.plot(x, scale * hinge.torque, color=LAW, lw=1.6, label="mean law")
    upper.axhline(0, color="#888888", lw=0.7)
    upper.set_ylabel(f"torque dU/dphi [{unit}N m]")
    energy = scale * hinge.law.energy(hinge.angle)
    lower.plot(x, energy, color=LAW, lw=1.6)
    lower.set_ylim(-0.06 * energy.max(), 1.15 * energy.max())
    for rest in hinge.rests:
        at = math.degrees(rest.angle), scale * rest.energy
        lower.plot(*at, "v" if rest.kind == "well" else "s", ms=6, color=INKS[2], zorder=3)
        lower.plot(np.degrees(rest.held), [at[1]] * 2, color=INKS[2], lw=3, alpha=0.45)
        lower.annotate(f"{at[0]:.4g}°", at, (0, 8), textcoords="offset points", ha="center")
    for axes in (upper, lower):
        for k, (a, b) in enumerate(hinge.falling):
            label = "stiffness < 0" if axes is upper and k == 0 else None
            axes.axvspan(*np.degrees([a, b]), color=FALLING, lw=0, zorder=0, label=label)
        axes.spines[["top", "right"]].set_visible(False)
    upper.legend(frameon=False, fontsize=9)
    upper.set_title(
        "\n".join([hinge.name, *hinge.notes]), fontsize=10, loc="left", parse_math=False
    )
    lower.set_ylabel(f"energy [{unit}J]")
    lower.set_xlabel("fold angle [deg]: mountain < 0 < valley")
    return figure
