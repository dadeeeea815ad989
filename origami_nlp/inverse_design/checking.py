"""The check of a design: what was asked for, looked for in the scene by the main job."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from origami_nlp.inverse_design.convex import ConvexDesign
from origami_nlp.inverse_design.result import Design, ExtraMinimum, HeldBarrier, HeldState
from origami_nlp.inverse_design.targets import ClosedTarget, EnergyBounds, Targets
from origami_nlp.inverse_design.transition_paths import Passes, height
from origami_nlp.kkt import State, classify
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import DESIGN_FOUND, SAME_ENERGY
from origami_nlp.pattern import Pattern, Scene
from origami_nlp.pattern_problem import pose


def check(
    targets: Targets,
    posed: ConvexDesign,
    scene: Scene | Pattern,
    minima: MinimaResult,
    passes: Passes | None,
) -> Design:
    """Compare the minima of a scene with what was asked for.

    Parameters
    ----------
    targets
        The question.
    posed
        The problem that the springs come from.
    scene
        With them.
    minima
        Of the scene.
    passes
        Curves between states whose barriers are asked for, with one degree of freedom.

    Returns
    -------
    Design
        With all that is wrong in `failed`.
    """
    near = [_nearest(minima, targets.model.expand(p.state.x)) for p in targets.placed]
    states = tuple(_held(targets, minima, *one) for one in zip(targets.placed, near, strict=True))
    energy = {s.name: s.energy for s in states}
    barriers = tuple(_barrier(targets, scene, ask, passes, energy) for ask in targets.barriers)
    failed = [*_unheld(targets, states), *_energies(targets, energy)]
    asked = {k for k, _ in near}
    return Design(
        targets,
        posed.margin,
        scene,
        states,
        tuple(
            ExtraMinimum(m.energy, str(m.kind), tuple(m.fold_angles))
            for k, m in enumerate(minima.minima)
            if k not in asked
        ),
        failed=(*failed, *(b.why for b in barriers if b.why)),
        minima=minima,
        iterations=posed.answer.iterations,
        residual=posed.answer.residual,
        barriers=barriers,
    )


def _nearest(found: MinimaResult, phi: np.ndarray) -> tuple[int, float]:
    """Return which minimum a state is, -1 for none, and how far it is [rad]."""
    far = [float(np.abs(np.subtract(m.fold_angles, phi)).max()) for m in found.minima]
    near = min(far, default=math.inf)
    return (far.index(near), near) if near <= DESIGN_FOUND else (-1, math.inf)


def _held(
    targets: Targets, result: MinimaResult, placed: ClosedTarget, near: tuple[int, float]
) -> HeldState:
    """Return what became of a target: a minimum of the list, or what it is by itself."""
    (k, far), phi = near, targets.model.expand(placed.state.x)
    asked = tuple(map(float, placed.target.fold_angles))
    this = placed.target.name, asked, tuple(phi.tolist()), placed.moved, far
    if k >= 0:
        m = result.minima[k]
        verdict = m.full_space.verdict if m.full_space else None
        return HeldState(*this, m.energy, m.kind, m.certificate, verdict)
    judged = classify(State(result.model, placed.state.x))
    energy = float(result.origami.energy(phi))
    return HeldState(*this, energy, judged.kind, judged.reason, None)


def _unheld(targets: Targets, states: Sequence[HeldState]) -> Iterator[str]:
    """Say which states are not found, or not stable."""
    for s in states:
        if math.isinf(s.found):
            alone = f"a minimum ({s.kind})" if s.kind else f"none: {s.certificate}"
            yield f"the search did not find state {s.name!r}, which by itself is {alone}"
        elif targets.full_space and s.full_space not in (None, "stable"):
            yield f"state {s.name!r} is {s.full_space} when the symmetry breaks"


def _energies(targets: Targets, energy: dict[str, float]) -> Iterator[str]:
    for gap in targets.energies:
        high, low = energy[gap.first], energy[gap.second]
        if why := _outside(high, low, gap.least, gap.most):
            yield f"energy of {gap.first!r} above {gap.second!r} {why}"


def _outside(high: float, low: float, least: float, most: float) -> str:
    """Say that a difference of energies is not within bounds, but for its rounding."""
    room = SAME_ENERGY * (abs(high) + abs(low))
    good = least - room <= high - low <= most + room
    return "" if good else f"is {high - low:.9g} J, not within [{least:g}, {most:g}]"


def _barrier(
    targets: Targets,
    scene: Scene | Pattern,
    ask: EnergyBounds,
    passes: Passes | None,
    energy: dict[str, float],
) -> HeldBarrier:
    """Measure a barrier along the curve of one degree of freedom; with more they are bounded from above alone."""
    if passes is None:
        why = f"barriers of {targets.model.dof} degrees of freedom are not known"
        return HeldBarrier(ask.first, ask.second, math.nan, (), why)
    # one way serves both directions: its top is the same
    pair = (ask.first, ask.second)
    model = pose(scene)
    top, x = height(model, passes.ways[pair if pair in passes.ways else pair[::-1]])
    why = _outside(top, energy[ask.first], ask.least, ask.most)
    why = f"barrier from {ask.first!r} to {ask.second!r} {why}" if why else ""
    phi = tuple(model.expand(x).tolist())
    return HeldBarrier(ask.first, ask.second, top - energy[ask.first], phi, why)
