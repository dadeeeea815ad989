"""Every error a user can cause, one subclass per kind of bad input.

Each message is one line that names the field, the value found, and the fix.  The command line turns
an `OrigamiError` into that line and exit code 2; anything else is a bug of ours.
"""

from typing import TypeVar

T = TypeVar("T")
OUT_OF_TIME = "interrupted by the time limit"
"""What is said of all that a time limit ended."""


class Interrupted(KeyboardInterrupt):
    """A search that the user interrupted.

    Parameters
    ----------
    result
        What it had found, whole, as if its time had been over.
    """

    def __init__(self, result: object) -> None:
        super().__init__("interrupted: .result holds what was found")
        self.result = result


def unless_stopped(result: T, stopped: bool) -> T:
    """Return a result, or raise `Interrupted` with it where the user has stopped what it is of."""
    if stopped:
        raise Interrupted(result)
    return result


class OutOfTime(Exception):
    """The time that was given is over."""


class OrigamiError(ValueError):
    """Base class of every complaint about input: catch this to catch them all.  Its text is one line.

    Parameters
    ----------
    message
        What is wrong: the field, the value found, and the fix.

    Examples
    --------
    >>> import origami_nlp as o
    >>> try:
    ...     o.Vertex(("pi/2", "pi/2"))
    ... except o.OrigamiError as error:
    ...     print(error)
    sector_angles has 2 entries: a vertex needs 3 at least
    """

    def __init__(self, message: object = "") -> None:
        super().__init__(" ".join(line.strip() for line in str(message).splitlines()))


class AngleError(OrigamiError):
    """An angle is not a finite number or a rational multiple of pi."""


class VertexError(OrigamiError):
    """The crease directions do not make a flat vertex."""


class SceneError(OrigamiError):
    """Stiffness, rest angles, symmetry or contact do not fit the vertex."""


class SymmetryError(SceneError):
    """The asked symmetry is not shared by geometry and mechanics."""


class SceneFileError(OrigamiError):
    """A scene file cannot be read, or has unknown or missing keys."""


class FoldFileError(OrigamiError):
    """A FOLD file cannot be read, or what is asked of it is not in it."""


class DrawingError(FoldFileError):
    """A drawing (SVG, .cp, DXF) cannot be read or written, or has no crease pattern in it."""


class OptionError(OrigamiError):
    """A command-line or keyword option has a value it cannot take."""


class NothingInTime(OptionError):
    """The time that was given was over before there was anything to return."""


class SweepError(OrigamiError):
    """A sweep file or the store of a sweep is not what it should be."""


class CertificateError(OrigamiError):
    """A file that should hold a proof cannot be read, or holds none."""
