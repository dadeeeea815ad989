"""The check of a design: what was asked for, looked for in the scene by the main job."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from origami_nlp.barriers import find_barriers
from origami_nlp.inverse_design.convex import ConvexDesign
from origami_nlp.inverse_design.result import Design, ExtraMinimum, HeldBarrier, HeldState
from origami_nlp.inverse_design.robustness import MOVES, Tolerance, tolerance_of
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.inverse_design.targets_file import Ask
from origami_nlp.inverse_design.transition_paths import TransitionPath, height
from origami_nlp.kkt import State, classify
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import DESIGN_FOUND, SAME_ENERGY, SETTLED
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.problem import Model

TRIALS = 20
"""Random springs within the tolerance that are tried."""


def check(
    targets: Targets,
    ask: Ask,
    posed: ConvexDesign,
    scene: Scene | Pattern,
    minima: MinimaResult,
    ways: Mapping[tuple[str, str], TransitionPath],
    seed: int,
    say: Callable[[str], None],
) -> Design:
    """Compare the minima of a scene with what was asked for.

    Parameters
    ----------
    targets, ask
        The question.
    posed
        The problem that the springs come from.
    scene
        With them.
    minima
        Of the scene.
    ways
        Curves between states whose barriers are asked for, with one degree of freedom.
    seed
        Of directions of tolerances.
    say
        Called before what takes time.

    Returns
    -------
    Design
        With all that is wrong in `failed`.
    """
    states, failed, ours = _states(targets, minima)
    others = [m for i, m in enumerate(minima.minima) if i not in ours]
    extra = tuple(ExtraMinimum(m.energy, str(m.kind), tuple(m.fold_angles)) for m in others)
    energy = {s.name: s.energy for s in states}
    failed += _energies(targets, energy)
    barriers: tuple[HeldBarrier, ...] = ()
    if isinstance(scene, Scene):
        barriers = _barriers(targets, scene, minima, ways, energy, seed)
    failed += [b.why for b in barriers if b.why]
    if extra and ask.extra_states == "forbid":
        failed.append(f"{len(extra)} minima that were to be forbidden are there")
    tolerance = None
    if not failed and (ask.tolerance_percent is not None or ask.maximise == "tolerance"):
        say("tolerance of the springs")
        tolerance, more = _tolerance(ask, scene, states, seed)  # type: ignore[arg-type]
        failed += more
    return Design(
        targets=targets,
        margin=posed.margin,
        scene=scene,
        states=states,
        extra_minima=extra,
        reason=None,
        failed=tuple(failed),
        minima=minima,
        iterations=posed.answer.iterations,
        residual=posed.answer.residual,
        barriers=barriers,
        tolerance=tolerance,
    )


def _states(
    targets: Targets, result: MinimaResult
) -> tuple[tuple[HeldState, ...], list[str], set[int]]:
    """Look for every target among the minima, and judge it by itself where it is not there."""
    held, failed, ours = [], [], set()
    for placed in targets.placed:
        who = placed.target.name
        phi = targets.model.expand(placed.state.x)
        asked = tuple(map(float, placed.target.fold_angles))
        this = who, asked, tuple(phi.tolist()), placed.moved
        number, far = _nearest(result, phi)
        if number:
            m = result.minima[number - 1]
            ours.add(number - 1)
            verdict = m.full_space.verdict if m.full_space else None
            held.append(HeldState(*this, far, m.energy, m.kind, m.certificate, verdict))
            if targets.full_space and verdict not in (None, "stable"):
                failed.append(f"state {who!r} is {verdict} when the symmetry breaks")
            continue
        made = result.origami
        judged = classify(State(targets.posed(made), placed.state.x))
        energy = float(made.energy(phi))
        held.append(HeldState(*this, math.inf, energy, judged.kind, judged.reason, None))
        failed.append(
            f"the search did not find state {who!r}, which by itself is "
            + (f"a minimum ({judged.kind})" if judged.kind else f"none: {judged.reason}")
        )
    return tuple(held), failed, ours


def _energies(targets: Targets, energy: dict[str, float]) -> list[str]:
    out = []
    for gap in targets.energies:
        d = energy[gap.upper] - energy[gap.lower]
        # rounding of a difference of two energies
        room = SAME_ENERGY * (abs(energy[gap.upper]) + abs(energy[gap.lower]))
        if not gap.least - room <= d <= gap.most + room:
            out.append(
                f"energy of {gap.upper!r} above {gap.lower!r} is {d:.9g} J, "
                f"not within [{gap.least:g}, {gap.most:g}]"
            )
    for name, most in targets.highest.items():
        if energy[name] > most + SAME_ENERGY * abs(energy[name]):
            out.append(f"energy of {name!r} is {energy[name]:.9g} J, above {most:g}")
    return out


def _barriers(
    targets: Targets,
    scene: Scene,
    minima: MinimaResult,
    ways: Mapping[tuple[str, str], TransitionPath],
    energy: dict[str, float],
    seed: int,
) -> tuple[HeldBarrier, ...]:
    """Measure every barrier: along the curve with one degree of freedom, by `find_barriers` with two."""
    if not targets.barriers:
        return ()
    dof = targets.model.dof
    if dof > 2:
        return tuple(
            HeldBarrier(
                b.start, b.end, math.nan, (), f"barriers of {dof} degrees of freedom are not known"
            )
            for b in targets.barriers
        )
    model = Model(scene)
    passes = find_barriers(scene, minima, seed=seed).passes if dof == 2 else ()
    out = []
    for b in targets.barriers:
        if dof == 1:
            # one way serves both directions: its top is the same
            way = ways[(b.start, b.end)] if (b.start, b.end) in ways else ways[(b.end, b.start)]
            top, x = height(model, way)
            phi = tuple(model.expand(x).tolist())
        else:
            at = {p.target.name: targets.model.expand(p.state.x) for p in targets.placed}
            pair = {_nearest(minima, at[end])[0] for end in (b.start, b.end)}
            found = next((p for p in passes if {p.from_state, p.to_state} == pair), None)
            top, phi = (math.nan, ()) if found is None else (found.energy, found.fold_angles)
        rise = top - energy[b.start]
        room = SAME_ENERGY * (abs(top) + abs(energy[b.start]))
        good = b.least - room <= rise <= b.most + room
        why = (
            f"barrier from {b.start!r} to {b.end!r} is {rise:.9g} J, not within "
            f"[{b.least:g}, {b.most:g}]"
        )
        out.append(HeldBarrier(b.start, b.end, rise, phi, "" if good else why))
    return tuple(out)


def _nearest(found: MinimaResult, phi: np.ndarray) -> tuple[int, float]:
    """Return the number of the minimum that a state is, 0 for none, and how far the nearest one is [rad]."""
    far = [float(np.abs(np.subtract(m.fold_angles, phi)).max()) for m in found.minima]
    near = min(far, default=math.inf)
    return (far.index(near) + 1 if near <= DESIGN_FOUND else 0), near


def _tolerance(
    ask: Ask, scene: Scene, states: tuple[HeldState, ...], seed: int
) -> tuple[Tolerance, list[str]]:
    at = {s.name: np.array(s.fold_angles) for s in states}
    found = tolerance_of(scene, at, seed=seed, trials=TRIALS)
    asked = ask.tolerance_percent
    unknown = [
        f"the tolerance of state {loss.state!r} is not known: closure loses rank there, it moves as soon as springs "
        "are off, and is not followed"
        for loss in found.losses
        if loss.event == MOVES and loss.percent <= 100.0 * SETTLED
    ]
    if unknown:
        return found, unknown
    if asked is not None and found.percent < asked:
        loss = min(found.losses, key=lambda one: one.percent)
        return found, [
            f"state {loss.state!r} is lost where springs are off by {loss.percent:.4g} % "
            f"({loss.event}), not {asked:g} %"
        ]
    return found, []
