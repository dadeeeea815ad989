"""Plain data there and back: what cannot be read is told with its path, its value and what is expected."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
import pytest

from origami_nlp.errors import OptionError
from origami_nlp.io import (
    OneBased,
    Unbounded,
    from_plain,
    read_json,
    to_plain,
)
from origami_nlp.pattern import Scene, examples


class Step(NamedTuple):
    at: tuple[float, ...]
    height: float = 0.5


@dataclass(frozen=True)
class Inner:
    ALSO = ("shout",)

    name: str
    range: tuple[float, Unbounded]

    @property
    def shout(self) -> str:
        return self.name.upper()


@dataclass(frozen=True)
class Outer:
    inner: tuple[Inner, ...]
    best: Inner | None
    steps: tuple[Step, ...] | None
    value: float
    count: int
    grid: np.ndarray
    table: dict[str, int]
    kind: Literal["open", "shut"]
    crease: OneBased
    facets: tuple[OneBased, OneBased] | None
    scene: Scene
    known: object = field(default=None, metadata={"plain": False})
    winding: int = field(default=1, metadata={"omit": True})
    last: float = 7.0


OUTER = Outer(
    inner=(Inner("a", (1.0, math.inf)), Inner("b", (2.0, 3.0))),
    best=None,
    steps=(Step((1.0, 2.0)),),
    value=math.nan,
    count=3,
    grid=np.array([[1.0, math.nan], [0.0, -math.inf]]),
    table={"x": 1},
    kind="open",
    crease=0,
    facets=(1, 2),
    scene=examples.degree6("pi/4"),
    known=object(),
)


def data():
    return json.loads(json.dumps(to_plain(OUTER), allow_nan=False))


def test_plain_data_is_json_and_reads_back():
    written = data()
    assert written["inner"][0] == {"name": "a", "range": [1.0, None], "shout": "A"}
    assert written["grid"] == [[1.0, None], [0.0, None]] and written["value"] is None
    assert written["crease"] == 1 and written["facets"] == [2, 3]
    assert "known" not in written and "winding" not in written
    again = from_plain(Outer, written)
    assert again.inner == OUTER.inner and again.steps == OUTER.steps and again.best is None
    assert isinstance(again.steps[0], Step) and math.isnan(again.value)
    assert again.crease == 0 and again.facets == (1, 2) and again.scene == OUTER.scene
    assert np.array_equal(again.grid, [[1.0, math.nan], [0.0, math.nan]], equal_nan=True)
    assert to_plain(again) == written
    other = Outer(**{**vars(OUTER), "best": OUTER.inner[1], "steps": None, "winding": 2})
    full = to_plain(other)
    again = from_plain(Outer, full)
    assert again.best == OUTER.inner[1] and again.steps is None and again.winding == 2
    del full["last"]
    assert from_plain(Outer, full).last == 7.0


def test_numbers_of_numpy_become_numbers():
    mixed = {"a": np.float64("nan"), "b": np.int32(3), "c": (np.bool_(True), 2.5)}
    assert to_plain(mixed) == {"a": None, "b": 3, "c": [True, 2.5]}
    for thing in (object(), {"a": object()}, 1 + 2j):
        with pytest.raises(TypeError, match="plain form"):
            to_plain(thing)


def put(value, *path):
    """Data in which one entry has another value; without it for ..., with it where there was none."""

    def change(whole):
        inside = whole
        for key in path[:-1]:
            inside = inside[key]
        if value is ...:
            del inside[path[-1]]
        else:
            inside[path[-1]] = value

    return change


WRONG = {
    "missing": (put(..., "count"), "count is missing"),
    "unknown": (put(3, "foo"), "unknown key 'foo': it takes inner, best"),
    "text for a number": (put("7", "value"), "value = '7' must be a finite number"),
    "number for a text": (put(7, "inner", 0, "name"), r"inner\[1\].name = 7 must be a text"),
    "fraction for an index": (put(1.5, "crease"), "crease = 1.5 must be a whole number"),
    "text in an array": (put("a", "grid", 0, 0), "grid = .* must be finite numbers"),
    "text for a list": (put("abc", "steps", 0, "at"), r"steps\[1\].at = 'abc' must be a list"),
    "too short": (put([1.0], "inner", 0, "range"), r"inner\[1\].range = .* must be a list of 2"),
    "another word": (put("ajar", "kind"), "kind = 'ajar' must be one of 'open', 'shut'"),
    "half a scene": (put(..., "scene", "creases"), "scene: .*creases"),
    "nan in a scene": (put(math.nan, "scene", "creases", "stiffness", 0), "scene: .*stiffness"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_told_with_its_path_and_its_value(case):
    change, message = WRONG[case]
    wrong = data()
    change(wrong)
    with pytest.raises(OptionError, match=message) as reported:
        from_plain(Outer, wrong, "'a.json'")
    assert str(reported.value).startswith("'a.json': ") and "\n" not in str(reported.value)


@pytest.mark.parametrize(
    "content", [b"{", b'{"a": NaN}', b"[" * 100_000, b"\xff\xfe", b"9" * 5000, b"[1] [2]"]
)
def test_files_that_are_no_json(content, tmp_path):
    path = tmp_path / "a.json"
    path.write_bytes(content)
    with pytest.raises(OptionError, match=r"thing '.*a\.json' is not valid JSON: .") as reported:
        read_json(path, 10**6, "thing", OptionError)
    assert "\n" not in str(reported.value) and len(str(reported.value)) < 300
    with pytest.raises(OptionError, match="larger"):
        read_json(path, len(content) - 1, "thing", OptionError)
