"""From a question to springs that were checked."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from origami_nlp.arguments import check_callback, check_whole, shown
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, classify
from origami_nlp.minima import MinimaResult, find_minima
from origami_nlp.numerics import DESIGN_FOUND
from origami_nlp.programme import Model
from origami_nlp.springs.convex import Posed, scene_of, solve, springs_of
from origami_nlp.springs.reasons import why_not
from origami_nlp.springs.result import Design, HeldState
from origami_nlp.springs.targets import Placed, Targets

Progress = Callable[[str], None]
BALANCE = 1e-9
"""Relative error of energy differences above which a design is not verified."""


def design(
    targets: Targets,
    *,
    name: str | None = None,
    seed: int = 0,
    effort: str = "normal",
    progress: Progress | None = None,
) -> Design:
    """Find the springs that hold given states with the largest margin, or prove that there are none.

    At fixed states the conditions are convex in stiffness and torque (`equilibrium`), so that the answer is the best
    there is, or a proof that none exists within the bounds; then the main job searches the scene for its minima.

    Parameters
    ----------
    targets
        The question.
    name
        Of the scene.
    seed, effort
        Of the search that checks the answer, as of `find_minima`.
    progress
        Called with a line before each stage.

    Returns
    -------
    Design
        With the scene and its check, or with the reason.

    Raises
    ------
    OptionError
        If an argument is not what it must be, a target does not close or is not admissible, or Clarabel is missing.

    Examples
    --------
    >>> import math, origami_nlp as o
    >>> vertex = o.Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3"))
    >>> result = o.find_minima(o.Scene(vertex, (1, 1, 1, 1), (1.2, -1.2, -0.6, -1.2)))
    >>> wanted = o.springs.Target("folded", result.minima[0].fold_angles)
    >>> answer = o.design(o.springs.Targets(vertex, (wanted,)))
    >>> answer.verified, answer.margin > 0
    (True, True)
    """
    if not isinstance(targets, Targets):
        raise OptionError(f"targets = {shown(targets)} must be Targets (read_targets reads a file)")
    check_whole("seed", seed, 0)
    check_callback("progress", progress)
    say = progress or (lambda _: None)
    say("springs for the states")
    posed = solve(targets)
    answer = posed.answer
    if not posed.feasible:
        return _none(targets, posed)
    found = springs_of(posed)
    scene = scene_of(targets, found, name)
    say("minima of the scene")
    full = targets.full_space and not targets.blank.group.is_trivial
    minima = find_minima(scene, seed=seed, effort=effort, full=full)
    states, failed, ours = _check(targets, minima)
    extra = tuple(
        (m.energy, m.kind, m.fold_angles) for i, m in enumerate(minima.minima) if i not in ours
    )
    failed += _check_energies(targets, {s.name: s.energy for s in states})
    return Design(
        targets,
        found.margin,
        scene,
        states,
        extra,
        None,
        tuple(failed),
        minima,
        answer.iterations,
        answer.residual,
    )


def _none(targets: Targets, posed: Posed) -> Design:
    reason = why_not(posed)
    a = posed.answer
    return Design(targets, posed.margin, None, (), (), reason, (), None, a.iterations, a.residual)


def _check(
    targets: Targets, result: MinimaResult
) -> tuple[tuple[HeldState, ...], list[str], set[int]]:
    """Look for every target among the minima, and judge it by itself where it is not there."""
    held, failed, ours = [], [], set()
    for placed in targets.placed:
        who = placed.target.name
        phi = targets.model.expand(placed.state.x)
        far = [float(np.abs(np.subtract(m.fold_angles, phi)).max()) for m in result.minima]
        i = int(np.argmin(far)) if far else -1
        if far and far[i] <= DESIGN_FOUND:
            m = result.minima[i]
            ours.add(i)
            verdict = m.full_space.verdict if m.full_space else None
            held.append(_held(placed, phi, far[i], m.energy, m.kind, m.certificate, verdict))
            if verdict not in (None, "stable"):
                failed.append(f"state {who!r} is {verdict} when the symmetry breaks")
            continue
        judged = classify(State(Model(result.scene), placed.state.x))
        energy = float(result.scene.energy(phi))
        held.append(_held(placed, phi, math.inf, energy, judged.kind, judged.reason, None))
        failed.append(
            f"the search did not find state {who!r}, which by itself is "
            + (f"a minimum ({judged.kind})" if judged.kind else f"none: {judged.reason}")
        )
    return tuple(held), failed, ours


def _held(
    placed: Placed,
    phi: np.ndarray,
    found: float,
    energy: float,
    kind: str | None,
    certificate: str,
    verdict: str | None,
) -> HeldState:
    return HeldState(
        placed.target.name,
        tuple(map(float, placed.target.fold_angles)),
        tuple(phi.tolist()),
        placed.moved,
        found,
        energy,
        kind,
        certificate,
        verdict,
    )


def _check_energies(targets: Targets, energy: dict[str, float]) -> list[str]:
    out = []
    for gap in targets.energies:
        d = energy[gap.upper] - energy[gap.lower]
        room = BALANCE * (abs(energy[gap.upper]) + abs(energy[gap.lower]))
        if not gap.least - room <= d <= gap.most + room:
            out.append(
                f"energy of {gap.upper!r} above {gap.lower!r} is {d:.9g} J, "
                f"not within [{gap.least:g}, {gap.most:g}]"
            )
    for name, most in targets.highest.items():
        if energy[name] > most + BALANCE * energy[name]:
            out.append(f"energy of {name!r} is {energy[name]:.9g} J, above {most:g}")
    return out
