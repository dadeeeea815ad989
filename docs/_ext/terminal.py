"""How lines of a terminal are shown: what is typed after a prompt, and what is printed as it is."""

from __future__ import annotations

from pygments.lexer import RegexLexer, bygroups
from pygments.token import Generic, Text


class Terminal(RegexLexer):
    """A prompt is a dollar sign; the usual lexer takes the number sign of our tables for one."""

    name = "terminal"
    tokens = {  # noqa: RUF012
        "root": [
            (r"^(\$ )(.*\n?)", bygroups(Generic.Prompt, Text)),
            (r".+\n?|\n", Generic.Output),
        ]
    }


def setup(app) -> dict:
    """Use it for blocks of a console."""
    app.add_lexer("console", Terminal)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
