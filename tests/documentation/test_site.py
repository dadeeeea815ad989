"""The site: what people type leads to a page for users, and names stand under a task.

That no built page loads anything from elsewhere is looked at where the site is built (`docs/_ext/offline.py` warns,
and warnings are errors there).
"""

import inspect
import json
import re
import sys

import pytest

import origami_nlp
from tests.documentation.pages import ROOT, markdown, name_of, prose

sys.path.append(str(ROOT / "docs" / "_ext"))

FIRST = (
    "bistable",
    "multistable",
    "degree of freedom",
    "stiffness",
    "snap-through",
    "self-folding",
    "Lagrange multiplier",
    "active constraint",
    "waterbomb",
    "FOLD",
    "contact",
    "escape barrier",
)
"""Terms of the glossary, which the search of the site lists first."""
WORDS = (
    *FIRST,
    "Poisson's ratio",
    "Kawasaki",
    "MERLIN",
    "Origami Simulator",
    "FOLD file",
)
"""What people type into the search of the site."""
USERS = [
    page
    for page in markdown()
    if name_of(page).startswith("docs/") and "docs/validation" not in name_of(page)
]


def headings(text: str) -> list[str]:
    """Headings and terms of the glossary of a page."""
    terms = [
        line
        for part in re.findall(r"^```\{glossary\}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
        for line in part.splitlines()
        if line[:1].strip()
    ]
    return [
        *re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S), re.M),
        *terms,
    ]


@pytest.mark.parametrize("word", WORDS)
def test_words_that_people_type_stand_in_a_heading_or_the_glossary(word):
    found = [
        page for page in USERS if any(word.lower() in h.lower() for h in headings(page.read_text()))
    ]
    assert found


@pytest.mark.parametrize("word", FIRST)
def test_words_of_the_field_are_terms_of_the_glossary(word):
    assert word in headings((ROOT / "docs" / "concepts.md").read_text())


def test_the_check_of_words_reads_headings_and_terms_only():
    text = "# One\nbistable\n```{glossary}\nterm\n  bistable\n```\n```text\n# no\n```\n"
    assert headings(text) == ["One", "term"]


def test_every_page_of_the_annex_stands_in_its_list_and_no_other():
    listed = set(re.findall(r"<?validation/(\w+)>", (ROOT / "docs" / "validation.md").read_text()))
    there = {page.stem for page in (ROOT / "docs" / "validation").glob("*.md")}
    assert listed == there and len(there) > 10
    assert not (ROOT / "docs" / "search.md").exists()  # the site writes its search to search.html


@pytest.mark.parametrize("page", USERS, ids=name_of)
def test_pages_for_users_do_not_tell_the_history_of_the_code(page):
    told = r"\b(used to (be|have|say|give)|no longer|before the kernel|today's change|in earlier versions|until now)\b"
    assert not re.findall(told, prose(page))


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

    file = write_page("metasheet:4x4", tmp_path / "new", starts=0)
    text = (tmp_path / "new" / file).read_text()
    (content,) = json.loads(text.split('id="data">')[1].split("</script>")[0])
    assert len(content["stations"]) == 2 and len(content["body"]["creases"]) == 24
    assert "2 pairs of facets" in text or "contact" in text
    assert len(text) < 2_000_000
    assert f'src="a/{file}#turning"' in frame("metasheet:4x4", f"a/{file}")


def test_every_picture_is_made_by_the_one_command_and_stands_on_a_page():
    from pictures import FOLDER, PICTURES, SLOW

    files = {file.relative_to(FOLDER) for file in FOLDER.rglob("*.*")}
    made = {file.stem if len(file.parts) == 1 else file.parts[0] for file in files}
    assert made == set(PICTURES) and set(SLOW) < set(PICTURES)
    text = "\n".join(page.read_text() for page in markdown())
    assert [str(file) for file in files if f"figures/{file.as_posix()}" not in text] == []
