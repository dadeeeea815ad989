"""What is named to be cited: against what was called while the result was found, and the file CITATION.cff."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.proof import Check

ROOT = Path(__file__).resolve().parents[1]
CALLED = """
import json, math, sys
import casadi, clarabel, scipy.sparse
import origami_nlp as o

def book():
    targets = o.inverse_design.Targets(
        o.Vertex(("pi/2",) * 4), (o.inverse_design.Target("book", (math.pi / 3, 0.0, math.pi / 3, 0.0)),)
    )
    return o.design(targets)

CASES = {
    "vertex": lambda: o.find_minima(o.examples.miura("pi/3", contact="none"), max_starts=4, prove=False),
    "proof": lambda: o.find_minima(o.examples.miura("pi/3", contact="fold-limits"), prove=True),
    "one vertex as a pattern": lambda: o.find_minima("miura:2x2", starts=1),
    "mobility": lambda: o.analyze_mobility(o.examples.pattern("miura", 2, 3)),
    "design": book,
}
used = set()

def watched(owner, name, key):
    call = getattr(owner, name)
    def told(*given, **more):
        used.add(key)
        return call(*given, **more)
    setattr(owner, name, told)

watched(casadi.Function, "__init__", "casadi")
watched(casadi, "nlpsol", "ipopt")
watched(clarabel, "DefaultSolver", "clarabel")
for kind in (scipy.sparse.coo_array, scipy.sparse.csc_array, scipy.sparse.csc_matrix):
    watched(kind, "__init__", "scipy")
said = {}
for case, find in CASES.items():
    used.clear()
    for module in [m for name, m in sys.modules.items() if name.startswith("origami_nlp.")]:
        for one in vars(module).values():
            if hasattr(one, "cache_clear"):  # functions that an earlier case compiled
                one.cache_clear()
    result = find()
    said[case] = [sorted(used), [one.key for one in o.citations(result).references]]
print(json.dumps(said))
"""


def test_what_is_cited_is_what_was_called():
    out = subprocess.run([sys.executable, "-c", CALLED], capture_output=True, text=True, check=True)
    for case, (used, cited) in json.loads(out.stdout.splitlines()[-1]).items():
        always = {"origami_nlp", "grasinger_lagrangian", "numpy"}
        assert always <= set(cited), case
        assert sorted(set(cited) - always) == used, case


@pytest.fixture(scope="module")
def twist(tmp_path_factory):
    """A FOLD file, and the mobility of what it holds."""
    file = tmp_path_factory.mktemp("fold") / "twist.fold"
    file.write_text(json.dumps(o.examples.crease_pattern("squaretwist")))
    return o.analyze_mobility(file)


def keys(found):
    return [one.key for one in found.references]


def test_files_read_and_written_are_cited(twist, tmp_path):
    assert "fold" in keys(o.citations(twist))
    sheet = o.analyze_mobility(o.examples.pattern("miura", 2, 2))
    assert "fold" not in keys(o.citations(sheet))
    assert {"fold", "matplotlib"} <= set(keys(o.citations(sheet, "a.FOLD", tmp_path / "b.pdf")))
    assert keys(o.citations(sheet, "a.json")) == keys(o.citations(sheet))


def test_a_check_of_a_proof_cites_ball_arithmetic():
    assert "arb" in keys(o.citations(Check("", (), (), {}, (), {}, ())))


def test_what_is_no_result_is_refused():
    for wrong in (3, "minima.json", None):
        with pytest.raises(OptionError, match="result = "):
            o.citations(wrong)


def entries(text):
    """BibTeX entries, read by a parser of this test: type, key, fields."""
    for kind, key, body in re.findall(r"@(\w+)\{(\w+),\n(.*?)\n\}", text, flags=re.S):
        fields = dict(re.findall(r"^  (\w+) = \{(.*)\},$", body, flags=re.M))
        assert all(v.count("{") == v.count("}") for v in fields.values())
        assert len(fields) == len(body.splitlines())
        yield kind, key, fields


def test_bibtex_is_complete_and_free_of_tex_commands(twist):
    found = o.citations(twist, "a.png")
    read = list(entries(found.bibtex()))
    assert [key for _, key, _ in read] == keys(found)
    needed = {"article": {"journal", "year", "volume", "pages", "doi"}, "inproceedings": {"year"}}
    for kind, _, fields in read:
        assert {"author", "title"} | needed.get(kind, set()) <= set(fields)
        assert not re.search(r"(?<!\\)[_&%#$]", fields["title"] + fields.get("journal", ""))
        assert re.fullmatch(r"10\.\d{4,9}/\S+|", fields.get("doi", ""))
    assert str(found).count("\n[") == len(read) and f"version {o.__version__}" in str(found)


def test_the_frame_has_a_row_each(twist):
    pytest.importorskip("pandas")
    assert list(o.citations(twist).to_frame()["key"]) == keys(o.citations(twist))


# ---------------------------------------------------------------- CITATION.cff

PERSON = {"family-names", "given-names", "affiliation"}
ENTITY = {"name"}
REFERENCE = {
    "type", "title", "authors", "notes", "doi", "repository-code", "year", "journal", "url",
}  # fmt: skip
WHOLE = {
    "cff-version", "message", "type", "title", "abstract", "version", "license", "authors", "keywords", "references",
    "doi", "date-released", "repository-code", "url", "identifiers", "contact", "commit", "license-url",
}  # fmt: skip
TYPES = {"generic", "data", "article", "software", "conference-paper", "unpublished", "manual"}


def check_people(people):
    assert people
    for one in people:
        assert set(one) <= PERSON or set(one) <= ENTITY
        assert all(isinstance(value, str) and value for value in one.values())


def test_citation_file_follows_its_format():
    """Required keys, known keys and forms of Citation File Format 1.2.0, as far as the file uses them."""
    data = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= set(data) <= WHOLE
    assert data["cff-version"] == "1.2.0" and data["type"] in ("software", "dataset")
    assert all(isinstance(word, str) for word in data["keywords"])
    assert len(set(data["keywords"])) == len(data["keywords"])
    check_people(data["authors"])
    for one in data["references"]:
        assert {"type", "title", "authors"} <= set(one) <= REFERENCE and one["type"] in TYPES
        check_people(one["authors"])
        assert re.fullmatch(r"10\.\d{4,9}/\S+|", one.get("doi", ""))
        assert re.fullmatch(r"https://\S+|", one.get("repository-code", ""))


def test_citation_file_and_references_agree(twist):
    data = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    ours, paper = o.citations(twist).references[:2]
    assert data["version"] == o.__version__ == ours.fields["version"]
    assert data["title"] == ours.title
    assert ours.authors == f"{{{data['authors'][0]['name']}}}"
    stated, dataset = data["references"]
    assert stated["title"] == paper.title and dataset["doi"] in paper.fields["note"]
    names = [f"{p['family-names']}, {p['given-names']}" for p in stated["authors"]]
    assert paper.authors == " and ".join(names)
