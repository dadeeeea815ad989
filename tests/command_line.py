"""The command as a user calls it, in this process: what it returns, prints and complains about."""

import contextlib
import io
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

from origami_nlp import Scene, format_scene
from origami_nlp.cli import Group, app, main


class Done(NamedTuple):
    """Exit code, standard output and standard error of a command that ended."""

    code: int
    out: str
    err: str


def run(*arguments: object, commands: Group = app) -> Done:
    """Run `origami-nlp`, or other commands, with the given words; what they are is turned into text."""
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        # on a slow machine lines would come in between that say how far it is
        patch.setattr(sys, "argv", ["origami-nlp", *map(str, arguments)])
        with pytest.raises(SystemExit) as stop:
            main(commands)
    texts = [stream.buffer.getvalue().decode() for stream in (out, err)]  # type: ignore[attr-defined]
    return Done(stop.value.code or 0, *texts)  # type: ignore[arg-type]


def scene_file(folder: Path, scene: Scene) -> Path:
    """Write a scene into a folder and return the file's path."""
    path = folder / "scene.toml"
    path.write_text(format_scene(scene))
    return path
