"""A group of commands: listed under headings, in the order in which they are added, and how each starts and ends."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from origami_nlp.cli.interruption import interruptible
from origami_nlp.errors import OptionError
from origami_nlp.io import is_number

WITHOUT_VALUE = "asked"
"""What an option whose value may be left out gets then."""
SPRINGS = ("--stiffness", "--rest-angle", "--rest-from", "--per-length")
"""Options of the commands that come first; others take a file in which springs stand."""
MAY_LACK_VALUE = ("--prove",)
"""Options whose value, a number, may be left out."""
WHOLE = "a whole number"
NUMBERS = {"integer": WHOLE, "float": "a number", "number": "a number"}
"""What the parser calls types of values, and how messages do."""
CLOSED_PIPE = 141
"""Exit code where the reader of what is printed has gone: 128 + SIGPIPE, as shells say of other programs."""
WRITES = "FILE"
"""Metavar of every option that writes what a command found, and of no other option."""
FOLD_FILES = "Options for FOLD files and examples"
"""Heading of the options that say what a FOLD file leaves open; `rich_help_panel` of each."""
UNBROKEN = "\u2011"
"""A hyphen at which no line breaks."""


class _Helped:
    """A command whose help has whole words on its lines, those with hyphens too; a wrong call is one line."""

    def make_context(
        self, info_name: str | None, args: list[str], *more: Any, **options: Any
    ) -> Any:
        """Read the words of the call."""
        with _one_line([*args]):
            return super().make_context(info_name, args, *more, **options)  # type: ignore[misc]

    def get_params(self, ctx: Any) -> list[Any]:
        """Return the parameters, which take plain values without pydantic."""
        found = super().get_params(ctx)  # type: ignore[misc]
        for one in found:
            one.process_value = partial(_value, one, type(one).process_value)
        return found

    def get_help(self, ctx: Any) -> str:
        """Return the help; ``--rest-angle`` stands on one line."""
        formatter = ctx.make_formatter()
        text, pairs = formatter.write_text, formatter.write_dl
        formatter.write_text = lambda words: text(_unbroken(words))
        formatter.write_dl = lambda rows: pairs([(a, _unbroken(b)) for a, b in rows])
        self.format_help(ctx, formatter)  # type: ignore[attr-defined]
        return formatter.getvalue().rstrip("\n").replace(UNBROKEN, "-")


@contextmanager
def _one_line(args: list[str]) -> Iterator[None]:
    """Turn what the parser says of a wrong call, with these words, into one line.

    Its errors are known by what they can do: their class is click's, or where typer brings its own parser another.
    """
    try:
        yield
    except Exception as error:
        ctx = getattr(error, "ctx", None)
        if not hasattr(error, "format_message") or "Help" in type(error).__name__:
            raise
        said = " ".join(error.format_message().split()).rstrip(".")
        must = next((words for kind, words in NUMBERS.items() if f"valid {kind}" in said), None)
        options = getattr(getattr(error, "param", None), "opts", ())
        for option in options if must else ():
            for arg, following in zip(args, [*args[1:], ""], strict=True):
                name, has, value = arg.partition("=")
                value = value if has else following
                if name == option and not (is_number(value) and (must != WHOLE or value.isdigit())):
                    raise OptionError(f"{option} = {value!r} must be {must}") from None
        where = f"; {ctx.command_path} --help lists what there is" if ctx else ""
        raise OptionError(f"{said[:1].lower()}{said[1:]}{where}") from None


def _unbroken(words: str) -> str:
    return words.replace("-", UNBROKEN)


class _Command(_Helped, TyperCommand):
    """A command; an option that needs no value gets `WITHOUT_VALUE` where no number follows."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Fill in what is left out."""
        filled = []
        for arg, following in zip(args, [*args, ""][1:], strict=True):
            filled.append(arg)
            if arg in MAY_LACK_VALUE and not is_number(following):
                filled.append(WITHOUT_VALUE)
        given = {arg.partition("=")[0] for arg in args}
        own = {p.name for p in self.params}
        for option in SPRINGS:
            if option in given and "vertex" in own and option[2:].replace("-", "_") not in own:
                raise OptionError(
                    f"{option} is not for {ctx.info_name}: write the springs into a file once, origami-nlp inspect "
                    f"FILE {option} ... -o NEW.fold (of one --vertex NEW.toml), and give that file"
                )
        return super().parse_args(ctx, filled)

    def invoke(self, ctx: Any) -> Any:
        """Run it; on a terminal, inform who asked for no file what could be written."""
        answer = super().invoke(ctx)
        could = [p for p in self.params if p.param_type_name == "option" and p.metavar == WRITES]
        if could and not any(ctx.params.get(p.name) for p in could):
            _tell_files([f"{p.opts[-1]} FILE" for p in could])
        return answer

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """Name arguments by what they are, those that may be left out in brackets."""
        words = [_word(p) for p in self.params if p.param_type_name == "argument"]
        return [self.options_metavar or "", *words]

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments without the type of their text, then options, those for FOLD files by themselves."""
        records = [(_heading(p), p, p.get_help_record(ctx)) for p in self.get_params(ctx)]
        for heading in ("Arguments", "Options", FOLD_FILES):
            rows = [
                (p.metavar or r[0] if heading == "Arguments" else r[0], r[1])
                for under, p, r in records
                if under == heading and r is not None
            ]
            if rows:
                with formatter.section(heading):
                    formatter.write_dl(rows)


def _heading(parameter: Any) -> str:
    """Return under which heading a parameter stands in the help."""
    if parameter.param_type_name == "argument":
        return "Arguments"
    return getattr(parameter, "rich_help_panel", None) or "Options"


def _word(argument: Any) -> str:
    name = argument.metavar or argument.name.upper()
    return name if argument.required else f"[{name}]"


def _value(parameter: Any, process: Callable[..., Any], ctx: Any, given: Any) -> Any:
    """Return the value of a parameter; all but plain text and numbers are left to Typer, which loads pydantic."""
    kind = getattr(getattr(parameter, "type_descriptor", None), "annotation", None)
    many = parameter.multiple or parameter.nargs != 1
    if given is None and not parameter.required and kind is not None:
        value: Any = () if many else None
    elif isinstance(given, str) and not many and kind is str:
        value = given
    elif kind == list[str] and isinstance(given, (list, tuple)):
        value = list(given) or ()
    elif (
        isinstance(given, str) and not many and kind is int and given.isascii() and given.isdigit()
    ):
        value = int(given)
    elif (
        not many and kind in (int, float) and type(given) is kind
    ):  # what stands there unless given
        value = given
    else:
        return process(parameter, ctx, given)
    return parameter.callback(ctx, parameter, value) if parameter.callback else value


def _tell_files(options: list[str]) -> None:
    from origami_nlp.io import Screen

    screen = Screen()
    if screen.is_terminal:
        one = len(options) == 1
        words = "writes this to a file" if one else "write this to files"
        screen.print(f"{', '.join(options)} {words}", style="dim", highlight=False)


@contextmanager
def _while_read() -> Iterator[None]:
    """End quietly where the reader of what is printed, head say, has had enough."""
    try:
        yield
    except BrokenPipeError:
        raise typer.Exit(CLOSED_PIPE) from None


class _Listed(_Helped, TyperGroup):
    """What typer makes of a `Group`; alone it would list groups last, and all under one heading."""

    names: dict[str, str]
    first_steps: dict[str, str]

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names that help shows."""
        return list(self.names)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands under their headings."""
        rows: dict[str, list[tuple[str, str]]] = {}
        widest = max(map(len, self.names))
        for name, heading in self.names.items():
            about = self.commands[name].short_help or ""
            rows.setdefault(heading, []).append((name.ljust(widest), about))
        for heading, listed in rows.items():
            with formatter.section(heading):
                formatter.write_dl(listed)
        if self.first_steps:
            with formatter.section("First steps"):
                formatter.write_dl([*self.first_steps.items()])

    def make_context(self, *args: Any, **extra: Any) -> Any:
        """Read the words of the command line; help is printed here."""
        with _while_read():
            return super().make_context(*args, **extra)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that is called."""
        with _one_line(args):
            return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run a command; an interruption by the user ends with a line of its own and exit code 130."""
        try:
            with _while_read(), interruptible():
                return super().invoke(ctx)
        except KeyboardInterrupt:
            # a terminal shows ^C on the line where it stands
            end = "\n" if sys.stderr is not None and sys.stderr.isatty() else ""
            print(f"{end}origami-nlp: interrupted", file=sys.stderr, flush=True)
            raise typer.Exit(130) from None


class Group(typer.Typer):
    """Commands, and groups of them, under one name.

    Parameters
    ----------
    help
        What the group is about.
    completion
        With options that install completion of words for a shell.
    first_steps
        What people want at first, and the commands for it, at the end of the help.
    """

    def __init__(
        self, help: str, completion: bool = False, first_steps: Mapping[str, str] | None = None
    ) -> None:
        self.about, self.names = help, dict[str, str]()
        super().__init__(
            cls=type(
                "Listed", (_Listed,), {"names": self.names, "first_steps": dict(first_steps or {})}
            ),
            help=help,
            no_args_is_help=True,
            add_completion=completion,
            pretty_exceptions_enable=False,
            rich_markup_mode=None,  # rich takes "[rad]" for markup and drops it
        )

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command that is called; of the others, whose options nobody asks for, no parser is made."""
        called, completes = sys.argv[1:2], any(key.endswith("_COMPLETE") for key in os.environ)
        every = self.registered_commands
        mine = [one for one in every if [one.name] == called]
        # without options of its own a group of one command would be that command, which nobody names
        if completes or not mine or self.registered_callback is None:
            return super().__call__(*args, **kwargs)
        groups = self.registered_groups
        self.registered_commands, self.registered_groups = mine, []
        try:
            return super().__call__(*args, **kwargs)
        finally:
            self.registered_commands, self.registered_groups = every, groups

    def add(self, *commands: Callable[..., None], under: str = "Commands") -> None:
        """Add commands under the names of their functions, and a heading."""
        for one in commands:
            about = (one.__doc__ or "").splitlines()[0]  # whole: typer would cut it
            name = one.__name__.replace("_", "-")
            self.command(name, cls=_Command, short_help=about)(one)
            self.names[name] = under

    def add_group(self, name: str, group: Group, under: str = "Commands") -> None:
        """Add a group of commands."""
        self.add_typer(group, name=name, short_help=group.about)
        self.names[name] = under
