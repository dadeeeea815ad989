"""Hard cases of contact: multipliers next to zero, and contacts that describe one touch several times."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from benchmarks.hard_case import HardCase, Measured, Outcome
from benchmarks.hard_flat import nearest, regular_at_pi
from origami_nlp.kkt import State, classify, polish
from origami_nlp.minima import Record, find_minima, solve_without_crossing
from origami_nlp.numerics import ROUNDED
from origami_nlp.pattern import Scene, examples
from origami_nlp.problem import Model

CLOSURE_PULL = 0.3
"""Torque [N m] by which closure pulls at the closed crease, so that its rest angle stays within +-pi."""


def weakly_pinned(moment: float) -> tuple[Scene, np.ndarray]:
    """A degree-5 scene whose state with phi_3 = pi is pinned with a given moment [N m].

    Design is linear: with k = 1 the rest angles phi0 = x - J' lam - a mu make x stationary, a = -e_3.
    """
    trial, x = regular_at_pi(math.pi)
    jac = Model(trial).closure(x)[1]
    lam = CLOSURE_PULL * jac[:, 2] / (jac[:, 2] @ jac[:, 2])
    rest = x - jac.T @ lam
    rest[2] += moment
    return Scene(trial.vertex, (1.0,) * 5, tuple(rest.tolist()), "none"), x


def _weakly_active() -> Iterator[Outcome]:
    for moment in (1e-2, 1e-6, 1e-8, 1e-10, 1e-11, 1e-12, 1e-13, 0.0):
        scene, x = weakly_pinned(moment)
        model, record = Model(scene), Record()
        answer = solve_without_crossing(model, x + np.array([0.1, -0.1, -0.2, 0.1, 0.1]), record)
        state = polish(model, answer)
        what = classify(State(model, state.x), polished=state.converged)
        pushes = [c.multiplier for c in what.contacts if c.type == "fold-limit"]
        error = abs(pushes[0] - moment) if pushes else math.inf
        # the rest angle is rounded to 4e-16: so is the moment
        measured = (
            Measured("angles", float(np.abs(state.x - x).max()), ROUNDED),
            Measured("multiplier", error, max(1e-12, ROUNDED)),
        )
        pinned = what.kind == "contact-pinned"
        right = what.verdict == "minimum" and (pinned if moment >= 1e-10 else not moment or True)
        right = right and (what.kind == "contact-touching" if moment == 0 else True)
        verdict = f"{what.verdict}, {what.kind}"
        yield Outcome(f"moment {moment:g} N m", measured, verdict, right, record.iterations)


def _handles() -> Iterator[Outcome]:
    pi = math.pi
    for ratio in (0.01, 1.0, 100.0):
        scene = examples.degree6("pi/3", ratio)
        km, kv = scene.stiffness[0], scene.stiffness[1]
        t = (kv * pi / 2 + 2 * km * pi) / (kv + 2 * km)
        state = (-pi, t, -pi, pi - 2 * t, -pi, t)
        energy = kv * (t - pi / 2) ** 2 + kv * (1.5 * pi) ** 2 + km / 2 * (2 * pi - 2 * t) ** 2
        result = find_minima(scene)
        m, far = nearest(result, state)
        assert m is not None
        ranges = [c.multiplier_range for c in m.contacts]
        open_ended = sum(math.isinf(high) for _, high in ranges)
        measured = (
            Measured("angles", far, ROUNDED),
            Measured("energy", abs(m.energy / energy - 1), ROUNDED),
        )
        verdict = (
            f"{m.kind}, dimension {m.local_dimension}, {len(ranges)} rows, {open_ended} unbounded"
        )
        right = m.kind == "degenerate" and m.local_dimension == 1 and open_ended >= 2
        yield Outcome(scene.name or "", measured, verdict, right, result.search.iterations)


CONTACT_CASES = (
    HardCase(
        "weakly active contact",
        "an interior-point method parks a contact without force at O(sqrt(mu)): slack and multiplier are both tiny",
        "rest angles are chosen so that the state with phi_3 = pi balances with a given moment",
        "that state to 1e-14 and its moment to 1e-12; pinned from 1e-10 on, touching at 0",
        _weakly_active,
    ),
    HardCase(
        "three dependent contacts",
        "three closed flaps at one edge: contact gradients are dependent, MFCQ fails, solvers return 1e6 to 1e10",
        "on the handle phi = (-pi, t, -pi, pi - 2 t, -pi, t); U is a parabola in t",
        "its minimum to 1e-14, as a state of dimension 1, with finite moments of smallest norm and their ranges",
        _handles,
    ),
)
