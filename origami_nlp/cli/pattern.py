"""`origami-nlp pattern`: a whole crease pattern, its counts and freedoms, its stable states, how it folds."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.loads import Creases, ForceOn, Held, PullOf, load_number, work_of
from origami_nlp.cli.output import Output
from origami_nlp.cli.source import spring_options
from origami_nlp.cli.timed import end_of
from origami_nlp.errors import Interrupted, OptionError

if TYPE_CHECKING:
    from origami_nlp.loading import LoadPath
    from origami_nlp.sheets import Motion, Overview, SheetResult


def pattern(
    file: o.PatternFile,
    minima: Annotated[
        bool, typer.Option("--minima", help="Find its stable states, all vertices coupled.")
    ] = False,
    path: Annotated[
        bool, typer.Option("--path", help="Trace its folding motion up to the first contact.")
    ] = False,
    load: Annotated[
        bool,
        typer.Option("--load", help="Load a stable state: name --crease, --pull or --force."),
    ] = False,
    crease: Creases = None,
    pull: PullOf = None,
    force: ForceOn = None,
    held: Held = 1,
    to: Annotated[
        str,
        typer.Option(
            metavar="LOAD|snap",
            help="With --load: torque [N m] or force [N] at which the path ends, from 0; snap: both ways to the first "
            "snap.",
        ),
    ] = "snap",
    state: Annotated[
        int,
        typer.Option(metavar="K", help="With --load: number of the stable state that is loaded."),
    ] = 1,
    back: Annotated[
        bool, typer.Option("--back", help="With --load: let the load fall back to 0.")
    ] = False,
    confirm: Annotated[
        bool, typer.Option(help="With --load: search for the states on both sides of each snap.")
    ] = True,
    starts: Annotated[
        int,
        typer.Option(
            "--starts",
            metavar="N",
            help="Random starts in a row that find nothing new, then --minima ends.",
        ),
    ] = 40,
    no_contact: Annotated[
        bool, typer.Option("--no-contact", help="With --minima: facets may cross.")
    ] = False,
    noise: o.Noise = None,
    seconds: Annotated[
        float,
        typer.Option(
            "--seconds", metavar="S", help="Wall time for the command with --minima or --load."
        ),
    ] = 300.0,
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
    """Say what a crease pattern is; with --minima, --path or --load how it stands, folds and snaps as a rigid sheet.

    Facets, creases, vertices, holes, freedoms, redundant equations, what is odd.  Files hold the states that were asked
    for, or without --minima, --path and --load the folded state at which freedoms were counted.
    """
    from origami_nlp.arguments import check_number, check_whole
    from origami_nlp.loading import load_path
    from origami_nlp.minima import check_mesh
    from origami_nlp.sheets import find_motion, find_states, overview

    until = time.monotonic() + seconds
    out = Output(json=json, figure=figure, fold=fold, mesh=mesh, html=html)
    if mesh:
        check_mesh(mesh)
    check_whole("--starts", starts, 0)
    check_number("--seconds", seconds, 0.0)
    given = [
        name for name, value in (("crease", crease), ("pull", pull), ("force", force)) if value
    ]
    if len(given) != load:
        raise OptionError(
            "--load needs one of --crease K, --pull V,W and --force V,X,Y,Z" if load else
            f"--{given[0]} says what --load is: give --load too"
        )  # fmt: skip
    if noise is not None and not minima:
        raise OptionError("--noise counts which stable states survive errors: give --minima too")
    sheet = _read(file, frame, stiffness, rest_angle, rest_angles, per_length)
    seen = overview(sheet, seed)
    seen.tell(out.console)
    motion = find_motion(sheet, seen, seed) if path else None
    if motion is not None:
        motion.tell(out.console)
    found: Any = None
    if minima:
        try:
            found = find_states(sheet, starts, seed, not no_contact, _left(until), noise=noise)
        except Interrupted as stopped:  # what was found is told and written all the same
            found = stopped.result
        found.tell(out.console)
    interrupted = found is not None and found.search.interrupted
    loaded = None
    if load and not interrupted:
        loaded = load_path(
            sheet,
            work_of(sheet, crease, pull, force, held),
            to=to if to == "snap" else load_number(to),
            state=_numbered(found, state),
            back=back,
            confirm=confirm,
            starts=starts,
            seed=seed,
            seconds=_left(until),
        )
        loaded.tell(out.console)
    _Files(seen, motion, found, loaded).write(out)
    if interrupted:
        raise KeyboardInterrupt
    if loaded is not None:
        end_of(loaded)


def _left(until: float) -> float:
    return max(until - time.monotonic(), 0.0)


def _read(
    file: str,
    frame: int | None,
    stiffness: float | None,
    rest_angle: str | None,
    rest_angles: str | None,
    per_length: bool,
) -> Any:
    from pathlib import Path

    from origami_nlp.pattern import examples, frame_pattern, parse_fold, read_pattern

    options = spring_options(stiffness=stiffness, rest_angle=rest_angle, rest_angles=rest_angles)
    named = file.partition(":")[0]
    if named in {*examples.BY_NAME, *examples.SHEETS} and not Path(file).exists():
        (drawn,) = parse_fold(
            json.dumps(examples.crease_pattern(file)), "first" if frame is None else frame
        )
        sheet = frame_pattern(drawn, **options)
    elif file != "-" and not Path(file).suffix and not Path(file).exists():
        known = ", ".join([*examples.BY_NAME, *examples.SHEETS])
        raise OptionError(f"PATTERN = {file!r} is no file, and no example: those are {known}")
    else:
        sheet = read_pattern(file, frame, **options)
    return sheet.with_springs(per_length=True) if per_length else sheet


def _numbered(found: SheetResult | None, state: int) -> Any:
    """Return the state of that number where states were found already, else the number."""
    from origami_nlp.arguments import check_whole

    check_whole("--state", state, 1)
    if found is None:
        return state
    if state > len(found.minima):
        raise OptionError(f"--state = {state}: {len(found.minima)} stable states were found")
    return found.minima[state - 1]


class _Files:
    """What goes to the files of the command."""

    def __init__(
        self,
        seen: Overview,
        motion: Motion | None,
        found: SheetResult | None,
        loaded: LoadPath | None,
    ) -> None:
        self.seen, self.motion, self.found, self.loaded = seen, motion, found, loaded
        self.pattern = seen.pattern
        self.states: list[tuple[str, Any, tuple[str, ...], dict[str, Any]]] = []
        for k, s in enumerate(found.minima if found else (), start=1):
            self.states.append((s.title(k), s.phi, s.lines(), s.frame_entries()))
        if found is None and motion is None and loaded is None:
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
        if self.loaded is not None:
            data["load"] = self.loaded.to_dict()
        return data

    def _figure(self) -> Any:
        found = self.found if self.states else None
        shown = next(x for x in (self.loaded, found, self.motion, self.seen) if x is not None)
        return shown.draw()

    def _fold(self) -> str:
        from origami_nlp.sheets import sheet_frame, sheet_to_fold

        frames = [
            sheet_frame(self.pattern, phi, title, **more) for title, phi, _, more in self.states
        ]
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
        for title, phi, more in self.loaded.states() if self.loaded else ():
            frames.append(sheet_frame(self.pattern, phi, title, path="load", **more))
        data = sheet_to_fold(self.pattern, frames)
        return json.dumps(data, indent=1, allow_nan=False) + "\n"

    def _mesh(self, file: str) -> None:
        import numpy as np

        from origami_nlp.minima import write_parts
        from origami_nlp.sheets import sheet_parts

        states = [phi for _, phi, _, _ in self.states]
        if self.motion is not None:
            states += [self.motion.fold_angles[k] for k in self.motion.shown(6)]
        for snap in self.loaded.snaps if self.loaded else ():
            states += [np.array(snap.before), np.array(snap.after)]
        if not states and self.loaded is not None:
            states = [np.array(leg.points[-1].fold_angles) for leg in self.loaded.legs]
        write_parts(sheet_parts(self.pattern, states), file)

    def _page(self, file: str) -> None:
        from origami_nlp.sheets import sheet_content
        from origami_nlp.show import TurnedPage

        states = [(title, phi, lines) for title, phi, lines, _ in self.states]
        if not states and self.motion is not None:
            states = [(f"end: {self.motion.end}", self.motion.fold_angles[-1], ())]
        told = [one for one in (self.found, self.motion, self.seen) if one is not None]
        pieces = [piece for one in told for piece in one.told()]
        contents = []
        if self.loaded is not None:
            under = f"{self.pattern.name}: under load"
            contents.append(replace(self.loaded.turned(), title=under))
        if states or self.motion is not None:
            contents.append(sheet_content(self.pattern, states, self.motion, pieces))
        TurnedPage(*contents).save(file)
