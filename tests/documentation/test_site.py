"""The site: pages stand in their lists, and names under a task.

That no built page loads anything from elsewhere is looked at where the site is built (`docs/_ext/offline.py` warns,
and warnings are errors there).
"""

import inspect
import json
import re
import sys

import pytest

import origami_nlp
from tests.documentation.pages import ROOT, markdown

sys.path.append(str(ROOT / "docs" / "_ext"))


def test_every_page_of_the_annex_stands_in_its_list_and_no_other():
    listed = set(re.findall(r"<?validation/(\w+)>", (ROOT / "docs" / "validation.md").read_text()))
    there = {page.stem for page in (ROOT / "docs" / "validation").glob("*.md")}
    assert listed == there and len(there) > 5
    assert not (ROOT / "docs" / "search.md").exists()  # the site writes its search to search.html


def test_every_public_name_stands_under_one_task():
    pytest.importorskip("typer")
    from reference import TASKS, by_task

    names = " ".join(TASKS.values()).split()
    assert sorted(names) == sorted(origami_nlp.__all__) and names[0] == "find_minima"
    for line in by_task().splitlines():
        if line.startswith("| {py:obj}") or line.startswith("| [`"):
            assert re.fullmatch(r"\| .+ \| \S.+ \|", line)
    assert inspect.getdoc(origami_nlp.find_minima).splitlines()[0] in by_task()


def test_what_pages_load_is_seen():
    pytest.importorskip("sphinx", reason="extra docs")
    pytest.importorskip("latex2mathml", reason="extra docs")
    from offline import loaded

    text = (
        '<script async src="https://a.b/x.js"></script> <link rel="stylesheet" href="//c.d/y.css">'
        '<a href="https://e.f">link</a> <link rel="canonical" href="https://g.h"> <img src="z.png">'
        "@import 'https://i.j/k.css'; url(https://l.m/n.woff2) url(fonts/o.woff2)"
    )
    assert list(loaded(text)) == [
        "https://a.b/x.js",
        "//c.d/y.css",
        "https://i.j/k.css",
        "https://l.m/n.woff2",
    ]


def test_the_landing_page_shows_states_that_the_search_finds(tmp_path):
    pytest.importorskip("docutils", reason="extra docs")
    from turning import frame, write_page

    file = write_page("metasheet:3x3", tmp_path / "new", starts=0)
    text = (tmp_path / "new" / file).read_text()
    content = json.loads(text.split('id="data">')[1].split("</script>")[0])
    assert len(content["stations"]) == 2 and len(content["body"]["creases"]) == 12
    assert "2 pairs of facets" in text or "contact" in text
    assert len(text) < 2_000_000
    assert f'src="a/{file}#turning"' in frame("metasheet:3x3", f"a/{file}")


def test_every_picture_is_made_by_the_one_command_and_stands_on_a_page():
    from pictures import FOLDER, PICTURES, SLOW

    files = {file.relative_to(FOLDER) for file in FOLDER.rglob("*.*")}
    made = {file.stem if len(file.parts) == 1 else file.parts[0] for file in files}
    assert made == set(PICTURES) and set(SLOW) < set(PICTURES)
    text = "\n".join(page.read_text() for page in markdown())
    assert [str(file) for file in files if f"figures/{file.as_posix()}" not in text] == []


WORDS = (
    *("disconnectivity", "bistable", "Kresling", "Yoshimura", "hysteresis", "snap-through"),
    *("pathway", "transition graph", "self-stress", "tessellation", "actuated", "MERLIN"),
)
"""Of the field: what a reader types into the search of the site."""


@pytest.mark.parametrize("word", WORDS)
def test_words_of_the_field_are_on_a_page_for_users(word):
    pages = [p for p in markdown() if not {"validation", "reference"} & {*p.parts, p.stem}]
    assert any(word.lower() in p.read_text().lower() for p in pages)
