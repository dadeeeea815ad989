"""The scene that a command works on, wherever it comes from: scene file, vertex of a FOLD file, standard input."""

from __future__ import annotations

import inspect
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, wraps
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_whole
from origami_nlp.cli import options as o
from origami_nlp.errors import FoldFileError, OptionError, SceneFileError
from origami_nlp.files import read_limited
from origami_nlp.pattern import (
    LARGEST,
    Frame,
    Pattern,
    Scene,
    decode_scene,
    fold_vertices,
    frame_pattern,
    is_json,
    parse_fold,
    vertex_scene,
    vertex_scenes,
)

FOLD_OPTIONS = {
    "vertex": o.VertexNumber,
    "frame": o.FrameNumber,
    "symmetry": o.FoldSymmetry,
    "contact": o.FoldContact,
    "stiffness": o.FoldStiffness,
    "rest_angle": o.FoldRestAngle,
    "rest_angles": o.FoldRestAngles,
}
"""What a vertex of a FOLD file needs beside the file; every command that takes a scene has them."""


@dataclass(frozen=True)
class Source:
    """A scene as the command line names it; nothing is read before it is asked for.

    Attributes
    ----------
    name
        The file, or ``-``.
    given
        Those of `FOLD_OPTIONS` that were given.
    """

    name: str
    given: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def is_fold(self) -> bool:
        """Whether it is a FOLD file, by its name or, without one that says so, by its first letter."""
        return _named_fold(self.name) or is_json(self._content)

    @cached_property
    def _content(self) -> bytes:
        if _named_fold(self.name):
            return read_limited(self.name, LARGEST, "FOLD", FoldFileError)
        return read_limited(self.name, LARGEST, "scene", SceneFileError)

    @property
    def vertex(self) -> int | None:
        """The vertex asked for."""
        return self.given.get("vertex")

    def frames(self) -> tuple[Frame, ...]:
        """Return the frame asked for, or all."""
        return parse_fold(self._content, self.given.get("frame"))

    def read(self) -> Scene:
        """Return the scene; what is odd in a FOLD file goes to standard error."""
        if not self.is_fold:
            self.refuse_options("a scene file states it itself")
            return decode_scene(self._content, self.name)
        if self.vertex is not None:
            check_whole("--vertex", self.vertex, 0)
        return vertex_scene(self._frame(), self.vertex, tell=_tell, **self._spring_options())

    def read_whole(self) -> Scene | Pattern:
        """Return the scene, or the pattern where a FOLD file has several vertices and none is asked for."""
        if self.is_fold and self.vertex is None:
            frame = self._frame()
            if len(fold_vertices(frame)[0]) > 1:
                for name in ("symmetry", "contact"):
                    if name in self.given:
                        raise OptionError(
                            f"--{name} is for one vertex: name it with --vertex, or leave it out"
                        )
                return frame_pattern(frame, **self._spring_options())
        return self.read()

    def read_all(self) -> dict[int, Scene]:
        """Return the scene of every vertex of a FOLD file that can be analysed, by its number."""
        return vertex_scenes(self._frame(), tell=_tell, **self._spring_options())

    def refuse_options(self, why: str) -> None:
        """Complain about options of FOLD files, if there are any."""
        if self.given:
            option = next(iter(self.given)).replace("_", "-")
            raise OptionError(f"--{option} is for FOLD files (.fold); {why}")

    def _frame(self) -> Frame:
        (frame,) = parse_fold(self._content, self.given.get("frame", "first"))
        return frame

    def _spring_options(self) -> dict[str, Any]:
        return spring_options(
            **{k: v for k, v in self.given.items() if k not in ("vertex", "frame")}
        )


def spring_options(**given: Any) -> dict[str, Any]:
    """Return the options of FOLD files that were given, those about springs checked and in radians."""
    options = {name: value for name, value in given.items() if value is not None}
    if not 0 < options.get("stiffness", 1.0) < math.inf:
        raise OptionError(f"--stiffness = {options['stiffness']:g} must be positive and finite")
    if "rest_angle" in options:
        options["rest_angle"] = math.radians(float(options["rest_angle"]))
    return options


def takes_scene(argument: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command with the parameter ``scene: Source`` the argument for it, and the options of FOLD files.

    argument: of `options`, such as ``SceneFile``.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        stated = inspect.signature(command, eval_str=True)
        own = [
            one.replace(annotation=argument) if name == "scene" else one
            for name, one in stated.parameters.items()
        ]
        fold = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)
            for name, kind in FOLD_OPTIONS.items()
        ]

        @wraps(command)
        def run(scene: str | None, **others: Any) -> None:
            values = {name: others.pop(name) for name in FOLD_OPTIONS}
            source = Source(scene or "", {k: v for k, v in values.items() if v is not None})
            if scene is None:
                source.refuse_options("there is no SCENE")
            command(scene=None if scene is None else source, **others)

        run.__signature__ = stated.replace(parameters=[*own, *fold])  # type: ignore[attr-defined]
        return run

    return decorate


def _named_fold(name: str) -> bool:
    return Path(name).suffix.lower() in (".fold", ".json")


def _tell(note: str) -> None:
    print(f"note: {note}", file=sys.stderr)
