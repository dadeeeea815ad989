"""The path of an SVG as chains of points: straight pieces as they are, curves as chords of equal steps."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_COMMAND = re.compile(r"([MLHVCSQTAZ])([^MLHVCSQTAZ]*)", re.I)
_ARC = re.compile(r"[\s,]*".join([*[f"({NUMBER})"] * 3, "([01])", "([01])", *[f"({NUMBER})"] * 2]))
TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
STRAIGHT = 1e-6
"""Share of its chord by which the handles of a straight curve may be off it: drawing programs write lines so."""

Chain = list[tuple[float, float]]


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
    chains: list[list[complex]] = []
    here = start = handle = 0j
    before, curves = "", 0
    for command, text in _COMMAND.findall(d):
        kind = command.upper()
        base = command.islower()
        if kind == "A":
            rows = [[float(w) for w in m.groups()] for m in _ARC.finditer(text)]
        else:
            numbers = [float(w) for w in re.findall(NUMBER, text)]
            many = TAKES[kind]
            rows = (
                [numbers[i : i + many] for i in range(0, len(numbers) - many + 1, many)]
                if many
                else [[]]
            )
        for k, row in enumerate(rows):
            origin = here if base else 0j
            if kind == "Z":
                if chains and here != start:
                    chains[-1].append(start)
                here = handle = start
                before = "Z"
                continue
            if kind == "H":
                to = complex(row[0] + origin.real, here.imag)
            elif kind == "V":
                to = complex(here.real, row[0] + origin.imag)
            else:
                to = complex(row[-2], row[-1]) + origin
            if kind == "M" and k == 0:
                chains.append([to])
                start = here = handle = to
                before = "M"
                continue
            if not chains:
                return [], curves
            if before == "Z":
                chains.append([start])
            smooth = 2 * here - handle
            curve: Callable[[float], complex] | None = None
            handle = to
            if kind in "CSQT":
                given = [complex(*row[i : i + 2]) + origin for i in range(0, len(row) - 2, 2)]
                if kind == "S":
                    given = [smooth if before in "CS" else here, *given]
                elif kind == "T":
                    given = [smooth if before in "QT" else here]
                handle = given[-1]
                if not _is_straight(here, given, to):
                    curve = _bezier([here, *given, to])
            elif kind == "A" and row[0] and row[1] and to != here:
                turn, large, sweep = math.radians(row[2]), bool(row[3]), bool(row[4])
                curve = _arc(here, abs(row[0]), abs(row[1]), turn, large, sweep, to)
            curves += curve is not None
            if curve is None:
                chains[-1].append(to)
            elif chords:
                chains[-1] += [curve(i / chords) for i in range(1, chords)] + [to]
            else:
                chains.append([to])
            here, before = to, kind
    return [[(z.real, z.imag) for z in chain] for chain in chains if len(chain) > 1], curves


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
