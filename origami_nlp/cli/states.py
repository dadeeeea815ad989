"""Commands that find states and say more of them; of each one function: read, one verb, and what is returned is
printed and written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_whole, require
from origami_nlp.cli import options as o
from origami_nlp.cli.exits import Ended
from origami_nlp.cli.group import writes
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress
from origami_nlp.cli.source import Source, note, note_normalized
from origami_nlp.cli.timed import Clock
from origami_nlp.errors import OptionError, SweepError

NO_COMPILER = (
    "no C compiler was found, or none is wanted: IPOPT searches, some hundred times slower, and escapes of vertices "
    "are not sought; install cc, gcc or clang, or name one by CC"
)


def search(clock: Clock, origami: Any, name: str, last: bool = False, **options: Any) -> Any:
    """Find the minima of a vertex or a pattern, and report starts and minima (on stderr).

    name: of what has no label.  last: whether the command has nothing more to find.  options: of `find_minima`.
    """
    from origami_nlp.io import screen
    from origami_nlp.search import compile_descents
    from origami_nlp.verbs import find_minima

    aloud = note if screen("-").is_terminal else lambda line: None
    if not compile_descents(aloud):
        note(NO_COMPILER)
    with progress(getattr(origami, "label", origami.name) or name) as show:

        def report(starts: int, found: int, at: int | str) -> None:
            at = at if isinstance(at, str) else f"{at} of them reached once"
            show(text=f"{starts} starts, {found} minima, {at}")

        return clock.within(find_minima, origami, last=last, progress=report, **options)


@writes("json", "csv", "figure", "html", "fold", "mesh", verbose=True)
def minima(
    origami: Source,
    out: Output,
    clock: Clock,
    seed: int = o.SEED,
    effort: str = o.EFFORT,
    max_starts: int | None = o.MAX_STARTS,
    starts: int | None = o.STARTS,
    method: str = o.METHOD,
    full: bool | None = o.FULL,
    noise: float | None = o.NOISE,
    prove: bool | None = o.PROVE,
    certificate: str | None = o.CERTIFICATE,
) -> Any:
    """Find the energy minima of ORIGAMI, a vertex or a pattern: its stable states.

    Of a scene they are those with its symmetry; whether they are stable without it is judged where that is cheap, or
    as --full and --no-full say.  A FOLD file or an example is
    a pattern with all its vertices coupled; --vertex takes one of them.
    """
    from origami_nlp import proof

    out.check(("--certificate", certificate))
    stated: Any = origami.read_whole()
    if certificate is not None and origami.is_whole:  # before anything is searched for
        stated.check_plain_hinges("--certificate")
        known = "" if origami.contact == "fold-limits" else "it needs --contact fold-limits"
        if why := proof.why_no_sheet(stated) or known:
            raise OptionError(f"--certificate: the list of a pattern is not proved: {why}")
    options: Any = {"max_starts": max_starts, "starts": starts, "full": full, "noise": noise}
    options |= {"method": method, "seed": seed, "effort": effort}
    # a certificate asks for a proof
    options["prove"] = True if prove is None and certificate is not None else prove
    found = search(clock, stated, origami.name, last=True, **options)
    if certificate is None:
        return found
    out.report(found)
    if (told := found.completeness) is None or not told.boxes:
        why = told.reason if told else "it was not asked for (--prove)"
        raise OptionError(f"--certificate: there is no proof to write: {why}")
    proof.write_certificate(proof.certify(found.origami, told.boxes), certificate)
    out.written(certificate)
    return Ended.DONE


@writes("json")
def check_proof(out: Output, proof: str = o.PROOF) -> int:
    """Check the proof of a list of minima: a second program, with shared lemmas, finds the list again.

    Exit code 1 if a state is not found again, or another one is: the first one is named.
    """
    from origami_nlp.proof import check_proof as check

    found = check(proof)
    out.say(*found.lines)
    out.write("json", found.to_dict)
    return Ended.NO if found.refused else Ended.DONE


@writes("json", "html", verbose=True)
def contacts(
    origami: Source,
    clock: Clock,
    state: int | None = o.STATE,
    segments: bool = o.SEGMENTS,
    seed: int = o.SEED,
    effort: str = o.EFFORT,
) -> Any:
    """Report contact moments, stiffness along the contact and load margin of ORIGAMI's pinned states."""
    from origami_nlp.contact import find_contacts

    stated = origami.read_whole()
    found = search(clock, stated, origami.name, escape=False, seed=seed, effort=effort)
    return find_contacts(found, state=state, segments=segments)


@writes("json", "csv", "figure", "html", "fold", verbose=True)
def barriers(origami: Source, clock: Clock, seed: int = o.SEED) -> Any:
    """Find the lowest pass between every two minima of ORIGAMI, and a path through it.

    Along traced curves; with two or more degrees of freedom along descents and straight paths, as upper bounds, exact
    where the flat state parts two minima of a vertex.
    """
    from origami_nlp.barriers import find_barriers

    stated = origami.read_whole()
    with progress(f"{origami.name}: barriers") as report:
        return clock.within(find_barriers, stated, seed=seed, progress=report.at)


