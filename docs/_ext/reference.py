"""The reference, written when the site is built: one page for each command and room."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path

from typer.main import get_command

import origami_nlp
from origami_nlp.cli import app as command_line

ROOMS = (
    "drawings pattern problem kkt search minima paths inverse_design proof contact "
    "barriers continuation chart pattern_problem pattern_states validity sweep paper "
    "paper.cone"
).split()
"""Rooms whose faces users of Python need, in the order of the pages."""

TASKS = {
    "Find stable states": (
        "find_minima classify check_admissible MinimaResult JudgedState SearchOptions"
    ),
    "State a vertex or a pattern": (
        "examples read_scene read_pattern from_mesh read_fold_scene parse_scene format_scene "
        "Scene Vertex Pattern Load"
    ),
    "Measured hinges": "fit_hinge HingeData MeasuredHinge",
    "How a sheet moves": "analyze_mobility find_motion Mobility Motion",
    "Is a folded state real, in how many layer orders": "check layer_orders Validity LayerOrders",
    "Loads, snaps, barriers": (
        "load_path find_barriers find_contacts LoadPath Barriers ContactReport"
    ),
    "Over a parameter": (
        "follow find_bifurcation_set sweep Atlas BifurcationSet ContinuationOptions"
    ),
    "Springs for given states": "design inverse_design Design",
    "Other formats": "convert DrawingOptions",
    "Draw, write, read": "draw draw_minima view save read_result to_frame write_fold write_mesh",
    "The whole energy landscape": (
        "find_landscape find_critical_points find_space find_segments ExactLandscape CriticalPoints Space"
    ),
    "Proofs, the model, what solvers see": "ProofOptions pose solve IpoptAnswer State Stratum",
    "The source paper": "paper",
    "Errors and version": "OrigamiError __version__",
}
"""Every name of `origami_nlp`, by what people want to do."""


# ---------------------------------------------------------------- commands


def commands(command=None, path: tuple[str, ...] = (), parent=None) -> Iterator[tuple]:
    """Every command that is no group, in the order of the help: its words, and its context."""
    command = command or get_command(command_line)
    context = command.context_class(command, info_name=(path or ["origami-nlp"])[-1], parent=parent)
    if not hasattr(command, "list_commands"):
        yield path, context
        return
    for name in command.list_commands(context):
        yield from commands(command.get_command(context, name), (*path, name), context)


def plain(text: str) -> str:
    """Words of the help as Markdown that shows them as they are."""
    for sign in "\\`*_<>[]|":
        text = text.replace(sign, "\\" + sign)
    return " ".join(text.split())


def option_rows(context) -> Iterator[str]:
    """Each argument and option as a definition: its spelling, then what it does."""
    for one in context.command.get_params(context):
        record = one.get_help_record(context)
        if record and "--help" not in one.opts:
            spelled, help = record
            yield f"`{spelled.strip()}`\n: {plain(help)}\n"


def command_page(path: tuple[str, ...], context) -> str:
    """The page of one command."""
    words = inspect.cleandoc(context.command.help or "").split("\n\n")
    rows = "\n".join(option_rows(context))
    usage = f"{context.command_path} {' '.join(context.command.collect_usage_pieces(context))}"
    reported = "\n\n".join(plain(part) for part in words)
    return f"# {' '.join(path)}\n\n{reported}\n\n```text\n{usage}\n```\n\n{rows}"


def overview() -> str:
    """Tables of all commands, a group after the other, and the order of their pages."""
    groups: dict[str, list[tuple]] = {}
    for path, context in commands():
        groups.setdefault(" ".join(path[:-1]), []).append((path, context.command))
    parts = []
    for group, members in groups.items():
        parts += [f"## {group}\n"] if group else []
        parts += ["| command | what it does |", "|---|---|"]
        for path, command in members:
            about = plain((command.help or "").strip().splitlines()[0])
            parts.append(f"| [{' '.join(path)}](commands/{'_'.join(path)}.md) | {about} |")
        names = "\n".join(f"commands/{'_'.join(path)}" for path, _ in members)
        parts.append(f"\n:::{{toctree}}\n:hidden:\n\n{names}\n:::\n")
    return "\n".join(parts)


# ---------------------------------------------------------------- docstrings


def by_task() -> str:
    """Tables of every public name of the package, by task, each with the first line of its docstring."""
    parts = []
    for task, names in TASKS.items():
        parts += [f"## {task}\n", "| name | what it does |", "|---|---|"]
        for name in names.split():
            thing = getattr(origami_nlp, name)
            if inspect.ismodule(thing):
                role = f"[`{name}`](python/{thing.__name__}.rst)"
                if not any(thing.__name__ == f"origami_nlp.{room}" for room in ROOMS):
                    role = f"`{name}`"
            else:
                role = f"`{name}`" if name.startswith("_") else f"{{py:obj}}`~origami_nlp.{name}`"
            about = "The version." if name == "__version__" else inspect.getdoc(thing) or ""
            words = re.split(r"`+([^`]*)`+", about.splitlines()[0])
            shown = [
                f"`{part}`" if i % 2 else re.sub(r"([\\*_<>\[\]|])", r"\\\1", part)
                for i, part in enumerate(words)
            ]
            parts.append(f"| {role} | {''.join(shown)} |")
        parts.append("")
    return "\n".join(parts)


def face_page(name: str) -> str:
    """The page of a face: what stands on it, by kind; what stands on the face of the package is named only."""
    room = import_module(name)
    top = set() if room is origami_nlp else set(origami_nlp.__all__)
    heading = (inspect.getdoc(room) or name).split("\n\n")[0]
    title = f"``{name}``"
    lines = [title, "=" * len(title), "", f".. currentmodule:: {name}", "", heading, ""]
    shown = {n: getattr(room, n) for n in sorted(room.__all__, key=str.lower)}
    inner = [n for n, what in shown.items() if inspect.ismodule(what)]
    known = [n for n in shown if n in top and getattr(origami_nlp, n) is shown[n]]
    if known:
        links = ", ".join(f":py:obj:`~origami_nlp.{n}`" for n in known)
        lines += [f"Described with ``origami_nlp`` itself: {links}.", ""]
    kinds = [
        ("Functions", inspect.isroutine, "autofunction"),
        ("Classes", inspect.isclass, "autoclass"),
    ]
    for head, of_kind, directive in kinds:
        names = [n for n, what in shown.items() if of_kind(what) and n not in known]
        lines += [head, "-" * len(head), ""] if names else []
        for n in names:
            members = ["   :members:"] if directive == "autoclass" else []
            lines += [f".. {directive}:: {n}", *members, ""]
    if inner:
        lines += ["Modules: " + ", ".join(f"``{name}.{n}``" for n in inner) + ".", ""]
    return "\n".join(lines)


def one_by_one(text: str) -> str:
    """Give each of the attributes `a, b` that share their words these words: else `a` is read as the type of `b`."""
    before, head, after = text.partition("Attributes\n----------\n")
    reported, *others = re.split(r"(?=^\w+\n-{3,}$)", after, maxsplit=1, flags=re.MULTILINE)
    shared = r"^(?P<names>\w+(?:, \w+)+)\n(?P<words>(?: +.*\n)+)"

    def each(found: re.Match) -> str:
        return "".join(f"{name}\n{found['words']}" for name in found["names"].split(", "))

    return before + head + re.sub(shared, each, reported, flags=re.MULTILINE) + "".join(others)


def as_shown(app, what: str, name: str, thing, options, lines: list[str]) -> None:
    """Make a docstring say as a page what it says as text: bars, and fields one below another."""
    lines[:] = one_by_one("\n".join(lines) + "\n").splitlines()
    named = {one.name for one in fields(thing)} if is_dataclass(thing) else set()
    within = False  # the words of a field
    for i, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):  # |x| is a size, not a name to be put in
            spans = re.split(r"(`[^`]*`)", line)
            line = "".join(s if s.startswith("`") else s.replace("|", "\\|") for s in spans)
        head, _, reported = line.partition(": ")
        if head in named and reported:
            line, within = f":ivar {head}: {reported}", True
        elif within:
            within = bool(line.strip())
            line = "    " + line.strip()
        lines[i] = line


# ---------------------------------------------------------------- files


def write(app) -> None:
    """Write all pages that have changed, and take away those that are no more."""
    pages = {f"commands/{'_'.join(path)}.md": command_page(path, c) for path, c in commands()}
    pages["commands/overview.txt"] = overview()
    pages["python/overview.txt"] = by_task()
    for name in ("origami_nlp", *(f"origami_nlp.{room}" for room in ROOMS)):
        pages[f"python/{name}.rst"] = face_page(name)
    folder = Path(app.srcdir) / "reference"
    for part in ("commands", "python"):
        (folder / part).mkdir(parents=True, exist_ok=True)
        for old in (folder / part).iterdir():
            if f"{part}/{old.name}" not in pages:
                old.unlink()
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def setup(app) -> dict:
    """Write the pages before sources are listed."""
    app.connect("builder-inited", write)
    app.connect(
        "autodoc-process-docstring", as_shown, priority=400
    )  # before numpydoc's sections are read
    return {"parallel_read_safe": True, "parallel_write_safe": True}
