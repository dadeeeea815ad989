"""Lines of a terminal as the pages show them, run in this process: `origami-nlp`, pipes, and output into a file."""

from __future__ import annotations

import io
import re
import shlex
import sys
from pathlib import Path

import pytest

from benchmarks.__main__ import app as benchmarks
from origami_nlp.cli import app
from studies.__main__ import app as studies
from tests.command_line import run

PROGRAMS = {
    "origami-nlp": app,
    "python -m benchmarks": benchmarks,
    "python -m studies": studies,
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


def words_of(text: str) -> list[str]:
    """Words of what is printed, without the lines of tables."""
    return re.sub(r"[\u2500-\u257f]", " ", text).split()


def same_word(shown: str, said: str) -> bool:
    """Whether two words are equal, or numbers that differ by rounding only."""
    if shown == said:
        return True
    a, b = NUMBER.fullmatch(shown.strip("(),;:")), NUMBER.fullmatch(said.strip("(),;:"))
    if not (a and b):
        return False
    if a[1] or b[1]:  # a residual: what rounding leaves differs between machines
        return bool(a[1] and b[1]) or 0.0 in (float(a[0]), float(b[0]))
    last = 10.0 ** -len(shown.strip("(),;:").partition(".")[2])
    return (
        "." in shown
        and abs(float(a[0].replace(",", "")) - float(b[0].replace(",", ""))) < 1.5 * last
    )


def differs(shown: str, said: str) -> str:
    """Where the words shown are not those said; a gap stands for any; empty: they agree.

    Seconds (`1.4 s`) are those of a machine and may be any.
    """
    parts = re.split(r"(?<!\S)\.\.\.(?!\S)", shown)
    rest, at = words_of(said), 0
    for number, part in enumerate(parts):
        words = words_of(part)
        places = range(at, len(rest) - len(words) + 1) if number else [0]
        if number and number == len(parts) - 1 and words:
            places = [len(rest) - len(words)] if len(rest) - len(words) >= at else []
        place = next((p for p in places if agrees(words, rest[p:])), None)
        if place is None:
            return f"not printed so: {' '.join(words)!r}\nprinted: {' '.join(rest[at:])!r}"
        at = place + len(words)
    if parts[-1].strip() and at != len(rest):
        return f"printed as well: {' '.join(rest[at:])!r}"
    return ""


def agrees(words: list[str], rest: list[str]) -> bool:
    """Whether words begin a text."""
    seconds = {i for i, word in enumerate(words[1:]) if word.strip("(),;:.") == "s"}
    return len(rest) >= len(words) and all(
        i in seconds or same_word(word, rest[i]) for i, word in enumerate(words)
    )
