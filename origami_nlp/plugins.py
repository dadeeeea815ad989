"""Plug-ins: example patterns, hinge materials and exporters that other distributions add by entry points.

A plug-in is looked for when a name is none of the package's own, which none can replace; what goes wrong in it is one
line that names its distribution.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from origami_nlp.errors import OptionError, OrigamiError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUPS = {kind: f"origami_nlp.{kind}s" for kind in ("example", "material", "exporter")}
"""The group of entry points of each kind."""


@dataclass(frozen=True)
class Plugin:
    """One entry point, not loaded yet.

    Attributes
    ----------
    kind
        Of `GROUPS`.
    name
        By which users call it; of an exporter the ending of a file, without its dot.
    entries
        Its entry points: one, unless several distributions have one of this name.
    """

    kind: str
    name: str
    entries: tuple[EntryPoint, ...]

    def __str__(self) -> str:
        return f"{self.kind} {self.name!r} of {' and of '.join(_distributions(self.entries))}"

    def load(self) -> Any:
        """Return what the entry point names.

        Returns
        -------
        object
            Whatever it is.

        Raises
        ------
        OptionError
            If it cannot be loaded, or is not the only one of its name: a line with the distribution and the cause.
        """
        if len(_distributions(self.entries)) > 1:
            raise self.broken("is there twice", "uninstall one of them")
        try:
            return self.entries[0].load()
        except Exception as error:
            raise self.broken("cannot be loaded", error) from None

    def call(self, *given: Any, **options: Any) -> Any:
        """Call what the entry point names.

        Parameters
        ----------
        given, options
            Its arguments.

        Returns
        -------
        object
            What it returned.

        Raises
        ------
        OptionError
            If it cannot be loaded, or raised an exception: a line with the distribution and the cause.
        """
        made = self.load()
        try:
            return made(*given, **options)
        except Exception as error:
            raise self.broken("failed", error) from None

    def broken(self, how: str, error: Exception | str) -> OptionError:
        """Return the error that says what is wrong with it, in one line."""
        said = str(error) if isinstance(error, str | OrigamiError) else _in_a_line(error)
        return OptionError(f"plug-in {self} {how}: {said}")


def plugins(kind: str) -> Mapping[str, Plugin]:
    """Return the plug-ins of a kind that are installed, by name.

    Parameters
    ----------
    kind
        ``"example"``, ``"material"`` or ``"exporter"``.

    Returns
    -------
    Mapping
        None of them is loaded.

    Examples
    --------
    >>> from origami_nlp.plugins import plugins
    >>> "nobody made this" in plugins("material")
    False
    """
    from importlib.metadata import entry_points  # 30 ms: where plug-ins are asked for

    entries = sorted(entry_points(group=GROUPS[kind]), key=lambda entry: entry.name)
    return {
        name: Plugin(kind, name, tuple(same))
        for name, same in groupby(entries, key=lambda entry: entry.name)
    }


def has_exporter(file: str | PathLike[str]) -> bool:
    """Return whether a plug-in writes files with this ending.

    Parameters
    ----------
    file
        Its name.

    Returns
    -------
    bool
        Built-in formats are not exporters.

    Examples
    --------
    >>> from origami_nlp.plugins import has_exporter
    >>> has_exporter("states.json")
    False
    """
    return _ending(file) in plugins("exporter")


def export(result: Any, file: str | PathLike[str]) -> bytes:
    """Return what the exporter for this ending makes of a result.

    Parameters
    ----------
    result
        What a `find_` function returned.
    file
        Its name.

    Returns
    -------
    bytes
        Content of the file; text as UTF-8.

    Raises
    ------
    OptionError
        If no plug-in writes such files, or it failed, or returned neither text nor bytes.

    Examples
    --------
    >>> from origami_nlp.plugins import export
    >>> try:
    ...     export("a result", "states.nobody")
    ... except ValueError as error:
    ...     print(error)
    file = 'states.nobody': no plug-in writes files that end in .nobody
    """
    if (plugin := plugins("exporter").get(_ending(file))) is None:
        raise OptionError(
            f"file = {str(file)!r}: no plug-in writes files that end in .{_ending(file)}"
        )
    content = plugin.call(result)
    if not isinstance(content, str | bytes):
        raise plugin.broken("is wrong", f"{type(content).__name__} instead of text or bytes")
    return content.encode() if isinstance(content, str) else content


def _ending(file: str | PathLike[str]) -> str:
    return Path(file).suffix.lower()[1:]


def _distributions(entries: Iterable[EntryPoint]) -> list[str]:
    """Return name and version of the distributions of entry points."""
    whose = {f"{e.dist.name} {e.dist.version}" if e.dist else "no distribution" for e in entries}
    return sorted(whose)


def _in_a_line(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())
