"""What people ask of a vertex and of a whole pattern alike: each question one function, whatever is folded.

A scene is one vertex with its springs, symmetry and contact; a pattern a sheet of facets with its springs.  Each
function hands over to the room that knows the one or the other.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING

import numpy as np

from origami_nlp.arguments import check_angles, check_path, check_type, check_until
from origami_nlp.errors import OptionError
from origami_nlp.numerics import CLOSURE_TOL

if TYPE_CHECKING:
    from origami_nlp.kkt import Classification, State
    from origami_nlp.minima import MinimaResult
    from origami_nlp.paths import LoadPath
    from origami_nlp.pattern import Contact, Stated
    from origami_nlp.proof import ProofOptions
    from origami_nlp.search import SearchOptions


def find_minima(
    origami: Stated,
    *,
    seed: int = 0,
    effort: str = "normal",
    options: SearchOptions | None = None,
    max_starts: int | None = None,
    starts: int | None = None,
    guesses: Sequence[np.ndarray] | None = None,
    contact: Contact | None = None,
    full: bool | None = None,
    prove: bool | float | ProofOptions | None = None,
    seconds: float | None = None,
    escape: bool = True,
    noise: float | None = None,
    method: str = "batch",
    progress: Callable[..., object] | None = None,
    found: Callable[[float, np.ndarray], object] | None = None,
) -> MinimaResult:
    """Find and classify the energy minima of a vertex or of a whole pattern: its stable states.

    Parameters
    ----------
    origami
        A scene, which is one vertex, or a scene file; or a pattern with all its vertices coupled: itself, the name of
        an example such as ``"miura:4x4"``, a FOLD file, or what one holds as a dict.
    seed
        Of the random starts; the same seed gives the same answer.
    effort
        ``"quick"``, ``"normal"`` or ``"thorough"``: how many starts find nothing new before the search stops.
    options
        All that steers the search, in place of the effort: `SearchOptions`.
    max_starts
        Cap on starts; None: what the effort says.
    seconds
        Wall time after which the search goes no further: what is left out is named, and the answer depends on the
        machine.  None: 300 s.
    escape
        Say what it takes to leave each minimum (its ``escape``); False: do not.
    noise
        Standard deviation [degrees] of random errors: how many of 20 draws each minimum survives.
    prove
        Whether to prove that no minimum is missing: of a vertex, or of a mesh of vertices of degree four.  None: where
        it is cheap.
    starts
        Random starts in a row that find nothing new, in place of the effort.
    contact
        In place of the one that is stated: ``"full"``, or ``"fold-limits"``: facets may cross.
    guesses
        States to start from first, fold angles [N] [rad] each: ``search.refused`` says why one is no minimum.
    full
        Judge each without an imposed symmetry as well; None: up to 12 creases and 64 states.
    method
        ``"batch"``: compiled descents with an active set; ``"ipopt"``: IPOPT on the same problem, from one start after
        the other.
    progress
        Called with starts, minima, and what the search is at.
    found
        Called with energy and fold angles of each minimum as it is found.

    Returns
    -------
    MinimaResult
        The minima in order of energy, and the record of the search.

    Raises
    ------
    OptionError
        If an argument is not what it must be.
    KeyboardInterrupt
        If the user interrupts it, in a notebook as well; its attribute ``result`` holds what was found, a
        `MinimaResult`: ``except KeyboardInterrupt as stop: found =
        stop.result``, or afterwards at a prompt ``sys.last_value.result``.

    Examples
    --------
    >>> import origami_nlp as o
    >>> [(m.kind, round(m.energy, 6)) for m in o.find_minima(o.examples.degree6("pi/4", ratio=0.01)).minima]
    [('interior', 0.009086), ('contact-touching', 1.233701)]
    >>> len(o.find_minima("metasheet:2x3", effort="quick", escape=False).minima)
    5
    """
    until = check_until(seconds)
    from origami_nlp.pattern import as_origami
    from origami_nlp.pattern_states import find_states

    stated = as_origami(origami)
    return find_states(
        stated if contact is None else stated.with_contact(contact),
        seed=seed,
        effort=effort,
        options=options,
        max_starts=max_starts,
        # importing and reading took some of it
        seconds=None if seconds is None else max(until - time.monotonic(), 0.0),
        escape=escape,
        noise=noise,
        prove=prove,
        starts=starts,
        guesses=() if guesses is None else guesses,
        full=full,
        method=method,
        progress=progress,
        found=found,
    )


def classify(
    origami: State | Stated,
    fold_angles: Sequence[float] | np.ndarray | None = None,
    *,
    polished: bool = True,
) -> Classification:
    """Classify a state of a vertex or of a pattern: a minimum, with its certificate and contacts, or why it is not one.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it; or a `State` of either, which says where it is itself.
    fold_angles
        Of every crease, of a closed state, shape [n] [rad].
    polished
        Whether the state is exact to rounding.

    Returns
    -------
    Classification
        The verdict with its certificate, contacts with multipliers, and a direction of descent where there is one.

    Raises
    ------
    AngleError, OptionError
        If `fold_angles` are not one number a crease, or do not close.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_minima("metasheet:4x4", starts=2)
    >>> pinned = o.classify(found.pattern, found.minima[-1].fold_angles)
    >>> pinned.verdict, len(pinned.contacts), pinned.contacts[0].type
    ('minimum', 2, 'edge-edge')
    """
    from origami_nlp import kkt
    from origami_nlp.pattern import as_origami
    from origami_nlp.pattern_problem import pose

    if isinstance(origami, kkt.State):
        return kkt.classify(origami, polished=polished)
    problem = pose(as_origami(origami))
    many = len(problem.expand(np.zeros(problem.size)))
    angles = check_angles("fold_angles", fold_angles, many, one=True)
    state = kkt.State(problem, problem.reduce(angles))
    if not state.residual <= CLOSURE_TOL or np.abs(state.fold_angles - angles).max() > CLOSURE_TOL:
        raise OptionError(f"fold_angles do not close: residual {state.residual:.1e}")
    return kkt.classify(state, polished=polished)


def write_fold(result: MinimaResult, path: str | PathLike[str]) -> None:
    """Write the states of a vertex or pattern as a FOLD file (spec 1.1), a folded frame each.

    Parameters
    ----------
    result
        Of `find_minima`.
    path
        The file, written whole or not at all; ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If `result` is no result, `path` no path, or the file cannot be written.

    Examples
    --------
    >>> import json, pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "states.fold")
    >>> o.write_fold(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> [frame["frame_title"] for frame in json.loads(path.read_text())["file_frames"]]
    ['state 1: interior, 0.0090858 J, stable', 'state 2: contact-touching, 1.2337 J, stable']
    >>> o.write_fold(o.find_minima("miura:2x2", starts=1), path)
    >>> len(json.loads(path.read_text())["file_frames"]) > 0
    True
    """
    from origami_nlp.minima import MinimaResult
    from origami_nlp.pattern_problem import save_fold

    check_type("result", result, MinimaResult)
    check_path("path", path)
    save_fold(result.to_fold(), fspath(path))


def write_mesh(result: MinimaResult | LoadPath, path: str | PathLike[str]) -> None:
    """Write the states of a vertex or pattern side by side as one triangle mesh, by way of trimesh (extra ``mesh``).

    Parameters
    ----------
    result
        Of `find_minima`; or of `load_path`: where each of its legs begins and ends.
    path
        The file, ``.obj``, ``.stl`` or ``.glb``.

    Raises
    ------
    OptionError
        If `result` is no result, `path` no path or ends in something else, trimesh is not installed, there is no
        minimum, or the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "states.stl")
    >>> o.write_mesh(o.find_minima("miura:2x2", starts=1), path)
    >>> path.stat().st_size > 0
    True
    """
    from origami_nlp.minima import MinimaResult, write_parts
    from origami_nlp.paths import LoadPath

    if not isinstance(result, LoadPath):
        check_type("result", result, MinimaResult)
    check_path("path", path)
    write_parts(result.mesh_parts(), fspath(path))
