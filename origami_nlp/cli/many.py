"""Commands for many vertices, scenes and creases: `pattern`, `follow`, `boundary` and `sweep`."""

from __future__ import annotations

from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.arguments import require
from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, answers, writes
from origami_nlp.cli.progress import progress
from origami_nlp.cli.source import Source, note_normalized, takes_scene
from origami_nlp.cli.timed import ENDED
from origami_nlp.errors import SweepError

if TYPE_CHECKING:
    from origami_nlp.pattern_states import Mobility, Motion


@takes_scene(o.PatternFile, whole=True)
@writes("json", "figure", "html", "fold", "mesh")
def pattern(
    out: Output,
    scene: Source,
    path: Annotated[
        bool, typer.Option("--path", help="Trace its folding motion up to the first contact.")
    ] = False,
    seed: o.Seed = 0,
    verbose: o.Verbose = False,
) -> None:
    """Analyze the mobility of a crease pattern; with --path trace its folding motion as a rigid sheet.

    Facets, creases, vertices, holes, degrees of freedom, redundant equations, defects of the file.  Files hold the
    folding motion, or without --path the folded state at which the degrees of freedom were counted.  Its stable
    states: minima; under a load: load.
    """
    from origami_nlp.pattern_states import analyze_mobility, find_motion

    sheet = scene.read_pattern()
    seen = analyze_mobility(sheet, seed=seed)
    seen.print_to(out.console, verbose)
    motion = find_motion(sheet, seen, seed=seed) if path else None
    if motion is not None:
        motion.print_to(out.console, verbose)
    _Files(seen, motion).write(out)


class _Files:
    """What goes to the files of the command."""

    def __init__(self, seen: Mobility, motion: Motion | None) -> None:
        self.seen, self.motion, self.pattern = seen, motion, seen.pattern
        phi = self.pattern.reference if seen.folded is None else seen.folded
        title = f"folded: {seen.start}" if seen.start else "as in the file"
        self.states = [] if motion is not None else [(title, phi)]

    def write(self, out: Output) -> None:
        """Write them."""
        out.write("json", self._data)
        out.write("figure", (self.motion or self.seen).draw)
        out.save("fold", self._fold)
        out.save("mesh", self._mesh)
        out.save("html", self._page)

    def _data(self) -> dict[str, Any]:
        data = self.seen.to_dict()
        return data if self.motion is None else {**data, "motion": self.motion.to_dict()}

    def _fold(self, file: str) -> None:
        from origami_nlp.folding import path_frames, save_fold
        from origami_nlp.pattern_problem import pattern_frame, pattern_to_fold

        frame = partial(pattern_frame, self.pattern)
        frames = [frame(phi, title) for title, phi in self.states]
        if self.motion is not None:
            path = self.motion.fold_angles, self.motion.energy
            frames = path_frames(frame, *path, "folding motion")
        save_fold(pattern_to_fold(self.pattern, frames), file)

    def _mesh(self, file: str) -> None:
        from origami_nlp.minima import write_parts
        from origami_nlp.pattern_problem import pattern_parts

        states = [phi for _, phi in self.states]
        if self.motion is not None:
            states += [self.motion.fold_angles[k] for k in self.motion.shown(6)]
        write_parts(pattern_parts(self.pattern, states), file)

    def _page(self, file: str) -> None:
        from origami_nlp.display import InteractivePage
        from origami_nlp.pattern_states import pattern_content

        states: list[Any] = [(title, phi, ()) for title, phi in self.states]
        if self.motion is not None:
            states = [(f"end: {self.motion.end}", self.motion.fold_angles[-1], ())]
        reported = [one for one in (self.motion, self.seen) if one is not None]
        pieces = [piece for one in reported for piece in one.report_sections()]
        InteractivePage(pattern_content(self.pattern, states, self.motion, pieces)).save(file)


