"""What every figure says in the same way: marks of minima and passes, lines of boundaries, colours of energy.

A minimum's shape is its kind and its filling its verdict in the full space; so both survive print in grey.  Passes
are white.  Colours are distinguished by readers with deuteranopia and protanopia, and by their lightness.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # tables read colours here: matplotlib loads when something is drawn
    from matplotlib.colors import Colormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


@dataclass(frozen=True)
class KindStyle:
    """How a kind of minimum looks.

    Attributes
    ----------
    marker
        Of matplotlib.
    scale
        Of its size against the star's.
    colour
        Where words stand for the kind; in pictures of states the colour is the verdict's.
    """

    marker: str
    scale: float
    colour: str


KINDS = {
    "interior": KindStyle("*", 1.0, "#0072B2"),
    "contact-pinned": KindStyle("^", 0.72, "#D55E00"),
    "contact-touching": KindStyle("o", 0.66, "#E69F00"),
    "degenerate": KindStyle("X", 0.72, "#7A7A7A"),
}
"""Each kind of minimum."""
VERDICTS: dict[str | None, tuple[str, str]] = {
    "stable": ("#FFC107", "stable in the full space"),
    "unstable": ("#D81B60", "unstable in the full space"),
    "undecided": ("#9E9E9E", "undecided"),
    None: ("#FFFFFF", "full space not asked"),
    "": ("#FFFFFF", "minimum"),
}
"""Filling of a minimum by its verdict in the full space, and what the legend says; undecided ones are half filled.

Empty with less than full contact and no symmetry imposed: there is no other space to ask about.
"""
PASSES = {
    "saddle": "D",
    "contact saddle": "d",
    "corner": "v",
    "flat state": "s",
    "singular": "P",
    "bound": "h",
}
"""Marker of each kind of pass; all are white."""
MOUNTAIN, VALLEY, FLAT, BORDER = "#c1121f", "#1d4ed8", "#8a8a8a", "#000000"
UPPER, LOWER = "#f6ead2", "#c3d3dc"
"""Creases, and the sides of the paper."""
LIGHT = (-0.35, 0.55, 0.76)
"""Towards the light, in the picture's frame."""
INK, WARNING = "#1B1B1B", "#AD1457"
"""Lines and words; words about what is unstable."""
METASTABLE = "#E10000"
PUSHES, IDLE = "#B5179E", "#6C757D"
"""Contacts that push, and contacts that only touch."""
INKS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#7F7F7F")
"""Okabe and Ito's colours, for what has no meaning of its own."""
HANDLE: dict[str, Any] = {"color": "#7B1FA2", "lw": 2.2, "ls": (0, (3.0, 1.6)), "zorder": 4}
"""Line of a 1-handle, on which states exist only at |phi| = pi exactly."""


def energy_colours() -> Colormap:
    """Dark blue (low) to pale green: marks stand out, lightness is even, and none of it is white.

    Returns
    -------
    matplotlib.colors.Colormap
        For energies.
    """
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    share = [0.03 + 0.87 * k / 255 for k in range(256)]
    return ListedColormap(colormaps["YlGnBu_r"](share), name="energy")


def minimum_look(kind: str, verdict: str | None, size: float) -> dict[str, Any]:
    """Return how a minimum is marked, for ``Axes.plot``.

    Parameters
    ----------
    kind
        Of `KINDS`.
    verdict
        Of `VERDICTS`.
    size
        Of a star [points].

    Returns
    -------
    dict
        Keywords.
    """
    look = KINDS[kind]
    half = {"fillstyle": "left", "mfcalt": "white"} if verdict == "undecided" else {}
    edge = {"mec": "black", "mew": max(0.6, 0.055 * size), "ls": "none"}
    shape = {"marker": look.marker, "ms": size * look.scale, "mfc": VERDICTS[verdict][0]}
    return {**shape, **edge, **half}


def pass_look(kind: str, size: float) -> dict[str, Any]:
    """Return how a pass is marked, for ``Axes.plot``.

    Parameters
    ----------
    kind
        Of `PASSES`.
    size
        Of a star [points].

    Returns
    -------
    dict
        Keywords.
    """
    edge = {"mec": "black", "mew": max(0.6, 0.07 * size), "ls": "none"}
    return {"marker": PASSES[kind], "ms": 0.5 * size, "mfc": "white", **edge}


def mark_minimum(
    axes: Any, point: Iterable[float], kind: str, verdict: str | None, size: float
) -> None:
    """Mark a minimum, on top of everything and never cut at the border.

    Parameters
    ----------
    axes
        Of matplotlib.
    point
        Where.
    kind, verdict, size
        As in `minimum_look`.
    """
    from matplotlib.patheffects import withStroke

    halo = [withStroke(linewidth=0.19 * size, foreground="white")]
    look = minimum_look(kind, verdict, size)
    axes.plot(*point, **look, zorder=7, clip_on=False, path_effects=halo, gid="mark")


def minima_legend(
    found: Iterable[tuple[str, str | None]], size: float, verdicts: bool = True
) -> list[Line2D]:
    """Return legend entries for minima: first the verdicts that occur, then the kinds.

    Parameters
    ----------
    found
        Kind and verdict of every minimum that is marked.
    size
        Of a star [points].
    verdicts
        Whether verdicts are listed: without a symmetry that may break they say nothing.

    Returns
    -------
    list of matplotlib.lines.Line2D
        Handles with labels.
    """
    from matplotlib.lines import Line2D

    pairs = set(found)
    kinds = [kind for kind in KINDS if any(k == kind for k, _ in pairs)]
    entries = [
        Line2D([], [], label=words, **minimum_look(kinds[0], verdict, size))
        for verdict, (_, words) in VERDICTS.items()
        if verdicts and any(v == verdict for _, v in pairs)
    ]
    for kind in kinds:
        entries.append(Line2D([], [], label=kind, **minimum_look(kind, None, size)))
    return entries


def passes_legend(kinds: Iterable[str], size: float) -> list[Line2D]:
    """Return legend entries for passes.

    Parameters
    ----------
    kinds
        Those that occur.
    size
        Of a star [points].

    Returns
    -------
    list of matplotlib.lines.Line2D
        Handles with labels.
    """
    from matplotlib.lines import Line2D

    found = set(kinds)
    met = [kind for kind in PASSES if kind in found]
    return [Line2D([], [], label=f"pass: {kind}", **pass_look(kind, size)) for kind in met]


def patch(colour: str, label: str) -> Patch:
    """Return the legend entry of an area.

    Parameters
    ----------
    colour, label
        Of it.

    Returns
    -------
    matplotlib.patches.Patch
        The handle.
    """
    from matplotlib.patches import Patch

    return Patch(facecolor=colour, edgecolor="#777777", linewidth=0.6, label=label)
