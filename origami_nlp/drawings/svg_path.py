"""The path of an SVG as chains of points: straight pieces as they are, curves as chords of equal steps."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from contextlib import suppress

STRAIGHT = 1e-6
"""Share of its chord by which the handles of a straight curve may be off it: drawing programs write lines so."""

Point = tuple[float, float]
Chain = list[Point]


def path_chains(d: str, chords: int) -> tuple[list[Chain], int]:
    """Return the chains of points of a path, and how many of its pieces are curves.

    Parameters
    ----------
    d
        The path, as SVG writes it; what comes after an error is not drawn, as browsers do.
    chords
        For each curve; 0 leaves them out.

    Returns
    -------
    list of list of tuple
        Points (x, y).
    int
        Curves, those not counted whose handles lie on their chord.

    Examples
    --------
    >>> path_chains("M1 1h2v3z", 0)
    ([[(1.0, 1.0), (3.0, 1.0), (3.0, 4.0), (1.0, 1.0)]], 0)
    >>> path_chains("M0 0 Q1 1 2 0", 2)
    ([[(0.0, 0.0), (1.0, 0.5), (2.0, 0.0)]], 1)
    """
    from fontTools.svgLib.path.parser import parse_path

    pen = _Pen(chords)
    with suppress(ValueError, IndexError, TypeError):
        parse_path(d, pen)
    return [[(z.real, z.imag) for z in chain] for chain in pen.chains if len(chain) > 1], pen.curves


class _Pen:
    """What the parser of fontTools draws with."""

    def __init__(self, chords: int) -> None:
        self.chords, self.curves = chords, 0
        self.chains: list[list[complex]] = []

    def moveTo(self, to: Point) -> None:
        self.chains.append([complex(*to)])

    def closePath(self) -> None:
        self.chains.append([self._here])  # what follows begins where the outline did

    def endPath(self) -> None:
        pass

    def lineTo(self, to: Point) -> None:
        self.chains[-1].append(complex(*to))

    @property
    def _here(self) -> complex:
        return self.chains[-1][-1]

    def curveTo(self, *points: Point) -> None:
        *handles, to = (complex(*p) for p in points)
        straight = _is_straight(self._here, handles, to)
        self._draw(None if straight else _bezier([self._here, *handles, to]), to)

    qCurveTo = curveTo

    def arcTo(
        self, rx: float, ry: float, turn: float, large: bool, sweep: bool, end: Point
    ) -> None:
        here, to = self._here, complex(*end)
        curved = bool(rx and ry and to != here)
        radii = abs(rx), abs(ry), math.radians(turn)
        self._draw(_arc(here, *radii, bool(large), bool(sweep), to) if curved else None, to)

    def _draw(self, curve: Callable[[float], complex] | None, to: complex) -> None:
        self.curves += curve is not None
        if curve is None:
            self.chains[-1].append(to)
        elif self.chords:
            self.chains[-1] += [curve(i / self.chords) for i in range(1, self.chords)] + [to]
        else:
            self.chains.append([to])


def _is_straight(here: complex, handles: list[complex], to: complex) -> bool:
    chord = to - here
    if not chord:
        return all(h == here for h in handles)
    along = [(h - here) / chord for h in handles]
    return all(abs(z.imag) <= STRAIGHT and -STRAIGHT <= z.real <= 1 + STRAIGHT for z in along)


def _bezier(points: list[complex]) -> Callable[[float], complex]:
    n = len(points) - 1

    def at(t: float) -> complex:
        return sum(
            (math.comb(n, i) * (1 - t) ** (n - i) * t**i * p for i, p in enumerate(points)), 0j
        )

    return at


def _arc(
    here: complex, rx: float, ry: float, turn: float, large: bool, sweep: bool, to: complex
) -> Callable[[float], complex]:
    """Return the points of an elliptical arc (SVG 1.1, appendix F.6.5: from endpoints to the centre)."""
    axes = cmath.rect(1.0, turn)

    def circle(z: complex) -> complex:  # where the ellipse is the unit circle
        z /= axes
        return complex(z.real / rx, z.imag / ry)

    a, b = circle(here), circle(to)
    half = abs(b - a) / 2
    scale = max(1.0, half)  # radii that do not reach grow
    a, b, half = a / scale, b / scale, half / scale
    side = 1.0 if large != sweep else -1.0
    centre = (a + b) / 2 + side * 1j * (b - a) / (2 * half) * math.sqrt(max(0.0, 1.0 - half**2))
    first = cmath.phase(a - centre)
    span = (cmath.phase(b - centre) - first) % (2 * math.pi)
    if not sweep:
        span -= 2 * math.pi

    def at(t: float) -> complex:
        z = scale * (centre + cmath.rect(1.0, first + t * span))
        return complex(z.real * rx, z.imag * ry) * axes

    return at
