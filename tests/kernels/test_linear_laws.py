"""Springs stated as piecewise hinge laws: the questions of `frozen` have the answers of springs.

Laws are evaluated piece by piece everywhere, so that numbers round otherwise, and the share of random descents that
ends in each minimum is not that of springs; what an answer says is the same.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import linear
from tests.kernels import frozen

SKIPPED = {
    **frozen.IGNORED,
    "law": "of each crease: what is compared",
    "laws": "them",
    "rest_angles": "of laws numbers, of springs as they were stated",
    "printed": "tells laws from springs",
    "search": "counts of random descents (compared: why it stopped, where it lists signs what is a minimum)",
    "hits": "counts of random descents",
    "evaluations": "as often as steps of descents round",
    "unstable_mode": "the first step of a descent, 1e-6 rad long, seen through a tolerance of its own length",
    "descent": "its steps",
}
"""Keys that are not compared, and why."""
REFUSED = {
    "degree 6, number 2, none": "laws are known between fold limits",
    "degree 4, number 5, none": "laws are known between fold limits",
    "degree 6, alpha_1 = pi/3, r_k = 1, ratio=0.2:5": "its numbers are law_scale",
    "degree 5, number 1, creases.rest_angles[1]=-1:1": "its numbers are law_scale",
}
"""Questions about springs that laws do not have, and what they are told."""
NEAR = 1e-7
"""Numbers agree to this share, or this absolutely."""


def of_laws(origami: Any) -> Any:
    """The same scene or pattern with each spring stated as a law."""
    if isinstance(origami, str):
        origami = o.examples.pattern(origami)
    if isinstance(origami, o.Scene):
        laws = tuple(map(linear, origami.stiffness, origami.wound_angles))
        return replace(origami, laws=laws, preload=())
    springs = zip(origami.stiffness.tolist(), origami.rest.tolist(), strict=True)
    return origami.with_laws([linear(*s) for s in springs])


class WithLaws:
    """The package, asked about springs that are stated as laws."""

    ASKED = ("find_minima", "load_path", "follow", "find_critical_points", "find_barriers")

    def __getattr__(self, name: str) -> Any:
        ask = getattr(o, name)
        if name not in self.ASKED:
            return ask
        return lambda origami, *more, **options: ask(of_laws(origami), *more, **options)


def told(value: Any, key: str = "") -> Any:
    """Plain data of what an answer says, whatever the order of states that are equal."""
    if isinstance(value, dict):
        if value.get("method") == "upper bound (descents)":
            value = {"method": value["method"], "to": value["to"]}
        if (
            "multiplier_range" in value
        ):  # which of dependent contacts carries is for rounding to say
            value = {}
        kept = {k: told(v, k) for k, v in value.items() if k not in SKIPPED}
        return kept | {"stopped_by": value["search"]["stopped_by"]} if "search" in value else kept
    if not isinstance(value, list):
        return value
    if (
        key == "singular"
    ):  # images of each other, and which of them is no state by which of two reasons
        return sorted(
            np.sort(np.round([x["lower"], x["upper"]], 6), axis=None).tolist() for x in value
        )
    return [told(x) for x in value]


def answers(group: str) -> Iterator[tuple[str, Any]]:
    """Names and data of a group of questions; a refusal is its words."""
    for name, ask in frozen.GROUPS[group]():
        try:
            yield name, told(json.loads(json.dumps(ask().to_dict())))
        except o.OrigamiError as refused:
            yield name, str(refused)


@pytest.mark.slow
@pytest.mark.parametrize("group", ["panels", "vertices", "gallery", "loads", "paths", "proofs"])
def test_springs_stated_as_laws_have_the_answers_of_springs(group, monkeypatch):
    springs = dict(answers(group))
    monkeypatch.setattr(frozen, "o", WithLaws())
    pull = frozen.Pull
    monkeypatch.setattr(frozen, "of_pattern", _loaded_with_laws(frozen.of_pattern, pull))
    monkeypatch.setattr(frozen, "NEAR", NEAR)
    monkeypatch.setattr(frozen, "ZERO", NEAR)
    for name, answer in answers(group):
        if name in REFUSED:
            assert REFUSED[name] in answer, name
        elif "torque[1]" in name:
            # beside a law a torque is a load, U - m phi; a spring is wound, k/2 (phi - rest - m/k)^2: not compared
            assert not [d for d in frozen.differences(springs[name], answer) if ".energy" not in d]
        else:
            assert not list(frozen.differences(springs[name], answer)), name


def _loaded_with_laws(load_path: Any, pull: type) -> Any:
    """Load paths of patterns whose springs are stated as laws."""

    def asked(pattern: o.Pattern, load: Any, **options: Any) -> Any:
        sheet = of_laws(pattern)
        if isinstance(load, pull):
            load = pull(sheet, load.corners)
        return o.load_path(sheet, load, seconds=frozen.PATIENT, **options)

    return asked
