"""Hard cases of springs and sector angles: extreme ratios and scales, facets about to vanish, rest when folded."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.hard_case import HardCase, Measured, Outcome
from benchmarks.hard_flat import exact_state, known_state
from origami_nlp.errors import SceneError
from origami_nlp.kkt import State
from origami_nlp.minima import MinimaResult, find_minima
from origami_nlp.numerics import EPS, ROUNDED
from origami_nlp.pattern import Scene, Vertex, examples
from origami_nlp.problem import Model
from origami_nlp.starts import Projected


def against_50_digits(setting: str, result: MinimaResult, bound: float) -> Outcome:
    """Compare every minimum of a result whose KKT system is regular with its 50-digit solution."""
    model = result.model
    angles, energies, pushes, singular = [0.0], [0.0], [0.0], 0
    for m in result.minima:
        x = model.reduce(np.array(m.fold_angles))
        exact = exact_state(model, x) if m.kind != "degenerate" else None
        if exact is None:
            singular += 1
            continue
        angles.append(exact.angle_error(x))
        energies.append(exact.energy_error(m.energy))
        if len(exact.multipliers):
            ours = State(model, x).on(exact.rows).forces
            largest = max(1.0, float(np.abs(exact.multipliers).max()))
            pushes.append(float(np.abs(ours - exact.multipliers).max()) / largest)
    unpolished = sum(not m.polished for m in result.minima)
    measured = (
        Measured("angles", max(angles), bound),
        Measured("energy", max(energies), max(1e-13, bound)),
        Measured("multipliers", max(pushes), max(1e-13, bound)),
    )
    kinds = ", ".join(m.kind for m in result.minima)
    note = f"{singular} singular, not compared" if singular else ""
    right = bool(result.minima) and not unpolished
    return Outcome(setting, measured, kinds or "none", right, result.search.iterations, note=note)


def _ratios() -> Iterator[Outcome]:
    for make in (examples.degree6, examples.degree8):
        for power in (-8, -6, -4, 4, 6, 8):
            scene = make("pi/4", 10.0**power)
            result = find_minima(scene)
            # a soft spring feels torques that are rounding beside the stiff ones
            bound = max(1e-13, 8 * EPS / result.model.parameters.softness)
            yield against_50_digits(f"degree {scene.degree}, r_k = 1e{power}", result, bound)


def _scales() -> Iterator[Outcome]:
    for base in (examples.degree6("5*pi/12", 100.0), examples.degree8("pi/12", 100.0)):
        unit = find_minima(base)
        for factor, words in (
            (1e-12, "1e-12"),
            (1e-6, "1e-6"),
            (2.0**40, "2^40"),
            (1e6, "1e6"),
            (1e12, "1e12"),
        ):
            scaled = replace(base, stiffness=tuple(factor * k for k in base.stiffness))
            result = find_minima(scaled)
            same = [m.kind for m in result.minima] == [m.kind for m in unit.minima]
            pairs = list(zip(result.minima, unit.minima, strict=False))
            far = max(
                float(np.abs(np.subtract(m.fold_angles, u.fold_angles)).max()) for m, u in pairs
            )
            energy = max(abs(m.energy / factor / u.energy - 1) for m, u in pairs)
            moments = [
                abs(a.multiplier / factor - b.multiplier) / max(b.multiplier, 1e-3)
                for m, u in pairs
                for a, b in zip(m.contacts, u.contacts, strict=False)
            ]
            exact = math.frexp(factor)[0] == 0.5
            bound = 0.0 if exact else ROUNDED
            measured = (
                Measured("angles", far, bound),
                Measured("energy", energy, bound),
                Measured("multipliers", max(moments, default=0.0), bound if exact else 1e-13),
            )
            kinds = ", ".join(m.kind for m in result.minima)
            title = f"degree {base.degree}, stiffness x {words}"
            yield Outcome(title, measured, kinds, same, result.search.iterations)


def _sector_limits() -> Iterator[Outcome]:
    for at, sign, name in (
        (0.0, 1, "0 +"),
        (math.pi / 3, 1, "pi/3 +"),
        (math.pi / 3, -1, "pi/3 -"),
        (math.pi / 2, -1, "pi/2 -"),
    ):
        count = 0
        for distance in (1e-6, 1e-8, 1e-10):
            alpha, title = at + sign * distance, f"alpha_1 = {name} {distance:g}"
            try:
                scene = examples.degree6(alpha, 1.0)
            except SceneError as error:
                refused = str(error).split(":")[0]
                yield Outcome(title, (), f"refused: {refused}", "narrower" in refused)
                continue
            # fold angles beside a facet of width w are known to eps / w
            bound = max(1e-13, 16 * EPS / min(scene.vertex.sector_angles))
            result = find_minima(scene)
            count = count or len(result.minima)
            if scene.relations.made_exact:  # the scene said so: it is the vertex of pi/3 itself
                exact = Vertex((at, math.pi - 2 * at, at) * 2)
                count = len(find_minima(replace(scene, vertex=exact)).minima)
            outcome = against_50_digits(title, result, bound)
            words = f"{len(result.minima)} minima"
            right = outcome.right and len(result.minima) == count
            note = outcome.note
            if scene.relations.made_exact:
                note += f"; made exact: sectors moved by {scene.relations.moved:.0e}"
            yield replace(outcome, verdict=words, right=right, note=note)


def _rest_states() -> Iterator[Outcome]:
    for degree, seed in ((5, 0), (6, 1), (7, 2)):
        sectors = np.random.default_rng(seed).dirichlet(np.full(degree, 8.0)) * 2 * math.pi
        vertex = Vertex(tuple(sectors.tolist()))
        trial = Scene(vertex, (1.0,) * degree, (0.0,) * degree, "none", "fold-limits")
        model = Model(trial)
        for start in Projected(model).starts(np.random.default_rng(seed)):
            if start.feasible and not model.refuses(start.x) and np.abs(start.x).max() < 3.0:
                break
        scene = replace(trial, rest_angles=tuple(start.x.tolist()))
        yield known_state(f"degree {degree}, random sectors", scene, start.x, 0.0, 1e-13)
    for make in (examples.degree6, examples.degree8):
        base = make("pi/4", 100.0)
        state = find_minima(base).minima[0].fold_angles
        scene = replace(base, rest_angles=state)
        yield known_state(f"degree {base.degree}, r_k = 100", scene, state, 0.0, 1e-12)


SPRING_CASES = (
    HardCase(
        "stiffness ratios 1e-8 to 1e8",
        "torques of soft springs are rounding beside the stiff ones; IPOPT's tolerance is absolute",
        "50-digit solution of the KKT system at each minimum; doubles know the softest direction to eps / softness",
        "every minimum polished, fold angles to max(1e-13, 8 eps k_mean / k_min)",
        _ratios,
    ),
    HardCase(
        "stiffness scale 1e-12 to 1e12",
        "absolute tolerances of a solver favour one unit of stiffness",
        "fold angles do not depend on the unit; energy and moments are proportional to it (bit for bit for 2^40)",
        "the same minima: angles and energies to 1e-14, moments to 1e-13",
        _scales,
    ),
    HardCase(
        "sector angles next to 0, pi/3, pi/2",
        "a facet of width 1e-10 (0 and pi/2); creases about to meet (pi/3)",
        "50-digit solution of the KKT system at each minimum; doubles know fold angles to eps / width",
        "every minimum polished, fold angles to max(1e-13, 16 eps / width); full contact refused below 1e-7; "
        "as many minima as 1e-6 away; below 1e-7, where the scene makes pi/3 exact, as many as there",
        _sector_limits,
    ),
    HardCase(
        "springs at rest in a folded state",
        "energy 0: relative errors mean nothing, gradient and multipliers vanish together",
        "the rest angles close: they are the minimum, of energy 0",
        "that state to rounding",
        _rest_states,
    ),
)
