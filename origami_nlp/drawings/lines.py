"""Lines as a drawing states them: two ends, a letter, perhaps a fold angle; nothing is repaired yet."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_number, check_whole, did_you_mean, shown
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
                raise OptionError(
                    f"colour {key!r} = {letter!r} must be one of {', '.join(LETTERS)} or -"
                )


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
        self.ends: list[tuple[float, float, float, float]] = []
        self.letters: list[str] = []
        self.angles: list[float] = []
        self.notes: list[str] = []
        self.unknown: Counter[str] = Counter()
        self.left_out: Counter[str] = Counter()
        self.broken: list[str] = []
        self.length_unit = ""
        self._used: set[str] = set()
        self._asked = {k.strip().lower(): v for k, v in options.letters.items()}

    def letter(self, key: str, known: Callable[[str], str | None]) -> str | None:
        """Return the letter of a colour or layer; what nobody knows is counted."""
        if (asked := self._asked.get(key.lower())) is not None:
            self._used.add(key.lower())
            return None if asked == "-" else asked
        found = known(key)
        if found is None:
            self.unknown[key] += 1
        return found

    def is_asked(self, key: str) -> bool:
        """Return whether a person says what this colour or layer is."""
        return key.lower() in self._asked

    def add(self, points: Sequence[Sequence[float]], letter: str, angle: float, where: str) -> None:
        """Add a chain of lines through points; those that are no numbers are left out."""
        for (x0, y0), (x1, y1) in itertools.pairwise(points):
            ends = (float(x0), float(y0), float(x1), float(y1))
            if not np.isfinite(ends).all() or max(map(abs, ends)) > 1e50:
                self.broken.append(where)
                continue
            self.ends.append(ends)
            self.letters.append(letter)
            self.angles.append(angle)
        if len(self.ends) > MOST_LINES:
            raise DrawingError(f"{self.name} has more than {MOST_LINES} lines: no crease pattern")

    def lines(self, kinds: str, y_down: bool, title: str = "") -> Lines:
        """Return them; kinds: what distinguishes lines, such as "colours"."""
        asked = set(self._asked) - self._used
        if asked:
            one = sorted(asked)[0]
            meant = did_you_mean(one, [*self.unknown, *self._used])
            raise DrawingError(f"{self.name} has no line of {one!r}{meant}")
        if self.left_out["curves"] and self.options.curves == "refuse":
            raise DrawingError(
                f"{self.name} has {self.left_out['curves']} curves: creases are straight. Leave them out with "
                "--curves leave, or redraw them"
            )
        known, unknown = len(self.ends), self.unknown.most_common()
        shown = ", ".join(f"{n} of {key}" for key, n in unknown[:6])
        shown += f" and {len(unknown) - 6} others" if len(unknown) > 6 else ""
        if not known:
            if unknown:
                raise DrawingError(
                    f"{self.name} has no line in {kinds} that say what it is, only {shown}: say it, such as "
                    f"--colour '{unknown[0][0]}=M'"
                )
            others = "".join(f"; {n} {what} left out" for what, n in (+self.left_out).items())
            raise DrawingError(f"{self.name} has no lines: nothing to fold{others}")
        if unknown:
            self.notes.append(
                f"left out, for {kinds} that do not say what they are: {shown}; --colour '{unknown[0][0]}=M' takes "
                "them for mountains"
            )
        if self.broken:
            self.notes.append(
                f"{len(self.broken)} lines left out, not readable or without finite coordinates: first "
                f"{self.broken[0]}"
            )
        for what, many in sorted((+self.left_out).items()):
            self.notes.append(f"{many} {what} left out")
        if not {*self.letters} & {*"MV"}:
            self.notes.append("no mountain or valley is drawn")
        ends = np.array(self.ends).reshape(-1, 2, 2)
        if y_down:
            ends = ends * [1.0, -1.0] + 0.0  # no minus zeros
        return Lines(
            ends,
            tuple(self.letters),
            np.array(self.angles),
            y_down,
            title,
            tuple(self.notes),
            self.length_unit,
        )
