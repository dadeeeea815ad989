"""What a command works on, wherever it comes from: scene file, FOLD file, example by name, standard input."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.arguments import check_whole, did_you_mean
from origami_nlp.cli import options as o
from origami_nlp.errors import FoldFileError, OptionError, SceneFileError
from origami_nlp.io import read_limited

if TYPE_CHECKING:
    from origami_nlp.pattern import Frame, Pattern, Scene

FOLD_OPTIONS = {
    "vertex": o.VertexNumber,
    "frame": o.FrameNumber,
    "symmetry": o.FoldSymmetry,
    "contact": o.FoldContact,
}
"""What of a FOLD file is meant; every command that takes a scene has them."""
SPRINGS = {"stiffness": o.FoldStiffness, "rest_angle": o.FoldRestAngle, "rest_from": o.FoldRestFrom}
"""Springs that a FOLD file leaves open: for the commands that come first, and `inspect`, which writes them down."""
CELLS = {"cell": o.Cell, "rolled": o.Rolled}
PER_LENGTH = {"per_length": o.PerLength, "bend": o.Bend, "diagonal": o.Diagonal, **CELLS}
"""What a command that takes springs and whole patterns has besides."""


@dataclass(frozen=True)
class Source:
    """A scene or a pattern as the command line names it; nothing is read before it is asked for.

    Attributes
    ----------
    name
        The file, ``-``, or an example such as ``miura:4x4``.
    given
        Those of `FOLD_OPTIONS`, `SPRINGS` and `PER_LENGTH` that were given.
    """

    name: str
    given: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def is_fold(self) -> bool:
        """Whether it is a FOLD file, a drawing or an example, by its name or, without one, by its first letters."""
        from origami_nlp.pattern import is_drawing, is_json

        if _named_scene(self.name):  # readers of drawings are not loaded then
            return is_json(self._content)
        if _named_fold(self.name) or is_drawing(self.name):
            return True
        return is_json(self._content) or is_drawing(self.name, self._content)

    @property
    def is_panels(self) -> bool:
        """Whether it is the paper's panels, for the commands that take them all."""
        return self.name == "panels" and not Path(self.name).exists()

    @cached_property
    def is_example(self) -> bool:
        """Whether it is an example by name."""
        if Path(self.name).exists():
            return False
        from origami_nlp.pattern import examples

        return examples.is_example(self.name)

    @cached_property
    def _content(self) -> bytes:
        from origami_nlp.pattern import LARGEST, is_drawing

        if self.is_example:
            from origami_nlp.pattern import examples

            cells = cell_options(**{name: self.given.get(name) for name in CELLS})
            return json.dumps(examples.crease_pattern(self.name, **cells)).encode()
        if self.name != "-" and not Path(self.name).suffix and not Path(self.name).exists():
            from origami_nlp.pattern import examples

            known = examples.names()
            meant = did_you_mean(self.name.partition(":")[0], known)
            raise OptionError(
                f"{self.name!r} is no file, and no example: those are {', '.join(known)}{meant}"
            )
        if _named_fold(self.name):
            return read_limited(self.name, LARGEST, "FOLD", FoldFileError)
        if not _named_scene(self.name) and is_drawing(self.name):
            return read_limited(self.name, LARGEST, "drawing", FoldFileError)
        return read_limited(self.name, LARGEST, "scene", SceneFileError)

    @property
    def _typed(self) -> str:
        return "standard input" if self.name == "-" else self.name

    @property
    def vertex(self) -> int | None:
        """The vertex asked for."""
        return self.given.get("vertex")

    @property
    def is_whole(self) -> bool:
        """Whether `read_whole` returns a pattern."""
        return self.is_fold and self.vertex is None

    @property
    def whole_contact(self) -> str | None:
        """The contact asked for of a whole pattern; a scene has its own."""
        return self.given.get("contact") if self.is_whole else None

    def frames(self) -> tuple[Frame, ...]:
        """Return the frame asked for, or all."""
        from origami_nlp.pattern import parse_fold

        return parse_fold(self._content, self.given.get("frame"), source=self._typed)

    def read(self) -> Scene:
        """Return the scene; what is odd in a FOLD file goes to standard error."""
        from origami_nlp.pattern import decode_scene, vertex_scene

        if not self.is_fold:
            self.refuse_options("a scene file states it itself", but=("symmetry",))
            scene = decode_scene(self._content, self.name)
            note_normalized(scene.vertex.normalized)
            if (symmetry := self.given.get("symmetry")) is None:
                return scene
            return replace(scene, symmetry=symmetry, mirror=None, winding=None)
        for option in PER_LENGTH.keys() & self.given.keys():
            named = option.replace("_", "-")
            raise OptionError(f"--{named} is for whole patterns, not for a vertex of one")
        if self.vertex is not None:
            check_whole("--vertex", self.vertex, 0)
        return vertex_scene(self._frame(), self.vertex, on_note=_note, **self._spring_options())

    def read_whole(self, contact: bool = False) -> Scene | Pattern:
        """Return the scene of a scene file or of the vertex that is asked for, else as `read_pattern`."""
        if not self.is_whole:
            return self.read()
        from origami_nlp.pattern import Pattern, fold_vertices

        whole = self.read_pattern(contact)  # what is wrong comes before what is odd
        one = fold_vertices(self._frame())[0]
        if len(one) == 1 and not (isinstance(whole, Pattern) and whole.cell is not None):
            number = one[0].number
            _note(
                f"one vertex, taken as a pattern; --vertex {number} takes it as a vertex, with its symmetry"
            )
        for note in whole.notes:
            _note(note)
        return whole

    def read_pattern(self, contact: bool = False) -> Pattern:
        """Return the whole pattern of a FOLD file or an example; contact: what is asked of it takes ``--contact``."""
        from origami_nlp.pattern import frame_pattern, with_bending

        if not self.is_fold:
            raise OptionError(
                f"{self.name!r} is the scene of one vertex: give a FOLD file or an example"
            )
        for option in ("vertex", "symmetry", *["contact"] * (not contact)):
            if option in self.given:
                more = "leave it out" if option == "vertex" else "name it with --vertex"
                raise OptionError(f"--{option} is for one vertex, not for a pattern: {more}")
        for option, key in (("cell", "lattice"), ("rolled", "rolled")):
            if self.given.get(option) and not self.is_example:
                raise OptionError(
                    f"--{option}: {self.name!r} is no example; what a FOLD file states is its origaminlp:{key}"
                )
        options = self._spring_options()
        options.pop("contact", None)
        whole = frame_pattern(self._frame(), **options)
        whole = whole.with_springs(per_length=True) if self.given.get("per_length") else whole
        bend, diagonal = self.given.get("bend"), self.given.get("diagonal")
        if diagonal and bend is None:
            raise OptionError("--diagonal is for facets that bend: give their stiffness, --bend K")
        return whole if bend is None else with_bending(whole, bend, diagonal or "short")

    def refuse_options(self, why: str, but: Sequence[str] = ()) -> None:
        """Raise an error for options of FOLD files, if there are any; but: those that scene files take too."""
        if given := [name for name in self.given if name not in but]:
            option = given[0].replace("_", "-")
            raise OptionError(f"--{option} is for FOLD files (.fold); {why}")

    def _frame(self) -> Frame:
        from origami_nlp.pattern import parse_fold

        number = self.given.get("frame", "first")
        (frame,) = parse_fold(self._content, number, source=self._typed)
        return frame

    def _spring_options(self) -> dict[str, Any]:
        return spring_options(
            **{k: v for k, v in self.given.items() if k not in ("vertex", "frame", *PER_LENGTH)}
        )


