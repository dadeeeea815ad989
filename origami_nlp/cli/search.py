"""The search for minima, shown while it runs: of one scene, or of the paper's panels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from origami_nlp.cli.progress import progress
from origami_nlp.pattern import Scene, examples

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult


def search(scene: Scene, name: str | None, **options: Any) -> MinimaResult:
    """Find the minima of `scene`, and tell starts, minima and expected undiscovered ones (on stderr).

    name: of a scene without a label.  options: of `find_minima`.
    """
    from origami_nlp.minima import find_minima

    with progress(scene.label or str(name)) as tell:

        def report(starts: int, found: int, missing: float) -> None:
            shown = "-" if math.isinf(missing) else f"{missing:.2f}"
            tell(text=f"{starts} starts, {found} minima, expected undiscovered {shown}")

        return find_minima(scene, progress=report, **options)


def search_panels(seed: int, full: bool = False) -> list[MinimaResult]:
    """Find the minima of all 18 panels of the paper's two landscape figures."""
    results: list[MinimaResult] = []
    scenes = examples.panels()
    with progress("panels", len(scenes)) as done:
        for scene in scenes:
            results.append(search(scene, None, seed=seed, full=full))
            done(len(results))
    return results
