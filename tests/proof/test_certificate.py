"""Certificates as files: what is read is what was written, and what is no certificate is said in one line."""

import base64
import copy
import json
import zlib

import numpy as np
import pytest

from origami_nlp.errors import CertificateError
from origami_nlp.proof import (
    certificate as c,
    certificate_from_dict,
    certificate_to_dict,
    read_certificate,
    write_certificate,
)
from tests.command_line import run
from tests.proof.slow_prover import proved

GOOD = proved(4, 3)
DATA = certificate_to_dict(GOOD)


def test_what_is_read_is_what_was_written(tmp_path):
    path = tmp_path / "proof.json"
    left = c.UndecidedBox((0.0,) * 4, (1e-5,) * 4, (0, 0, 0, 0), "dependent axes")
    more = c.Certificate(GOOD.scene, GOOD.r0, GOOD.points, (left,), (left, left), GOOD.nodes)
    write_certificate(more, path)
    assert path.stat().st_size < 200_000
    back = read_certificate(path)
    for name in ("scene", "r0", "points", "singular", "undecided"):
        assert getattr(back, name) == getattr(more, name)
    for name in ("kind", "number", "boxes"):
        assert np.array_equal(getattr(back.nodes, name), getattr(more.nodes, name))
    assert certificate_to_dict(back) == certificate_to_dict(more)


def packed(values):
    return base64.b64encode(zlib.compress(values)).decode()


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


count = len(GOOD.nodes.kind)
BAD = {
    "a list": ([], "schema"),
    "another schema": (having("origami-nlp/proof/2", "schema"), "schema"),
    **{
        f"no {name}": (without(name), name)
        for name in ("scene", "exact", "r0", "points", "singular", "undecided", "tree")
    },
    **{f"no tree.{name}": (without("tree", name), name) for name in DATA["tree"]},
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
    "points of numbers": (having([1], "points"), "points"),
    "no base64": (having("§", "tree", "kind"), "tree.kind"),
    "no zlib": (having("AAAA", "tree", "kind"), "tree.kind"),
    "cut short": (having(DATA["tree"]["boxes"][:-400], "tree", "boxes"), "tree.boxes"),
    "a kind too few": (having(packed(bytes(count - 1)), "tree", "kind"), "tree.kind"),
    "a kind too many": (having(packed(bytes(count + 1)), "tree", "kind"), "tree.kind"),
    "a bomb": (having(packed(bytes(10**8)), "tree", "kind"), "tree.kind"),
    "an unknown kind": (having(packed(bytes([200]) * count), "tree", "kind"), "200"),
    "no nodes": (having(0, "tree", "nodes"), "nodes"),
    "nodes without end": (having(10**30, "tree", "nodes"), "nodes"),
    "boxes that are no numbers": (
        having(packed(b"\xff" * GOOD.nodes.boxes.nbytes), "tree", "boxes"),
        "no number",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_certificate_is_one_clear_line(name):
    data, word = BAD[name]
    with pytest.raises(CertificateError) as error:
        certificate_from_dict(json.loads(json.dumps(data)))
    text = str(error.value)
    assert word in text and "\n" not in text and len(text) < 300


def test_the_command_says_what_it_found(tmp_path):
    path, out = tmp_path / "proof.json", tmp_path / "check.json"
    write_certificate(GOOD, path)
    done = run("check-proof", path, "-o", out)
    assert done.code == 0 and done.out.startswith("checked: complete - ")
    assert done.out.count("minimum: point") == sum(bool(p.is_minimum) for p in GOOD.points)
    said = json.loads(out.read_text())
    assert said["checked"] and said["complete"] and not said["open"]
    assert said["nodes"]["split"] == DATA["counts"]["split"]


def test_a_refused_claim_is_exit_code_1(tmp_path):
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(having(3, "points", 0, "index")))
    done = run("check-proof", path)
    assert (
        done.code == 1 and done.out.startswith("refused: point 1: ") and done.out.count("\n") == 1
    )


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
