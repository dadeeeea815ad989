"""The page of sheets by name says what the code finds now."""

import re

import pytest

from tests import gallery_of_patterns as gallery
from tests.computed_once import states

QUICK = ("metasheet:4x4",)


@pytest.mark.parametrize(
    "name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in gallery.SHEETS]
)
def test_the_page_lists_the_states_that_are_found(name):
    result = states(name)
    assert all(s.closure_residual < 1e-12 for s in result.minima)
    assert result._repr_html_().count("<img") == 1
    page = gallery.PAGE.read_text()
    part = page[page.index(f"## {name}") :].split("\n## ")[0]
    table = re.findall(r"^\| \d.*$", part, re.M)
    assert table and table == gallery.rows(result), "run python -m tests.gallery_of_patterns"
    picture = re.search(r"\((figures/\S+\.png)\)", part)
    assert picture and (gallery.DOCS / picture.group(1)).is_file()
