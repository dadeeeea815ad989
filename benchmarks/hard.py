"""Problems that are hard for solvers, each posed in several settings with an answer that is known another way.

An outcome holds what was measured beside the bound that it must keep; one that misses a bound, or ends in another
verdict, is a failure.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from benchmarks.reference import Reference, Unsolved, solve_reference
from origami_nlp import find_minima
from origami_nlp.display import Table
from origami_nlp.errors import SceneError
from origami_nlp.kkt import State, classify, polish, project
from origami_nlp.minima import JudgedState, MinimaResult
from origami_nlp.numerics import CLOSURE_TOL, EPS, ROUNDED
from origami_nlp.pattern import Scene, Vertex, examples, parse_angles
from origami_nlp.pattern_problem import PatternProblem, pose
from origami_nlp.search import solve_apart

CLOSURE_PULL = 0.3
"""Torque [N m] by which closure pulls at the closed crease, so that its rest angle stays within +-pi."""
DEGREE = 60
"""Of the vertex of many creases."""
STARTS = 150
"""Cap on random starts there: completeness is not the question."""


@dataclass(frozen=True)
class Outcome:
    """What came out of one setting: errors as (value, bound) by name, and whether the verdict is right."""

    setting: str
    errors: dict[str, tuple[float, float]]
    verdict: str
    right: bool = True
    seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether the verdict is right and every number keeps its bound (nan does not)."""
        return self.right and all(value <= bound for value, bound in self.errors.values())


def exact_state(problem: PatternProblem, x: np.ndarray) -> Reference | None:
    """Return the 50-digit solution next to a polished state x [n], None where there is none."""
    try:
        return solve_reference(problem, x, State(problem, x).pieces[0])
    except Unsolved:
        return None


def nearest(result: MinimaResult, fold_angles: object) -> tuple[JudgedState, float]:
    """Return the minimum nearest to a state, and its largest difference in a fold angle."""
    wanted = np.asarray(fold_angles, dtype=float)
    far = [float(np.abs(np.array(m.fold_angles) - wanted).max()) for m in result.minima]
    best = int(np.argmin(far))
    return result.minima[best], far[best]


def known_state(
    setting: str, scene: Scene, fold_angles: object, energy: float = 0.0, bound: float = ROUNDED
) -> Outcome:
    """Search a scene for a state that is known exactly and must be a minimum of it."""
    m, far = nearest(find_minima(scene), fold_angles)
    off = abs(m.energy - energy) / max(energy, float(np.mean(scene.stiffness)))
    errors = {"angles": (far, bound), "energy": (off, bound)}
    return Outcome(setting, errors | {"closure": (m.closure_residual, ROUNDED)}, str(m.kind))


def against_50_digits(setting: str, result: MinimaResult, bound: float) -> Outcome:
    """Compare every minimum of a result whose KKT system is regular with its 50-digit solution."""
    problem = pose(result.scene)
    angles, energies, pushes = [0.0], [0.0], [0.0]
    for m in result.minima:
        x = problem.reduce(np.array(m.fold_angles))
        exact = exact_state(problem, x) if m.kind != "degenerate" else None
        if exact is None:
            continue
        angles.append(exact.angle_error(x))
        energies.append(exact.energy_error(m.energy))
        if len(exact.multipliers):
            ours = State(problem, x).on(exact.rows).forces
            largest = max(1.0, float(np.abs(exact.multipliers).max()))
            pushes.append(float(np.abs(ours - exact.multipliers).max()) / largest)
    loose = max(1e-13, bound)
    errors = {"angles": (max(angles), bound), "energy": (max(energies), loose)}
    errors["multipliers"] = (max(pushes), loose)
    right = bool(result.minima)
    return Outcome(setting, errors, f"{len(result.minima)} minima", right)


def _solved(problem: PatternProblem, start: np.ndarray) -> tuple[Any, Any]:
    state = polish(problem, solve_apart(problem, start)[0])
    return state, classify(State(problem, state.x), polished=state.converged)


