"""What a laser is to do, in mm, in order: creases, holes, cuts, and last the outline, each line once.

Dashes are segments of their own, since many programs ignore dashed strokes; a gap lies at both ends of each crease, so
that none meets another at a vertex.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.drawings.sheet import Drawing
from origami_nlp.numerics import INPUT_TOL

LAYERS = {"V": "VALLEY", "M": "MOUNTAIN", "U": "CREASE", "H": "HOLES", "C": "CUT", "B": "BORDER"}
"""Layers in the order in which they are done; what is inside comes before the outline that lets it go."""
GRID = 1e-6
"""Lengths [mm] are compared to this, so that rounding chooses no order."""

Point = tuple[float, float]


@dataclass(frozen=True)
class Stroke:
    """One movement of the laser.

    Attributes
    ----------
    layer
        Of `LAYERS`.
    points
        Corners [mm], y upwards; of a hole its centre.
    closed
        Whether it comes back to its first corner.
    radius
        Of a hole [mm]; 0 for lines.
    """

    layer: str
    points: tuple[Point, ...]
    closed: bool = False
    radius: float = 0.0


def laser_strokes(
    drawing: Drawing, dash: tuple[float, float] | None, holes: float
) -> tuple[list[Stroke], list[str]]:
    """Return what is to be done, in order, and what is left out.

    Parameters
    ----------
    drawing
        In mm.
    dash
        Length of a dash and of the gap after it [mm], at least; None: whole lines.
    holes
        Radius at each vertex inside the paper where creases meet [mm]; creases end there.

    Returns
    -------
    list of Stroke
        By layer, in each layer the nearest next.
    list of str
        Notes.
    """
    letters = np.array(drawing.letters)
    notes = []
    flat = int(np.isin(letters, ("F", "J")).sum())
    if flat:
        notes.append(f"{flat} flat edges (F) are no creases: left out")
    inside = _inside(drawing) if holes else np.zeros(0, int)
    strokes: list[Stroke] = []
    short = 0
    for letter in "VMU":
        here = drawing.edges[letters == letter]
        plain = dash is None and not holes
        lines = _runs(drawing.points, here) if plain else [tuple(e) for e in here.tolist()]
        for a, b in lines:
            trim = [holes * bool(np.isin(v, inside)) for v in (a, b)]
            pieces, cramped = _pieces(drawing.points[a], drawing.points[b], trim, dash)
            short += cramped
            strokes += [Stroke(letter, piece) for piece in pieces]
    if short:
        notes.append(f"{short} creases are shorter than a dash and two gaps: their dash is shorter")
    strokes += [Stroke("H", (_point(drawing.points[v]),), True, holes) for v in inside]
    for letter in "CB":
        strokes += _outlines(drawing.points, drawing.edges[letters == letter], letter)
    return _ordered(strokes), notes


def _point(p: np.ndarray) -> Point:
    return (float(p[0]), float(p[1]))


def _inside(drawing: Drawing) -> np.ndarray:
    """Return the vertices at which creases meet and no border or cut ends."""
    letters = np.array(drawing.letters)
    rim = np.isin(letters, ("B", "C"))
    creases = np.bincount(
        drawing.edges[np.isin(letters, list("MVU"))].ravel(), minlength=len(drawing.points)
    )
    return np.setdiff1d(np.flatnonzero(creases > 2), drawing.edges[rim])


def _runs(points: np.ndarray, edges: np.ndarray) -> list[tuple[int, int]]:
    """Return the ends of straight lines, edges that go straight on in each other joined."""
    at: dict[int, list[int]] = {}
    for e, (a, b) in enumerate(edges.tolist()):
        at.setdefault(a, []).append(e)
        at.setdefault(b, []).append(e)
    after: dict[
        tuple[int, int], int
    ] = {}  # of an edge and the vertex that it arrives at, the edge that goes on
    for v, several in at.items():
        d = points[edges[several].sum(axis=1) - v] - points[v]
        d /= np.linalg.norm(d, axis=1, keepdims=True)
        cosine = d @ d.T
        for i, j in zip(*np.nonzero(np.triu(cosine < -1.0 + INPUT_TOL**1.5, 1)), strict=True):
            after[several[i], v], after[several[j], v] = several[j], several[i]
    lines, done = [], set()
    for e, (a, b) in enumerate(edges.tolist()):
        if e in done:
            continue
        ends = []
        for v in (a, b):
            here = e
            while (here, v) in after and after[here, v] != e:
                here = after[here, v]
                done.add(here)
                v = int(edges[here].sum()) - v
            ends.append(v)
        done.add(e)
        lines.append((ends[0], ends[1]))
    return lines


def _pieces(
    p: np.ndarray, q: np.ndarray, trim: Sequence[float], dash: tuple[float, float] | None
) -> tuple[list[tuple[Point, ...]], bool]:
    """Return the dashes of a line, and whether it is too short for one with its gaps."""
    length = float(np.linalg.norm(q - p))
    along = (q - p) / length
    first, last = trim[0], length - trim[1]
    if last <= first:
        return [], True
    if dash is None:
        return [(_point(p + first * along), _point(p + last * along))], False
    on, gap = dash
    whole = last - first
    many = math.floor((whole - gap) / (on + gap) + GRID)
    cramped = many < 1
    if cramped:
        many, on = 1, whole * on / (on + 2 * gap)
    space = (whole - many * on) / (many + 1)  # gaps are all alike, and no shorter than asked
    starts = first + space + np.arange(many) * (on + space)
    return [(_point(p + s * along), _point(p + (s + on) * along)) for s in starts], cramped


def _outlines(points: np.ndarray, edges: np.ndarray, letter: str) -> list[Stroke]:
    """Return chains of edges, closed where they come back, without corners on straight lines."""
    if not len(edges):
        return []
    from shapely import line_merge, multilinestrings

    merged = line_merge(multilinestrings(points[edges]))
    found = []
    for line in getattr(merged, "geoms", [merged]):
        chain = np.array(line.coords)
        closed = len(chain) > 3 and bool((chain[0] == chain[-1]).all())
        found.append(Stroke(letter, _corners(chain, closed), closed))
    return found


def _corners(chain: np.ndarray, closed: bool) -> tuple[Point, ...]:
    if closed:
        chain = chain[:-1]
    before, after = np.roll(chain, 1, axis=0), np.roll(chain, -1, axis=0)
    d, e = chain - before, after - chain
    turn = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    keep = np.abs(turn) > INPUT_TOL * np.linalg.norm(d, axis=1) * np.linalg.norm(e, axis=1)
    if not closed:
        keep[[0, -1]] = True
    return tuple(_point(p) for p in chain[keep])


def _ordered(strokes: list[Stroke]) -> list[Stroke]:
    """Return strokes by layer, outlines from the smallest to the largest, others each followed by the nearest."""
    done: list[Stroke] = []
    here = np.zeros(2)
    for letter in LAYERS:
        rest = [s for s in strokes if s.layer == letter]
        if letter == "B":
            done += sorted(rest, key=lambda s: (round(_area(s) / GRID), s.points))
            continue
        if not rest:
            continue
        ends = np.array([(s.points[0], s.points[-1]) for s in rest])
        left = np.ones(len(rest), bool)
        for _ in rest:
            off = np.round(np.linalg.norm(ends - here, axis=2) / GRID)
            off[~left] = np.inf
            k, backwards = divmod(int(off.argmin()), 2)
            left[k] = False
            one = rest[k]
            if backwards:
                one = Stroke(letter, one.points[::-1], one.closed, one.radius)
            done.append(one)
            here = np.array(one.points[0 if one.closed else -1])
    return done


def _area(stroke: Stroke) -> float:
    p = np.array(stroke.points)
    q = np.roll(p, -1, axis=0)
    return abs(float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())) / 2
