"""The paper's appendix-A test against the exact verdicts: equal where the state is regular and free of contact."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

from origami_nlp.folding import fold_vertex
from origami_nlp.kkt import State as StateOf, classify, project
from origami_nlp.minima import FullSpace, JudgedState, find_minima, full_scene
from origami_nlp.numerics import null_space
from origami_nlp.pattern import Scene, Vertex, examples
from origami_nlp.problem import Model
from studies import STEPS, appendix_a
from studies.audit import distance_from_stationary
from studies.baseline import EPS_GRADIENT, Baseline, crease_matrix
from tests.computed_once import panel_result

EXACT_TO = 1e-5  # relative error of centred differences at h = 3e-3 and smaller, rounding included


@dataclass(frozen=True)
class State:
    scene: Scene
    minimum: JudgedState
    full: FullSpace

    @property
    def phi(self) -> np.ndarray:
        return np.array(self.minimum.fold_angles)

    @property
    def loaded(self) -> bool:
        """Whether some contact carries a moment, in any of its multiplier vectors."""
        return any(c.multiplier_range[1] > 1e-12 for c in self.minimum.contacts)

    @cached_property
    def regular(self) -> bool:
        creases, _ = fold_vertex(self.scene.vertex, self.phi)
        return bool(np.linalg.svd(creases)[1][2] > 1e-6)

    @cached_property
    def paper(self) -> Baseline:
        """What the paper's test says, with its own settings."""
        return appendix_a(self.scene, self.phi)


@pytest.fixture(scope="module")
def states() -> list[State]:
    out = []
    for scene in examples.panels():
        minima = panel_result(scene, full=True).minima
        out += [State(scene, m, m.full_space) for m in minima]
    return out


def test_agrees_where_contact_is_inactive_and_the_state_regular(states: list[State]) -> None:
    free = [s for s in states if not s.minimum.contacts and s.regular]
    assert len(free) >= 18  # at least one a panel on average: the comparison is no empty statement
    for s in free:
        paper = s.paper
        assert paper.robust
        assert (paper.verdict == "strict minimum") == (s.full.verdict == "stable"), s.scene.name


def test_every_disagreement_is_a_loaded_contact_or_a_rank_deficient_state(
    states: list[State],
) -> None:
    disagree = []
    for s in states:
        paper = s.paper
        if (paper.verdict == "strict minimum") != (s.full.verdict == "stable"):
            disagree.append(s)
            assert s.loaded or not s.regular, s.scene.name
            assert paper.verdict == ("not stationary" if s.regular else "singular")
    assert disagree  # there is something to explain


def test_gradient_is_the_torque_that_contacts_balance(states: list[State]) -> None:
    seen = 0
    for s in states:
        if not (s.loaded and s.regular):
            continue
        seen += 1
        paper = s.paper
        without_contact = distance_from_stationary(StateOf(Model(full_scene(s.scene)), s.phi, -1.0))
        assert paper.steps[0].gradient == pytest.approx(without_contact, rel=1e-5)
        # with the contact moments the very same state is stationary to rounding
        model = Model(s.scene)
        assert distance_from_stationary(StateOf(model, model.reduce(s.phi), 1e-7)) < 1e-9
    assert seen


def test_loose_tolerance_accepts_states_that_only_contact_holds(states: list[State]) -> None:
    accepted = [s for s in states if s.loaded and s.regular and s.paper.verdict == "strict minimum"]
    for s in accepted:  # the torque is real: a tighter eps_g rejects them
        tight = appendix_a(s.scene, s.phi, eps_gradient=1e-5)
        assert tight.verdict == "not stationary"
        assert 1e-5 < tight.steps[0].gradient <= EPS_GRADIENT
    assert accepted


def test_eigenvalues_match_the_exact_hessian(states: list[State]) -> None:
    worst = 0.0
    for s in states:
        if s.minimum.contacts or not s.regular:
            continue
        exact = np.array(s.full.hessian_eigenvalues)
        for step in s.paper.steps:
            error = np.abs(np.array(step.eigenvalues) - exact).max() / np.abs(exact).max()
            worst = max(worst, float(error))
    assert 0 < worst < EXACT_TO


