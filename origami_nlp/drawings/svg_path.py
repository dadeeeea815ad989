"""The path of an SVG as chains of points: what is straight of it, curves counted."""

from __future__ import annotations

from contextlib import suppress

STRAIGHT = 1e-6
"""Share of its chord by which the handles of a straight curve may be off it: drawing programs write lines so."""

Point = tuple[float, float]


def path_chains(d: str) -> tuple[list[list[Point]], int]:
    """Return the chains of points of a path, and how many of its pieces are curves, which are left out.

    Parameters
    ----------
    d
        The path, as SVG writes it; what comes after an error is not drawn, as browsers do.

    Returns
    -------
    list of list of tuple
        Points (x, y).
    int
        Curves, those not counted whose handles lie on their chord.

    Examples
    --------
    >>> path_chains("M1 1h2v3z")
    ([[(1.0, 1.0), (3.0, 1.0), (3.0, 4.0), (1.0, 1.0)]], 0)
    >>> path_chains("M0 0 Q1 1 2 0 L3 0")
    ([[(2.0, 0.0), (3.0, 0.0)]], 1)
    """
    from fontTools.svgLib.path.parser import parse_path

    pen = _Pen()
    with suppress(ValueError, IndexError, TypeError):
        parse_path(d, pen)
    return [chain for chain in pen.chains if len(chain) > 1], pen.curves


class _Pen:
    """What the parser of fontTools draws with."""

    def __init__(self) -> None:
        self.chains: list[list[Point]] = []
        self.curves = 0

    def moveTo(self, to: Point) -> None:
        self.chains.append([to])

    def closePath(self) -> None:
        self.chains.append([self.chains[-1][-1]])  # what follows begins where the outline did

    def endPath(self) -> None:
        pass

    def lineTo(self, to: Point) -> None:
        self.chains[-1].append(to)

    def curveTo(self, *points: Point) -> None:
        if _is_straight(*(complex(*p) for p in (self.chains[-1][-1], *points))):
            self.lineTo(points[-1])
        else:
            self.curves += 1
            self.moveTo(points[-1])

    qCurveTo = curveTo

    def arcTo(self, rx: float, ry: float, turn: float, large: bool, far: bool, to: Point) -> None:
        self.curves += 1
        self.moveTo(to)


def _is_straight(here: complex, *points: complex) -> bool:
    *handles, to = points
    chord = to - here
    if not chord:
        return all(h == here for h in handles)
    along = [(h - here) / chord for h in handles]
    return all(abs(z.imag) <= STRAIGHT and -STRAIGHT <= z.real <= 1 + STRAIGHT for z in along)
