"""A minimum is called stable only where its verdict in the full contact-admissible space is known."""

import dataclasses
import io
import json
import math

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

import origami_nlp as o
from origami_nlp.cli import app
from origami_nlp.display import VERDICTS, WARNING
from origami_nlp.minima import is_affordable, judge_in_full_space
from origami_nlp.minima.stability import count_words, not_asked_words, verdict
from tests.computed_once import once, panel_result

SCENE = o.examples.degree6("pi/3", 1)


@pytest.fixture(scope="module")
def decided():
    return panel_result(SCENE, full=True)


@pytest.fixture(scope="module")
def open_(decided):
    """The same result with nothing asked about the full space."""
    minima = tuple(dataclasses.replace(m, full_space=None) for m in decided.minima)
    return dataclasses.replace(decided, minima=minima)


@pytest.fixture(scope="module")
def free():
    """A vertex without imposed symmetry: what the search finds is a minimum of the whole space."""
    vertex = o.Vertex(("pi/2", "pi/3", "pi/2", "2*pi/3"))
    scene = o.Scene(vertex, (1.0,) * 4, (1.0, -1.0, 1.0, 1.0), "none", "full")
    return once(
        "free",
        lambda: o.find_minima(scene, fewest_starts=16, max_starts=16, prove=False, escape=False),
    )


def words(figure):
    legends = [t.get_text() for legend in figure.legends for t in legend.get_texts()]
    return [t.get_text() for t in figure.texts] + legends


def test_without_verdicts_no_word_says_stable(open_):
    assert count_words(open_.scene, open_.minima) == "4 symmetric minima"
    assert {verdict(SCENE, m) for m in open_.minima} == {"not asked"}
    figure = o.draw_minima(open_, size=21)
    reported = [str(open_), open_.to_html(picture=False), *words(figure)]
    reported.append(json.dumps(open_.to_fold()))
    for text in reported:
        plain = text.replace(not_asked_words(open_.scene, open_.minima), "").replace(
            "whether they are stable", ""
        )
        assert "stable" not in plain, text
    assert (
        not_asked_words(open_.scene, open_.minima) in reported[0]
        and not_asked_words(open_.scene, open_.minima) in reported[1]
    )
    assert "full space not asked" in words(figure)


def test_verdicts_are_in_table_html_figure_and_fold(decided):
    """State 1, two creases on each other, is unstable when the mirror may break; three are stable."""
    verdicts = [judge_in_full_space(SCENE, np.array(m.fold_angles)).verdict for m in decided.minima]
    assert sorted(verdicts) == ["stable"] * 3 + ["unstable"]
    title = "3 stable states; 1 more that is stable only while its symmetry is kept"
    text = str(decided)
    assert title in " ".join(text.split()) and "full space: not asked" not in text
    rows = [line.split() for line in text.splitlines() if line.strip().startswith(("1  ", "2  "))]
    rows += [line.split() for line in text.splitlines() if line.strip().startswith(("3  ", "4  "))]
    assert [next(w for w in row if w in verdicts) for row in rows] == verdicts
    html = decided.to_html(picture=False)
    assert title in html
    frames = decided.to_fold()["file_frames"]
    frames = [frame for frame in frames if "origaminlp:path" not in frame]  # of descents
    figure = o.draw_minima(decided, size=21)
    counted = "4 symmetric minima (3 stable, 1 unstable in the full space)"
    assert counted in html and any(counted in t for t in words(figure))
    for number, (own, frame) in enumerate(zip(verdicts, frames, strict=True), start=1):
        assert frame["frame_title"].endswith(f" J, {own}")
        (drawn,) = [t for t in figure.texts if t.get_text().startswith(f"{number}:  U = ")]
        assert f", {own}\n" in drawn.get_text()
        assert (drawn.get_color() == WARNING) == (own == "unstable")
    marks = [line for line in figure.axes[0].get_lines() if line.get_gid() == "mark"]
    filled = [mark.get_markerfacecolor() for mark in marks]
    assert sorted(filled) == sorted(VERDICTS[v][0] for v in verdicts)
    assert {VERDICTS[v][1] for v in verdicts} <= set(words(figure))


