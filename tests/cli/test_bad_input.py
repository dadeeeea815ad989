"""Bad input gets one clear line that names the field, and exit code 2; nothing is written."""

import math
from pathlib import Path

import pytest

from origami_nlp.errors import OrigamiError
from origami_nlp.pattern import format_scene, parse_scene
from tests.command_line import run

GOOD = {
    "sector_angles": '["pi/4", "pi/2", "pi/4", "pi/4", "pi/2", "pi/4"]',
    "stiffness": "[0.025, 0.025, 0.025, 0.025, 0.025, 0.025]",
    "rest_angles": '["-pi", "pi/2", "pi/2", "-pi", "pi/2", "pi/2"]',
    "symmetry": '"D1"',
    "contact": '"full"',
}


def text(extra: str = "", **changes: str) -> str:
    value = {**GOOD, **changes}
    return (
        f"[vertex]\nsector_angles = {value['sector_angles']}\n"
        f"[creases]\nstiffness = {value['stiffness']}\nrest_angles = {value['rest_angles']}\n"
        f"[model]\nsymmetry = {value['symmetry']}\ncontact = {value['contact']}\n{extra}"
    )


DEGREES = (
    "[vertex]\nsector_angles_deg = {}\n[creases]\nstiffness = [1, 1, 1, 1, 1, 1]\n"
    "rest_angles_deg = [0, 0, 0, 0, 0, 0]\n"
)

