"""The search for minima, shown while it runs: of one scene, or of the paper's panels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from origami_nlp.cli.progress import progress
from origami_nlp.cli.timed import keep, paused
from origami_nlp.pattern import Scene, examples

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult


def search(scene: Scene, name: str | None, **options: Any) -> MinimaResult:
    """Find the minima of `scene`, and tell starts and minima (on stderr).

    name: of a scene without a label.  options: of `find_minima`.
    """
    from origami_nlp.minima import find_minima

    with progress(scene.label or str(name)) as tell:

        def report(starts: int, found: int, once: int) -> None:
            tell(text=f"{starts} starts, {found} minima, {once} of them reached once")

        with paused() as left:
            if left is not None:
                options["seconds"] = left
            given = {name: value for name, value in options.items() if value is not None}
            result = find_minima(scene, progress=report, **given)
            keep(result)
        return result


def search_panels(seed: int, full: bool = False) -> list[MinimaResult]:
    """Find the minima of all 18 panels of the paper's two landscape figures."""
    results: list[MinimaResult] = []
    scenes = examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            results.append(search(scene, None, seed=seed, full=full))
            done(len(results))
    return results
