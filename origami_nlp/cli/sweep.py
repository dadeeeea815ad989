"""`origami-nlp sweep`: many scenes, on processes or a cluster, stored as they finish."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.timed import ENDED
from origami_nlp.errors import SweepError


def sweep(
    spec: o.SweepFile,
    out: Annotated[Path, o.OutFolder],
    workers: o.WorkersWanted = None,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run on an existing Dask cluster (extra sweep)."),
    ] = None,
    seconds: o.Seconds = None,
    figure: o.FigureFile = None,
) -> None:
    """Find the minima of every scene, or pattern, of SWEEP; run it again to go on after an interruption."""
    from origami_nlp.files import make_folder
    from origami_nlp.sweep import draw_sweep, read_sweep, run_sweep

    output = Output(figure=figure)
    stated = read_sweep(spec)
    make_folder(out, "--out")
    with _executor(dask) as executor, progress(Path(spec).name, stated.count) as report:
        done = run_sweep(
            stated,
            out,
            executor=executor,
            workers=workers,
            seconds=seconds,
            progress=lambda done, total, states: report(done, total, f"{states} states"),
        )
    counts = ", ".join(f"{n:,} {status}" for status, n in sorted(done.counts.items())) or "none"
    output.say(f"{stated.count:,} scenes: {counts}; {done.ran:,} run now in {done.seconds:.1f} s")
    if done.interrupted:
        late = seconds is not None and done.seconds >= seconds
        by = " by the time limit" if late else ""
        output.say(f"interrupted{by}: the same command goes on from here")
        raise typer.Exit(ENDED if late else 130)
    failed = done.counts.get("failed")
    if failed:
        output.say("failed scenes are tried again by the same command; reasons are in the store")
    output.written(out)
    output.write("figure", draw_sweep, out)
    if failed:
        raise typer.Exit(1)


@contextmanager
def _executor(address: str | None):  # type: ignore[no-untyped-def]
    """The executor of a Dask cluster, or None for processes."""
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise SweepError('--dask needs dask: pip install "origami_nlp[sweep]"') from None
    try:
        client: Any = Client(address, timeout=10, set_as_default=False)
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
