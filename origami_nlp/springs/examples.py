"""Targets that people want, by name."""

from __future__ import annotations

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError

EXAMPLES: dict[str, str] = {}


def example_targets(name: str) -> str:
    """Return the targets of an example as TOML.

    Parameters
    ----------
    name
        One of `EXAMPLES`.

    Raises
    ------
    OptionError
        If there is none of this name.
    """
    if name not in EXAMPLES:
        raise OptionError(f"example = {shown(name)}: use one of {', '.join(EXAMPLES)}")
    return EXAMPLES[name]
