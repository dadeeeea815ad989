"""The README fits a screen and a few minutes."""

import re

from tests.documentation.pages import ROOT

WORDS = 600
WIDTH = 100


def test_the_readme_is_short_and_its_lines_fit_a_screen():
    text = (ROOT / "README.md").read_text()
    assert len(text.split()) <= WORDS
    assert not [line for line in text.splitlines() if len(line) > WIDTH]


def test_the_readme_begins_with_a_sentence_and_a_picture_of_states():
    head = (ROOT / "README.md").read_text().split("## ")[0]
    pictures = re.findall(r"!\[.+\]\((\S+)\)", head)
    assert pictures and all((ROOT / name).is_file() for name in pictures)
