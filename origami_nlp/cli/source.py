"""What a command works on, wherever it comes from: scene file, FOLD file, drawing, example by name, standard input."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import check_number, check_whole, did_you_mean
from origami_nlp.cli import options as o
from origami_nlp.errors import FoldFileError, OptionError, SceneFileError
from origami_nlp.io import read_limited

if TYPE_CHECKING:
    from origami_nlp.pattern import Frame, Pattern, Scene


REPEATS = ("cell", "rolled")
OF_PATTERNS = ("per_length", "bend", "snap", *REPEATS)
"""Options that mean something for whole patterns only."""


@dataclass(frozen=True)
class Source:
    """A scene or a pattern as the command line names it; its fields are the options of all commands that take one.

    Nothing is read before it is asked for.

    Attributes
    ----------
    name
        The file, ``-``, or an example such as ``miura:4x4``.
    vertex, frame, symmetry, contact
        What of a file is meant.
    stiffness, rest_angle, rest_from, per_length, bend
        Springs that a file leaves open.
    snap
        How far corners of a drawing may be moved.
    cell, rolled
        Of an example that repeats.
    """

    name: str = o.ORIGAMI
    vertex: int | None = o.VERTEX
    frame: int | None = o.FRAME
    symmetry: str | None = o.SYMMETRY
    contact: str | None = o.CONTACT
    stiffness: float | None = o.STIFFNESS
    rest_angle: float | None = o.REST_ANGLE
    rest_from: str | None = o.REST_FROM
    per_length: bool | None = o.PER_LENGTH
    bend: float | None = o.BEND
    snap: float | None = o.SNAP
    cell: bool | None = o.CELL
    rolled: str | None = o.ROLLED

    @classmethod
    def of(cls, name: str) -> Source:
        """Return a file, or an example, of which no option was given."""
        return cls(name, *[None] * (len(fields(cls)) - 1))

    @cached_property
    def given(self) -> dict[str, Any]:
        """The options that were given, by name."""
        values = {f.name: getattr(self, f.name) for f in fields(self)[1:]}
        return {name: value for name, value in values.items() if value is not None}

    @cached_property
    def is_fold(self) -> bool:
        """Whether it is a FOLD file, a drawing or an example, by its name or, without one, by its first letters."""
        from origami_nlp.pattern import is_json

        return self._kind in ("FOLD", "drawing") or is_json(self._content)

    @cached_property
    def _kind(self) -> str:
        """What it holds, by its name; of a drawing without one by its first letters."""
        if (ending := Path(self.name).suffix.lower()) in (".toml", ".fold", ".json"):
            return "scene" if ending == ".toml" else "FOLD"
        # readers of drawings are not loaded for scenes
        from origami_nlp.drawings import drawing_kind

        drawn = drawing_kind(self.name, b"") or drawing_kind(self.name, self._content)
        return "drawing" if drawn else "scene"

    @cached_property
    def is_example(self) -> bool:
        """Whether it is an example by name."""
        from origami_nlp.pattern import examples

        return not Path(self.name).exists() and examples.is_example(self.name)

    @property
    def is_whole(self) -> bool:
        """Whether `read_whole` returns a pattern."""
        return self.is_fold and self.vertex is None

    def read(self) -> Scene:
        """Return the scene; what is odd in a FOLD file goes to standard error."""
        from origami_nlp.pattern import decode_scene, scene_at

        if not self.is_fold:
            self._refuse(
                "is for FOLD files: a scene states it itself",
                {*self.given} - {"symmetry", "contact"},
            )
            scene = decode_scene(self._content, self.name)
            scene = scene.with_contact(self.contact) if self.contact else scene  # type: ignore[arg-type]
            note_normalized(scene.vertex.normalized)
            if self.symmetry is None:
                return scene
            return replace(scene, symmetry=self.symmetry, mirror=None, winding=None)
        self._refuse("is for whole patterns, not for a vertex of one", OF_PATTERNS)
        if self.vertex is not None:
            check_whole("--vertex", self.vertex, 0)
        kept = self._of("symmetry", "contact")
        return scene_at(self._frame(), self.vertex, on_note=note, **kept, **self._springs())

    def read_whole(self) -> Any:
        """Return the scene of a scene file or of the vertex that is asked for, else as `read_pattern`."""
        if not self.is_whole:
            return self.read()
        from origami_nlp.pattern import fold_vertices

        whole = self.read_pattern()  # what is wrong comes before what is odd
        one = fold_vertices(self._frame())[0]
        if len(one) == 1 and whole.cell is None:
            note(f"one vertex, taken as a pattern; --vertex {one[0].number} takes it as a vertex")
        for odd in whole.notes:
            note(odd)
        return whole

    def read_pattern(self) -> Pattern:
        """Return the whole pattern of a FOLD file or an example."""
        from origami_nlp.pattern import frame_pattern, with_bending

        if not self.is_fold:
            raise OptionError(f"{self.name!r} is a scene: give a FOLD file or an example")
        refused = {"vertex", "symmetry"}
        self._refuse("is for one vertex (--vertex V), not for a pattern", refused)
        if not self.is_example:
            self._refuse(f"is for examples; {self.name!r} states its origaminlp:lattice", REPEATS)
        whole = frame_pattern(self._frame(), snap=self.snap, **self._springs())
        whole = whole.with_springs(per_length=True) if self.per_length else whole
        whole = whole.with_contact(self.contact) if self.contact else whole  # type: ignore[arg-type]
        return whole if self.bend is None else with_bending(whole, self.bend)

    def frames(self, usual: Any = None) -> tuple[Frame, ...]:
        """Return the frame asked for; where none is, all, or the usual one."""
        from origami_nlp.pattern import parse_fold

        number = usual if self.frame is None else self.frame
        typed = "standard input" if self.name == "-" else self.name
        return parse_fold(self._content, number, source=typed)

    def _frame(self) -> Frame:
        return self.frames("first")[0]

    @cached_property
    def _content(self) -> bytes:
        from origami_nlp.pattern import LARGEST, examples

        if self.is_example:
            cells = cell_options(self.cell, self.rolled)
            return json.dumps(examples.crease_pattern(self.name, **cells)).encode()
        ending = Path(self.name).suffix.lower()
        if self.name != "-" and not ending and not Path(self.name).exists():
            known = examples.names()
            those = f"{', '.join(known)}{did_you_mean(self.name.partition(':')[0], known)}"
            raise OptionError(f"{self.name!r} is no file, and no example: those are {those}")
        if ending in (".toml", ""):
            return read_limited(self.name, LARGEST, "scene", SceneFileError)
        return read_limited(self.name, LARGEST, "FOLD", FoldFileError)

    def _of(self, *names: str) -> dict[str, Any]:
        return {name: self.given[name] for name in names if name in self.given}

    def _refuse(self, why: str, names: Iterable[str]) -> None:
        """Raise an error for the first option of these that was given."""
        for name in self.given:
            if name in names:
                raise OptionError(f"--{name.replace('_', '-')} {why}")

    def _springs(self) -> dict[str, Any]:
        """Return the options about springs that were given, angles in radians."""
        if self.stiffness is not None and not 0 < self.stiffness < math.inf:
            raise OptionError(f"--stiffness = {self.stiffness:g} must be positive and finite")
        found = self._of("stiffness", "rest_angle", "rest_from")
        if self.rest_angle is not None:
            size = check_number("--rest-angle", self.rest_angle, 0.0, 180.0)
            found["rest_angle"] = math.radians(size)
        return found


def cell_options(cell: bool | None, rolled: str | None) -> dict[str, Any]:
    """Return what a cell that repeats is made with."""
    if rolled is None:
        return {"cell": bool(cell)}
    if not cell:
        raise OptionError("--rolled is for cells that repeat: give --cell as well")
    copies = rolled.split(",")
    if not all(copy.strip().lstrip("-").isdecimal() for copy in copies):
        raise OptionError(f"--rolled = {rolled!r} must be a number of copies, such as 6, or 6,2")
    return {"cell": True, "rolled": [*map(int, copies)] if len(copies) > 1 else int(rolled)}


def note_normalized(change: float, most: str = "") -> None:
    """Say on standard error by how much ``normalize`` changed each sector angle [rad], where it did."""
    if change:
        each = f"each by {math.degrees(change):+.6g} deg{most}"
        note(f"sector angles normalized to a sum of 360 deg: {each}")


def note(text: str) -> None:
    """Say on standard error what is odd, or was assumed."""
    from origami_nlp.io import printable

    print(f"note: {printable(text)}", file=sys.stderr)
