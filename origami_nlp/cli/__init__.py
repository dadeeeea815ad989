"""The command line: one file a command; `entry` lists them."""

from origami_nlp.cli.entry import app, main

__all__ = ["app", "main"]
