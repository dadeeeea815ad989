"""`origami-nlp pattern`: what a whole crease pattern is, its counts and freedoms, and how it folds."""

from __future__ import annotations

import json as js
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import Source, takes_scene

if TYPE_CHECKING:
    from origami_nlp.sheets import Motion, Overview


@takes_scene(o.PatternFile, whole=True)
def pattern(
    scene: Source,
    path: Annotated[
        bool, typer.Option("--path", help="Trace its folding motion up to the first contact.")
    ] = False,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    fold: o.StatesFold = None,
    mesh: o.StatesMesh = None,
    html: o.HtmlFile = None,
) -> None:
    """Say what a crease pattern is; with --path how it folds as a rigid sheet.

    Facets, creases, vertices, holes, freedoms, redundant equations, what is odd.  Files hold the folding motion, or
    without --path the folded state at which freedoms were counted.  Its stable states: minima; under a load: load.
    """
    from origami_nlp.minima import check_mesh
    from origami_nlp.sheets import find_motion, overview

    out = Output(json=json, figure=figure, fold=fold, mesh=mesh, html=html)
    if mesh:
        check_mesh(mesh)
    sheet = scene.read_pattern()
    seen = overview(sheet, seed)
    seen.tell(out.console)
    motion = find_motion(sheet, seen, seed) if path else None
    if motion is not None:
        motion.tell(out.console)
    _Files(seen, motion).write(out)


class _Files:
    """What goes to the files of the command."""

    def __init__(self, seen: Overview, motion: Motion | None) -> None:
        self.seen, self.motion, self.pattern = seen, motion, seen.pattern
        phi = self.pattern.reference if seen.folded is None else seen.folded
        title = f"folded: {seen.start}" if seen.start else "as in the file"
        self.states = [] if motion is not None else [(title, phi)]

    def write(self, out: Output) -> None:
        """Write them."""
        out.write("json", self._data)
        out.write("figure", (self.motion or self.seen).draw)
        out.write("fold", self._fold)
        out.save("mesh", self._mesh)
        out.save("html", self._page)

    def _data(self) -> dict[str, Any]:
        data = self.seen.to_dict()
        return data if self.motion is None else {**data, "motion": self.motion.to_dict()}

    def _fold(self) -> str:
        from origami_nlp.facets import sheet_frame, sheet_to_fold

        frames = [sheet_frame(self.pattern, phi, title) for title, phi in self.states]
        if self.motion is not None:
            shown = self.motion.shown(60)
            frames += [
                sheet_frame(
                    self.pattern,
                    self.motion.fold_angles[k],
                    f"folding motion, {number} of {len(shown)}",
                    energy=float(self.motion.energy[k]),
                    path="folding motion",
                )
                for number, k in enumerate(shown, start=1)
            ]
        data = sheet_to_fold(self.pattern, frames)
        return js.dumps(data, indent=1, allow_nan=False) + "\n"

    def _mesh(self, file: str) -> None:
        from origami_nlp.facets import sheet_parts
        from origami_nlp.minima import write_parts

        states = [phi for _, phi in self.states]
        if self.motion is not None:
            states += [self.motion.fold_angles[k] for k in self.motion.shown(6)]
        write_parts(sheet_parts(self.pattern, states), file)

    def _page(self, file: str) -> None:
        from origami_nlp.sheets import sheet_content
        from origami_nlp.show import TurnedPage

        states: list[Any] = [(title, phi, ()) for title, phi in self.states]
        if self.motion is not None:
            states = [(f"end: {self.motion.end}", self.motion.fold_angles[-1], ())]
        told = [one for one in (self.motion, self.seen) if one is not None]
        pieces = [piece for one in told for piece in one.told()]
        TurnedPage(sheet_content(self.pattern, states, self.motion, pieces)).save(file)
