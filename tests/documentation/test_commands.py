"""Every command and every Python block of the documentation runs, in the order of its page: exit codes and numbers
are those shown.  `python -m tests.documentation --write [PAGE ...]` renews what pages show.

A remark before a block says what differs: `<!-- run: slow: why -->` (with the long studies only),
`<!-- run: not: why -->`, `<!-- run: exit 2 -->` (the exit code), `<!-- file: NAME -->` (kept under this name for the
blocks that follow).
"""

import contextlib
import functools
import io
import re
import shutil
import tomllib

import pytest
from typer.main import get_command

from tests.computed_once import minima_once
from tests.documentation import shell
from tests.documentation.pages import ROOT, blocks, inline_commands, markdown, name_of

TERMINAL = ("bash", "console")
PAGES = [
    page for page in markdown() if any(b.language in (*TERMINAL, "python") for b in blocks(page))
]
DEAR = (
    "README bistable_waterbomb by_ipopt check check_a_claim cones design export extend files fold getting_started "
    "hinges loads many_scenes noise others paths pattern periodic"
).split()
"""Pages of several seconds: other tests run such commands; what they print waits for the long studies."""
SLOW = [page for page in PAGES if any(b.run.startswith("slow") for b in blocks(page))]


@pytest.fixture(autouse=True)
def _searched_once(monkeypatch):
    """Pages search the same scenes as other pages, and the panels that other tests have."""
    monkeypatch.setattr("origami_nlp.pattern_states.find_states", minima_once)


def run_block(block, names):
    """Run one block in the folder where we are; what is wrong is told with its line.  Returns what Python prints."""
    if block.file:
        with open(block.file, "w") as file:
            file.write(block.text)
    if block.language == "python":
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(compile(block.text, f"block of line {block.line}", "exec"), names)
        return said.getvalue()
    if block.language in TERMINAL:
        wanted = int(block.run.removeprefix("exit ")) if block.run.startswith("exit ") else 0
        lines, shown = shell.commands(block.text), shell.shown_after(block.text)
        assert lines and len(lines) == len(shown)
        for line, expected in zip(lines, shown, strict=True):
            code, said = shell.run_line(line)
            assert code == wanted, f"line {block.line}: {line}\n{said}"
            wrong = shell.differs(expected, said)
            assert not wrong, f"line {block.line}: {line}\n{wrong}"
    return ""


def run_page(page, folder, long):
    """Run the blocks of a page in a folder of its own that holds the files of the documentation."""
    shutil.copytree(ROOT / "docs" / "files", folder, dirs_exist_ok=True)
    names = {"__name__": "__main__"}
    found = blocks(page)
    for block, after in zip(found, [*found[1:], None], strict=True):
        if block.run.startswith("not: ") or (block.run.startswith("slow: ") and not long):
            continue
        said = run_block(block, names)
        if said and after is not None and after.language == "text":
            wrong = shell.differs(after.text, said)
            assert not wrong, f"line {block.line}: {wrong}"


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=[pytest.mark.slow] if p.stem in DEAR else []) for p in PAGES],
    ids=name_of,
)
def test_blocks_run_and_print_what_is_shown(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run_page(page, tmp_path, long=False)


@pytest.mark.slow
@pytest.mark.parametrize("page", SLOW, ids=name_of)
def test_long_blocks_run_and_print_what_is_shown(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run_page(page, tmp_path, long=True)


@pytest.mark.parametrize("page", markdown(), ids=name_of)
def test_blocks_are_marked_with_reasons_and_none_hides_a_command(page):
    for block in blocks(page):
        assert re.fullmatch(r"|(slow|not): \S.{10,}|exit \d", block.run, re.DOTALL), block
        if re.search(r"^(\$ )?origami-nlp ", block.text, re.MULTILINE):
            assert block.language in TERMINAL, (
                f"line {block.line}: a command in a block of no shell"
            )
        if block.language == "toml":
            tomllib.loads(block.text)


# ---------------------------------------------------------------- commands that are named, not shown


@functools.cache
def commands_of(program):
    return get_command(shell.PROGRAMS[program])


def misnamed(text):
    """What of a command as people write it (`a|b`, `[--option VALUE]`) the command line does not know."""
    program, words = shell.called(re.sub(r"[][()]", " ", text).split())
    commands = [commands_of(program)]
    while words and hasattr(commands[0], "list_commands") and not words[0].startswith("-"):
        inner = [c.get_command(None, name) for c in commands for name in words[0].split("|")]
        if None in inner:
            return f"no command {words[0]}"
        commands, words = inner, words[1:]
    known = {o for c in commands for p in c.params for o in (*p.opts, *p.secondary_opts)} | {
        "--help"
    }
    return ", ".join(w for w in words if w.startswith("--") and w.split("=")[0] not in known)


@pytest.mark.parametrize("page", markdown(), ids=name_of)
def test_commands_in_the_text_exist_with_their_options(page):
    shown = [
        line
        for block in blocks(page)
        if block.language in TERMINAL
        for whole in shell.commands(block.text)
        for line in re.split(r"\||&&", whole.split(" #")[0])
    ]
    named = [
        *inline_commands(page),
        *(s.strip() for s in shown if s.strip().startswith(tuple(shell.PROGRAMS))),
    ]
    wrong = {text: why for text in named if (why := misnamed(text))}
    assert not wrong


# ---------------------------------------------------------------- the runner itself


def test_the_runner_sees_what_is_wrong(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, said = shell.run_line("origami-nlp example degree6 --alpha pi/3 > a.toml")
    assert (code, said) == (0, "") and "pi/3" in (tmp_path / "a.toml").read_text()
    code, said = shell.run_line("origami-nlp example degree6 --alpha pi/3 | origami-nlp inspect -")
    assert code == 0 and "degree 6" in said
    with pytest.raises(AssertionError, match="only origami-nlp"):
        shell.run_line("rm -r a.toml")
    assert not shell.differs("one 1.50 2e-16 ... end 3 s", "one 1.501 7e-17 and so on, end 9 s")
    for shown in ("one 1.52", "one 1.50 2e-16 ... 4", "2 ...", "one"):
        assert shell.differs(shown, "one 1.501 7e-17 and so on, end 9 s"), shown
    assert shell.renewed("a 1.5\n...\nend 3 m\n", "a 1.6\nb\nend 4 m\n") == "a 1.6\n...\nend 4 m\n"
    assert misnamed("origami-nlp paper cone count|phase [--degree N]") == ""
    assert misnamed("origami-nlp paper cone count|phases") and misnamed(
        "origami-nlp minima X --nothing"
    )
