"""Plain data there and back, and tables in every form."""

from __future__ import annotations

import io
import json
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest
from rich.console import Console

from origami_nlp.errors import OptionError
from origami_nlp.show import (
    Table,
    Told,
    Words,
    check_schema,
    from_plain,
    pi_label,
    pick,
    to_plain,
)


class Step(NamedTuple):
    at: tuple[float, ...]
    height: float = 0.5


@dataclass(frozen=True)
class Inner:
    name: str
    range: tuple[float, float]


@dataclass(frozen=True)
class Outer:
    inner: tuple[Inner, ...]
    best: Inner | None
    steps: tuple[Step, ...] | None
    value: float
    count: int
    grid: np.ndarray
    table: dict[str, int]
    last: float = 7.0


OUTER = Outer(
    (Inner("a", (1.0, math.inf)), Inner("b", (2.0, 3.0))),
    None,
    (Step((1.0, 2.0)),),
    math.nan,
    3,
    np.array([[1.0, math.nan], [0.0, -math.inf]]),
    {"x": 1},
)


def test_plain_data_is_json_and_reads_back():
    data = json.loads(json.dumps(to_plain(OUTER), allow_nan=False))
    assert data["inner"][0] == {"name": "a", "range": [1.0, None]}
    assert data["grid"] == [[1.0, None], [0.0, None]] and data["value"] is None
    again = from_plain(Outer, {**data, "unknown": 1}, {"range": math.inf})
    assert again.inner == OUTER.inner and again.steps == OUTER.steps and again.best is None
    assert isinstance(again.steps[0], Step) and math.isnan(again.value)
    assert to_plain(again) == data
    full = to_plain(Outer(**{**vars(OUTER), "best": OUTER.inner[1], "steps": None}))
    assert from_plain(Outer, full).best == OUTER.inner[1] and from_plain(Outer, full).steps is None


def test_a_missing_entry_or_one_of_another_form_is_an_error():
    data = to_plain(OUTER)
    del data["last"]
    assert from_plain(Outer, data).last == 7.0
    with pytest.raises(TypeError, match="count"):
        from_plain(Outer, {k: v for k, v in data.items() if k != "count"})
    with pytest.raises((TypeError, ValueError)):
        from_plain(Inner, {"name": "a", "range": [1.0, 2.0, 3.0]})
    with pytest.raises(TypeError, match="plain form"):
        to_plain({"a": object()})


def test_picked_entries_keep_their_order_and_names():
    found = pick(OUTER, "number=count", "value", "first", "inner", first=2, more=math.inf)
    assert list(found) == ["number", "value", "first", "inner", "more"]
    assert found["number"] == 3 and found["first"] == 2 and found["more"] is None


@pytest.mark.parametrize("data", [{"schema": "a/2"}, {}, [], "a/1", None])
def test_another_schema_is_named(data):
    check_schema({"schema": "a/1"}, "a/1", OptionError)
    with pytest.raises(OptionError, match="a/1"):
        check_schema(data, "a/1", OptionError)


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


class Result(Told):
    def told(self):
        yield TABLE
        yield "a line with [markup] and <tags> that is longer than the eighty columns of most terminals"
        yield Words("dim", "dim")


def test_a_result_tells_itself_in_every_form():
    text = str(Result())
    assert "a title" in text and text.splitlines()[-1] == "dim"
    assert any(line.endswith("of most terminals") for line in text.splitlines())
    html = Result()._repr_html_()
    assert "[markup] and &lt;tags&gt;" in html and "<b>a title</b>" in html
    markdown = Result().to_markdown()
    assert "| c |" in markdown and "[markup]" in markdown
    console = Console(file=io.StringIO(), width=80)
    Result().tell(console)
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