def flat_starts() -> Iterator[Outcome]:
    """Closure and its Jacobian give no direction at the flat state: another state must be reached and judged."""
    for scene in (
        examples.degree6("pi/4", 1.0),
        examples.degree6("pi/3", 1.0),
        examples.degree8("pi/6", 1.0),
        examples.degree6("pi/4", 1.0, symmetry="none"),
    ):
        problem = pose(scene)
        state, what = _solved(problem, np.zeros(problem.size))
        exact = exact_state(problem, state.x)
        errors = {"closure": (state.closure_residual, ROUNDED)}
        if exact is None:
            errors["KKT"] = (state.kkt_residual, 1e-11)
        else:
            errors["angles"] = (exact.angle_error(state.x), 1e-12)
        right = float(np.abs(state.x).max()) > 0.1 and what.verdict != "undecided"
        yield Outcome(f"{scene.name}, {scene.group.name}", errors, what.verdict, right)


def flat_answers() -> Iterator[Outcome]:
    """All rest angles 0: the flat state is the one of energy 0, degenerate and of full dimension."""
    for sectors, symmetry in (
        (("pi/2",) * 4, "none"),
        (("pi/3", "2*pi/3") * 2, "none"),
        (("pi/3",) * 6, "D1"),
        (("pi/4",) * 8, "D2"),
        (("pi/5",) * 10, "D5"),
    ):
        n = len(sectors)
        vertex = Vertex(parse_angles(sectors, "sector_angles"))
        scene = Scene(vertex, (1.0,) * n, (0.0,) * n, symmetry)
        result = find_minima(scene)
        m, far = nearest(result, np.zeros(n))
        alone = sum(other.energy <= 1e-20 for other in result.minima) == 1
        right = m.kind == "degenerate" and alone and m.local_dimension == pose(scene).dof
        errors = {"angles": (far, ROUNDED), "energy": (m.energy, 1e-25)}
        yield Outcome(f"degree {n}, {scene.group.name}", errors, str(m.kind), right)


def folded() -> Iterator[Outcome]:
    """Flat-folded states (rank-deficient closure, all facets touching) and book folds (families of rank 2)."""
    pi = math.pi
    for sectors, signs, symmetry in (
        # Kawasaki and Maekawa; the smallest facet between a mountain and a valley
        (("pi/4", "pi/3", "3*pi/4", "2*pi/3"), (-1, 1, 1, 1), "none"),
        (("pi/4", "pi/2", "3*pi/4", "pi/2"), (-1, 1, 1, 1), "none"),
        (("pi/3",) * 6, (1, 1, -1, 1, -1, 1), "D1"),
    ):
        rest = tuple(pi * s for s in signs)
        vertex = Vertex(parse_angles(sectors, "sector_angles"))
        scene = Scene(vertex, (1.0,) * len(rest), rest, symmetry)
        yield known_state(f"folded flat, degree {len(rest)}, {sectors[1]}", scene, rest)
    for ratio in (0.01, 1.0, 100.0):
        scene = examples.degree6("pi/4", ratio)
        energy = 4 * scene.stiffness[1] / 2 * (pi / 2) ** 2
        closed = (-pi, 0.0, 0.0, -pi, 0.0, 0.0)
        yield known_state(f"closed book, r_k = {ratio:g}", scene, closed, energy)
    vertex = Vertex(parse_angles(("pi/4", "pi/2", "pi/4") * 2, "sector_angles"))
    for angle, symmetry in ((1.0, "D1"), (1e-3, "D1"), (1e-5, "D1"), (1e-6, "D1"), (1e-6, "none")):
        rest = (angle, 0.0, 0.0, angle, 0.0, 0.0)
        scene = Scene(vertex, (1.0,) * 6, rest, symmetry)
        yield known_state(f"book open by {angle:g} rad, {symmetry}", scene, rest)


