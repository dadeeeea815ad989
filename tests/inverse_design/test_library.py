"""Design with a library of hinge laws: random states held and found again, refutations, the fewest wells by trial."""

from __future__ import annotations

import itertools
import json

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design import (
    ConvexDesign,
    LibraryProgram,
    Target,
    Targets,
    design_with_library,
    fewest_wells,
    wells_library,
)
from origami_nlp.kkt import project
from origami_nlp.pattern import linear
from tests.command_line import run


def three_states(rng):
    """A random vertex of degree four and three of its states, 20 degrees apart."""
    while True:
        sectors = rng.uniform(40, 140, 3)
        sectors = np.append(sectors, 360 - sectors.sum())
        if 40 < sectors[3] < 140:
            break
    vertex = o.Vertex.from_degrees(tuple(sectors))
    model = o.Model(o.Scene(vertex, (1,) * 4, (0,) * 4, "none", "fold-limits"))
    states: list[Target] = []
    while len(states) < 3:  # (closed the other way round is no sheet)
        x, residual = project(model, rng.uniform(-2.5, 2.5, model.size))
        far = [np.abs(model.expand(x) - np.array(s.fold_angles)).max() for s in states]
        admissible = residual < 1e-9 and not o.State(model, x).refused
        if admissible and 0.3 < np.abs(x).max() < 2.8 and min(far, default=1) > 0.35:
            states.append(Target(f"s{len(states)}", tuple(model.expand(x))))
    return Targets(vertex, tuple(states), contact="fold-limits")


def held(targets, scene):
    """Whether each state is a strict minimum: by the angles alone, on both sides of it along the curve."""
    model = o.Model(targets.blank)
    for placed in targets.placed:
        x = placed.state.x
        j = model.jacobian(x) if hasattr(model, "jacobian") else placed.state.jacobian
        along = np.linalg.svd(j)[2][-1]
        energies = [
            float(scene.energy(model.expand(project(model, x + s * along)[0])))
            for s in (-3e-3, 0.0, 3e-3)
        ]
        if not energies[1] < min(energies[0], energies[2]):
            return False
    return True


@pytest.mark.parametrize("count", [1, pytest.param(20, marks=pytest.mark.slow)])
def test_three_random_states_are_held_and_found_again(count):
    rng = np.random.default_rng(5)
    plain = 0
    for _ in range(count):
        targets = three_states(rng)
        plain += ConvexDesign(targets).feasible
        found = design_with_library(targets)
        assert found.verified and found.margin > 0.1, found
        assert held(targets, found.scene)
        assert int((found.weights > 0).sum()) <= 7 + 4  # rows of the program: a vertex uses no more
    assert plain <= count / 4  # springs alone seldom do


def test_refuted_with_this_library():
    """One spring at 0 on each crease: along the curve from flat all angles grow, and nothing balances."""
    targets = three_states(np.random.default_rng(5))
    one = Targets(targets.origami, targets.states[:1], contact="fold-limits")
    found = design_with_library(one, {"spring": linear(1.0)})
    placed = one.placed[0].state
    along = np.linalg.svd(placed.jacobian)[2][-1]
    signs = np.sign(placed.x * along)
    assert found.refuted == bool(abs(signs.sum()) == 4) and found.scene is None
    assert "with a thousandth of the mean stiffness" in str(found)


def test_the_fewest_wells_by_trying_all():
    targets = three_states(np.random.default_rng(3))
    few = {
        k: v
        for k, v in wells_library().items()
        if "spring" in k or k.endswith(("60", "120", "at 0"))
    }
    laws = tuple(few.values())
    best = LibraryProgram(targets, laws)
    assert best.feasible
    small, proved = fewest_wells(best)
    wells = np.array([not law.monotone for law in laws])
    used = int((small.weights()[:, wells] > 0).sum())
    assert proved and small.margin >= 0.5 * best.margin * (1 - 1e-6)
    choice = np.flatnonzero(np.tile(wells, 4))
    assert used == 2
    for kept in itertools.combinations(choice, used - 1):
        other = LibraryProgram(targets, laws, without=[c for c in choice if c not in kept])
        assert not other.margin > 0.5 * best.margin * (1 + 1e-6)


def test_the_command(tmp_path):
    targets = three_states(np.random.default_rng(5))
    text = "[vertex]\nsector_angles = " + json.dumps(list(targets.origami.sector_angles))
    text += '\n[model]\ncontact = "fold-limits"\nsymmetry = "none"\n'
    for s in targets.states:
        text += f'[[states]]\nname = "{s.name}"\nfold_angles = {list(map(float, s.fold_angles))}\n'
    file, made = tmp_path / "three.toml", tmp_path / "made.toml"
    file.write_text(text)
    done = run("design", file, "--library", "wells", "-o", made, "-o", tmp_path / "made.json")
    assert done.code == 0 and "3 of 3 found again" in done.out
    assert any(o.read_scene(made).laws)
    assert json.loads((tmp_path / "made.json").read_text())["margin"] > 0.1
    library = tmp_path / "library.toml"
    library.write_text('[laws.soft]\ntype = "linear"\nstiffness = 1\n')
    assert run("design", file, "--library", library).code in (1, 3)
    assert "give --library too" in run("design", file, "--fewest").err
    library.write_text("[vertex]\n")
    assert "give tables [laws.NAME]" in run("design", file, "--library", library).err


def test_what_laws_do_not_have_is_refused():
    targets = three_states(np.random.default_rng(5))
    free = Targets(targets.origami, targets.states, contact="none")
    with pytest.raises(OptionError, match="contact = 'none'"):
        design_with_library(free)
    sheet = o.examples.pattern("miura", 2, 2)
    with pytest.raises(OptionError, match="for the laws of one vertex"):
        design_with_library(Targets(sheet, (Target("flat", (0.0,) * sheet.creases),)))
    with pytest.raises(OptionError, match="library must have a HingeLaw"):
        design_with_library(targets, {})
