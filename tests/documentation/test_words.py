"""Words of the field: private ones are in no name, message, docstring or page; the notation page names what exists."""

import dataclasses
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

import origami_nlp
from tests.documentation.pages import ROOT, markdown, name_of

NAMES = set(
    """
    Told told Brief brief Full Turnable Station Track Programme programme Posed Touch Lying Choice Placed press pressing
    ways_out Lower thin_at leads_somewhere search_spheres let_go Way Web Arc Node Half Over Overview overview freedoms
    examine Alike group_alike find_boundaries Boundaries Moving Ended CLOSES TOUCHES SAME BESIDE ENDS TYPED Stand stands
    SheetTerrain SheetSearch TouchStrata TouchStarts TouchSystem Twin programmes tell
    freedom one_freedom sheets Sheets on_sheet
    """.split()
)
"""Identifiers that had a private meaning."""
WORDS = {
    r"(un)?told|tells?": "reported, printed, distinguished",
    r"shut": "fully folded, at its fold limit",
    r"holds? still": "is stable, is in equilibrium",
    r"ways? out": "escape path, branch direction, exit",
    r"(one |no |without )freedom|freedoms": "degrees of freedom",
    r"complain(s|ed)?": "raise an error",
    r"moment (m )?(that )?passes round": "constant internal moment",
    r"how it is shared is open": "contact forces statically indeterminate",
    r"fell back flat": "converged to the flat state",
    r"did not arrive": "did not converge",
    r"no states? of paper": "rejected",
    r"programmes?": "problem; linear, convex or conic program",
    r"gone out of": "followed",
    r"leads? somewhere": "is followed by admissible states",
    r"crossroads?": "branch points",
    r"(on|leaves?|other|two) (the )?sheets? q|(the|this) other sheet": "lift (q = +1 or -1), branch, leaf",
    r"why it is (?-i:none)|that (is|are) (?-i:none)(?! of)": "is not one",
}
"""What is not said, and what is."""
ENDS = r"(?<![\w./-])(?:{})(?![\w/]|\.\w)"
"""A word stands alone: in no path, and in no name with a dot."""
EACH = {word: re.compile(ENDS.format(word).replace(" ", r"\s+"), re.IGNORECASE) for word in WORDS}
ANY = re.compile(ENDS.format("|".join(WORDS)).replace(" ", r"\s+"), re.IGNORECASE)
PACKAGE = Path(origami_nlp.__file__).parent


def sources() -> list[Path]:
    """Modules of the package."""
    return sorted(PACKAGE.rglob("*.py"))


@cache
def parts(path: Path) -> tuple[list[tuple[int, str]], frozenset[str]]:
    """Strings and then comments of a file of Python, with their lines, and its names."""
    strings: list[tuple[int, str]] = []
    comments: list[tuple[int, str]] = []
    found: set[str] = set()
    for token in tokenize.generate_tokens(io.StringIO(path.read_text()).readline):
        if token.type == tokenize.STRING:
            strings.append((token.start[0], token.string))
        elif token.type == tokenize.COMMENT:
            comments.append((token.start[0], token.string))
        elif token.type == tokenize.NAME:
            found.add(token.string)
    return [*strings, *comments], frozenset(found)


def texts(path: Path) -> list[tuple[int, str]]:
    """Line and text of what people read in a file: pages whole, of modules strings and comments."""
    return [(1, path.read_text())] if path.suffix == ".md" else parts(path)[0]


def private(path: Path) -> Iterator[str]:
    """Yield each private word in a file: its line, and what is said instead."""
    for line, text in texts(path):
        plain = re.sub(r"`[^`\n]*`|\{[^{}\n]*\}|\]\([^)\s]*\)", lambda m: "x" * len(m[0]), text)
        if not ANY.search(plain):
            continue
        for word, instead in WORDS.items():
            for match in EACH[word].finditer(plain):
                at = line + text.count("\n", 0, match.start())
                yield f"{at}: {match[0]!r}, say: {instead}"


def test_texts_use_the_words_of_the_field():
    found = {name_of(path): list(private(path)) for path in [*sources(), *markdown()]}
    assert not {name: words for name, words in found.items() if words}


def test_names_use_the_words_of_the_field():
    found = {name_of(path): parts(path)[1] & NAMES for path in sources()}
    assert not {name: words for name, words in found.items() if words}


def test_the_check_sees_private_words(tmp_path):
    page, module = tmp_path / "a.md", tmp_path / "a.py"
    page.write_text(
        "It is told\nwhich states hold\nstill; `told` is a name, and [a](told.md) a link.\n"
    )
    module.write_text('"""One ways out."""\nx = f"{told} freedoms"  # shut\n')
    assert [line.split(":")[0] for line in private(page)] == ["1", "2"]
    assert [line.split(":")[0] for line in private(module)] == ["1", "2", "2"]


# ---------------------------------------------------------------- the notation page


def named() -> list[str]:
    """Names of the package in the last column of the tables of the notation page."""
    rows = [
        line for line in (ROOT / "docs" / "notation.md").read_text().splitlines() if line[:1] == "|"
    ]
    cells = [re.split(r"(?<!\\)\|", row)[3] for row in rows]
    return sorted(
        {name for cell in cells for name in re.findall(r"`([A-Za-z_][\w.]*)`(?! \()", cell)}
    )


def found(name: str) -> bool:
    """Whether a dotted name, from the package on, is a module, an attribute, or a field of a dataclass."""
    thing, where = origami_nlp, "origami_nlp"
    for part in name.split("."):
        where += f".{part}"
        if dataclasses.is_dataclass(thing) and part in {
            field.name for field in dataclasses.fields(thing)
        }:
            return name.endswith(part)
        try:
            thing = getattr(thing, part, None) or import_module(where)
        except ImportError:
            return False
    return True


@pytest.mark.parametrize("name", [name for name in named() if name != "origami_nlp"])
def test_names_of_the_notation_page_exist(name):
    assert found(name)


def test_the_notation_page_names_much():
    assert len(named()) > 40 and not found("JudgedState.lambda_") and not found("kkt.Lambda")