def test_differences_converge_with_second_order(states: list[State]) -> None:
    s = next(s for s in states if not s.minimum.contacts and s.scene.degree == 8)
    exact = np.array(s.full.hessian_eigenvalues)
    steps = (8e-2, 4e-2, 2e-2)
    paper = appendix_a(s.scene, s.phi, steps=steps)
    errors = [np.abs(np.array(r.eigenvalues) - exact).max() for r in paper.steps]
    rate = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert rate == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("seed", range(4))
def test_gradient_at_states_that_are_not_stationary(seed: int) -> None:
    scene = examples.degree6("pi/4", 1.0, symmetry="none", contact="none")
    model = Model(scene)
    x, residual = project(model, np.random.default_rng(seed).uniform(-1.5, 1.5, 6), ())
    assert residual < 1e-12
    paper = appendix_a(scene, x)
    local = model.local(x)
    z = null_space(local.closure_jacobian)
    exact = np.linalg.norm(z.T @ local.gradient) * model.scale / (np.pi * sum(scene.stiffness))
    for step in paper.steps:
        assert step.gradient == pytest.approx(exact, rel=1e-4)
    assert paper.verdict == "not stationary"


@pytest.mark.parametrize(
    "scene",
    [
        examples.degree6("pi/4", 1.0, contact="none"),
        examples.degree8("pi/4", 100.0, contact="none"),
    ],
    ids=["degree 6", "degree 8"],
)
def test_saddles_without_contact(scene: Scene) -> None:
    """Without contact some symmetric minima are saddles of the full space: both sides must say so."""
    model = Model(full_scene(scene))
    verdicts = set()
    for m in find_minima(scene, max_starts=64, prove=False, escape=False).minima:
        phi = np.array(m.fold_angles)
        if np.linalg.svd(fold_vertex(scene.vertex, phi)[0])[1][2] <= 1e-6:
            continue  # singular: the paper's test does not apply
        exact, paper = classify(StateOf(model, phi)), appendix_a(scene, phi)
        assert paper.verdict == {"minimum": "strict minimum"}.get(exact.verdict, exact.verdict), phi
        verdicts.add(paper.verdict)
    assert verdicts == {"saddle", "strict minimum"}


def test_states_that_do_not_close_are_refused() -> None:
    scene = examples.degree6("pi/4", 1.0)
    assert appendix_a(scene, np.full(6, 0.3)).verdict == "not closed"
    assert appendix_a(scene, np.zeros(6)).verdict == "singular"


def test_crease_matrix_is_the_derivative_of_the_retraction_residual() -> None:
    scene = examples.degree8("pi/6", 1.0)
    phi = np.array(panel_result(scene).minima[0].fold_angles)
    c, r = crease_matrix(scene, phi)
    assert np.linalg.norm(r) < 1e-12
    for i, h in ((0, 1e-6), (5, 1e-6)):
        e = np.zeros(8)
        e[i] = h
        slope = (crease_matrix(scene, phi + e)[1] - crease_matrix(scene, phi - e)[1]) / (2 * h)
        assert np.abs(slope - c[:, i]).max() < 1e-9


def test_uses_the_steps_of_the_paper() -> None:
    scene = examples.degree8("pi/4", 1.0)
    phi = np.array(panel_result(scene).minima[0].fold_angles)
    paper = appendix_a(scene, phi)
    assert tuple(r.step for r in paper.steps) == STEPS == (3e-4, 1e-3, 3e-3)
    assert paper.seconds > 0


def test_the_crease_matrix_of_the_baseline_closes_too():
    """Appendix A's rotation vector vanishes at the states that the quaternion closure finds."""
    scene = Scene(Vertex((1.2, 1.3, 1.1, 1.4), flat=False), (1,) * 4, (0.4,) * 4, "none")
    for m in find_minima(scene, prove=False, escape=False).minima:
        assert np.abs(crease_matrix(scene, np.array(m.fold_angles))[1]).max() < 1e-13
