"""Drawings that want to take time, memory or a stack: read or refused soon; and what is said of odd ones."""

import math
import time
import tracemalloc

import pytest

from origami_nlp.drawings import DrawingOptions, read_drawing
from origami_nlp.errors import FoldFileError
from origami_nlp.pattern import frame_pattern, parse_fold

SQUARE = "1 0 0 4 0\n1 4 0 4 4\n1 4 4 0 4\n1 0 4 0 0\n"
LINE = '<line x1="0" y1="0" x2="1" y2="1" stroke="red" {}/>'


def star(lines):
    angles = [math.pi * (k + 0.3) / lines for k in range(lines)]
    ends = (
        (2 - 1.9 * math.cos(t), 2 - 1.9 * math.sin(t), 2 + 1.9 * math.cos(t), 2 + 1.9 * math.sin(t))
        for t in angles
    )
    return "".join(f"2 {' '.join(map(repr, row))}\n" for row in ends)


@pytest.mark.parametrize(
    ("text", "edges"), [(star(100), 4), ("2 0 0 4 4\n" * 20_000, 5)], ids=("star", "equal")
)
def test_lines_that_meet_in_one_place_take_memory_as_they_are_many(text, edges):
    tracemalloc.start()
    try:
        made = read_drawing((SQUARE + text).encode(), ".cp")
        assert tracemalloc.get_traced_memory()[1] < 200e6
    finally:
        tracemalloc.stop()
    assert len(made.edges) == edges


@pytest.mark.parametrize(
    "text",
    [
        LINE.format(f'transform="{"a" * 200_000}"'),
        LINE.format(f'transform="{"a(" * 100_000}"'),
        f"<style>{'a{' * 100_000}</style>" + LINE.format(""),
        f"<style>{'/*' * 100_000}</style>" + LINE.format(""),
        f"<style>{'@import' * 30_000}</style>" + LINE.format(""),
        f"<style>{'a' * 200_000}</style>" + LINE.format(""),
        LINE.format(f'style="{"/*" * 100_000}"'),
    ],
    ids=("letters", "brackets", "braces", "comments", "imports", "selector", "style"),
)
def test_text_of_a_drawing_is_read_in_time_that_grows_with_its_length(text):
    begin = time.process_time()
    made = read_drawing(f"<svg>{text}</svg>".encode(), ".svg")
    assert len(made.edges) == 1 and time.process_time() - begin < 2.0


def test_several_sheets_of_a_drawing_name_what_takes_one():
    text = "".join(
        f"1 {x} 0 {x + 4} 0\n1 {x + 4} 0 {x + 4} 4\n1 {x + 4} 4 {x} 4\n1 {x} 4 {x} 0\n2 {x} 0 {x + 4} 4\n"
        for x in (0, 10)
    )
    with pytest.raises(FoldFileError, match="2 parts"):
        frame_pattern(parse_fold(text.encode(), source="two.cp")[0])
    one = parse_fold(text.encode(), source="two.cp", drawing=DrawingOptions(part=1))[0]
    assert frame_pattern(one).name == "two"
