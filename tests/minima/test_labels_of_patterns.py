"""Labels and orientation change nothing: the same states, and what was enumerated."""

from dataclasses import asdict

import numpy as np
import pytest

from origami_nlp import examples
from origami_nlp.pattern import read_pattern
from origami_nlp.pattern_states import find_states
from tests.computed_once import thinned
from tests.fold_files import others
from tests.patterns import metasheet, strip
from tests.relabelled import relabelled

COPIES = {
    "renumbered": {},
    "mirrored": {"mirror": True},
    "turned over": {"over": True},
    "both": {"mirror": True, "over": True},
}


OF_WAYS = "starts open drawn seen_once seen_twice stopped reached alone by_source feasible_starts flat new_per_thousand"
"""What counts where single ways down end: beside states at which closure loses rank that hangs on rounding."""
MEASURED = "seconds iterations solves unclear expected_undiscovered expected_error"


def _named(name):
    kind, _, size = name.partition(":")
    if kind == "strip":
        return strip(int(size))
    if kind == "twisted":
        pattern, _ = metasheet(int(size))
        rng = np.random.default_rng(4)
        n = pattern.creases
        return pattern.with_springs(list(rng.uniform(0.2, 2, n)), list(rng.uniform(-2, 2, n)))
    return (
        examples.pattern(kind, *(int(x) for x in size.split("x")))
        if size
        else examples.pattern(kind)
    )


def _agree(found, other, creases, sign):
    a, b = asdict(found.search), asdict(other.search)
    for search in (a, b):
        for name in (*MEASURED.split(), *OF_WAYS.split(), "rejected", "undecided"):
            del search[name]  # states are compared below
    assert a == b
    for kind in ("minima", "undecided", "rejected"):
        one, two = getattr(found, kind), getattr(other, kind)
        assert [s.energy for s in two] == pytest.approx([s.energy for s in one], abs=1e-9)
        for s in two:
            near = [t for t in one if abs(t.energy - s.energy) < 1e-8 and t.verdict == s.verdict]
            near = [t for t in near if (t.kind, t.dof) == (s.kind, s.dof)]
            apart = [np.abs(sign * t.phi[creases] - s.phi).max() for t in near]
            assert min(apart) < 1e-6


def _check(pattern, copies, starts, seed=0, contact=True):
    found = find_states(pattern, starts, seed, contact, escape=False)
    for k, options in enumerate(copies):
        copy, creases, sign = relabelled(pattern, 10 + k, **options)
        assert np.abs(copy.stiffness - pattern.stiffness[creases]).max() == 0
        assert np.abs(copy.rest - sign * pattern.rest[creases]).max() == 0
        _agree(found, find_states(copy, starts, seed, contact, escape=False), creases, sign)


@pytest.mark.parametrize("name", thinned(["metasheet:2x3", "strip:3"], 2))
def test_labels_change_nothing(name):
    _check(_named(name), [COPIES["both"]], 3)  # renumbered as well


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "foldforge_miura_9xdeg4",
        "foldforge_waterbomb_base_deg8",
        "foldforge_single_vertex_deg6",
    ],
)
def test_labels_change_nothing_of_files(name):
    (file,) = others(f"{name}.fold")
    pattern = read_pattern(file)
    rng = np.random.default_rng(0)
    n = pattern.creases
    pattern = pattern.with_springs(list(rng.uniform(0.5, 2, n)), list(rng.uniform(-1.5, 1.5, n)))
    _check(pattern, [COPIES["renumbered"], COPIES["both"]], 6)


@pytest.mark.slow
@pytest.mark.parametrize("copy", COPIES)
@pytest.mark.parametrize(
    "name",
    [
        "miura:2x3",
        "miura:3x3",
        "metasheet:3x3",
        "twisted:3",
        "squaretwist",
        "yoshimura:2x3",
        "waterbomb:1x2",
        "strip:0",
    ],
)
def test_labels_change_nothing_of_patterns_by_name(name, copy):
    _check(_named(name), [COPIES[copy]], 6)
    _check(_named(name), [COPIES[copy]], 4, seed=3, contact=False)
