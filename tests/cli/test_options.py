"""One option, one meaning: over all commands, in their help at any width."""

from collections import defaultdict

import pytest
from typer.main import get_command

from origami_nlp.cli import app
from tests.command_line import run

IN_THEIR_OWN_WORDS = {
    "--output": "each command lists what it can write",
    "--frame": "check asks of all frames by default",
}
"""Options of one name, form and meaning whose help differs between commands, and why."""


LEAST = 68
"""Columns that help takes at least; first steps stand whole on their lines."""


def commands(command=None, path=()):
    """Every command that help shows, groups included, with the words that call it."""
    command = command or get_command(app)
    yield path, command
    for name in command.list_commands(None) if hasattr(command, "list_commands") else ():
        yield from commands(command.commands[name], (*path, name))


def options():
    """Every option of every command: its name, the command and the parameter."""
    for path, command in commands():
        for one in command.params:
            if one.param_type_name == "option":
                yield one.opts[0], path, one


def test_one_option_is_one_thing_in_all_commands():
    seen = defaultdict(dict)
    for name, path, one in options():
        seen[name][path] = one
    for name, of in seen.items():
        assert len({(p.metavar, p.is_flag, p.multiple) for p in of.values()}) == 1 or (
            # one drawing may show several, and a sheet be loaded at several
            {p.metavar for p in of.values()} in ({"ANGLE"}, {"K"})
        ), name
        helps = {p.help for p in of.values()}
        assert len(helps) == 1 or name in IN_THEIR_OWN_WORDS, (name, helps)
    ratios = {path: p.default for path, p in seen["--ratio"].items()}
    assert ratios.pop(("example",)) is None  # each example has its own
    assert set(ratios.values()) == {1.0}
    assert {p.default for p in seen["--seed"].values()} == {0}


@pytest.mark.parametrize("width", [40, pytest.param(200, marks=pytest.mark.slow)])
def test_help_keeps_to_the_terminal_and_cuts_no_word(width, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    for path, command in commands():
        code, out, _ = run(*path, "--help")
        assert code == 0 and max(map(len, out.splitlines())) <= max(width, LEAST), path
        words = "".join(out.split())
        for text in (command.help, *(p.help for p in command.params)):
            assert "".join(text.split()) in words, (path, text)
