"""Targets that people want, by name."""

from __future__ import annotations

from importlib.resources import files

NAMES = ("waitukaitis-five", "six-states", "switch", "flat-and-one", "three-equal")
_FOLDER = files("origami_nlp.inverse_design") / "example_files"
EXAMPLES = {name: (_FOLDER / f"{name}.toml").read_text("utf-8") for name in NAMES}
"""TOML by name."""
