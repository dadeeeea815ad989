"""Hard cases at states where loop closure loses rank: flat, flat-folded, book fold; and next to +-pi."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from benchmarks.hard_case import HardCase, Measured, Outcome
from benchmarks.reference import Reference, Unsolved, solve_reference
from origami_nlp.kkt import State, classify, polish, project
from origami_nlp.minima import (
    JudgedState,
    MinimaResult,
    Record,
    find_minima,
    solve_without_crossing,
)
from origami_nlp.numerics import CLOSURE_TOL, DUPLICATE_TOL, EPS, ROUNDED
from origami_nlp.pattern import Scene, Vertex, examples, parse_angles
from origami_nlp.problem import Model
from origami_nlp.starts import BATCH


def _vertex(sectors: tuple[str, ...]) -> Vertex:
    return Vertex(parse_angles(sectors, "sector_angles"))


def exact_state(model: Model, x: np.ndarray) -> Reference | None:
    """Return the 50-digit solution next to a polished state x [n], None where there is none."""
    try:
        return solve_reference(model, x, State(model, x).pieces[0])
    except Unsolved:
        return None


def nearest(result: MinimaResult, fold_angles: object) -> tuple[JudgedState | None, float]:
    """Return the minimum nearest to a state, and its largest difference in a fold angle (inf: no minima)."""
    wanted = np.asarray(fold_angles, dtype=float)
    if not result.minima:
        return None, math.inf
    far = [float(np.abs(np.array(m.fold_angles) - wanted).max()) for m in result.minima]
    best = int(np.argmin(far))
    return result.minima[best], far[best]


def known_state(
    setting: str, scene: Scene, fold_angles: object, energy: float, bound: float = ROUNDED
) -> Outcome:
    """Search a scene for a state that is known exactly and must be a minimum of it."""
    result = find_minima(scene)
    m, far = nearest(result, fold_angles)
    unit = float(np.mean(scene.stiffness))
    if m is None:
        return Outcome(setting, (), "no minimum found", False, result.search.iterations)
    measured = (
        Measured("angles", far, bound),
        Measured("energy", abs(m.energy - energy) / max(energy, unit), bound),
        Measured("closure", m.closure_residual, ROUNDED),
    )
    verdict, note = f"{m.kind}, dimension {m.local_dimension}", ""
    if bound < far <= 1.001 * DUPLICATE_TOL:
        note = f"a flat folding within {DUPLICATE_TOL:g} is taken for the same state"
    return Outcome(setting, measured, verdict, True, result.search.iterations, note=note)


def _flat_starts() -> Iterator[Outcome]:
    for scene in (
        examples.degree6("pi/4", 1.0),
        examples.degree6("pi/3", 1.0),
        examples.degree8("pi/6", 1.0),
        examples.degree6("pi/4", 1.0, symmetry="none"),
    ):
        model = Model(scene)
        record = Record()
        answer = solve_without_crossing(model, np.zeros(model.size), record)
        state = polish(model, answer)
        what = classify(State(model, state.x), polished=state.converged)
        exact = exact_state(model, state.x)
        left = float(np.abs(state.x).max())
        measured = [Measured("closure", state.closure_residual, ROUNDED)]
        if exact is not None:
            measured.append(Measured("angles", exact.angle_error(state.x), 1e-12))
        else:
            measured.append(Measured("KKT", state.kkt_residual, 1e-11))
        right = left > 0.1 and what.verdict != "undecided"
        verdict = f"{answer.status}; {what.verdict}" + (f", {what.kind}" if what.kind else "")
        verdict += f", {left:.2f} rad from flat"
        name = f"{scene.name}, {scene.group.name}"
        yield Outcome(name, tuple(measured), verdict, right, record.iterations)


def _flat_answers() -> Iterator[Outcome]:
    for sectors, symmetry in (
        (("pi/2",) * 4, "none"),
        (("pi/3", "2*pi/3", "pi/3", "2*pi/3"), "none"),
        (("pi/3",) * 6, "D1"),
        (("pi/4",) * 8, "D2"),
        (("pi/5",) * 10, "D5"),
    ):
        n = len(sectors)
        scene = Scene(_vertex(sectors), (1.0,) * n, (0.0,) * n, symmetry)
        result = find_minima(scene)
        m, far = nearest(result, np.zeros(n))
        assert m is not None
        lower = sum(other.energy <= 1e-20 for other in result.minima)
        measured = (Measured("angles", far, ROUNDED), Measured("energy", m.energy, 1e-25))
        verdict = f"{m.kind}, dimension {m.local_dimension}, {lower} state of energy 0"
        right = m.kind == "degenerate" and lower == 1
        right = right and m.local_dimension == Model(scene).dof
        title = f"degree {n}, {scene.group.name}, sectors {sectors[0]}, {sectors[1]}, .."
        yield Outcome(title, measured, verdict, right, result.search.iterations)


def _flat_folded() -> Iterator[Outcome]:
    pi = math.pi
    for sectors, signs, symmetry in (
        # Kawasaki and Maekawa; the smallest facet between a mountain and a valley
        (("pi/4", "pi/3", "3*pi/4", "2*pi/3"), (-1, 1, 1, 1), "none"),
        (("pi/4", "pi/2", "3*pi/4", "pi/2"), (-1, 1, 1, 1), "none"),
        (("pi/3",) * 6, (1, 1, -1, 1, -1, 1), "D1"),
    ):
        rest = tuple(pi * s for s in signs)
        n = len(sectors)
        scene = Scene(_vertex(sectors), (1.0,) * n, rest, symmetry)
        yield known_state(f"degree {n}, {scene.group.name}, {signs}", scene, rest, 0.0)


def _book_folds() -> Iterator[Outcome]:
    pi = math.pi
    for ratio in (0.01, 1.0, 100.0):
        scene = examples.degree6("pi/4", ratio)
        k = scene.stiffness[1]
        closed = (-pi, 0.0, 0.0, -pi, 0.0, 0.0)
        energy = 4 * k / 2 * (pi / 2) ** 2
        yield known_state(f"closed book, {scene.name}", scene, closed, energy)
    for angle, symmetry in ((1.0, "D1"), (1e-3, "D1"), (1e-5, "D1"), (1e-6, "D1"), (1e-6, "none")):
        rest = (angle, 0.0, 0.0, angle, 0.0, 0.0)
        scene = Scene(_vertex(("pi/4", "pi/2", "pi/4") * 2), (1.0,) * 6, rest, symmetry)
        yield known_state(f"at rest open by {angle:g} rad, {symmetry}", scene, rest, 0.0)


def _next_to_pi() -> Iterator[Outcome]:
    for distance in (1e-6, 1e-9, 1e-12, 1e-14, 0.0):
        angle = math.pi - distance
        rest = (angle, 0.0, angle, 0.0)
        scene = Scene(_vertex(("pi/2",) * 4), (1.0,) * 4, rest, "none")
        bound = max(ROUNDED, 2 * EPS + min(distance, 4 * EPS / max(distance, 1e-300)))
        yield known_state(f"book of degree 4, pi - {distance:g}", scene, rest, 0.0, bound)
    for sign, distance in ((1, 1e-6), (1, 1e-12), (-1, 1e-12), (1, 0.0)):
        scene, state = regular_at_pi(sign * (math.pi - distance))
        title = f"regular, degree 5, {'+' if sign > 0 else '-'}(pi - {distance:g})"
        yield known_state(title, scene, state, 0.0)


def regular_at_pi(angle: float) -> tuple[Scene, np.ndarray]:
    """A degree-5 scene at rest in an admissible state of full rank whose third fold angle is given."""
    vertex = Vertex((1.0, 1.3, 1.4, 1.2, 2 * math.pi - 4.9))
    model = Model(Scene(vertex, (1.0,) * 5, (0.3,) * 5, "none"))
    x = np.random.default_rng(3).uniform(-2.5, 2.5, (BATCH, 5))
    x[:, 2] = angle
    frozen = np.zeros_like(x, dtype=bool)
    frozen[:, 2] = True
    x, residual = project(model, x, frozen=frozen)
    for state in x[residual <= CLOSURE_TOL]:
        state[2] = angle
        rank = np.linalg.svd(model.closure(state)[1], compute_uv=False).min()
        if rank > 0.2 and np.abs(np.delete(state, 2)).max() < 3.0 and not model.refuses(state):
            # closed to rounding only: the least energy is about 1e-31
            return Scene(vertex, (1.0,) * 5, tuple(state.tolist()), "none"), state
    raise AssertionError("no regular state with this fold angle")


FLAT_CASES = (
    HardCase(
        "flat state as a start",
        "closure and its Jacobian give no direction at the flat state: rank 0 within a symmetry, 2 without",
        "the state that is reached, to 50 digits",
        "another state, stationary to 1e-12 and judged: the flat state is no minimum here",
        _flat_starts,
    ),
    HardCase(
        "flat state as the answer",
        "closure loses rank there: no KKT system is regular, multipliers of closure are arbitrary",
        "all rest angles 0: the flat state has energy 0, every other state more",
        "fold angles 0, energy 0, degenerate, of full dimension, and no second state of energy 0",
        _flat_answers,
    ),
    HardCase(
        "flat-folded state as the answer",
        "rank-deficient closure, all facets touching, every fold limit active",
        "rest angles are those of a flat folding: energy 0",
        "fold angles +-pi to rounding, energy 0",
        _flat_folded,
    ),
    HardCase(
        "book fold",
        "(phi_2, phi_3) = (0, 0) is a whole family of states, all of rank 2",
        "closed book: phi_1 = phi_4 = -pi at rest, U = 2 k_v (pi/2)^2; open book at rest: energy 0",
        "these states to rounding, as minima",
        _book_folds,
    ),
    HardCase(
        "fold angle within 1e-12 of +-pi",
        "an opening below the tolerance (1e-8) at which contacts count as closed; +pi and -pi have one shape",
        "the springs rest in the state: energy 0; on the book, closure at distance d from the folding has a singular "
        "value d, so that doubles know the angle to eps / d, or to d by taking the folding itself",
        "a minimum at that very angle where closure is regular (nothing may snap to the fold limit), and to "
        "min(d, 4 eps / d) on the book",
        _next_to_pi,
    ),
)
