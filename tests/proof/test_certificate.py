"""Certificates as files: what is read is what was written, and what is no certificate is said in one line."""

import copy
import json
from dataclasses import replace

import pytest

from origami_nlp.errors import CertificateError
from origami_nlp.problem import Model
from origami_nlp.proof import (
    certificate as c,
    certificate_from_dict,
    certificate_of,
    certificate_to_dict,
    prove,
    read_certificate,
    write_certificate,
)
from tests.command_line import run
from tests.proof.test_check import SCENE

GOOD = certificate_of(SCENE, prove(Model(SCENE)))
DATA = certificate_to_dict(GOOD)


def test_what_is_read_is_what_was_written(tmp_path):
    path = tmp_path / "proof.json"
    left = c.UndecidedBox((0.0,) * 4, (1e-5,) * 4, (0, 0, 0, 0), "dependent axes")
    more = replace(GOOD, singular=(left,), undecided=(left, left))
    write_certificate(more, path)
    back = read_certificate(path)
    assert back == more and back.points
    assert certificate_to_dict(back) == certificate_to_dict(more)


def without(*path):
    data = copy.deepcopy(DATA)
    place = data
    for name in path[:-1]:
        place = place[name]
    del place[path[-1]]
    return data


def having(value, *path):
    data = copy.deepcopy(DATA)
    place = data
    for name in path[:-1]:
        place = place[name]
    place[path[-1]] = value
    return data


BAD = {
    "a list": ([], "schema"),
    "another schema": (having("origami-nlp/proof/2", "schema"), "schema"),
    **{
        f"no {name}": (without(name), name)
        for name in ("scene", "exact", "r0", "points", "singular", "undecided")
    },
    **{
        f"no points.{name}": (without("points", 0, name), name)
        for name in ("x", "radius", "stratum")
    },
    "a scene that is none": (having({"vertex": {}}, "scene"), "scene"),
    "a scene of numbers": (having({"vertex": 3}, "scene"), "scene"),
    "another spring": (having(["0x1p+0"] * 4, "exact", "stiffness"), "stiffness"),
    "three angles": (having([0, 0, 0], "points", 0, "x"), "points[1].x"),
    "an angle in words": (having(["a", 0, 0, 0], "points", 0, "x"), "x"),
    "a huge integer": (having(10**400, "r0"), "r0"),
    "a sign of 2": (having([2, 0, 0, 0], "points", 0, "stratum"), "stratum"),
    "an index in words": (having("0", "points", 0, "index"), "index"),
    "a minimum of 1": (having(1, "points", 0, "is_minimum"), "is_minimum"),
    "a minimum of 0.5": (having(0.5, "points", 0, "index"), "index"),
    "a reason of numbers": (
        having([{"lower": [0] * 4, "upper": [0] * 4, "stratum": [0] * 4, "reason": 1}], "singular"),
        "reason",
    ),
    "a tree": (having({}, "tree"), "tree"),
    "points of numbers": (having([1], "points"), "points"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_certificate_is_one_clear_line(name):
    data, word = BAD[name]
    with pytest.raises(CertificateError) as error:
        certificate_from_dict(json.loads(json.dumps(data)))
    text = str(error.value)
    assert word in text and "\n" not in text and len(text) < 300


@pytest.mark.parametrize(
    "content", [b"", b"{", b"\xff\xfe", b'{"schema": NaN}', b"[" * 100_000, b"origami"]
)
def test_a_damaged_file_is_exit_code_2_and_one_line(content, tmp_path):
    path = tmp_path / "proof.json"
    path.write_bytes(content)
    done = run("check-proof", path)
    assert done.code == 2 and done.err.count("\n") == 1 and len(done.err) < 300 and not done.out


def test_a_truncated_file_is_exit_code_2_and_one_line(tmp_path):
    path = tmp_path / "proof.json"
    text = json.dumps(DATA)
    for share in (0.1, 0.5, 0.9, 0.999):
        path.write_text(text[: int(share * len(text))])
        done = run("check-proof", path)
        assert done.code == 2 and done.err.count("\n") == 1
    assert run("check-proof", tmp_path / "nowhere.json").code == 2
