"""Designs: found again by the search, the optimum by a second solver, refutations by exact arithmetic."""

import json
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.inverse_design import (
    design,
    parse_targets,
    scene_of,
    solve,
)
from origami_nlp.inverse_design.targets_file import EXAMPLES
from origami_nlp.kkt import State, classify
from origami_nlp.pattern_problem import pose
from tests.computed_once import thinned
from tests.inverse_design.questions import built, question

pytest.importorskip("clarabel")
LONG = pytest.mark.slow
CASES = thinned(
    [(4, 5, 2, 1, 1), (6, 5, 2, 1, 0), (4, 0, 1, 0, 0), (8, 3, 1, 0, 0), (4, 6, 3, 1, 1)], 2
)


def held_by_hand(targets, scene):
    """Whether each state is a minimum, by nothing but energies of closed states around it."""
    from origami_nlp.kkt import project

    model, rng = pose(scene), np.random.default_rng(0)
    for placed in targets.placed:
        x = placed.state.x
        for _ in range(60):
            y, left = project(model, x + 2e-3 * rng.standard_normal(model.size))
            if left > 1e-12 or model.refuses(y) or np.abs(y - x).max() < 1e-5:
                continue
            if model.energy(y) < model.energy(x):
                return False
    return True


@pytest.mark.parametrize(("n", "seed", "count", "pinned", "flat"), CASES)
def test_states_of_a_design_are_minima(n, seed, count, pinned, flat):
    targets, posed = built(n, seed, count, pinned, flat, preload=count > 1)
    scene = scene_of(posed)
    for placed in targets.placed:
        found = classify(State(pose(scene), placed.state.x))
        assert found.verdict == "minimum", found.reason
        assert placed.moved < 1e-9
    assert held_by_hand(targets, scene)
    low, high = targets.stiffness
    assert low * (1 - 1e-9) <= min(scene.stiffness) and max(scene.stiffness) <= high * (1 + 1e-9)


def test_a_reason_names_changes_that_help():
    for seed in range(30):
        targets = question(seed, 4, 2)
        if not solve(targets).feasible and solve(replace(targets, preload=True)).feasible:
            break
    found = design(targets)
    assert not found.feasible and found.refuted and found.reason.states == ("s0", "s1")
    assert any("rest angles reach" in c for c in found.reason.changes)
    assert any("leave out state" in c for c in found.reason.changes)
    assert "no design" in str(found)
    assert design(replace(targets, preload=True)).verified


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=[LONG] * (n in ("three-equal", "waitukaitis-five", "six-states")))
        for n in EXAMPLES
    ],
)
def test_examples_verify(name, tmp_path):
    targets = parse_targets(EXAMPLES[name])
    found = design(targets)
    assert found.verified, found.failed
    assert max(s.found for s in found.states) <= 1e-9
    data = json.loads(json.dumps(found.to_dict()))
    assert data["feasible"] and len(data["states"]) == len(targets.states)
    if name == "switch":
        rises = [b.rise for b in found.barriers]
        assert rises == pytest.approx([0.02, 0.01], abs=1e-12)
        # the highest of many closed states between the two, found without the rows
        crest = max(_between(found, 300))
        low = found.states[0].energy
        assert crest <= low + 0.02 + 1e-12 and crest == pytest.approx(low + 0.02, abs=1e-4)
        o.draw(found, tmp_path / "d.png")
        assert (tmp_path / "d.png").stat().st_size > 10_000
    if name == "three-equal":
        u = [s.energy for s in found.states]
        assert max(u) - min(u) < 1e-12


def _between(found, count):
    """Energies of closed states from the first to the second, over the second crease's fold angle."""
    from origami_nlp.kkt import project

    model = pose(found.scene)
    a, b = (model.reduce(np.array(s.fold_angles)) for s in found.states)
    x = a
    for angle in np.linspace(a[1], b[1], count):
        x = x.copy()
        x[1] = angle
        x, left = project(model, x, frozen=np.arange(model.size) == 1)
        assert left < 1e-10
        yield model.energy(x)


def test_states_are_like_those_of_an_earlier_run(tmp_path):
    found = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=8, escape=False)
    found.save(tmp_path / "states.json")
    sectors = "sector_angles_deg = [45, 45, 90, 90, 45, 45]"
    text = f"[vertex]\n{sectors}\n[[states]]\nlike = 'states.json#{{}}'\n"
    (state,) = parse_targets(text.format(2), tmp_path).states
    assert state.fold_angles == found.minima[1].fold_angles
    with pytest.raises(o.OrigamiError, match="has 2 minima, like asks for 3"):
        parse_targets(text.format(3), tmp_path)
