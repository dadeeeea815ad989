"""What a check looked at, and what is wrong there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from origami_nlp.display import shown
from origami_nlp.numerics import NOISE, PLACES
from origami_nlp.pattern import Frame

MILLI = 1e-3
"""Of a degree: fold angles of which no smaller part is stated have three decimals; as a share of the sheet, the most
that layers may be apart."""
PLACED = 9
"""Decimals of places, over the size of the frame: beyond that is rounding."""

LENGTHS, PLANES = "lengths as in the crease pattern", "plane faces"
ANGLES, LETTERS = "fold angles as in the coordinates", "mountains and valleys as folded"
ROUND, FLAT = "flat round every vertex", "flat edges are flat"
CLOSES, CROSSINGS = "closes round vertices and holes", "no faces pass through each other"
KAWASAKI, MAEKAWA = "Kawasaki", "Maekawa"
UNITS = dict.fromkeys((LENGTHS, PLANES, CROSSINGS), "length")
UNITS |= dict.fromkeys((ANGLES, LETTERS, ROUND, FLAT, CLOSES, KAWASAKI), "rad")
"""Of the sizes of the faults of a test."""

Status = Literal["ok", "fault", "not decided", "does not apply"]


@dataclass(frozen=True)
class Fault:
    """Something that is wrong with a frame; vertices, edges and faces are numbered from 0 as in the file.

    Attributes
    ----------
    test
        What found it.
    text
        What is wrong, in a sentence.
    frame
        Of the file.
    vertices, edges, faces
        Where it is.
    place
        A point there, in the coordinates of the frame; empty where there is none.
    size
        How much, in the unit of `unit`; None where there is no measure of it.
    unit
        ``"length"`` in that of the file, ``"rad"``, or ``""`` for a share.
    """

    test: str = field(metadata=shown())
    text: str = field(metadata=shown())
    frame: int = field(metadata=shown())
    vertices: tuple[int, ...] = field(default=(), metadata=shown())
    edges: tuple[int, ...] = field(default=(), metadata=shown())
    faces: tuple[int, ...] = field(default=(), metadata=shown())
    place: tuple[float, ...] = field(default=(), metadata=shown())
    size: float | None = field(default=None, metadata=shown())
    unit: str = field(default="", metadata=shown())


STYLES = {"fault": "red", "not decided": "yellow", "does not apply": "dim"}


@dataclass(frozen=True)
class Test:
    """One thing that was asked of a frame.

    Attributes
    ----------
    name
        What was asked.
    frame
        Of the file.
    status
        The answer.
    text
        What was looked at, or why it is not decided or does not apply.
    """

    name: str = field(metadata=shown("test"))
    frame: int = field(metadata=shown("frame"))
    status: Status = field(metadata=shown("answer", styles=STYLES))
    text: str = field(default="", metadata=shown("of what"))


@dataclass
class Findings:
    """Tests, faults and oddities of a frame, as they are found.

    Attributes
    ----------
    frame
        What is looked at.
    tolerance
        Share of its size by which places may be off, as asked for; None where nothing was asked.
    """

    frame: Frame
    tolerance: float | None = None
    notes: list[str] = field(default_factory=list)
    tests: list[Test] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    @property
    def size(self) -> float:
        """Longest side of what the frame holds."""
        return float(np.ptp(self.frame.coords, axis=0).max())

    def lengths(self, *others: Frame) -> float:
        """Return by how much lengths may differ: places of this frame and of others have so many digits."""
        if self.tolerance is not None:
            return self.tolerance * self.size
        digits = 2 * sum(one.unit for one in (self.frame, *others) if one.folded)
        return float(np.clip(digits, PLACES * self.size, NOISE * self.size))

    def of(self, test: str) -> list[Fault]:
        """Return the faults of a test."""
        return [one for one in self.faults if one.test == test]

    def in_order(self) -> list[Fault]:
        """Return all faults, in the order of their tests."""
        place = {test.name: k for k, test in reversed([*enumerate(self.tests)])}
        return sorted(self.faults, key=lambda one: place.get(one.test, len(place)))

    def settle(self, name: str, text: str = "", doubt: str = "") -> bool:
        """Record a test whose faults are known; doubt: why it is not decided, where it has none.  Whether it is ok."""
        found = self.of(name)
        status: Status = "fault" if found else "not decided" if doubt else "ok"
        many = f"{len(found)} found" if len(found) > 1 else ""
        said = "; ".join(filter(None, (many, text))) if found or not doubt else doubt
        self.tests.append(Test(name, self.frame.number, status, said))
        return status == "ok"

    def settle_faults(self, name: str) -> None:
        """Record a test that is told of only where it has faults."""
        if self.of(name):
            self.settle(name)

    def skip(self, name: str, why: str, undecided: bool = False) -> None:
        """Record a test that does not apply, or is not decided."""
        status: Status = "not decided" if undecided else "does not apply"
        self.tests.append(Test(name, self.frame.number, status, why))

    def fault(
        self,
        test: str,
        text: str,
        size: float | None = None,
        *,
        vertices: Sequence[int] = (),
        edges: Sequence[int] = (),
        faces: Sequence[int] = (),
        place: Sequence[float] | np.ndarray | None = None,
    ) -> None:
        """Record a fault of this frame; its place is the middle of the vertices, else of edges or faces."""
        if place is None:
            frame, at = self.frame, [*vertices]
            if not at and len(edges):
                at = frame.edges[np.isin(frame.numbers, edges)].ravel().tolist()
            elif not at and frame.faces:
                at = [v for k in faces for v in frame.faces[k]]
            place = frame.coords[at].mean(axis=0) if at else ()
        v, e, fs = (tuple(map(int, numbers)) for numbers in (vertices, edges, faces))
        x = tuple(float(round(v / self.size, PLACED)) * self.size + 0.0 for v in place)
        much, unit = (None, "") if size is None else (float(size), UNITS.get(test, ""))
        self.faults.append(Fault(test, text, self.frame.number, v, e, fs, x, much, unit))