def cell_options(cell: bool | None, rolled: str | None) -> dict[str, Any]:
    """Return what a cell that repeats is made with."""
    if rolled is None:
        return {"cell": bool(cell)}
    if not cell:
        raise OptionError("--rolled is for cells that repeat: give --cell as well")
    try:
        copies = [int(n) for n in rolled.split(",")]
    except ValueError:
        raise OptionError(
            f"--rolled = {rolled!r} must be a number of copies, such as 6, or 6,2"
        ) from None
    return {"cell": True, "rolled": copies if len(copies) > 1 else copies[0]}


def spring_options(**given: Any) -> dict[str, Any]:
    """Return the options of FOLD files that were given, those about springs checked and in radians."""
    options = {name: value for name, value in given.items() if value is not None}
    stiffness = options.get("stiffness", 1.0)
    if not isinstance(stiffness, str) and not 0 < stiffness < math.inf:
        raise OptionError(f"--stiffness = {stiffness:g} must be positive and finite")
    if "rest_angle" in options:
        options["rest_angle"] = math.radians(float(options["rest_angle"]))
    return options


def takes_scene(
    argument: Any, whole: bool = False, springs: bool = True
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command with the parameter ``scene: Source`` the argument for it, and the options of FOLD files.

    argument: of `options`, such as ``SceneFile``.  whole: it takes whole patterns as well.  springs: it takes
    springs for FOLD files that leave them open.
    """
    of_patterns: dict[str, Any] = PER_LENGTH if springs else CELLS
    options = FOLD_OPTIONS | (SPRINGS if springs else {}) | (of_patterns if whole else {})

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(scene: str, **others: Any) -> None:
            values = {name: others.pop(name) for name in options}
            source = Source(scene, {k: v for k, v in values.items() if v is not None})
            if source.is_panels:
                source.refuse_options("the panels are scenes")
            command(scene=source, **others)

        more = {name: (kind, None) for name, kind in options.items()}
        return o.extended(run, command, more, last=True, scene=argument)

    return decorate


def note_normalized(change: float, most: str = "") -> None:
    """Say on standard error by how much ``normalize`` changed each sector angle [rad], where it did."""
    if change:
        _note(
            f"sector angles normalized to a sum of 360 deg: each by {math.degrees(change):+.6g} deg{most}"
        )


def _named_fold(name: str) -> bool:
    return Path(name).suffix.lower() in (".fold", ".json")


def _named_scene(name: str) -> bool:
    return Path(name).suffix.lower() == ".toml"


def _note(note: str) -> None:
    print(f"note: {note}", file=sys.stderr)
