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
    from origami_nlp.pattern import Scene

    terminal = screen("-").is_terminal
    label = origami.name
    if isinstance(origami, Scene):
        _tell_of_compiler(terminal)
        label = origami.label
    return _searched(origami, label or str(name), terminal, **options)


def _tell_of_compiler(terminal: bool) -> None:
    """Say, once a command, what is compiled for vertices, or that nothing is."""
    from origami_nlp.minima import compiled

    if compiled(_note if terminal else lambda line: None) is None:
        _note(NO_COMPILER)


def _searched(origami: Scene | Pattern, label: str, terminal: bool, **options: Any) -> Any:
    from origami_nlp.verbs import find_minima

    with progress(label) as show:
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
    from origami_nlp.io import screen
    from origami_nlp.pattern import examples

    results, terminal = list[Any](), screen("-").is_terminal
    _tell_of_compiler(terminal)
    scenes = examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            results.append(_searched(scene, scene.label, terminal, seed=seed, full=full))
            done(len(results))
    return results
