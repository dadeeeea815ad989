"""Every link of the pages and the notebooks leads somewhere; those to other sites have the form of an address."""

import re
from urllib.parse import unquote, urlsplit

import pytest

from tests.documentation.pages import ROOT, anchors, links, markdown, name_of, notebooks


@pytest.mark.parametrize("page", [*markdown(), *notebooks()], ids=name_of)
def test_links_resolve(page):
    broken = []
    for link in links(page):
        parts = urlsplit(link)
        if parts.scheme:
            if not (parts.scheme == "https" and "." in parts.netloc):
                broken.append(f"{link}: no address")
            continue
        target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
        if not target.exists():
            broken.append(f"{link}: no such file")
        elif parts.fragment and target.suffix in (".md", ".ipynb"):
            if parts.fragment not in anchors(target):
                broken.append(f"{link}: no such heading")
    assert not broken, "\n".join(broken)


def test_tests_that_pages_and_docstrings_name_exist():
    code = [path for room in ("origami_nlp", "symbolic") for path in (ROOT / room).rglob("*.py")]
    named = {
        (name_of(page), test)
        for page in (*markdown(), *notebooks(), *code)
        for test in re.findall(r"\btests/[\w/]+\.py\b", page.read_text())
    }
    assert len(named) > 5
    assert not [f"{page}: {test}" for page, test in sorted(named) if not (ROOT / test).is_file()]


def test_the_check_sees_broken_links(tmp_path):
    page = tmp_path / "a.md"
    page.write_text(
        "# One `two`\n[x](nowhere.md), [y](#one-two) ![z](b.png)\n\n```text\n[no](link)\n```\n"
    )
    assert links(page) == ["nowhere.md", "#one-two", "b.png"] and anchors(page) == {"one-two"}
