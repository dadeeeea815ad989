"""Plain data there and back, and tables in every form."""

from __future__ import annotations

import io

from rich.console import Console

from origami_nlp.display import Table, Words

TABLE = Table(
    ("name", "of|it", "n"),
    [("a<b", "one\ntwo", Words("1", "bold")), ("c", "x|y", "10")],
    "a title",
    "lLr",
)


def test_a_table_in_every_form():
    assert TABLE.markdown().splitlines() == [
        "| name | of\\|it | n |",
        "|---|---|---:|",
        "| a<b | one<br>two | **1** |",
        "| c | x\\|y | 10 |",
    ]
    html = TABLE.html()
    assert "a&lt;b" in html and "a<b" not in html and "one<br>two" in html
    assert html.count("<tr>") == 3 and "text-align:right" in html
    text = io.StringIO()
    Console(file=text, width=60).print(TABLE)
    assert "a title" in text.getvalue() and "one" in text.getvalue()
