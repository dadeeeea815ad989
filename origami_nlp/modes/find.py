"""The modes of each minimum: eigenvectors of the reduced Hessian, with the energy until something touches."""

from __future__ import annotations

import math

import numpy as np

from origami_nlp.arguments import check_type, check_whole
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, Stratum
from origami_nlp.minima import JudgedState, MinimaResult, full_scene, group_average, mode_symmetry
from origami_nlp.modes.geodesic import geodesic
from origami_nlp.modes.result import BREAKING, Mode, Modes, StateModes
from origami_nlp.numerics import BALANCED, first_largest
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import MOST_DENSE
from origami_nlp.problem import Contact, Model


def find_modes(result: MinimaResult, *, state: int | None = None) -> Modes:
    """Compute soft modes of minima: energy along each eigenvector of the reduced Hessian until something touches.

    The Hessian is that of the Lagrangian in the space of all N fold angles, whatever symmetry the search kept, on the
    directions that keep closure and loaded contacts.  Along each eigenvector the energy is that of the geodesic that
    leaves the state that way, which keeps closure and these contacts exactly.  Under an imposed symmetry the Hessian
    falls apart into a block of symmetric modes and one of those that break it; what is left between them is reported,
    and is rounding.

    Parameters
    ----------
    result
        Of `find_minima`, for a vertex or a pattern.
    state
        Number (1-based) of the only minimum to look at.

    Returns
    -------
    Modes
        One entry a minimum; one without modes says why.

    Raises
    ------
    OptionError
        If `result` is no result, or there is no minimum of that number.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> found = o.find_modes(result, state=1)
    >>> [mode.block for mode in found.states[0].modes]
    ['symmetric', 'symmetric', 'breaking']
    >>> sheet = o.find_minima("metasheet:2x3", effort="quick", escape=False)
    >>> [len(state.modes) for state in o.find_modes(sheet, state=1).states]
    [1]
    """
    check_type("result", result, MinimaResult)
    count = len(result.minima)
    if state is not None:
        if not count:
            raise OptionError(f"state = {state}: no minimum was found")
        check_whole("state", state, 1, count)
    scene = None if result.is_pattern else result.scene
    problem = result.model if scene is None else Model(full_scene(scene))
    found = [
        modes_of(State(problem, np.array(minimum.fold_angles)), scene, number, minimum)
        for number, minimum in enumerate(result.minima, start=1)
        if state in (None, number)
    ]
    return Modes(result, tuple(found))


def modes_of(state: State, scene: Scene | None, number: int, minimum: JudgedState) -> StateModes:
    """Return the modes of one minimum, posed without symmetry; `scene` is that of a vertex."""
    if state.problem.sparse:
        why = f"a pattern of more than {MOST_DENSE} creases is too large for eigenvectors"
        return StateModes(number, minimum, (), (), 0.0, why)
    held, why = loaded_stratum(state)
    if held is None:
        return StateModes(number, minimum, (), (), 0.0, why)
    problem = state.problem
    names = tuple(problem.name(c) for c in held.contacts)
    z = held.tangent
    if not z.shape[1]:
        return StateModes(
            number, minimum, names, (), 0.0, "no motion keeps the loaded contacts closed"
        )
    h = z.T @ held.hessian @ z
    blocks, coupling = _blocks(z, h, scene)
    modes = []
    for name, basis in blocks:
        values, vectors = np.linalg.eigh(basis.T @ h @ basis)
        for value, vector in zip(values, (z @ basis @ vectors).T, strict=True):
            # an eigenvector has no sign of its own: its largest entry, of equal ones the first, is made positive
            d = vector * np.sign(vector[first_largest(np.abs(vector))])
            keeps = "" if scene is None or scene.group.is_trivial else mode_symmetry(scene, d)
            # h and its eigenvectors are in the metric of all fold angles, so values are stiffnesses in N m/rad^2
            stiffness = float(value * problem.scale)
            modes.append(Mode(stiffness, d, name, keeps, geodesic(held, d)))
    return StateModes(number, minimum, names, tuple(modes), coupling * problem.scale, "")


def breaking_stiffness(
    state: State, scene: Scene, contacts: tuple[Contact, ...] | None = None
) -> float:
    """Return the smallest stiffness of a state against motions that break the symmetry of a scene.

    Parameters
    ----------
    state
        Of all N fold angles.
    scene
        Whose symmetry the state keeps.
    contacts
        Those closed at the state, where they are known; the state looks for them otherwise.

    Returns
    -------
    float
        Smallest eigenvalue of the block that `find_modes` calls breaking [N m/rad]; inf where nothing breaks it and
        keeps the loaded contacts closed, nan where the state has no one Hessian.
    """
    held, _ = loaded_stratum(state, contacts)
    if held is None:
        return math.nan
    z = held.tangent
    h = z.T @ held.hessian @ z
    for name, basis in _blocks(z, h, scene)[0] if z.shape[1] else ():
        if name == BREAKING:
            return float(np.linalg.eigvalsh(basis.T @ h @ basis)[0] * state.problem.scale)
    return math.inf


def loaded_stratum(
    state: State, contacts: tuple[Contact, ...] | None = None
) -> tuple[Stratum | None, str]:
    """Return a state with its loaded contacts held, or None and why it has no one Hessian.

    Parameters
    ----------
    state
        In equilibrium.
    contacts
        Those closed at the state, where they are known; the state looks for them otherwise.

    Returns
    -------
    held : Stratum or None
        The state on the contacts that push.
    why : str
        In words, where there is none.
    """
    if not state.regular:
        return None, "closure loses rank here: states leave in no linear space of directions"
    if contacts is None and len(state.pieces) > 1:
        return None, "pieces of the feasible set meet here: each has a Hessian of its own"
    piece = state.on(state.pieces[0] if contacts is None else contacts)
    mu = piece.multiplier_set
    if mu.residual > BALANCED * (1 + np.abs(state.gradient).max()):
        return None, "no multipliers balance the torque"
    if not mu.unique:
        return None, "contact moments are not unique here, and the Hessian with them"
    rows: list[Contact] = [
        c for c, m in zip(piece.contacts, mu.smallest, strict=True) if m > BALANCED
    ]
    return state.on(rows), ""


def _blocks(
    z: np.ndarray, h: np.ndarray, scene: Scene | None
) -> tuple[list[tuple[str, np.ndarray]], float]:
    """Split the space of directions z [N, t] into named blocks [t, b], and say how much of h [t, t] is between them.

    The mean over the group is the projector on symmetric directions: its eigenvalues on z are 0 and 1.
    """
    if scene is None or scene.group.is_trivial:
        return [("", np.eye(len(h)))], 0.0
    average = group_average(scene)
    # a projector that commutes with the tangent space's has the eigenvalues 1 (symmetric) and 0 (breaking) on it
    share, vectors = np.linalg.eigh(z.T @ average @ z)
    breaking, kept = vectors[:, share <= 0.5], vectors[:, share > 0.5]
    between = np.abs(kept.T @ h @ breaking).max(initial=0.0)
    mixed = np.minimum(np.abs(share), np.abs(share - 1)).max() * np.abs(h).max()
    blocks = [("symmetric", kept), (BREAKING, breaking)]
    return [(name, b) for name, b in blocks if b.shape[1]], float(max(between, mixed))