@takes_scene(o.OrigamiFile, whole=True)
@answers(
    "json",
    "csv",
    "figure",
    "html",
    "fold",
    search=("full", "effort", "seed", "seconds"),
    details=True,
)
def follow(
    scene: Source,
    parameter: o.ParameterRange,
    checks: Annotated[
        int,
        typer.Option(metavar="N", help="Searches: both ends, the middle, then the widest gaps."),
    ] = 3,
    prove: o.ProveChecks = None,
    starts: o.Starts = None,
    **search: Any,
) -> Any:
    """Follow the states of ORIGAMI over a parameter, and locate where they appear, change and vanish."""
    from origami_nlp.bifurcation import follow as follow_states

    # options of an example by name are among what it can be followed over
    named = scene.is_example and not scene.given
    with progress(f"{scene.name} over {parameter}") as report:
        return follow_states(
            scene.name if named else scene.read_whole(),
            parameter,
            checks=checks,
            prove=o.wanted_proof(prove),
            starts=starts,
            progress=lambda text: report(text=text),
            **search,
        )


@takes_scene(o.SceneFile, springs=False)
@answers("json", "csv", "figure", search=("effort", "seed", "seconds"))
def boundary(
    scene: Source,
    event: Annotated[
        str,
        typer.Option(
            metavar="NAME=FROM:TO",
            help="The parameter in whose range events are looked for; NAME=VALUE for those nearby.",
        ),
    ],
    parameter: o.ParameterRange,
    lines: Annotated[
        int, typer.Option(metavar="N", help="Values of the second at which the first is followed.")
    ] = 3,
    **search: Any,
) -> Any:
    """Draw where states of SCENE appear, change and vanish over two parameters, as exact curves."""
    from origami_nlp.bifurcation import find_bifurcation_set

    return find_bifurcation_set(scene.read(), event, parameter, lines=lines, **search)


@writes("figure")
def sweep(
    out: Output,
    spec: o.SweepFile,
    folder: Annotated[Path, o.OutFolder],
    workers: o.WorkersWanted = None,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run on an existing Dask cluster (extra sweep)."),
    ] = None,
    seconds: o.Seconds = None,
) -> None:
    """Find the minima of every scene, or pattern, of SWEEP; run it again to go on after an interruption."""
    from origami_nlp.io import make_folder
    from origami_nlp.sweep import draw_sweep, read_sweep, run_sweep

    stated = read_sweep(spec)
    if change := getattr(stated, "normalized", 0.0):
        note_normalized(change, ", at most")
    with _executor(dask) as executor, progress(Path(spec).name, stated.count) as report:
        make_folder(folder, "--folder")
        done = run_sweep(
            stated,
            folder,
            executor=executor,
            workers=workers,
            seconds=seconds,
            progress=lambda done, total, states: report(done, total, f"{states} states"),
        )
    counts = ", ".join(f"{n:,} {status}" for status, n in sorted(done.counts.items())) or "none"
    out.say(f"{stated.count:,} scenes: {counts}; {done.ran:,} run now in {done.seconds:.1f} s")
    if done.interrupted:
        late = seconds is not None and done.seconds >= seconds
        by = " by the time limit" if late else ""
        out.say(f"interrupted{by}: the same command goes on from here")
        raise typer.Exit(ENDED if late else 130)
    failed = done.counts.get("failed")
    if failed:
        out.say("failed scenes are tried again by the same command; reasons are in the store")
    out.written(folder)
    out.write("figure", draw_sweep, folder)
    if failed:
        raise typer.Exit(1)


@contextmanager
def _executor(address: str | None):  # type: ignore[no-untyped-def]
    """The executor of a Dask cluster, or None for processes."""
    if address is None:
        yield None
        return
    distributed = require("distributed", "--dask", "sweep", SweepError)
    try:
        distributed.comm.get_address_host_port(address)  # a client without an address raises again
        client: Any = distributed.Client(address, timeout=10, set_as_default=False)
    except (OSError, ValueError) as error:
        raise SweepError(
            f"--dask {address!r} cannot be reached: {str(error).splitlines()[0]}"
        ) from None
    try:
        pool = client.get_executor()
        pool.num_workers = sum(client.nthreads().values())
        yield pool
    finally:
        client.close()
