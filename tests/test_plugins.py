"""Plug-ins by entry points: the packaged example as users install it, and broken ones."""

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern import STIFFNESS_KEY, Material, examples, find_material, read_pattern
from origami_nlp.plugins import GROUPS, export, has_exporter, plugins
from tests.command_line import run

EXAMPLE = Path(__file__).parent.parent / "docs" / "files" / "plugin"
STATED = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())["project"]


def install(folder, name, version, entry_points):
    """Put down what an installer does: the metadata with the entry points."""
    place = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    place.mkdir(parents=True)
    (place / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n")
    lines = [
        line
        for group, entries in entry_points.items()
        for line in (f"[{group}]", *(f"{key} = {value}" for key, value in entries.items()))
    ]
    (place / "entry_points.txt").write_text("\n".join(lines) + "\n")


@pytest.fixture
def zigzag(tmp_path, monkeypatch):
    """The example of the documentation, installed; the folder of installed distributions."""
    site = tmp_path / "site"
    site.mkdir()
    for module in EXAMPLE.glob("*.py"):
        (site / module.name).write_text(module.read_text())
    install(site, STATED["name"], STATED["version"], STATED["entry-points"])
    monkeypatch.syspath_prepend(str(site))
    yield site
    sys.modules.pop("origami_nlp_zigzag", None)


@pytest.fixture
def broken(tmp_path, monkeypatch):
    """Plug-ins that fail in every way."""
    site = tmp_path / "broken"
    site.mkdir()
    (site / "faulty.py").write_text(
        "def fails(*given, **more):\n    raise RuntimeError('the\\ncause')\n"
        "def wrong(*given, **more):\n    return 3\n"
        "number = 3\n"
    )
    (site / "unreadable.py").write_text("def (\n")
    entries = {"fails": "faulty:fails", "wrong": "faulty:wrong", "number": "faulty:number"}
    entries |= {"gone": "not_there:f", "lost": "faulty:f", "odd": "unreadable:f"}
    install(site, "faulty-folds", "2.0", {group: entries for group in GROUPS.values()})
    monkeypatch.syspath_prepend(str(site))
    yield site
    for name in ("faulty", "unreadable"):
        sys.modules.pop(name, None)


def test_without_plug_ins_there_are_none():
    assert not {*plugins("material")} and "zigzag" not in examples.names()
    with pytest.raises(OptionError, match="no plug-in with one is installed"):
        find_material("paper")


def test_patterns_of_a_plug_in_are_taken_by_name(zigzag):
    assert {"zigzag", "bookvertex"} <= set(examples.names())
    seen = o.analyze_mobility("zigzag")
    assert seen.pattern.creases == 3 and seen.pattern.source == ""
    assert examples.pattern("zigzag", columns=6).creases == 5
    assert o.examples.by_name("bookvertex", stiffness=0.1).stiffness == (0.1,) * 4
    assert examples.crease_pattern("bookvertex")["edges_assignment"].count("V") == 2
    for call_, said in (
        (lambda: examples.by_name("zigzag"), "is a sheet"),
        (lambda: examples.by_name("bookvertex", stifness=1), "did you mean stiffness"),
        (lambda: examples.pattern("zigzag:2x3"), "zigzag has no rows"),
    ):
        with pytest.raises(OptionError, match=said):
            call_()


def test_a_material_is_stiffness_times_length_in_metres(zigzag, tmp_path):
    material = find_material("soft-hinge")
    assert material == Material(0.05, "an example, not measured")
    file = tmp_path / "strip.fold"
    data = examples.crease_pattern("zigzag")
    for unit, metre in (("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("unit", 1.0), (None, 1.0)):
        data["frame_unit"] = unit
        file.write_text(json.dumps({k: v for k, v in data.items() if v is not None}))
        for stiffness in ("soft-hinge", material):
            sheet = read_pattern(file, stiffness=stiffness)
            assert np.allclose(sheet.stiffness, 0.05 * metre * sheet.lengths, rtol=1e-15)
            (note,) = (n for n in sheet.notes if "N/rad" in n)
            assert "an example, not measured" in note
            assert ("taken as metres" in note) == (metre == 1.0)
    # what the file states stays
    data[STIFFNESS_KEY] = [
        7.0 if edge == 1 else None for edge in range(len(data["edges_vertices"]))
    ]
    data["frame_unit"] = "m"
    file.write_text(json.dumps(data))
    assert sorted(read_pattern(file, stiffness=material).stiffness) == [0.05, 0.05, 7.0]


def test_a_material_states_a_positive_number_and_a_source():
    for wrong in ((0.0, "a"), (-1.0, "a"), (float("inf"), "a"), ("1", "a"), (1.0, ""), (1.0, None)):
        with pytest.raises(OptionError):
            Material(*wrong)


def test_results_are_exported_by_their_ending(zigzag, tmp_path):
    result = o.find_minima(o.examples.miura("pi/3"), prove=False)
    assert has_exporter("a.XYZ") and not has_exporter("a.abc") and not has_exporter("a")
    o.save(result, tmp_path / "a.xyz")
    read = np.loadtxt(tmp_path / "a.xyz", ndmin=2)
    assert np.allclose(read[:, 1:], [np.degrees(m.fold_angles) for m in result.minima], rtol=1e-5)
    result.save(tmp_path / "a.json")
    assert o.load(tmp_path / "a.json").minima[0].energy == result.minima[0].energy


def test_commands_take_all_three(zigzag, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = run("pattern", "zigzag", "--stiffness", "soft-hinge")
    assert code == 0 and "3 degrees of freedom" in out and "0.05 N/rad" in out + err
    code, out, _ = run("example", "bookvertex", "-o", "book.toml")
    assert code == 0 and "two creases of which rest half open" in Path("book.toml").read_text()
    code, out, _ = run("minima", "book.toml", "--prove", "0", "-o", "a.xyz")
    assert code == 0 and "written: a.xyz" in out
    assert [float(v) for v in Path("a.xyz").read_text().split()] == [0, 90, 0, 90, 0]
    for words, said in (
        (["minima", "zigzag", "--vertex", "0", "--stiffness", "soft-hinge"], "whole patterns"),
        (["pattern", "zigzag", "--stiffness", "soft-hinge", "--per-length"], "per length already"),
        (["pattern", "zigzag", "--stiffness", "soft-hing"], "did you mean soft-hinge"),
        (["pattern", "zigzig"], "did you mean zigzag"),
        (["inspect", "book.toml", "-o", "a.xyz"], "must end in one of"),  # no result
    ):
        code, out, err = run(*words)
        assert (code, out, err.count("\n")) == (2, "", 1) and said in err, (words, err)


WAYS = {
    "fails": "failed: RuntimeError: the cause",
    "wrong": "is wrong: int instead of",
    "gone": "cannot be loaded: ModuleNotFoundError: No module named 'not_there'",
    "lost": "cannot be loaded: AttributeError: module 'faulty' has no attribute 'f'",
    "odd": "cannot be loaded: SyntaxError: ",
}


@pytest.mark.parametrize("name", WAYS)
def test_a_broken_plug_in_is_one_line_with_its_distribution(broken, name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = o.analyze_mobility("miura:1x2")
    for kind, ask in (
        ("example", lambda: o.examples.by_name(name)),
        ("example", lambda: o.analyze_mobility(name)),
        ("material", lambda: find_material(name)),
        ("exporter", lambda: export(result, f"a.{name}")),
    ):
        with pytest.raises(OptionError) as caught:
            ask()
        said = str(caught.value)
        assert said.startswith(f"plug-in {kind} {name!r} of faulty-folds 2.0 {WAYS[name]}"), said
        assert "\n" not in said
    for words in (
        ["pattern", name],
        ["example", name],
        ["pattern", "miura:1x2", "-o", f"a.{name}"],
    ):
        code, _, err = run(*words)
        assert code == 2 and "Traceback" not in err
        assert err.splitlines()[-1].startswith("origami-nlp: plug-in ") and "faulty-folds" in err


def test_what_is_no_function_is_refused(broken):
    with pytest.raises(OptionError, match="int instead of a function"):
        o.examples.by_name("number")
    with pytest.raises(OptionError, match="int instead of a Material"):
        find_material("number")


def test_one_name_in_two_distributions_is_refused_where_it_is_asked_for(zigzag, tmp_path):
    install(zigzag, "other-folds", "1", {"origami_nlp.examples": {"zigzag": "other:f"}})
    with pytest.raises(
        OptionError, match=r"of origami-nlp-zigzag 0\.1 and of other-folds 1 is there twice"
    ):
        examples.pattern("zigzag")
    assert examples.by_name("bookvertex").degree == 4


def test_no_plug_in_replaces_what_is_built_in(broken):
    install(broken, "greedy", "1", {"origami_nlp.examples": {"miura": "faulty:fails"}})
    assert o.examples.by_name("miura") == o.examples.miura()
    assert examples.names().count("miura") == 1
