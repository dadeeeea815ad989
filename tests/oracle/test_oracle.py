"""The oracle: its data are those of the commit that made them, and it sees what is wrong with an answer."""

import argparse
import copy
import hashlib
from pathlib import Path

import pytest

from tests.oracle import __main__ as oracle
from tests.oracle.engine import unclosed
from tests.oracle.mutations import MUTATIONS

MADE = "cff19e43"
HASH = "487de36cc6f7c17769575e2f17c2708485a978eedc5ab2864f12245fafc3f9fc"
"""Of the part of the data that this commit made: it never changes."""


@pytest.fixture(scope="module")
def every():
    return oracle.records()


def test_data_of_the_first_commit_stay_and_are_few() -> None:
    files = sorted((oracle.DATA / MADE).glob("*.json"))
    found = hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()
    assert found == HASH
    assert sum(file.stat().st_size for file in oracle.DATA.glob("*/*.json")) <= 4_000_000


def test_what_calls_the_package_is_one_short_file() -> None:
    here = Path(oracle.__file__).parent
    assert len((here / "ask.py").read_text().splitlines()) <= 150
    for file in ("__main__.py", "engine.py"):
        assert "origami_nlp" not in (here / file).read_text()


def test_states_that_are_known_close_by_rotations_alone(every) -> None:
    far = [
        unclosed(r["q"]["stated"], phi)
        for records in every.values()
        for r in records[::120]
        if r["q"]["verb"] == "minima"
        for _, phi in r["answer"]["minima"]
    ]
    checked = [x for x in far if x == x]
    assert len(checked) > 20 and max(checked) < 1e-9


def test_quick_questions_are_of_every_group(every) -> None:
    asked = argparse.Namespace(groups=[], long=False, sample=0, quick=True)
    chosen = oracle.chosen(every, asked)
    assert {group for group, _ in chosen} >= set(every) - {"large_sheets"}
    assert sum(r.get("seconds", 0.0) for _, r in chosen) <= 1.5 * oracle.QUICK


def judged_as(record, answer, refused=()):
    row = oracle.Row()
    oracle.JUDGES.get(record["q"]["verb"], oracle.numbers)(row, record, answer, list(refused))
    return row


def test_what_is_wrong_is_seen(every) -> None:
    """A state that is missing, one that must be refused, another verdict, a moment, an event, a number."""
    record = next(
        r
        for r in every["panels"]
        if len(r["answer"]["minima"]) > 1
        and min(r["answer"]["share"]) == r["answer"].get("seeds", 3)
    )
    right = {**record["answer"], "undecided": []}
    assert judged_as(record, right).missing == judged_as(record, right).false == 0
    assert judged_as(record, {**right, "minima": right["minima"][1:]}).missing == 1
    assert judged_as(record, right, right["minima"][:1]).false == 1
    record = next(r for r in every["refused"] if r["answer"]["verdict"] == "not stationary")
    assert judged_as(record, {**record["answer"], "verdict": "saddle"}).false == 0
    assert judged_as(record, {**record["answer"], "verdict": "minimum"}).false == 1
    assert judged_as(record, {**record["answer"], "verdict": "undecided"}).undecided == 1
    record = next(
        r
        for r in every["states"]
        if oracle._moments(r["answer"]) and r["answer"]["verdict"] == "minimum"
    )
    wrong = copy.deepcopy(record["answer"])
    wrong["contacts"] = [
        [*c[:3], *(None if x is None else 1.001 * x for x in c[3:])] for c in wrong["contacts"]
    ]
    assert (
        judged_as(record, wrong).differing >= 1
        and not judged_as(record, record["answer"]).differing
    )
    record = next(r for r in every["located"] if r["answer"].get("events"))
    moved = [[*e[:-1], e[-1] + 1e-8] for e in record["answer"]["events"]]
    assert judged_as(record, {"events": moved}).differing == len(moved)
    record = next(r for r in every["counted"] if r["q"]["verb"] == "cones")
    assert judged_as(record, {**record["answer"], "stable_interior": -1}).differing == 1


def test_each_line_that_is_made_wrong_stands_once_in_the_package() -> None:
    assert len(MUTATIONS) >= 10
    for mutation in MUTATIONS:
        assert mutation.wrong in mutation.source
