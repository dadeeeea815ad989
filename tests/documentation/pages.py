"""Pages of the documentation, taken apart: blocks with their marks, commands in the text, links, headings."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import nbformat

ROOT = Path(__file__).parents[2]
MADE = (
    "docs/reference/commands/",
    "docs/reference/python/",
    "docs/tutorials/",
    "docs/gallery/",
    "out/",
)
"""Written when the site is built."""
BLOCK = re.compile(
    r"(?P<marks>(?:^ *<!-- (?:run|file): .*? -->\n+)*)^(?P<indent> *)```(?P<language>\w*)\n(?P<text>.*?)^ *```$",
    re.MULTILINE | re.DOTALL,
)
MARK = re.compile(r"<!-- (run|file): (.*?) -->", re.DOTALL)


class Block(NamedTuple):
    """One block of code.

    run: "" (always), "slow: why", "not: why" or "exit CODE".
    file: the name under which the block is kept for the blocks after it; else empty.
    """

    line: int
    language: str
    text: str
    run: str
    file: str


def markdown() -> list[Path]:
    """Every page that people write."""
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return [page for page in pages if not name_of(page).startswith(MADE)]


def notebooks() -> list[Path]:
    """Every notebook."""
    return sorted((ROOT / "notebooks").glob("*.ipynb"))


def name_of(page: Path) -> str:
    """Name of a page within the project."""
    return page.relative_to(ROOT).as_posix()


def text_of(page: Path) -> str:
    """Markdown of a page, or of the cells of a notebook."""
    if page.suffix == ".md":
        return page.read_text()
    cells = nbformat.read(page, as_version=4).cells
    return "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")


def blocks(page: Path) -> list[Block]:
    """Blocks of code of a page, in order."""
    text, found = page.read_text(), []
    for match in BLOCK.finditer(text):
        marks = dict(MARK.findall(match["marks"]))
        body = re.sub(f"^{match['indent']}", "", match["text"], flags=re.MULTILINE)
        line = text[: match.start("text")].count("\n")
        found.append(
            Block(line, match["language"], body, marks.get("run", ""), marks.get("file", ""))
        )
    return found


def prose(page: Path) -> str:
    """The text of a page without its blocks of code and its hidden remarks."""
    text = re.sub(r"^ *(`{3,}|:{3,})\{?toctree.*?^ *\1$", "", text_of(page), flags=re.M | re.S)
    text = re.sub(r"^ *```.*?^ *```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)


def inline_commands(page: Path) -> list[str]:
    """Commands in running text and in tables, as written."""
    spans = re.findall(r"`((?:origami-nlp|python -m benchmarks) [^`]+)`", prose(page))
    return [" ".join(span.replace("\\|", "|").split()) for span in spans]


def links(page: Path) -> list[str]:
    """Targets of links and pictures of a page."""
    text = re.sub(r"(`+)[^`]*?\1", "", prose(page))
    written = re.findall(r"\]\(<?([^()\s>]+(?:\([^()]*\))?[^()\s>]*)>?(?: \"[^\"]*\")?\)", text)
    return [
        *written,
        *re.findall(r"<(https?://[^>\s]+)>", text),
        *re.findall(r' (?:src|href)="([^"]+)"', text),
    ]


def anchors(page: Path) -> set[str]:
    """Names to which links into a page may point, as GitHub and the site make them from headings."""
    heads = re.findall(
        r"^#+ +(.*?) *$", re.sub(r"^ *```.*?^ *```$", "", text_of(page), flags=re.M | re.S), re.M
    )
    found: set[str] = set()
    for head in heads:
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", head).lower()
        name = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        found.add(name)
    return found
