"""Certificates as files: what is read is what was written, and what is no certificate is said in one line."""

import copy
import json
from dataclasses import replace

import pytest

import origami_nlp as o
from origami_nlp.errors import CertificateError
from origami_nlp.io import to_plain
from origami_nlp.pattern import Scene, Vertex
from origami_nlp.proof import certificate_from_dict, certify, read_certificate, write_certificate
from origami_nlp.proof.certificate import SCHEMA, OpenRegion

SCENE = Scene(
    Vertex.from_degrees((70, 80, 120, 90)),
    (1, 2, 3, 2),
    (1.0, -0.5, 0.3, 0.8),
    symmetry="none",
    contact="fold-limits",
)
GOOD = certify(SCENE, 100_000)
DATA = json.loads(json.dumps({"schema": SCHEMA, **to_plain(GOOD)}))


@pytest.mark.parametrize("of", [GOOD, certify(o.examples.pattern("metasheet", 2, 2), 10_000)])
def test_what_is_read_is_what_was_written(tmp_path, of):
    path = tmp_path / "proof.json"
    left = OpenRegion((0.0,) * 4, (1e-5,) * 4, "dependent axes")
    more = replace(of, undecided=(left, left))
    write_certificate(more, path)
    assert read_certificate(path) == more and more.minima


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
    "another schema": (having("origami-nlp/proof/1", "schema"), "schema"),
    **{f"no {name}": (without(name), name) for name in ("scene", "over", "minima", "undecided")},
    "no radius": (without("minima", 0, "radius"), "radius"),
    "a scene that is none": (having({"vertex": {}}, "scene"), "scene"),
    "a scene of numbers": (having({"vertex": 3}, "scene"), "scene"),
    "three angles": (having([0, 0, 0], "minima", 0, "fold_angles"), "minima[1].fold_angles"),
    "an angle in words": (having(["a", 0, 0, 0], "minima", 0, "fold_angles"), "fold_angles"),
    "a huge integer": (having(10**400, "minima", 0, "radius"), "radius"),
    "a reason of numbers": (
        having([{"lower": [0] * 4, "upper": [0] * 4, "reason": 1}], "undecided"),
        "reason",
    ),
    "a tree": (having({}, "tree"), "tree"),
    "minima of numbers": (having([1], "minima"), "minima"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_certificate_is_one_clear_line(name):
    data, word = BAD[name]
    with pytest.raises(CertificateError) as error:
        certificate_from_dict(json.loads(json.dumps(data)))
    text = str(error.value)
    assert word in text and "\n" not in text and len(text) < 300
