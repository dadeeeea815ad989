"""C beside the package, compiled once a machine by its compiler; without one NumPy does the same."""

from __future__ import annotations

import atexit
import ctypes
import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from origami_nlp.io import write_whole

SWITCH = "ORIGAMI_NLP_COMPILED"
"""Environment variable: 0 compiles nothing."""
FLAGS = ("-O1", "-std=c99", "-shared", "-fPIC", "-ffp-contract=off", "-ftree-vectorize")
"""No fused products, and sums in no other order: the same bits by each compiler (-O2: twice as long to compile)."""
_LOADED: dict[tuple[str | None, ...], Any] = {}


def compiled(
    name: str, source: Callable[[], str], says: Callable[[], object] = lambda: None
) -> Any:
    """Return the library of C source; None where there is no compiler, or it fails.

    Parameters
    ----------
    name
        What it is called.
    source
        Makes the whole source, with everything that it includes but what every C compiler has.
    says
        Called before something is compiled.
    """
    key = name, *map(os.environ.get, (SWITCH, "CC", "XDG_CACHE_HOME", "HOME"))
    if key not in _LOADED:  # which is asked some thousand times a second
        stated = os.environ.get("CC") or _compiler()
        home = os.environ.get("XDG_CACHE_HOME") or ""
        # a relative one is none (XDG base directories)
        home = home if os.path.isabs(home) else os.path.expanduser("~/.cache")
        if os.environ.get(SWITCH) == "0" or not stated:
            return None
        try:
            _LOADED[key] = _library(name, source(), stated, Path(home) / "origami_nlp", says)
        except (OSError, AttributeError, ValueError, subprocess.SubprocessError):
            _LOADED[key] = None  # it is not tried again
    return _LOADED[key]


def c_sources(*paths: Path) -> str:
    """Return C sources one after the other, after that of vectors (`c/vectors.h`).

    Parameters
    ----------
    paths
        Files that include nothing but what every C compiler has.

    Returns
    -------
    str
        Their text.

    Examples
    --------
    >>> from origami_nlp.numerics import c_sources
    >>> "static double dot" in c_sources()
    True
    """
    vectors = Path(__file__).parent / "c" / "vectors.h"
    return "\n".join(path.read_text("utf-8") for path in (vectors, *paths))


def address(array: Any) -> int:
    """Return where the numbers of an array stand, for C; as `array.ctypes.data`, in a quarter of its time.

    Raises
    ------
    ValueError
        If they are not row after row in one piece: C would read others.
    """
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))
    except (TypeError, ValueError):  # not writable, not in one piece, or empty
        if not array.flags.c_contiguous:
            raise ValueError("an array for C is not row after row in one piece") from None
        return int(array.ctypes.data)


@lru_cache(maxsize=1)
def _compiler() -> str | None:
    """Return the C compiler of the machine."""
    if sys.platform == "darwin":  # without these tools `cc` only opens a window that offers them
        asked = subprocess.run(["xcode-select", "-p"], check=False, capture_output=True)
        if asked.returncode:
            return None
    known = next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if known is None and find_spec("ziglang") is not None:  # of the extra `compiler`
        return f"{shlex.quote(sys.executable)} -m ziglang cc"
    return known


def _library(
    name: str, text: str, compiler: str, cache: Path, says: Callable[[], object]
) -> ctypes.CDLL:
    """Return the library from a folder, in which it is made where it is not there."""
    command = [*shlex.split(compiler), *FLAGS]
    key = repr((command, text, sys.platform, platform.machine())).encode()
    made = cache / f"{name}-{hashlib.sha256(key).hexdigest()[:16]}.so"
    if not _is_trusted(made):
        says()
        cache.mkdir(parents=True, exist_ok=True, mode=0o700)
        # where somebody else may put files: in a folder that dies with the process
        if not _is_ours(cache):
            cache = Path(tempfile.mkdtemp(prefix="origami_nlp-"))
            atexit.register(shutil.rmtree, cache, ignore_errors=True)
            made = cache / made.name
        # beside, then moved: another process sees all of it or nothing
        with tempfile.TemporaryDirectory(dir=cache) as folder:
            out = Path(folder) / "made.so"
            command += ["-x", "c", "-", "-o", str(out), "-lm"]
            subprocess.run(
                command, input=text.encode(), check=True, capture_output=True, timeout=60
            )
            write_whole(_sum_of(made), hashlib.sha256(out.read_bytes()).hexdigest().encode())
            os.chmod(out, 0o700)
            os.replace(out, made)
    return ctypes.CDLL(str(made))


def _sum_of(made: Path) -> Path:
    """Return the file with the checksum of a library."""
    return made.with_suffix(".sha256")


def _is_ours(path: Path) -> bool:
    """Return whether a file or folder is the user's, and nobody else may write to it."""
    known = path.stat()
    return not hasattr(os, "getuid") or (known.st_uid == os.getuid() and not known.st_mode & 0o022)


def _is_trusted(made: Path) -> bool:
    """Return whether a library is there, whole, and was put there by the user: what is loaded is run."""
    try:
        if not (_is_ours(made.parent) and _is_ours(made)):
            return False
        return hashlib.sha256(made.read_bytes()).hexdigest() == _sum_of(made).read_text("ascii")
    except OSError:
        return False
