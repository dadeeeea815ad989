"""An exception that no command expects: one line for the user, and a file with all that mending it takes."""

from __future__ import annotations

import os
import platform
import shlex
import sys
import tempfile
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import NoReturn

from origami_nlp.io import printable
from origami_nlp.version import __version__

INTERNAL_ERROR = 70
"""Exit code, that of EX_SOFTWARE in sysexits.h."""
MOST_LETTERS = 200
"""Of a message that is shown; the report has all of it."""


def report_fault(error: Exception, inputs: Mapping[str, bytes]) -> NoReturn:
    """Print one line, write the report, and end with `INTERNAL_ERROR`.

    inputs: content of each file that was read, by its name; ``-`` is standard input.
    """
    try:
        file: object = _write(_text(error, inputs))
        where = f"command, input and traceback are in {str(file)!r}"
    except OSError as problem:
        where = f"no report could be written ({problem.strerror or problem})"
    message = " ".join(f"{type(error).__name__}: {error}".split())
    if len(message) > MOST_LETTERS:
        message = message[: MOST_LETTERS - 3] + "..."
    line = f"internal error, please report: {message}; {where}"
    print(f"origami-nlp: {printable(line)}", file=sys.stderr)
    sys.exit(INTERNAL_ERROR)


def _text(error: Exception, inputs: Mapping[str, bytes]) -> str:
    parts = [
        f"origami-nlp {__version__}, Python {platform.python_version()}, {platform.platform()}",
        f"command: {shlex.join(['origami-nlp', *sys.argv[1:]])}",
        "".join(traceback.format_exception(error)),
    ]
    for name, content in inputs.items():
        parts.append(f"---- {name}\n{content.decode(errors='backslashreplace')}")
    return "\n".join(parts)


def _write(text: str) -> Path:
    """Write into the working folder, else into that for temporary files; no file is written over."""
    for folder in (Path(), Path(tempfile.gettempdir())):
        if not os.access(folder, os.W_OK):
            continue
        for number in range(1, 1000):
            file = folder / f"origami-nlp-error-{number}.txt"
            try:
                with open(file, "x", encoding="utf-8", errors="backslashreplace") as out:
                    out.write(text)
                return file
            except FileExistsError:
                continue
    raise OSError("no folder can be written to")
