"""Arguments of public functions: what is wrong gets one line with its name, its value and the fix."""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from importlib import import_module
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

from origami_nlp.errors import AngleError, OptionError, OrigamiError

if TYPE_CHECKING:
    import numpy as np

_MAKERS = {
    "Scene": "a Scene (read_scene reads one from a file)",
    "Vertex": "a Vertex (such as scene.vertex)",
    "MinimaResult": "a MinimaResult: what find_minima returns",
    "Barriers": "a Barriers: what find_barriers(scene) returns",
    "ExactLandscape": "an ExactLandscape: what find_landscape(result) returns",
    "PhaseDiagram": "a PhaseDiagram: what phase_diagram(degree) returns",
    "Frame": "a Frame: one of those that read_fold(file) returns",
    "ReducedVertex": "a ReducedVertex: ReducedVertex(scene); a pattern is searched for (find_minima), not proved",
    "Sweep": "a Sweep: what read_sweep(file) returns",
    "Pattern": "a Pattern (read_pattern reads one from a FOLD file), the name of an example, or a FOLD file",
    "LoadPath": "a load path: what load_path returns",
    "SearchOptions": "SearchOptions(...) of origami_nlp",
    "ContinuationOptions": "ContinuationOptions(...) of origami_nlp",
    "Executor": "an executor of concurrent.futures, or None",
    "Axes": "Axes of matplotlib",
    "Result": "a result of a find_ function",
}


def shown(value: object) -> str:
    """Return `repr(value)` on one short line."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # a repr of the user's, or an integer of too many digits
        text = f"<{type(value).__name__}>"
    return text if len(text) <= 60 else f"{text[:57]}..."


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """Return a question to append to a complaint about a word: the closest known one, or nothing if none is close."""
    close = get_close_matches(str(word).lower(), list(known), n=1)
    return f"; did you mean {close[0]}?" if close else ""


def require(module: str, what: str, extra: str, error: type[OrigamiError] = OptionError) -> Any:
    """Return a module that only `what` needs, and that an extra of the package installs.

    Raises
    ------
    OrigamiError
        An `error` that says what to install, if it is not there.
    """
    try:
        return import_module(module)
    except ImportError:
        raise error(
            f'{what} needs {module}, which is not installed: pip install "origami_nlp[{extra}]"'
        ) from None


def check_type(name: str, value: object, kind: type) -> None:
    """Raise an error unless `value` is a `kind`.

    Raises
    ------
    OptionError
        This and all checks of this module, with the name, the value and what it must be.
    """
    if not isinstance(value, kind):
        raise OptionError(f"{name} = {shown(value)} must be {_MAKERS[kind.__name__]}")


def refuse(kind: str, reasons: Mapping[str, str], **given: object) -> None:
    """Raise an error for the first argument that was given (is not None) and is not for what is asked, and why."""
    for name, value in given.items():
        if value is not None and name in reasons:
            raise OptionError(f"{name} = {shown(value)} is not for a {kind}: {reasons[name]}")


def check_whole(
    name: str,
    value: Any,
    least: int,
    most: int | None = None,
    error: type[OrigamiError] = OptionError,
) -> int:
    """Return a whole number from `least` to `most`."""
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    if not whole or value < least or (most is not None and value > most):
        span = f", at least {least}" if most is None else f" from {least} to {most:,}"
        raise error(f"{name} = {shown(value)} must be a whole number{span}")
    return int(value)


def check_number(
    name: str,
    value: Any,
    low: float = -math.inf,
    high: float = math.inf,
    error: type[OrigamiError] = OptionError,
) -> float:
    """Return a finite number from `low` to `high`."""
    try:
        number = (
            math.nan if isinstance(value, bool) or not isinstance(value, Real) else float(value)
        )
    except OverflowError:
        number = math.inf
    if not (math.isfinite(number) and low <= number <= high):
        above = 0.0 < low < sys.float_info.min  # the least of all numbers: any that is positive
        span = {
            (True, True): f" above 0, at most {high:g}" if above else f" from {low:g} to {high:g}",
            (True, False): " above 0" if above else f", at least {low:g}",
            (False, True): f", at most {high:g}",
            (False, False): "",
        }[math.isfinite(low), math.isfinite(high)]
        raise error(f"{name} = {shown(value)} must be a finite number{span}")
    return number


def check_until(seconds: Any) -> float:
    """Return when the time of a search is over (`time.monotonic`), infinity for None."""
    if seconds is None:
        return math.inf
    return time.monotonic() + check_number("seconds", seconds, 0.0)


def check_flag(name: str, value: object) -> None:
    """Raise an error unless `value` is true or false."""
    import numpy as np

    if not isinstance(value, bool | np.bool_):
        raise OptionError(f"{name} = {shown(value)} must be True or False")


def check_callback(name: str, value: object) -> None:
    """Raise an error unless `value` is a function, or None."""
    if value is not None and not callable(value):
        raise OptionError(f"{name} = {shown(value)} must be a function to call, or None")


def check_path(name: str, value: Any) -> None:
    """Raise an error unless `value` names a file or folder; a number would be taken for an open file."""
    if not isinstance(value, str | os.PathLike) or not isinstance(os.fspath(value), str):
        raise OptionError(f"{name} = {shown(value)} must be a path: text or a pathlib.Path")
    if "\0" in os.fspath(value):
        raise OptionError(f"{name} = {shown(value)} holds a NUL character: no path does")


def check_angles(
    name: str, value: Any, degree: int, *, one: bool = False, finite: bool = True
) -> np.ndarray:
    """Return the fold angles of states [..., degree], or of just `one`, as an array [rad].

    Raises
    ------
    AngleError
        If they are no numbers, of another number of creases, or (with `finite`) not all finite.
    """
    import numpy as np

    try:
        phi = np.asarray(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise AngleError(f"{name} = {shown(value)} must be numbers [rad], one a crease") from None
    if phi.ndim == 0 or phi.shape[-1] != degree or (one and phi.ndim > 1):
        raise AngleError(
            f"{name} has shape {phi.shape}: give all {degree} fold angles, one a crease"
            + (", of one state" if one else "")
        )
    if finite and not np.isfinite(phi).all():
        where = tuple(np.argwhere(~np.isfinite(phi))[0].tolist())
        place = "".join(f"[{k + 1}]" for k in where)
        raise AngleError(f"{name}{place} = {phi[where]} is not finite: fold angles are radians")
    return phi