def next_to_pi() -> Iterator[Outcome]:
    """Springs that rest within 1e-12 of +-pi: nothing may snap to the fold limit where closure is regular.

    On the book of degree 4 closure at distance d has a singular value d: doubles know the angle to eps / d.
    """
    for distance in (1e-6, 1e-9, 1e-12, 1e-14, 0.0):
        angle = math.pi - distance
        rest = (angle, 0.0, angle, 0.0)
        scene = Scene(Vertex((math.pi / 2,) * 4), (1.0,) * 4, rest, "none")
        bound = max(ROUNDED, 2 * EPS + min(distance, 4 * EPS / max(distance, 1e-300)))
        yield known_state(f"book of degree 4, pi - {distance:g}", scene, rest, bound=bound)
    for sign, distance in ((1, 1e-6), (1, 1e-12), (-1, 1e-12), (1, 0.0)):
        scene, state = regular_at_pi(sign * (math.pi - distance))
        yield known_state(f"degree 5, {'+' if sign > 0 else '-'}(pi - {distance:g})", scene, state)


def regular_at_pi(angle: float) -> tuple[Scene, np.ndarray]:
    """A degree-5 scene at rest in an admissible state of full rank whose third fold angle is given."""
    vertex = Vertex((1.0, 1.3, 1.4, 1.2, 2 * math.pi - 4.9))
    problem = pose(Scene(vertex, (1.0,) * 5, (0.3,) * 5, "none"))
    x = np.random.default_rng(3).uniform(-2.5, 2.5, (64, 5))
    x[:, 2] = angle
    frozen = np.zeros_like(x, dtype=bool)
    frozen[:, 2] = True
    x, residual = project(problem, x, frozen=frozen)
    for state in x[residual <= CLOSURE_TOL]:
        state[2] = angle
        rank = np.linalg.svd(problem.constraints(state)[1], compute_uv=False).min()
        if rank > 0.2 and np.abs(np.delete(state, 2)).max() < 3.0 and not problem.refuses(state):
            return Scene(vertex, (1.0,) * 5, tuple(state.tolist()), "none"), state
    raise AssertionError("no regular state with this fold angle")


def ratios() -> Iterator[Outcome]:
    """Torques of soft springs are rounding beside the stiff ones: right to eps over the softness."""
    for make in (examples.degree6, examples.degree8):
        for power in (-8, -6, -4, 4, 6, 8):
            scene = make("pi/4", 10.0**power)
            result = find_minima(scene)
            bound = max(1e-13, 8 * EPS / result.model.parameters.softness)
            yield against_50_digits(f"degree {scene.degree}, r_k = 1e{power}", result, bound)


def scales() -> Iterator[Outcome]:
    """Fold angles do not depend on the unit of stiffness; energy and moments are proportional to it."""
    for base in (examples.degree6("5*pi/12", 100.0), examples.degree8("pi/12", 100.0)):
        unit = find_minima(base)
        for factor in (1e-12, 1e-6, 2.0**40, 1e6, 1e12):
            scaled = replace(base, stiffness=tuple(factor * k for k in base.stiffness))
            result = find_minima(scaled)
            pairs = list(zip(result.minima, unit.minima, strict=False))
            moments = [
                abs(a.multiplier / factor - b.multiplier) / max(b.multiplier, 1e-3)
                for m, u in pairs
                for a, b in zip(m.contacts, u.contacts, strict=False)
            ]
            far = [np.abs(np.subtract(m.fold_angles, u.fold_angles)).max() for m, u in pairs]
            energy = [abs(m.energy / factor / u.energy - 1) for m, u in pairs]
            exact = math.frexp(factor)[0] == 0.5
            bound, loose = (0.0, 0.0) if exact else (ROUNDED, 1e-13)
            errors = {"angles": (float(max(far)), bound), "energy": (max(energy), bound)}
            errors["multipliers"] = (max(moments, default=0.0), loose)
            same = [m.kind for m in result.minima] == [m.kind for m in unit.minima]
            title = f"degree {base.degree}, stiffness times {factor:.3g}"
            yield Outcome(title, errors, "the same kinds" if same else "other kinds", same)