def test_the_table_with_verdicts_fits_a_narrow_terminal(decided):
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(decided.table())
    text = console.export_text()
    assert "…" not in text and "contact-touching" in text and "unstable" in text


def test_without_imposed_symmetry_a_minimum_is_a_stable_state(free):
    count = len(free.minima)
    assert (
        count
        and count_words(free.scene, free.minima) == f"{count} stable state{'s' * (count != 1)}"
    )
    assert not not_asked_words(free.scene, free.minima)
    for m in free.minima:
        full = judge_in_full_space(free.scene, np.array(m.fold_angles))
        assert verdict(free.scene, m) == full.verdict == "stable"


@pytest.mark.parametrize("contact", ["fold-limits", "none"])
def test_with_less_than_full_contact_a_minimum_is_a_minimum(contact):
    scene = dataclasses.replace(SCENE, symmetry="none", contact=contact)
    result = o.find_minima(scene, fewest_starts=4, max_starts=4, prove=False, escape=False)
    assert count_words(result.scene, result.minima, "no").endswith(("minima", "minimum"))
    assert "stable" not in count_words(result.scene, result.minima) and not not_asked_words(
        result.scene, result.minima
    )


def test_undecided_states_are_counted_as_such(decided):
    first, *others = decided.minima
    unsure = dataclasses.replace(first.full_space, verdict="undecided")
    minima = (dataclasses.replace(first, full_space=unsure), *others)
    result = dataclasses.replace(decided, minima=minima)
    assert (
        count_words(result.scene, result.minima)
        == "4 symmetric minima (3 stable, 1 undecided in the full space)"
    )


@pytest.mark.slow
def test_demo_decides_every_state(tmp_path, monkeypatch):
    few = [o.examples.degree6("pi/3", 1.0), o.examples.degree8("pi/4", 1.0)]
    monkeypatch.setattr(o.examples, "panels", lambda: few)
    out = CliRunner().invoke(app, ["paper", "demo", "--folder", str(tmp_path)])
    assert out.exit_code == 0, out.output
    assert "4 symmetric minima (3 stable, 1 unstable in the full space)" in out.output
    assert "3 of 4" in out.output and "2 of 2" in out.output and "5 of 6" in out.output
    for panel in json.loads((tmp_path / "minima.json").read_text()):
        assert all(m["full_space"]["verdict"] in ("stable", "unstable") for m in panel["minima"])
    assert (tmp_path / "degree6.png").stat().st_size > 10_000


def test_the_full_space_is_asked_where_that_is_affordable():
    """By size alone: not of more states, or creases, than are stated, nor where no symmetry is imposed."""
    found = o.find_minima(SCENE, max_starts=8, escape=False)
    assert {m.full_space.verdict for m in found.minima} <= {"stable", "unstable", "undecided"}
    asked = o.find_minima(SCENE, max_starts=8, escape=False, full=True)
    assert [m.full_space for m in found.minima] == [m.full_space for m in asked.minima]
    n = 14
    wide = o.Scene(o.Vertex((2 * math.pi / n,) * n), (1.0,) * n, (0.5, -0.5) * (n // 2))
    assert not wide.group.is_trivial and not is_affordable(wide, 1)
    assert is_affordable(SCENE, 64) and not is_affordable(SCENE, 65)
    free = o.find_minima(
        dataclasses.replace(SCENE, symmetry="none"), max_starts=8, escape=False, prove=False
    )
    assert all(m.full_space is None for m in free.minima)
    left = o.find_minima(wide, max_starts=2, escape=False, prove=False)
    assert all(m.full_space is None for m in left.minima)
    if left.minima:
        assert "12 creases" in not_asked_words(wide, left.minima)
