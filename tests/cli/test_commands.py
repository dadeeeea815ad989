"""The command line as a whole: as a module, its help, what it writes."""

import json

import pytest

from tests.command_line import run
from tests.fold_files import disc


def test_springs_that_a_command_does_not_take_are_in_the_file_that_inspect_writes(tmp_path):
    """All that a FOLD file leaves open can be written down once; the states are the same."""
    file = tmp_path / "a.fold"
    data = disc([60, 100, 120, 80], "MVVV")
    file.write_text(json.dumps(data))
    springs = ("--stiffness", 0.3, "--rest-angle", 40)
    quick = ("--no-prove", "--effort", "quick", "--max-starts", 8)
    for more, name in ((("--per-length",), "c.fold"), (("--vertex", 0), "d.toml")):
        made = tmp_path / name
        done = run("inspect", file, *springs, *more, "-o", made)
        assert done.code == 0, done.err
        found = [
            json.loads(run("minima", *given, *quick, "-o", "-").out)["minima"]
            for given in ((file, *springs, *more), (made,))
        ]
        energies = [[m["energy"] for m in one] for one in found]
        assert energies[0] and energies[0] == pytest.approx(energies[1], rel=1e-12), name


def test_a_pattern_is_taken_by_name_as_it_is_from_a_file(tmp_path):
    file = tmp_path / "miura.fold"
    assert run("example", "miura:3x3", "-o", str(file)).code == 0
    one, two = run("inspect", "miura:3x3", "-o", "-"), run("inspect", str(file), "-o", "-")
    assert one.code == two.code == 0
    assert one.out.replace('"source": "miura:3x3"', f'"source": "{file}"') == two.out
    wrong = run("inspect", "kresling")
    assert wrong.code == 2 and "no example: those are miura" in wrong.err