def sector_limits() -> Iterator[Outcome]:
    """A facet of width 1e-10, creases about to meet: right to eps over the width, refused below 1e-7 with contact."""
    for at, sign in ((0.0, 1), (math.pi / 3, 1), (math.pi / 3, -1), (math.pi / 2, -1)):
        count = 0
        for distance in (1e-6, 1e-8, 1e-10):
            title = f"alpha_1 = {at:.3g} {'+' if sign > 0 else '-'} {distance:g}"
            try:
                scene = examples.degree6(at + sign * distance, 1.0)
            except SceneError as error:
                yield Outcome(title, {}, "refused", "narrower" in str(error))
                continue
            result = find_minima(scene)
            count = count or len(result.minima)
            if scene.relations.made_exact:  # the scene said so: it is the vertex of pi/3 itself
                exact = Vertex((at, math.pi - 2 * at, at) * 2)
                count = len(find_minima(replace(scene, vertex=exact)).minima)
            bound = max(1e-13, 16 * EPS / min(scene.vertex.sector_angles))
            outcome = against_50_digits(title, result, bound)
            yield replace(outcome, right=outcome.right and len(result.minima) == count)


def rest_states() -> Iterator[Outcome]:
    """Springs at rest in a folded state: energy 0, gradient and multipliers vanish together."""
    for degree, seed in ((5, 0), (6, 1), (7, 2)):
        sectors = np.random.default_rng(seed).dirichlet(np.full(degree, 8.0)) * 2 * math.pi
        vertex = Vertex(tuple(sectors.tolist()))
        trial = Scene(vertex, (1.0,) * degree, (0.0,) * degree, "none", "fold-limits")
        problem = pose(trial)
        drawn = np.random.default_rng(seed).uniform(-3.0, 3.0, (64, degree))
        closed, residual = project(problem, drawn)
        x = next(
            x
            for x, left in zip(closed, residual, strict=True)
            if left <= CLOSURE_TOL and not problem.refuses(x) and np.abs(x).max() < 3.0
        )
        scene = replace(trial, rest_angles=tuple(x.tolist()))
        yield known_state(f"degree {degree}, random sectors", scene, x, bound=1e-13)
    for make in (examples.degree6, examples.degree8):
        base = make("pi/4", 100.0)
        state = find_minima(base).minima[0].fold_angles
        scene = replace(base, rest_angles=state)
        yield known_state(f"degree {base.degree}, r_k = 100", scene, state, bound=1e-12)


def weakly_active() -> Iterator[Outcome]:
    """A contact with next to no force, which an interior-point method parks at O(sqrt(mu)).

    Rest angles are linear in the moment: with k = 1, x - J' lam - a mu make x stationary, a = -e_3.
    """
    trial, x = regular_at_pi(math.pi)
    jac = pose(trial).constraints(x)[1]
    lam = CLOSURE_PULL * jac[:, 2] / (jac[:, 2] @ jac[:, 2])
    for moment in (1e-2, 1e-6, 1e-8, 1e-10, 1e-11, 1e-12, 1e-13, 0.0):
        rest = x - jac.T @ lam
        rest[2] += moment
        problem = pose(replace(trial, rest_angles=tuple(rest.tolist())))
        state, what = _solved(problem, x + np.array([0.1, -0.1, -0.2, 0.1, 0.1]))
        pushes = [c.multiplier for c in what.contacts if c.type == "fold-limit"]
        # the rest angle is rounded to 4e-16: so is the moment; Newton knows the state to that over its condition
        errors = {"angles": (float(np.abs(state.x - x).max()), 1e-13)}
        errors["multiplier"] = (abs(pushes[0] - moment) if pushes else math.inf, 1e-12)
        wanted = "contact-pinned" if moment >= 1e-10 else "contact-touching" if not moment else ""
        right = what.verdict == "minimum" and what.kind in (wanted or what.kind,)
        yield Outcome(f"moment {moment:g} N m", errors, str(what.kind), right)


