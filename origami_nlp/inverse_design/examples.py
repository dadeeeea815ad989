"""Targets that people want, by name."""

from __future__ import annotations

from importlib.resources import files

from origami_nlp.arguments import did_you_mean, shown
from origami_nlp.errors import OptionError

NAMES = ("waitukaitis-five", "six-states", "switch", "flat-and-one", "three-equal", "monostable8")
_FOLDER = files("origami_nlp.inverse_design") / "example_files"
EXAMPLES = {name: (_FOLDER / f"{name}.toml").read_text("utf-8") for name in NAMES}
"""TOML by name."""


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
        raise OptionError(
            f"example = {shown(name)}: use one of {', '.join(EXAMPLES)}{did_you_mean(name, EXAMPLES)}"
        )
    return EXAMPLES[name]
