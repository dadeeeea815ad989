"""Plain data there and back, and tables in every form."""

from __future__ import annotations

import io

from rich.console import Console

from origami_nlp.display import Report, Table, Words, pi_label

TABLE = Table(
    ("name", "of|it", "n"),
    [("a<b", "one\ntwo", Words("1", "bold", "#D55E00")), ("c", "x|y", "10")],
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
    assert html.count("<tr>") == 3 and "color:#D55E00" in html and "text-align:right" in html
    text = io.StringIO()
    Console(file=text, width=60).print(TABLE)
    assert "a title" in text.getvalue() and "one" in text.getvalue()


class Result(Report):
    def report_sections(self):
        yield TABLE
        yield "a line with [markup] and <tags> that is longer than the eighty columns of most terminals"
        yield Words("dim", "dim")


def test_a_result_tells_itself_in_every_form():
    text = str(Result())
    assert "a title" in text and text.splitlines()[-1] == "dim"
    assert any(line.endswith("of most terminals") for line in text.splitlines())
    html = Result()._repr_html_()
    assert "[markup] and &lt;tags&gt;" in html and "<b>a title</b>" in html
    console = Console(file=io.StringIO(), width=80)
    Result().print_to(console)
    assert "[markup] and <tags>" in console.file.getvalue()


def test_multiples_of_pi_are_in_lowest_terms():
    assert [pi_label(k, 4) for k in (-4, -3, -2, 0, 1, 2, 8)] == [
        "−π",
        "−3π/4",
        "−π/2",
        "0",
        "π/4",
        "π/2",
        "2π",
    ]