def handles() -> Iterator[Outcome]:
    """Three closed flaps at one edge: contact gradients are dependent; on (-pi, t, -pi, pi - 2 t, ..) U is convex."""
    pi = math.pi
    for ratio in (0.01, 1.0, 100.0):
        scene = examples.degree6("pi/3", ratio)
        km, kv = scene.stiffness[0], scene.stiffness[1]
        t = (kv * pi / 2 + 2 * km * pi) / (kv + 2 * km)
        energy = kv * (t - pi / 2) ** 2 + kv * (1.5 * pi) ** 2 + km / 2 * (2 * pi - 2 * t) ** 2
        m, far = nearest(find_minima(scene), (-pi, t, -pi, pi - 2 * t, -pi, t))
        open_ended = sum(math.isinf(c.multiplier_range[1]) for c in m.contacts)
        errors = {"angles": (far, ROUNDED), "energy": (abs(m.energy / energy - 1), ROUNDED)}
        right = m.kind == "degenerate" and m.local_dimension == 1 and open_ended >= 2
        yield Outcome(f"r_k = {ratio:g}", errors, str(m.kind), right)


def wedges() -> Iterator[Outcome]:
    """Products of 60 folds, facets of 6 degrees that may meet all others: right to 1e-12."""
    for group, period in (("D", 2), ("D", 4), ("D", 6), ("C", 3), ("C", 4)):
        j = np.arange(DEGREE) % period
        if group == "D":
            j = np.minimum(j, period - j)  # both ends of the wedge lie on creases
        springs = (1.0 + 0.5 * np.cos(1.3 * j), 1.2 * np.cos(np.pi * j) * (1 - 0.1 * j))
        stiffness, rest = (tuple(v.tolist()) for v in springs)
        vertex = Vertex((2 * math.pi / DEGREE,) * DEGREE)
        name = f"{group}{DEGREE // period}"
        limits = Scene(vertex, stiffness, rest, name, "fold-limits").of_one_winding
        for scene in (limits, replace(limits, contact="full"))[: 1 + (group == "D")]:
            result = find_minima(scene, max_starts=STARTS)
            yield against_50_digits(f"{name}, contact {scene.contact}", result, 1e-12)


CASES: dict[str, Callable[[], Iterator[Outcome]]] = {
    "flat state as a start": flat_starts,
    "flat state as the answer": flat_answers,
    "flat-folded states and book folds": folded,
    "fold angle within 1e-12 of +-pi": next_to_pi,
    "stiffness ratios 1e-8 to 1e8": ratios,
    "stiffness scale 1e-12 to 1e12": scales,
    "sector angles next to 0, pi/3, pi/2": sector_limits,
    "springs at rest in a folded state": rest_states,
    "weakly active contact": weakly_active,
    "three dependent contacts": handles,
    "wedges of a vertex of degree 60": wedges,
}


def run_case(run: Callable[[], Iterator[Outcome]]) -> list[Outcome]:
    """Run one case; an exception inside it becomes a failed outcome, not the end of the run."""
    out: list[Outcome] = []
    begin = time.perf_counter()
    try:
        for outcome in run():
            out.append(replace(outcome, seconds=time.perf_counter() - begin))
            begin = time.perf_counter()
    except Exception as error:  # whatever it is: the case failed, and the others still run
        out.append(Outcome("(after the above)", {}, f"{type(error).__name__}: {error}", False))
    return out


def run_hard(progress: Callable[[str], object] = lambda text: None) -> dict[str, list[Outcome]]:
    """Run every hard case."""
    out = {}
    for name, run in CASES.items():
        progress(name)
        out[name] = run_case(run)
    return out


def hard_table(found: dict[str, list[Outcome]]) -> Table:
    """Return one row a case, and one for each failure."""
    rows = []
    for name, outcomes in found.items():
        passed = [o for o in outcomes if o.passed]
        angles = [o.errors["angles"][0] for o in outcomes if "angles" in o.errors]
        seconds = sum(o.seconds for o in outcomes)
        worst = f"{max(angles, default=0.0):.0e}"
        rows.append((name, f"{len(passed)} of {len(outcomes)}", worst, f"{seconds:.1f}"))
        rows += [(f"{name}: {o.setting}", "fails", o.verdict, "") for o in outcomes if not o.passed]
    return Table(("case", "settings that pass", "largest error [rad]", "s"), rows)


def hard_to_dict(found: dict[str, list[Outcome]]) -> dict[str, Any]:
    """Return plain data for JSON."""
    cases = {name: [asdict(o) | {"passed": o.passed} for o in of] for name, of in found.items()}
    return {"schema": "origami-nlp/hard/2", "cases": cases}
