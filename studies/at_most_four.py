"""Boxes of vertices of degree 4 whose energy is likely to have one maximum a branch, whatever the springs.

With p the fold opposite to the crease that reaches 180 degrees on a branch, f = U'(p) and the springs of the three
other creases at rest at -180 or 180 degrees, f'' is a mixture of six functions g.  Where a number gamma makes
g' + gamma g > 0 for all six, f'' rises through 0.  If that is so at all places, f has three zeros at most and U one
maximum.  This is looked at here in double precision, at some places and at the middle of boxes;
`tests/independent/one_maximum` proves it, or refuses, for all of a box.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

PLACES = (np.arange(24) + 0.5) * 1.56 / 24
"""theta, from 0 (flat) to pi/2: tan(theta/2) is the parameter t of the closed form."""
ORDER = 6
EQUAL = 1e-9
"""Sectors [rad] that differ by less are taken as equal."""
ROOM = 1.0
"""Room for gamma next to the flat state; boxes of a degree with less are refused."""
TOGETHER = 4_000
"""Vertices at a time."""
COLOURS = ListedColormap(["#e8e8e8", "#c9c9c9", "#a8c8e8"])
Box = tuple[int, int, int]


def _times(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.array([sum(a[j] * b[k - j] for j in range(k + 1)) for k in range(len(a))])


def _over(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    out: list[Any] = []
    for k in range(len(a)):
        out.append((a[k] - sum(out[j] * b[k - j] for j in range(k))) / b[0])
    return np.array(out)


def _slope(a: np.ndarray) -> np.ndarray:
    k = np.arange(1, len(a)).reshape(-1, 1, 1)
    return np.concatenate([k * a[1:], 0 * a[:1]])


def folds(sectors: np.ndarray, branch: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return half the slope and half the fold of each crease, the leading one first, as power series in theta.

    sectors: [B, 4] rad, numbered so that creases 1 and 2 reach 180 degrees; branch: 0 or 1, which of them does.
    Each [`ORDER`, B, places].
    """
    s1, s2, s3, s4 = np.sin(sectors.T)[:, :, None]
    q, other, tanh2 = s1 * s4 / (s2 * s3), s1 * s2 / (s3 * s4), s1 * s3 / (s2 * s4)
    if branch:
        q, other = other, q
    k = np.arange(ORDER)[:, None, None]
    factorial = np.cumprod(np.maximum(k, 1), axis=0)
    shape = (ORDER, len(sectors), len(PLACES))
    sine = np.broadcast_to(np.sin(PLACES + k * np.pi / 2) / factorial, shape)
    cosine = np.broadcast_to(np.cos(PLACES + k * np.pi / 2) / factorial, shape)

    def rate(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of a fold with tan(phi/2) = sin/(a + b cos)."""
        below = b * cosine
        below[0] += a
        top = a * cosine
        top[0] += b
        slope = _over(top, _times(sine, sine) + _times(below, below))
        whole = np.concatenate([np.arctan2(sine[:1], below[:1]), slope[:-1] / k[1:]])
        return slope, whole

    b2 = np.sqrt((1 - other) / (1 - tanh2))
    b4 = b2 / np.sqrt(other)
    zero, tanh = 0 * q, np.sqrt(tanh2)
    opposite = np.sqrt((1 - q) / q), zero
    leading, one, two = (zero, np.sqrt(1 - q)), (tanh * b2, b2), (b4, tanh * b4)
    return [rate(*ab) for ab in (leading, one, opposite, two)]


def gammas(sectors: np.ndarray, branch: int) -> np.ndarray:
    """Return the widest room for gamma at each place, negative where there is none, [B, places].

    sectors, branch: as `folds`.
    """
    leading, one, (along, _), two = folds(sectors, branch)
    rows = []
    for slope, fold in (leading, one, two):
        for limit in (np.pi / 2, -np.pi / 2):
            from_rest = fold.copy()
            from_rest[0] -= limit
            g = _over(_times(from_rest, slope), along)
            for _ in range(2):
                g = _over(_slope(g), along)
            rows.append((g[0], g[1]))
    return room(rows)


def room(rows: list[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Return the widest room for gamma with g' + gamma g > 0 for all (g, g'), negative where there is none."""
    low, high = np.array(-np.inf), np.array(np.inf)
    for g, more in rows:
        with np.errstate(all="ignore"):
            ratio = -more / g
        low = np.where(g > 0, np.maximum(low, ratio), low)
        high = np.where(g < 0, np.minimum(high, ratio), high)
    return np.asarray(high - low)


def holds(sectors: np.ndarray, room: float = 0.0) -> np.ndarray:
    """Return whether there is a gamma at all places of both branches of each vertex [B, 4] (rad, as `gammas`), [B].

    room: more of it than this is asked for next to the flat state.
    """
    found = np.zeros(len(sectors), bool)
    for first in range(0, len(sectors), TOGETHER):
        some = sectors[first : first + TOGETHER]
        wide = [gammas(some, branch) for branch in (0, 1)]
        both = [(w > 0).all(axis=1) & (w[:, 0] > room) for w in wide]
        found[first : first + TOGETHER] = both[0] & both[1]
    return found


def middles(boxes: np.ndarray, width: Fraction) -> np.ndarray:
    """Return sectors [B, 4] (rad) at the middle of boxes [B, 3]: widths that sectors 1, 2 and 4 are at least."""
    one, two, four = (boxes.T + 0.5) * float(width)
    return np.radians([one, two, 360 - one - two - four, four]).T


def candidates(width: Fraction, coarse: int = 2) -> Iterator[Box]:
    """Yield boxes at whose middle it holds with `ROOM`; looked for around those of `coarse` times the width.

    Of two vertices that are mirror images the one whose second sector is not the larger one.
    """
    around = np.array([*product((-1, 0, 1), repeat=3)])
    inside = np.array([*product(range(coarse), repeat=3)])
    wide = _held(_all(width * coarse), width * coarse, 0.0)
    near = np.unique((wide[:, None] + around).reshape(-1, 3), axis=0)
    some = np.unique((near[:, None] * coarse + inside).reshape(-1, 3), axis=0)
    held = _held(some, width, ROOM).tolist()
    yield from ((one, two, four) for one, two, four in held)


def _all(width: Fraction) -> np.ndarray:
    n = int(180 / width)
    return np.argwhere(np.ones((n, n, n), bool))


def _held(boxes: np.ndarray, width: Fraction, room: float) -> np.ndarray:
    """Of boxes those numbered as they are to be, mirror images once, at whose middle it holds."""
    boxes = boxes[(boxes[:, 1] <= boxes[:, 2]) & (boxes >= 0).all(axis=1)]
    a, b, c, d = middles(boxes, width).T
    inside = np.min([a, b, c, d], axis=0) > 0, np.max([a, b, c, d], axis=0) < np.pi
    leads = abs(a - d) > abs(b - c) + EQUAL, abs(a - b) > abs(c - d) + EQUAL
    boxes = boxes[np.all([*inside, *leads], axis=0)]
    return np.asarray(boxes[holds(middles(boxes, width), room)])


def draw_boxes(boxes: Sequence[Box], width: Fraction, slices: Sequence[int] = (45, 140)) -> Figure:
    """Draw boxes for two values of the first sector [deg]: those listed, and all vertices where it holds."""
    figure = Figure(figsize=(8.4, 4.2), layout="constrained")
    listed = {*boxes, *((one, four, two) for one, two, four in boxes)}
    fine = np.arange(0.5, 180)
    two, four = (x.ravel() for x in np.meshgrid(fine, fine, indexing="ij"))
    for axes, first in zip(figure.subplots(1, len(slices)), slices, strict=True):
        a = np.array([np.full(len(two), first + 0.5), two, 359.5 - first - two - four, four]).T
        real = (a > 0).all(axis=1) & (a < 180).all(axis=1)
        leads = real & (abs(a[:, 0] - a[:, 3]) > abs(a[:, 1] - a[:, 2]))
        leads &= abs(a[:, 0] - a[:, 1]) > abs(a[:, 2] - a[:, 3])
        picture = np.where(real, 1.0, np.nan)
        picture[leads] = 2.0 + holds(np.radians(a[leads]))
        here = [(t + 0.5, f + 0.5) for one, t, f in listed if one * width == first]
        axes.pcolormesh(fine, fine, picture.reshape(180, 180).T, cmap=COLOURS, vmin=0.5, vmax=3.5)
        if here:
            axes.plot(*np.array(here).T * float(width), "s", ms=1.6, mew=0, color="#1f4e8c")
        axes.set(xlabel="second sector [deg]", ylabel="fourth sector [deg]", aspect="equal")
        axes.set_title(f"first sector {first} to {first + 1} deg", fontsize=10)
    looks = [("#e8e8e8", "other numberings"), ("#c9c9c9", "two maxima are not excluded here")]
    looks += [
        ("#a8c8e8", "one maximum a branch, in double precision"),
        ("#1f4e8c", "proved: at most four states"),
    ]
    marks = [Patch(color=colour, label=words) for colour, words in looks]
    figure.legend(handles=marks, loc="outside lower center", ncols=2, fontsize=8, frameon=False)
    return figure
