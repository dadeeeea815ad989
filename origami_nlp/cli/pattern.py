"""`origami-nlp pattern`: a whole crease pattern, its counts and freedoms, its stable states, how it folds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.sheets import Motion, Overview, SheetResult


def pattern(
    file: o.FoldFile,
    minima: Annotated[
        bool, typer.Option("--minima", help="Find its stable states, all vertices coupled.")
    ] = False,
    path: Annotated[
        bool, typer.Option("--path", help="Trace its folding motion up to the first contact.")
    ] = False,
    starts: Annotated[
        int, typer.Option("--starts", metavar="N", help="Random starts of --minima.")
    ] = 40,
    no_contact: Annotated[
        bool, typer.Option("--no-contact", help="With --minima: facets may cross.")
    ] = False,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    fold: o.StatesFold = None,
    mesh: o.StatesMesh = None,
    html: o.HtmlFile = None,
    frame: o.FrameNumber = None,
    stiffness: o.FoldStiffness = None,
    per_length: Annotated[
        bool,
        typer.Option("--per-length", help="Stiffness is per length [N/rad]: times the crease's."),
    ] = False,
    rest_angle: o.FoldRestAngle = None,
    rest_angles: o.FoldRestAngles = None,
) -> None:
    """Say what a crease pattern is, and with --minima or --path how it stands and folds as a sheet of rigid facets.

    Facets, creases, vertices, holes, freedoms, redundant equations, what is odd.  Files hold the states that were asked
    for, or without --minima and --path the folded state at which freedoms were counted.
    """
    from origami_nlp.arguments import check_whole
    from origami_nlp.minima import check_mesh
    from origami_nlp.sheets import find_motion, find_states, overview

    out = Output(json=json, figure=figure, fold=fold, mesh=mesh, html=html)
    if mesh:
        check_mesh(mesh)
    check_whole("--starts", starts, 0)
    sheet = _read(file, frame, stiffness, rest_angle, rest_angles, per_length)
    seen = overview(sheet, seed)
    seen.tell(out.console)
    motion = find_motion(sheet, seen, seed) if path else None
    if motion is not None:
        motion.tell(out.console)
    found = find_states(sheet, starts, seed, not no_contact) if minima else None
    if found is not None:
        found.tell(out.console)
    _Files(seen, motion, found).write(out)


def _read(
    file: str,
    frame: int | None,
    stiffness: float | None,
    rest_angle: float | None,
    rest_angles: Any,
    per_length: bool,
) -> Any:
    from origami_nlp.pattern import read_pattern

    options: dict[str, Any] = {"rest_angles": rest_angles}
    if stiffness is not None:
        if not 0 < stiffness < math.inf:
            raise OptionError(f"--stiffness = {stiffness:g} must be positive and finite")
        options["stiffness"] = stiffness
    if rest_angle is not None:
        options["rest_angle"] = math.radians(rest_angle)
    sheet = read_pattern(file, frame, **options)
    return sheet.with_springs(per_length=True) if per_length else sheet


class _Files:
    """What goes to the files of the command."""

    def __init__(self, seen: Overview, motion: Motion | None, found: SheetResult | None) -> None:
        self.seen, self.motion, self.found = seen, motion, found
        self.pattern = seen.pattern
        self.states: list[tuple[str, Any, tuple[str, ...], dict[str, Any]]] = []
        for k, s in enumerate(found.minima if found else (), start=1):
            more = {name: v for name, v in s.to_dict().items() if name != "fold_angles"}
            title = f"state {k}: {s.kind}, {s.energy:.6g} J"
            self.states.append((title, s.fold_angles, (s.certificate,), more))
        if found is None and motion is None:
            phi = seen.pattern.reference if seen.folded is None else seen.folded
            title = f"folded: {seen.start}" if seen.start else "as in the file"
            self.states.append((title, phi, (), {}))

    def write(self, out: Output) -> None:
        """Write them."""
        out.write("json", self._data)
        out.write("figure", self._figure)
        out.write("fold", self._fold)
        out.save("mesh", self._mesh)
        out.save("html", self._page)

    def _data(self) -> dict[str, Any]:
        data = self.seen.to_dict()
        if self.found is not None:
            more = {k: v for k, v in self.found.to_dict().items() if k != "schema"}
            data |= more
        if self.motion is not None:
            data["motion"] = self.motion.to_dict()
        return data

    def _figure(self) -> Any:
        from origami_nlp.sheets import draw_motion, draw_overview, draw_states

        if self.found is not None and self.states:
            shown = [(title, phi) for title, phi, _, _ in self.states]
            return draw_states(self.pattern, shown, self.pattern.name)
        return draw_motion(self.motion) if self.motion is not None else draw_overview(self.seen)

    def _fold(self) -> str:
        import json

        from origami_nlp.sheets import sheet_frame, sheet_to_fold

        frames = [
            sheet_frame(self.pattern, phi, title, **more) for title, phi, _, more in self.states
        ]
        if self.motion is not None:
            shown = self.motion.shown(60)
            frames += [
                sheet_frame(
                    self.pattern,
                    self.motion.phi[k],
                    f"folding motion, {number} of {len(shown)}",
                    energy=float(self.motion.energy[k]),
                    path="folding motion",
                )
                for number, k in enumerate(shown, start=1)
            ]
        data = sheet_to_fold(self.pattern, frames)
        return json.dumps(data, indent=1, allow_nan=False) + "\n"

    def _mesh(self, file: str) -> None:
        from origami_nlp.sheets import write_sheet_mesh

        states = [phi for _, phi, _, _ in self.states]
        if self.motion is not None:
            states += [self.motion.phi[k] for k in self.motion.shown(6)]
        write_sheet_mesh(self.pattern, states, file)

    def _page(self, file: str) -> None:
        from origami_nlp.sheets import sheet_content
        from origami_nlp.show import TurnedPage

        states = [(title, phi, lines) for title, phi, lines, _ in self.states]
        if not states and self.motion is not None:
            states = [(f"end: {self.motion.end}", self.motion.phi[-1], ())]
        told = [one for one in (self.found, self.motion, self.seen) if one is not None]
        pieces = [piece for one in told for piece in one.told()]
        TurnedPage(sheet_content(self.pattern, states, self.motion, pieces)).save(file)