# name: (scene text, words the one-line message must contain)
BAD = {
    "empty file": ("", ["scene.toml", "is empty"]),
    "not TOML": ("[vertex\nx", ["TOML"]),
    "unknown table": (text("[vertx]\na = 1"), ["vertx", "vertex"]),
    "table is a number": ("vertex = 3", ["vertex", "table"]),
    "unknown key": (text("colour = 1"), ["colour", "symmetry"]),
    "misspelt key": (text("contakt = 'full'"), ["contakt", "did you mean contact?"]),
    "angles given twice": (
        text().replace("[creases]", "sector_angles_deg = [45, 90, 45, 45, 90, 45]\n[creases]"),
        ["sector_angles_deg", "exactly one"],
    ),
    "no stiffness": (text().replace("stiffness =", "rest_angles_deg ="), ["exactly one"]),
    "stiffness missing": (
        "[vertex]\nsector_angles_deg=[90,90,90,90]\n[creases]\nrest_angles_deg=[0,0,0,0]",
        ["stiffness", "missing"],
    ),
    "sum too small": (
        text(sector_angles='["pi/4", "pi/4", "pi/4", "pi/4", "pi/2", "pi/4"]'),
        [
            "sector_angles sum to 5.49778714 rad",
            "2 pi",
            "0.7854 rad missing",
            "a sector is missing or wrong",
        ],
    ),
    "degrees that sum to 359.7": (
        DEGREES.format("[60, 60, 60, 60, 60, 59.7]"),
        [
            "sector_angles_deg sum to 359.7 deg, not 360 deg: 0.3 deg missing",
            "normalize = true",
            "0.05 deg",
        ],
    ),
    "degrees beyond 180": (
        DEGREES.format("[190, 10, 40, 40, 40, 40]"),
        ["sector_angles_deg[1] = 190 deg must be below 180"],
    ),
    "radians as degrees": (
        DEGREES.format("[0.785398, 1.570796, 0.785398, 0.785398, 1.570796, 0.785398]"),
        ["look like radians", "sector_angles"],
    ),
    "degrees as radians": (
        text(sector_angles="[45, 90, 45, 45, 90, 45]"),
        ["sector_angles[1] = 45 rad", "look like degrees", "sector_angles_deg"],
    ),
    "normalize is a word": (
        DEGREES.format("[60, 60, 60, 60, 60, 60]").replace(
            "[creases]", 'normalize = "yes"\n[creases]'
        ),
        ["normalize", "true or false"],
    ),
    "rest angle beyond 180 degrees": (
        text().replace(
            f"rest_angles = {GOOD['rest_angles']}", "rest_angles_deg = [0, 200, 0, 0, 0, 0]"
        ),
        ["rest_angles_deg[2] = 200 deg", "[-180, 180]"],
    ),
    "sum rounded to 6 digits": (
        text(sector_angles="[1.0472, 1.0472, 1.0472, 1.0472, 1.0472, 1.0472]"),
        ["sector_angles", "pi/3"],
    ),
    "sector of pi": (
        text(sector_angles='["pi", "pi/4", "pi/4", "pi/4", "pi/8", "pi/8"]'),
        ["sector_angles[1]", "below pi"],
    ),
    "hostile angle": (
        text(sector_angles='["__import__(\'os\')", "pi/2", "pi/4", "pi/4", "pi/2", "pi/4"]'),
        ["sector_angles[1]", "not an angle"],
    ),
    "nan rest angle": (text(rest_angles="[nan, 0, 0, 0, 0, 0]"), ["rest_angles[1]", "finite"]),
    "rest angle beyond pi": (text(rest_angles="[4, 0, 0, 0, 0, 0]"), ["rest_angles[1]", "radians"]),
    "too few rest angles": (text(rest_angles="[0, 0, 0]"), ["rest_angles", "3 entries", "6"]),
    "degrees as text": (
        text().replace(f"rest_angles = {GOOD['rest_angles']}", 'rest_angles_deg = ["90"]'),
        ["rest_angles_deg[1]", "degrees"],
    ),
    "negative stiffness": (text(stiffness="[1, 1, -1, 1, 1, 1]"), ["stiffness[3]", "positive"]),
    "text stiffness": (text(stiffness='["soft", 1, 1, 1, 1, 1]'), ["stiffness[1]", "number"]),
    "one stiffness for all": (text(stiffness="0.025"), ["stiffness", "list"]),
    "unknown symmetry": (text(symmetry='"mirror"'), ["symmetry", "mirror"]),
    "symmetry not shared": (text(symmetry='"D3"'), ["symmetry", "largest common group"]),
    "mechanics break the mirror": (
        text(stiffness="[1, 2, 1, 1, 1, 1]"),
        ["symmetry", "not shared"],
    ),
    "unknown contact": (text(contact='"soft"'), ["contact", "fold-limits"]),
    "mirror out of range": (text("mirror = 9"), ["mirror", "1 to 6"]),
    "name is a number": (text("name = 3"), ["name"]),
    "directions not ccw": (
        text().replace(
            f"sector_angles = {GOOD['sector_angles']}", "directions = [[1,0],[0,-1],[-1,0],[0,1]]"
        ),
        ["directions", "counter-clockwise"],
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_scene_is_one_line_and_exit_code_2(name, tmp_path):
    scene, words = BAD[name]
    with pytest.raises(OrigamiError):
        parse_scene(scene)
    path = tmp_path / "scene.toml"
    path.write_text(scene)
    out = tmp_path / "out.json"
    code, _, err = run("minima", path, "-o", out)
    assert code == 2 and err.count("\n") == 1 and len(err) < 300
    for word in words:
        assert word in err
    assert (
        "flat = false" not in err or "flat = false" in scene
    )  # that is another sheet, no correction
    assert not out.exists()


def test_normalize_spreads_what_is_missing_and_says_so(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        DEGREES.format("[60, 60, 60, 60, 60, 59.7]").replace(
            "[creases]", "normalize = true\n[creases]"
        )
    )
    code, _, err = run("inspect", path)
    assert (
        code == 0
        and err == "note: sector angles normalized to a sum of 360 deg: each by +0.05 deg\n"
    )
    scene = parse_scene(path.read_text())
    degrees = [math.degrees(a) for a in scene.vertex.sector_angles]
    assert degrees == pytest.approx([60.05] * 5 + [59.75], abs=1e-12)
    assert math.degrees(scene.vertex.normalized) == pytest.approx(0.05)
    assert parse_scene(format_scene(scene)) == scene


SCENE = "scene.toml"
PHASE, COUNT = (("paper", "cone", name) for name in ("phase", "count"))
BAD_CALLS = {
    "no such file": (["minima", "nowhere.toml"], "nowhere.toml"),
    "folder as scene": (["minima", "."], "cannot read"),
    "unknown family": (["example", "degree7"], "degree7"),
    "alpha out of range": (["example", "degree6", "--alpha", "2"], "alpha"),
    "alpha no angle": (["example", "degree6", "--alpha", "os.system"], "alpha"),
    "ratio negative": (["example", "degree8", "--ratio", "-1"], "ratio"),
    "state beyond the list": (["contacts", SCENE, "--state", 9, "--effort", "quick"], "state"),
    "seed of contacts": (["contacts", SCENE, "--seed", -1], "seed"),
    "map too small": (["landscape", SCENE, "--size", 4], "--size = 4"),
    "arrays as text": (["landscape", SCENE, "-o", "a.txt"], "must end in one of .json"),
    "figure of no format": (["landscape", SCENE, "-o", "a.bmp"], "-o"),
    "odd degree": ([*PHASE, "--degree", 7], "degree"),
    "a file twice": (["minima", SCENE, "-o", "a.png", "-o", "a.png"], "is given twice"),
    "binary as text": (["minima", SCENE, "-o", "-.png"], "only text goes to standard output"),
    "a load of nothing": (["load", SCENE], "--crease K is missing"),
    "fixed for no force": (["load", SCENE, "--crease", 1, "--fixed-facet", 2], "--fixed-facet = 2"),
    "pull of one": (["load", "miura:2x2", "--pull", "1"], "--pull = '1' must be 2 numbers"),
    "force of nan": (["load", "miura:2x2", "--force", "1,2,3,nan"], "must be 4 numbers"),
    "one parameter twice": (
        ["boundary", SCENE, "--event", "ratio=1:2", "--parameter", "ratio=1:2"],
        "name two parameters",
    ),
    "certificate of a pattern": (
        ["minima", "waterbomb:2x2", "--certificate", "a"],
        "certificate = 'a': the list of a pattern is not proved: ",
    ),
    "certificate of a mesh with contact": (
        ["minima", "metasheet:3x3", "--effort", "quick", "--certificate", "a"],
        "it is written for --contact fold-limits",
    ),
    "stiffness of a pattern": (["minima", "miura:2x2", "--stiffness", -1], "--stiffness = -1"),
    "rest state unknown": ([*PHASE, "--degree", 8, "--rest", "mine"], "rest"),
}


MISSPELT = {
    "example as input": (["minima", "muira:3x3"], "did you mean miura?"),
    "example": (["example", "yoshimora"], "did you mean yoshimura?"),
    "targets": (["design", "three-equals"], "did you mean three-equal?"),
    "parameter": (
        ["follow", SCENE, "--parameter", "rest_angle[1]=0:1"],
        "did you mean rest_angles?",
    ),
    "of a pattern": (
        ["follow", "miura:2x2", "--parameter", "creases.stifness[1]=1:2"],
        "did you mean stiffness?",
    ),
    "of an example": (
        ["follow", "miura:2x2", "--parameter", "alfa=50deg:60deg"],
        "did you mean alpha?",
    ),
}


@pytest.mark.parametrize("name", MISSPELT)
def test_a_misspelt_name_gets_the_closest_one(name, tmp_path, monkeypatch):
    arguments, question = MISSPELT[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / SCENE).write_text(text())
    code, _, err = run(*arguments)
    assert code == 2 and err.count("\n") == 1 and err.endswith(f"; {question}\n")


def test_what_is_far_from_all_names_gets_no_question(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / SCENE).write_text(text())
    for parameter in ("colour=1:5", "stiffness[99]=1:5"):
        code, _, err = run("follow", SCENE, "--parameter", parameter)
        assert code == 2 and "did you mean" not in err


@pytest.mark.parametrize("name", BAD_CALLS)
def test_bad_call_is_one_line_and_exit_code_2(name, tmp_path, monkeypatch):
    arguments, word = BAD_CALLS[name]
    monkeypatch.chdir(tmp_path)
    (tmp_path / SCENE).write_text(text())
    code, _, err = run(*arguments)
    assert code == 2 and err.count("\n") == 1 and word in err
    assert [p.name for p in tmp_path.iterdir()] == [SCENE]


def test_bad_outputs_are_refused_before_the_search(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(text())
    for arguments, word in (
        (["-o", str(tmp_path / "no" / "x.json")], "does not exist"),
        (["-o", str(tmp_path)], "folder"),
        (["-o", str(tmp_path / "x.docx")], ".svg"),
        (["--seed", "-1"], "seed"),
        (["--max-starts", "0"], "max_starts"),
    ):
        code, _, err = run("minima", path, *arguments)
        assert code == 2 and err.count("\n") == 1 and word in err
    assert list(tmp_path.iterdir()) == [path]


def test_binary_and_huge_files_are_refused(tmp_path):
    for content, word in ((b"\xff\xfe\x00", "UTF-8"), (b"#" * 2_000_000, "1 MB")):
        path = tmp_path / "scene.toml"
        path.write_bytes(content)
        code, _, err = run("minima", path)
        assert code == 2 and word in err


@pytest.mark.parametrize(
    ("name", "command"),
    [
        ("a.toml", ("minima",)),
        ("a.fold", ("minima",)),
        ("a.json", ("inspect",)),
        ("a.toml", ("design",)),
        ("a.toml", ("sweep", "--folder", "out")),
        ("a.json", ("check-proof",)),
    ],
)
def test_an_empty_or_broken_file_is_named(name, command, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for content, said in ((b" \n", "is empty"), (b"\xff\xfe\x00x", ""), (b"[[[", "")):
        Path(name).write_bytes(content)
        code, _, err = run(command[0], name, *command[1:])
        assert code == 2 and err.count("\n") == 1 and repr(name) in err and said in err, err
    assert [p.name for p in tmp_path.iterdir()] == [name]
