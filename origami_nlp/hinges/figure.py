"""The picture of a measured hinge: torque with data, band and loop above, energy with wells below."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from origami_nlp.arguments import check_type
from origami_nlp.display import INKS, StackedFigure
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
    scale, unit = (1e3, "mN m") if np.abs(hinge.torque).max() < 0.1 else (1.0, "N m")
    two = not math.isnan(hinge.loop_area)
    handles: list[Any] = [Line2D([], [], color=LAW, lw=1.6, label="mean law")]
    dots: Any = {"ls": "", "marker": "o", "ms": 3, "mew": 0}
    ways = [(LOADING, "angle growing"), (UNLOADING, "angle falling")]
    for colour, label in ways if two else [(LOADING, "data")]:
        handles.append(Line2D([], [], color=colour, label=label, **dots))
    if np.isfinite(hinge.band).all():
        handles.append(Patch(color=LAW, alpha=0.2, lw=0, label="95 % band"))
    if two:
        handles.append(Line2D([], [], color=LAW, lw=0.9, ls=(0, (4, 2)), label="law and half-gap"))
    if hinge.falling:
        handles.append(Patch(color=FALLING, lw=0, label="stiffness < 0"))
    page = StackedFigure(WIDE, TALL, [hinge.name], handles, hinge.notes)
    upper = page.axes(0.75, 0.1, WIDE - 0.95, 0.58 * TALL - 0.15)
    lower = page.axes(0.75, 0.58 * TALL + 0.1, WIDE - 0.95, 0.42 * TALL - 0.65)
    room = 0.06 * np.ptp(x)
    for axes in (upper, lower):
        axes.set_xlim(x[0] - room, x[-1] + room)
        for a, b in hinge.falling:
            axes.axvspan(math.degrees(a), math.degrees(b), color=FALLING, lw=0, zorder=0)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    way = data.sweep if two else np.ones(len(data.angle))
    small = max(1.0, min(3.5, 60 / math.sqrt(len(way))))
    for sign, colour in ((1, LOADING), (-1, UNLOADING)):
        rows = way == sign
        dotted = {"ms": small, "mew": 0, "alpha": 0.55, "color": colour}
        upper.plot(np.degrees(data.angle[rows]), scale * data.torque[rows], "o", **dotted)
    if np.isfinite(hinge.band).all():
        above, below = (scale * (hinge.torque + s * hinge.band) for s in (1, -1))
        upper.fill_between(x, below, above, color=LAW, alpha=0.2, lw=0)
    if two:
        for s in (1, -1):
            upper.plot(x, scale * (hinge.torque + s * hinge.gap), color=LAW, lw=0.9, ls=(0, (4, 2)))
    upper.plot(x, scale * hinge.torque, color=LAW, lw=1.6)
    upper.axhline(0, color="#888888", lw=0.7)
    upper.set_ylabel(f"torque dU/dphi [{unit}]")
    upper.tick_params(labelbottom=False)
    energy = scale * hinge.law.energy(hinge.angle)
    lower.plot(x, energy, color=LAW, lw=1.6)
    lower.set_ylim(-0.06 * energy.max(), 1.15 * energy.max())
    for rest in hinge.rests:
        at = math.degrees(rest.angle), scale * rest.energy
        lower.plot(*at, "v" if rest.kind == "well" else "s", ms=6, color=INKS[2], zorder=3)
        if rest.held[1] > rest.held[0]:
            held = np.degrees(rest.held)
            lower.plot(held, [at[1]] * 2, color=INKS[2], lw=3, alpha=0.45, solid_capstyle="butt")
        lower.annotate(
            f"{at[0]:.4g}°", at, (0, 8), textcoords="offset points", ha="center", fontsize=9
        )
    lower.set_ylabel(f"energy [{'mJ' if scale > 1 else 'J'}]")
    lower.set_xlabel("fold angle [deg]: mountain < 0 < valley")
    return page.figure
