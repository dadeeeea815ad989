"""The page of verbs: each line of Python runs, on the files that the page names."""

import re

import pytest

from tests.documentation import shell
from tests.documentation.pages import ROOT

PAGE = (ROOT / "docs" / "which_verb.md").read_text()


@pytest.mark.slow  # 13 searches
def test_each_question_has_a_line_of_python_that_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec("import origami_nlp as o", names)
    for command in re.findall(r"`(origami-nlp example [^`]+)`", PAGE):
        assert shell.run_line(command)[0] == 0
    rows = [re.findall(r"`([^`]+)`", row) for row in PAGE.splitlines() if row.startswith("| <img")]
    assert len(rows) > 7 and all(row[0].startswith("origami-nlp ") for row in rows)
    for row in rows:
        exec(row[1], names)
