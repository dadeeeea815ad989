"""The search for minima, shown while it runs: of a vertex or a pattern, or of the paper's panels."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from origami_nlp.cli.progress import progress
from origami_nlp.cli.timed import keep, paused

if TYPE_CHECKING:
    from origami_nlp.pattern import Pattern, Scene


NO_COMPILER = (
    "no C compiler was found, or none is wanted: IPOPT searches, some hundred times slower, and escapes of vertices "
    "are not sought; install cc, gcc or clang, or name one by CC"
)


def search(origami: Scene | Pattern, name: str | None, **options: Any) -> Any:
    """Find the minima of a vertex or a pattern, and report starts and minima (on stderr).

    name: of what has no label.  options: of `find_minima`; what is None is left to it.
    """
    from origami_nlp.io import screen
    from origami_nlp.minima import compiled
    from origami_nlp.pattern import Scene
    from origami_nlp.verbs import find_minima

    vertex = isinstance(origami, Scene)
    terminal = screen("-").is_terminal
    if vertex and compiled(_note if terminal else lambda line: None) is None:
        _note(NO_COMPILER)
    label = origami.label if isinstance(origami, Scene) else origami.name
    with progress(label or str(name)) as show:
        energies: list[float] = []

        def report(starts: int, found: int, at: int | str) -> None:
            listed = ", ".join(f"{energy:.4g}" for energy in sorted(energies))
            shown = f" (energies {listed})" if energies and terminal else ""
            at = at if isinstance(at, str) else f"{at} of them reached once"
            show(text=f"{starts} starts, {found} minima{shown}, {at}")

        given = {option: value for option, value in options.items() if value is not None}
        given["progress"] = report
        given["found"] = lambda energy, _: energies.append(energy)
        with paused() as left:
            if left is not None:
                given["seconds"] = left
            result: Any = find_minima(origami, **given)
            keep(result)
        return result


def _note(line: str) -> None:
    print(f"note: {line}", file=sys.stderr)


def search_panels(seed: int, full: bool = False) -> list[Any]:
    """Find the minima of all 18 panels of the paper's two landscape figures."""
    from origami_nlp.pattern import examples

    results: list[Any] = []
    scenes = examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            results.append(search(scene, None, seed=seed, full=full))
            done(len(results))
    return results
