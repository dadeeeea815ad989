"""Bad input gets one clear line that names the field, and exit code 2; nothing is written."""

import math

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


def sectors(stated: str) -> str:
    return text(sector_angles=stated)


def instead(key: str, other: str) -> str:
    """A scene with something else in place of a key."""
    return text().replace(f"{key} = {GOOD[key]}", other)


BAD = [
    ("", "is empty"),
    ("[vertex\nx", "TOML"),
    ("vertex = 3", "table"),
    (text("[vertx]\na = 1"), "vertx"),
    (text("colour = 1"), "colour"),
    (text("contakt = 'full'"), "it takes symmetry, contact"),
    (instead("stiffness", "rest_angles_deg = [0, 0, 0, 0, 0, 0]"), "exactly one"),
    (instead("stiffness", ""), "stiffness"),
    (sectors('["pi/4", "pi/4", "pi/4", "pi/4", "pi/2", "pi/4"]'), "0.7854 rad"),
    (sectors("[45, 90, 45, 45, 90, 45]"), "look like degrees"),
    (sectors("[1.0472, 1.0472, 1.0472, 1.0472, 1.0472, 1.0472]"), "pi/3"),
    (sectors('["pi", "pi/4", "pi/4", "pi/4", "pi/8", "pi/8"]'), "sector_angles[1]"),
    (sectors('["__import__(\'os\')", "pi", "pi/4", "pi/4", "pi/4", "pi/4"]'), "sector_angles[1]"),
    (DEGREES.format("[60, 60, 60, 60, 60, 59.7]"), "normalize = true"),
    (DEGREES.format("[190, 10, 40, 40, 40, 40]"), "sector_angles_deg[1] = 190 deg"),
    (DEGREES.format("[0.785398, 1.570796, 0.785398, 0.785398, 1.570796, 0.785398]"), "radians"),
    (DEGREES.format("[60, 60, 60, 60, 60, 60]\nnormalize = 'yes'"), "true or false"),
    (instead("rest_angles", "rest_angles_deg = [0, 200, 0, 0, 0, 0]"), "rest_angles_deg[2] = 200"),
    (instead("rest_angles", 'rest_angles_deg = ["90"]'), "rest_angles_deg[1]"),
    (text(rest_angles="[nan, 0, 0, 0, 0, 0]"), "rest_angles[1]"),
    (text(rest_angles="[4, 0, 0, 0, 0, 0]"), "radians"),
    (text(rest_angles="[0, 0, 0]"), "3 entries"),
    (text(stiffness="[1, 1, -1, 1, 1, 1]"), "stiffness[3]"),
    (text(stiffness='["soft", 1, 1, 1, 1, 1]'), "stiffness[1]"),
    (text(symmetry='"mirror"'), "symmetry"),
    (text(symmetry='"D3"'), "largest common group"),
    (text(stiffness="[1, 2, 1, 1, 1, 1]"), "not shared"),
    (text(contact='"soft"'), "fold-limits"),
    (text("mirror = 9"), "1 to 6"),
    (text("name = 3"), "name"),
    (instead("sector_angles", "directions = [[1,0],[0,1],[-1,0],[0,-1]]"), "directions"),
]
"""Texts of scenes, and what the one line that refuses each must contain."""


@pytest.mark.parametrize(("scene", "word"), BAD)
def test_bad_scene_is_one_line_and_exit_code_2(scene, word, tmp_path):
    with pytest.raises(OrigamiError):
        parse_scene(scene)
    path, out = tmp_path / "scene.toml", tmp_path / "out.json"
    path.write_text(scene)
    code, _, err = run("minima", path, "-o", out)
    assert code == 2 and err.count("\n") == 1 and len(err) < 300 and word in err
    assert "flat = false" not in err  # that is another sheet, no correction
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
BAD_CALLS = """
minima nowhere.toml: nowhere.toml
minima .: cannot read
example degree7: degree7
example degree6 --alpha 2: alpha
example degree6 --alpha os.system: alpha
example degree8 --ratio -1: ratio
contacts scene.toml --state 9 --effort quick: state
contacts scene.toml --seed -1: seed
landscape scene.toml --size 4: --size = 4
landscape scene.toml -o a.txt: must end in one of .json
landscape scene.toml -o a.bmp: -o
paper cone phase --degree 7: degree
paper cone phase --degree 8 --rest mine: rest
minima scene.toml -o a.png -o a.png: is the file of -o too
minima scene.toml -o -.png: only text goes to standard output
load scene.toml: --crease K is missing
load scene.toml --crease 1 --fixed-facet 2: --fixed-facet = 2
load miura:2x2 --pull 1: '--pull' requires 2
load miura:3x3 --force 15 2 3 nan: three numbers
boundary scene.toml --event ratio=1:2 --parameter ratio=1:2: name two parameters
minima waterbomb:2x2 --certificate a: the list of a pattern is not proved
minima metasheet:3x3 --effort quick --certificate a: --contact fold-limits
minima miura:2x2 --stiffness -1: --stiffness = -1
inspect miura:3x3 --vertex 0: interior
inspect miura:3x3 --vertex 99: interior
inspect miura:3x3 --vertex -1: at least 0
inspect miura:3x3 --vertex 5 --frame 7: there is 0
landscape miura:3x3: --vertex is needed
example miur: miura, waterbomb
example miura:4: ROWSxCOLUMNS
example miura:4x4: -o FILE
example birdbase --alpha 1: no option alpha
example miura:0x4 -o a.fold: rows
minima: missing argument 'ORIGAMI'
minima a.toml b.toml: unexpected extra argument
minima a.toml --verbos: no such option
minima a.toml --seed 1 --seed 2.5: '--seed'
minima a.toml --seconds=soon: '--seconds'
load a.toml --crease one: '--crease'
follow a.toml: missing option '--parameter'
paper cone coutn: no such command 'coutn'
"""
MISSPELT = """
minima muira:3x3: did you mean miura?
example yoshimora: did you mean yoshimura?
design three-equals: did you mean three-equal?
follow scene.toml --parameter rest_angle[1]=0:1: did you mean rest_angles?
follow miura:2x2 --parameter creases.stifness[1]=1:2: did you mean stiffness?
follow miura:2x2 --parameter alfa=50deg:60deg: did you mean alpha?
"""
"""Calls, and what the one line that refuses each must contain."""


@pytest.mark.parametrize("line", (BAD_CALLS + MISSPELT).strip().replace("\n\n", "\n").splitlines())
def test_bad_call_is_one_line_and_exit_code_2(line, tmp_path, monkeypatch):
    call, _, word = line.rpartition(": ")
    monkeypatch.chdir(tmp_path)
    (tmp_path / SCENE).write_text(text())
    code, _, err = run(*call.split())
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
