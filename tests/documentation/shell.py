"""Lines of a terminal as the pages show them, run in this process: `origami-nlp`, pipes, and output into a file."""

from __future__ import annotations

import io
import re
import shlex
import sys
from difflib import get_close_matches
from pathlib import Path

import pytest

from benchmarks.__main__ import app as benchmarks
from origami_nlp.cli import app
from tests.command_line import run

PROGRAMS = {
    "origami-nlp": app,
    "python -m benchmarks": benchmarks,
}
"""What is run here, by the words that call it."""

GAP = "..."
"""Stands for words that a page leaves out of what is printed."""
NUMBER = re.compile(r"[-+]?\d[\d,]*\.?\d*(e[-+]?\d+)?")


def commands(text: str) -> list[str]:
    """Lines to be run: all of them, or those after a prompt; a backslash at the end goes on."""
    lines = text.replace("\\\n", " ").splitlines()
    if any(line.startswith("$ ") for line in lines):
        return [line[2:] for line in lines if line.startswith("$ ")]
    return [line for line in lines if shlex.split(line, comments=True)]


def shown_after(text: str) -> list[str]:
    """What a page shows after each prompt; without prompts nothing is shown."""
    if not re.search(r"^\$ ", text, re.MULTILINE):
        return [GAP] * len(commands(text))
    parts = re.split(r"^\$ .*(?:\\\n.*)*\n?", text, flags=re.MULTILINE)[1:]
    return [part if part.strip() else GAP for part in parts]


def called(words: list[str]) -> tuple[str, list[str]]:
    """Part what calls a program from its arguments."""
    long = 3 if words[:2] == ["python", "-m"] else 1
    return " ".join(words[:long]), words[long:]


def run_line(line: str) -> tuple[int, str]:
    """Run a line in the folder where we are; exit code of its last command, and all that it shows."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars="|>")
    lexer.whitespace_split = True
    target, pipeline = None, [[]]
    for word in lexer:
        if word == "|":
            pipeline.append([])
        elif word == ">":
            target = Path(next(lexer))
        else:
            pipeline[-1].append(word)
    given, said, code = "", "", 0
    for words in pipeline:
        program, arguments = called(words)
        assert program in PROGRAMS, f"{line!r}: only origami-nlp is run here; else say why not"
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(given.encode()), "utf-8"))
            code, given, complained = run(*arguments, commands=PROGRAMS[program])
        said += complained
    if target:
        target.write_text(given)
        given = ""
    return code, said + given


def numbers_of(text: str) -> list[str]:
    """Numbers among the words of what is printed; seconds (`1.4 s`) are those of a machine and left out."""
    words = [w.strip("(),;:") for w in re.sub(r"[\u2500-\u257f]", " ", text).split()]
    after = [*words[1:], ""]
    return [w for w, n in zip(words, after, strict=False) if NUMBER.fullmatch(w) and n != "s"]


def same_number(shown: str, said: str) -> bool:
    """Whether two numbers are equal, or differ by rounding only."""
    if shown == said:
        return True
    a, b = NUMBER.fullmatch(shown), NUMBER.fullmatch(said)
    assert a and b
    if a[1] or b[1]:  # a residual: what rounding leaves differs between machines
        return bool(a[1] and b[1]) or 0.0 in (float(a[0]), float(b[0]))
    last = 10.0 ** -len(shown.partition(".")[2])
    far = abs(float(a[0].replace(",", "")) - float(b[0].replace(",", "")))
    return "." in shown and far < 1.5 * last


def differs(shown: str, said: str) -> str:
    """Where the numbers shown are not those printed; a gap stands for any; empty: they agree."""
    parts = re.split(r"(?<!\S)\.\.\.(?!\S)", shown)
    rest, at = numbers_of(said), 0
    for number, part in enumerate(parts):
        wanted = numbers_of(part)
        places = range(at, len(rest) - len(wanted) + 1) if number else [0]
        if number and number == len(parts) - 1 and wanted:
            places = [len(rest) - len(wanted)] if len(rest) - len(wanted) >= at else []
        place = next((p for p in places if agrees(wanted, rest[p:])), None)
        if place is None:
            return f"not printed so: {' '.join(wanted)!r}\nprinted: {' '.join(rest[at:])!r}"
        at = place + len(wanted)
    if (len(parts) == 1 or numbers_of(parts[-1])) and at != len(rest):
        return f"printed as well: {' '.join(rest[at:])!r}"
    return ""


def agrees(wanted: list[str], rest: list[str]) -> bool:
    """Whether numbers begin a list of them."""
    return len(rest) >= len(wanted) and all(map(same_number, wanted, rest))


def renewed(shown: str, said: str) -> str:
    """What a page shows, as it is printed now: whole, or of lines beside gaps each the most similar one, in order."""
    if GAP not in shown.split():
        return said
    rest, out = said.splitlines(), []
    for line in shown.splitlines():
        alike = get_close_matches(line, rest, 1, 0.6) if line.strip() not in ("", GAP) else []
        if alike and GAP not in line.split():
            out.append(alike[0])
            rest = rest[rest.index(alike[0]) + 1 :]
        else:
            out.append(line)
    return "\n".join(out) + "\n"