@writes("json", "figure", "html", verbose=True)
def landscape(
    origami: Source,
    clock: Clock,
    size: int = o.SIZE,
    space: bool = o.SPACE,
    critical: bool = o.CRITICAL,
    seed: int = o.SEED,
) -> Any:
    """Map the energy landscape of a vertex: exact boundaries, and minima; or its space, or critical points."""
    from origami_nlp import paper
    from origami_nlp.chart import chart_of, landscape as coordinates

    stated = origami.read()
    name = stated.label or origami.name
    if critical or space:
        with progress(f"{name}: critical points" if critical else f"{name}: mesh, walls, layers"):
            return (paper.find_critical_points if critical else paper.find_space)(stated)
    check_whole("--size", size, 16, 4097)
    if chart_of(stated) is None:
        why = coordinates(stated, 8).reason or "one degree of freedom: minima -o FILE.png draws it"
        raise OptionError(f"scene has no landscape over two coordinates: {why}")
    result = search(clock, stated, origami.name, seed=seed, full=True, escape=False)
    with progress(f"{name}: boundary"):
        return paper.find_landscape(result, size=size)


@writes("json", "csv", "scene", "fold", "figure", verbose=True)
def design(
    out: Output, targets: str = o.TARGETS, seed: int = o.SEED, effort: str = o.EFFORT
) -> int:
    """Find the springs that hold the states of TARGETS, with the largest margin, and look for its minima.

    Fold angles of the states may be measured: the nearest states that close are taken, and how far they moved is said.
    -o writes a vertex with its springs as .toml, a pattern as .fold.  Exit code 0: a design that does all that is
    asked.  1: proved that no springs do.  3: neither; the last lines say why.
    """
    from origami_nlp.inverse_design import design as find, read_targets
    from origami_nlp.pattern import Pattern, Scene, format_scene
    from origami_nlp.pattern_problem import states_to_fold

    question = read_targets(targets)
    if isinstance(question.origami, Scene):
        note_normalized(question.origami.vertex.normalized)
        out.refuse("a vertex is written as a scene: end the name in .toml", "fold")
    else:
        out.refuse("a pattern is written as FOLD: end the name in .fold", "scene")
    answer = find(question, seed=seed, effort=effort)
    out.say(answer)
    out.write("json", answer.to_dict)
    out.write("csv", answer.to_csv)
    if (made := answer.scene) is not None:
        if isinstance(made, Pattern):
            out.write("fold", states_to_fold, made, [])
        else:
            out.write("scene", format_scene, made)
        out.write("figure", answer.draw)
    return Ended.DONE if answer.verified else Ended.NO if answer.refuted else Ended.OPEN


@writes("csv")
def sweep(
    out: Output,
    clock: Clock,
    spec: str = o.SWEEP,
    folder: Path = o.FOLDER,
    workers: int | None = o.WORKERS,
    dask: str | None = o.DASK,
) -> int | None:
    """Find the minima of every scene, or pattern, of SWEEP; run it again to go on after an interruption."""
    from origami_nlp.io import make_folder
    from origami_nlp.sweep import load_states, read_sweep, run_sweep

    stated = read_sweep(spec)
    note_normalized(stated.normalized, ", at most")
    executor = _executor(dask) if dask else None
    with progress(Path(spec).name, stated.count) as report:
        make_folder(folder, "--folder")
        say = lambda done, total, states: report(done, total, f"{states} states")  # noqa: E731
        options: Any = {"executor": executor, "workers": workers, "progress": say}
        done = clock.within(run_sweep, stated, folder, **options)
        clock.found = None  # its words follow
    counts = ", ".join(f"{n:,} {status}" for status, n in sorted(done.counts.items())) or "none"
    out.say(f"{stated.count:,} scenes: {counts}; {done.ran:,} run now")
    if done.interrupted:
        clock.late = clock.over
        by = " by the time limit" if clock.over else ""
        out.say(f"interrupted{by}: the same command goes on from here")
        return Ended.OUT_OF_TIME if clock.over else Ended.INTERRUPTED
    if failed := done.counts.get("failed"):
        out.say("failed scenes are tried again by the same command; reasons are in the store")
    out.written(folder)
    out.write("csv", lambda: load_states(folder).to_csv(index=False))
    return Ended.NO if failed else Ended.DONE


def _executor(address: str) -> Any:
    """Return the executor of a Dask cluster."""
    distributed = require("distributed", "--dask", "sweep", SweepError)
    try:
        client: Any = distributed.Client(address, timeout=10, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise SweepError(f"--dask {address!r} cannot be reached: {error}") from None
    pool = client.get_executor()
    pool.num_workers = max(sum(client.nthreads().values()), 1)
    return pool
