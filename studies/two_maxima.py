"""Vertices of degree 4 on whose branches the energy has two maxima at most, whatever the springs, in double precision.

f is the slope of the energy along half of a branch, from the flat state to the limit; u1 the speed of the neighbour
of the leading crease that closes on neither branch, u2 that of the crease opposite, less, with shift -1, that of the
leading one (both over what they are at the flat state).  Where a number gamma makes h' + gamma h > 0 for all springs,
h = W(u1, u2, f)/W(u1, u2), h goes through 0 once at most, f/u1 is concave and then convex as a function of u2/u1, and
there is one maximum on the half.  Looked at here at some places; `tests/independent/two_maxima` proves it for boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from studies.at_most_four import folds, room

SHIFTS = (0.0, -1.0)
TOGETHER = 4_000
"""Vertices at a time."""
LOOKS = {
    "#e8e8e8": "the same vertices, numbered otherwise",
    "#c9c9c9": "two maxima on half a branch are not excluded here",
    "#a8c8e8": "one at most on each half, in double precision",
    "#1f4e8c": "proved: at most six states",
}
Leaf = tuple[list[float], list[float]]


def rooms(sectors: np.ndarray, branch: int, shift: float) -> np.ndarray:
    """Return the widest room for gamma at each place of half a branch, negative where there is none, [B, places].

    sectors: [B, 4] rad, numbered so that creases 1 and 2 reach 180 degrees; branch: 0 or 1, which of them does.
    """
    creases = folds(sectors, branch)
    speeds = [slope / slope[:1, :, :1] for slope, _ in creases]  # over about that at the flat state
    taylor = [factorial(k) for k in range(4)]

    def derivatives(x: np.ndarray) -> list[np.ndarray]:
        return [x[k] * taylor[k] for k in range(4)]

    u, v = derivatives(speeds[3]), derivatives(speeds[2] + shift * speeds[0])

    def minor(j: int, k: int) -> np.ndarray:
        return u[j] * v[k] - u[k] * v[j]

    side = np.sign(minor(0, 1))
    rows = []
    for i, (slope, fold) in enumerate(creases):
        if i == 3 or (i == 2 and not shift):  # the spring counts, not where it rests
            limits: Sequence[float] = (0.0,)
        else:
            limits = (np.pi / 2, -np.pi / 2)
        for limit in limits:
            from_rest = fold.copy()
            from_rest[0] -= limit
            product = [sum(slope[j] * from_rest[k - j] for j in range(k + 1)) for k in range(4)]
            w = derivatives(np.array(product))
            h = w[0] * minor(1, 2) - w[1] * minor(0, 2) + w[2] * minor(0, 1)
            more = w[0] * minor(1, 3) - w[1] * minor(0, 3) + w[3] * minor(0, 1)
            rows.append((side * h, side * more))
    return np.where((side == side[:, :1]) & (u[0] > 0), room(rows), -np.inf)


def one_on_each_half(sectors: np.ndarray) -> np.ndarray:
    """Return whether there is a gamma, with either shift, at all places of both branches of each vertex [B, 4], [B]."""
    found = np.zeros(len(sectors), bool)
    for first in range(0, len(sectors), TOGETHER):
        some = sectors[first : first + TOGETHER]
        found[first : first + TOGETHER] = np.all(
            [
                np.any([(rooms(some, branch, shift) > 0).all(axis=1) for shift in SHIFTS], axis=0)
                for branch in (0, 1)
            ],
            axis=0,
        )
    return found


def leaves(tree: str) -> list[Leaf]:
    """Return the boxes that a tree states as proved: ends [deg] of sectors 1 and 2 together, 1 and 4, and 1."""
    found: list[Leaf] = []
    open_: list[tuple[list[float], list[float], int]] = [([0.0] * 3, [360.0, 360.0, 180.0], 0)]
    for mark in tree:
        low, high, shown = open_.pop()
        if mark in "012":
            k = int(mark)
            middle = (low[k] + high[k]) / 2
            open_.append(([*low[:k], middle, *low[k + 1 :]], high, shown))
            open_.append((low, [*high[:k], middle, *high[k + 1 :]], shown))
        elif mark != "." and shown == 0:
            open_.append((low, high, 1))
        elif mark != ".":
            found.append((low, high))
    assert not open_
    return found


def draw_two_maxima(tree: str, slices: Sequence[int] = (30, 60)) -> Figure:
    """Draw proved boxes for two values of the first sector [deg], and all vertices where double precision sees it."""
    figure = Figure(figsize=(8.4, 4.4))
    figure.set_layout_engine("constrained", h_pad=0.1)
    boxes = leaves(tree)
    fine = np.arange(0.25, 180, 0.5)
    two, four = (x.ravel() for x in np.meshgrid(fine, fine, indexing="ij"))
    for axes, first in zip(figure.subplots(1, len(slices)), slices, strict=True):
        z = first + 0.5
        a = np.array([np.full(len(two), z), two, 360 - z - two - four, four]).T
        real = (a > 0).all(axis=1) & (a < 180).all(axis=1)
        leads = real & (abs(a[:, 0] - a[:, 3]) > abs(a[:, 1] - a[:, 2]))
        leads &= abs(a[:, 0] - a[:, 1]) > abs(a[:, 2] - a[:, 3])
        picture = np.where(real, 1.0, np.nan)
        picture[leads] = 2.0 + one_on_each_half(np.radians(a[leads]))
        for low, high in boxes:
            if low[2] <= z < high[2]:
                x, y = z + np.maximum(two, four) - low[1], z + np.minimum(two, four) - low[0]
                inside = (x >= 0) & (x < high[1] - low[1]) & (y >= 0) & (y < high[0] - low[0])
                picture[inside & leads] = 4.0
        axes.pcolormesh(
            fine,
            fine,
            picture.reshape(360, 360).T,
            cmap=ListedColormap([*LOOKS]),
            vmin=0.5,
            vmax=4.5,
        )
        axes.set(xlabel="second sector [deg]", ylabel="fourth sector [deg]", aspect="equal")
        axes.set_title(f"first sector {first}.5 deg", fontsize=10)
    marks = [Patch(color=colour, label=words) for colour, words in LOOKS.items()]
    figure.legend(handles=marks, loc="outside lower center", ncols=2, fontsize=8, frameon=False)
    return figure
