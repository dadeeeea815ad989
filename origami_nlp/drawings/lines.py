"""Lines as a drawing states them: two ends, a letter, perhaps a fold angle; nothing is repaired yet."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_number, check_whole, shown
from origami_nlp.errors import DrawingError, OptionError

LETTERS = "BCMVUF"
"""What a line may be, as in FOLD: border, cut, mountain, valley, unassigned, flat."""
MOST_LINES = 200_000
"""Of one drawing; the largest published ones have some ten thousand."""

ERROR_KEY = "origaminlp:coordinateError"
"""How far the vertices of a frame may be off, in the unit of the file: what a tolerance joined."""


@dataclass(frozen=True)
class DrawingOptions:
    """What a person may say of a drawing that the drawing does not.

    Attributes
    ----------
    tolerance
        Share of the sheet within which ends are one point; None: the smallest at which the drawing is whole.
    letters
        By colour (``"#EE1032"``, ``"orange"``) or DXF layer, one of B, C, M, V, U, F; or ``"-"``, to leave it out.
    curves
        ``"refuse"``, or ``"leave"`` (out).
    part
        Which of several sheets, from 1, the largest first; None: all of them.

    Raises
    ------
    OptionError
        If a value is none of these.

    Examples
    --------
    >>> import origami_nlp as o
    >>> o.DrawingOptions(letters={"#EE1032": "M", "orange": "-"}, curves="leave").letters["#EE1032"]
    'M'
    """

    tolerance: float | None = None
    letters: Mapping[str, str] = field(default_factory=dict)
    curves: str = "refuse"
    part: int | None = None

    def __post_init__(self) -> None:
        if self.tolerance is not None:
            check_number("tolerance", self.tolerance, math.ulp(0.0), 0.1)
        if self.curves not in ("refuse", "leave"):
            raise OptionError(f"curves = {shown(self.curves)} must be refuse or leave")
        if self.part is not None:
            check_whole("part", self.part, 1)
        for key, letter in self.letters.items():
            if letter not in (*LETTERS, "-"):
                raise OptionError(f"colour {key!r} = {letter!r} must be one of {LETTERS} or -")


@dataclass(frozen=True, eq=False)
class Lines:
    """What a drawing states.

    Attributes
    ----------
    ends
        Points, [n, 2, 2], y upwards.
    letters
        One a line, as in FOLD.
    angles
        Fold angles [deg], valley positive, [n]; NaN where none is stated.
    y_down
        Whether the file's own y points down: places are named as they are in the file.
    title
        Of the drawing, or "".
    notes
        What was left out, one line each.
    length_unit
        As in ``frame_unit``; "" where the file states none.
    """

    ends: np.ndarray = field(repr=False)
    letters: tuple[str, ...] = field(repr=False)
    angles: np.ndarray = field(repr=False)
    y_down: bool
    title: str = ""
    notes: tuple[str, ...] = ()
    length_unit: str = ""

    def place(self, point: np.ndarray) -> str:
        """Write a point as it is in the file."""
        y = -point[1] if self.y_down else point[1]
        return f"({point[0] + 0.0:.6g}, {y + 0.0:.6g})"


class LineList:
    """Lines as they come from a file, and what is left out of them.

    Parameters
    ----------
    name
        Of the file, for complaints.
    options
        What a person says of it.
    """

    def __init__(self, name: str, options: DrawingOptions) -> None:
        self.name, self.options = name, options
        self.drawn: list[tuple[tuple[float, ...], str, float]] = []
        self.notes: list[str] = []
        self.unknown, self.left_out = Counter[str](), Counter[str]()
        self.broken: list[str] = []
        self.length_unit = ""
        self._used: set[str] = set()
        self._asked = {k.strip().lower(): v for k, v in options.letters.items()}

    def letter(self, key: str, known: str | None) -> str | None:
        """Return the letter of a colour or layer, `known` unless a person says it; what nobody knows is counted."""
        if (asked := self._asked.get(key.lower())) is not None:
            self._used.add(key.lower())
            return None if asked == "-" else asked
        if known is None:
            self.unknown[key] += 1
        return known

    def is_asked(self, key: str) -> bool:
        """Return whether a person says what this colour or layer is."""
        return key.lower() in self._asked

    def draw(
        self, key: str, known: str | None, points: Sequence[Sequence[float]], where: str
    ) -> None:
        """Add a chain of lines whose letter a code says, without fold angles."""
        if (letter := self.letter(key, known)) is not None:
            self.add(points, letter, math.nan, where)

    def add(self, points: Sequence[Sequence[float]], letter: str, angle: float, where: str) -> None:
        """Add a chain of lines through points; those that are no numbers are left out."""
        for a, b in itertools.pairwise(points):
            ends = tuple(map(float, (*a, *b)))
            if np.isfinite(ends).all() and max(map(abs, ends)) <= 1e50:
                self.drawn.append((ends, letter, angle))
            else:
                self.broken.append(where)
        if len(self.drawn) > MOST_LINES:
            raise DrawingError(f"{self.name} has more than {MOST_LINES} lines: no crease pattern")

    def lines(self, kinds: str, y_down: bool, title: str = "") -> Lines:
        """Return them; kinds: what distinguishes lines, such as "colours"."""
        for asked in sorted({*self._asked} - self._used):
            raise DrawingError(f"{self.name} has no line of {asked!r}")
        if self.left_out["curves"] and self.options.curves == "refuse":
            many = f"{self.left_out['curves']} curves"
            raise DrawingError(f"{self.name} has {many}: --curves leave takes straight lines alone")
        unknown = self.unknown.most_common()
        shown = ", ".join(f"{n} of {key}" for key, n in unknown[:6]) + ", ..." * (len(unknown) > 6)
        others = [f"{many} {what} left out" for what, many in sorted((+self.left_out).items())]
        if unknown:
            say = f"{kinds} that do not say what they are: {shown}; --colour '{unknown[0][0]}=M' says it"
            others.insert(0, f"left out, for {say}")
        if self.broken:
            others.append(
                f"{len(self.broken)} lines left out, not readable: first {self.broken[0]}"
            )
        if not self.drawn:
            raise DrawingError("; ".join([f"{self.name} has no lines to fold", *others]))
        ends, letters, angles = zip(*self.drawn, strict=True)
        if not {*letters} & {*"MV"}:
            others.append("no mountain or valley is drawn")
        x = np.array(ends).reshape(-1, 2, 2) * [1.0, -1.0 if y_down else 1.0] + 0.0
        notes = (*self.notes, *others)
        return Lines(x, letters, np.array(angles), y_down, title, notes, self.length_unit)
