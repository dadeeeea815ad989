"""The check of a design: what was asked for, looked for in the scene by the main job."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from origami_nlp.inverse_design.convex import ConvexDesign
from origami_nlp.inverse_design.result import Design, ExtraMinimum, HeldBarrier, HeldState
from origami_nlp.inverse_design.targets import Targets
from origami_nlp.inverse_design.transition_paths import TransitionPath, height
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
    ways: Mapping[tuple[str, str], TransitionPath],
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
    ways
        Curves between states whose barriers are asked for, with one degree of freedom.

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
        barriers = _barriers(targets, scene, ways, energy)
    failed += [b.why for b in barriers if b.why]
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
    ways: Mapping[tuple[str, str], TransitionPath],
    energy: dict[str, float],
) -> tuple[HeldBarrier, ...]:
    """Measure every barrier along the curve of one degree of freedom; with more they are bounded from above alone."""
    dof = targets.model.dof
    if dof > 1:
        return tuple(
            HeldBarrier(
                b.start, b.end, math.nan, (), f"barriers of {dof} degrees of freedom are not known"
            )
            for b in targets.barriers
        )
    model = pose(scene)
    out = []
    for b in targets.barriers:
        # one way serves both directions: its top is the same
        way = ways[(b.start, b.end)] if (b.start, b.end) in ways else ways[(b.end, b.start)]
        top, x = height(model, way)
        rise = top - energy[b.start]
        room = SAME_ENERGY * (abs(top) + abs(energy[b.start]))
        good = b.least - room <= rise <= b.most + room
        why = (
            f"barrier from {b.start!r} to {b.end!r} is {rise:.9g} J, not within "
            f"[{b.least:g}, {b.most:g}]"
        )
        phi = tuple(model.expand(x).tolist())
        out.append(HeldBarrier(b.start, b.end, rise, phi, "" if good else why))
    return tuple(out)


def _nearest(found: MinimaResult, phi: np.ndarray) -> tuple[int, float]:
    """Return the number of the minimum that a state is, 0 for none, and how far the nearest one is [rad]."""
    far = [float(np.abs(np.subtract(m.fold_angles, phi)).max()) for m in found.minima]
    near = min(far, default=math.inf)
    return (far.index(near) + 1 if near <= DESIGN_FOUND else 0), near
