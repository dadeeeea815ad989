"""Commands that find the states of a scene: `minima`, `check-proof` and `landscape`."""

from __future__ import annotations

import io
import time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output, writes
from origami_nlp.cli.progress import progress
from origami_nlp.cli.search import search
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.cli.timed import bounded
from origami_nlp.errors import Interrupted, OptionError

if TYPE_CHECKING:
    from origami_nlp.landscape import ExactLandscape
    from origami_nlp.minima import MinimaResult
    from origami_nlp.pattern import Pattern


@takes_scene(o.OrigamiFile, whole=True)
@writes("json", "csv", "figure", "html", "fold", "mesh")
def minima(
    out: Output,
    scene: Source,
    seed: o.Seed = 0,
    effort: o.Effort = "normal",
    max_starts: o.MaxStarts = None,
    starts: o.Starts = None,
    workers: o.Workers = None,
    method: o.Method = "batch",
    seconds: o.Seconds = None,
    full: o.FullOrNot = None,
    noise: o.Noise = None,
    prove: o.Prove = None,
    certificate: o.CertificateFile = None,
    verbose: o.Verbose = False,
) -> None:
    """Find the energy minima of ORIGAMI, a vertex or a pattern: its stable states.

    Of a scene they are those with its symmetry; whether they are stable without it is judged where that is cheap, or
    as --full and --no-full say.  A FOLD file or an example is
    a pattern with all its vertices coupled; --vertex takes one of them.
    """
    from origami_nlp.pattern import Scene
    from origami_nlp.results import draw
    from origami_nlp.verbs import write_fold, write_mesh

    begun = time.monotonic()
    out.check(("--certificate", certificate))
    options: dict[str, Any] = {
        "seed": seed,
        "effort": effort,
        "max_starts": max_starts,
        "starts": starts,
        "workers": workers,
        "method": method,
        "seconds": seconds,
        "full": full,
        "noise": noise,
        # a certificate asks for a proof
        "prove": o.wanted_proof(prove) if prove or certificate is None else True,
    }
    stated = scene.read_whole(contact=True)
    if seconds is not None:  # the limit is the command's: reading a large sheet takes of it
        options["seconds"] = max(seconds - (time.monotonic() - begun), 0.0)
    if not isinstance(stated, Scene):
        options["contact"] = scene.whole_contact
        if certificate is not None:
            _check_provable(stated, certificate, scene.whole_contact or "full")
    stopped = False
    try:
        result = search(stated, scene.name, **options)
    except Interrupted as early:  # what was found is reported and written all the same
        result, stopped = early.result, True
    result.print_to(out.console, verbose)
    out.write("json", result.to_dict)
    out.write("csv", result.to_csv)
    out.save("figure", draw, result)
    out.save("fold", write_fold, result)
    out.save("mesh", write_mesh, result)
    if certificate is not None:
        _write_certificate(result, certificate)
        out.written(certificate)
    out.turn(result)
    if stopped:
        raise KeyboardInterrupt


def _check_provable(pattern: Pattern, file: str, contact: str) -> None:
    """Refuse a certificate that cannot be, before anything is searched for."""
    from origami_nlp.proof import why_no_mesh, why_no_quad_mesh

    pattern.check_plain_hinges("--certificate")
    flat, other = why_no_mesh(pattern), why_no_quad_mesh(pattern)
    if flat and other:
        raise OptionError(
            f"--certificate = {file!r}: the list of a pattern is proved of meshes "
            f"whose vertices fold flat ({flat}), and of those of which none does ({other})"
        )
    if contact == "full":
        raise OptionError(
            "--certificate: the check knows meshes within fold limits; it is written for --contact fold-limits"
        )


def _write_certificate(result: MinimaResult, file: str) -> None:
    """Prove again, and write down what is proved."""
    from origami_nlp.proof import certificate_of_scene, write_certificate

    found = result.completeness
    if found is None or not found.boxes:
        why = found.reason if found else "it was not asked for (--prove)"
        raise OptionError(f"--certificate: there is no proof to write: {why}")
    if result.is_pattern:
        _write_pattern_certificate(result, found.boxes, file)
        return
    write_certificate(certificate_of_scene(result.scene, found.boxes), file)


def _write_pattern_certificate(result: MinimaResult, boxes: int, file: str) -> None:
    from origami_nlp.proof import (
        certificate_of_mesh,
        prove_mesh,
        prove_quad_mesh,
        why_no_quad_mesh,
        write_certificate,
    )

    generic = not why_no_quad_mesh(result.pattern)
    mesh = (prove_quad_mesh if generic else prove_mesh)(result.pattern, boxes=boxes)
    write_certificate(certificate_of_mesh(result.pattern, mesh, generic=generic), file)


@writes("json")
def check_proof(out: Output, proof: o.ProofFile) -> None:
    """Check a proof that the list of minima of a mesh is complete, claim by claim, in ball arithmetic.

    Exit code 1 if a claim is not confirmed: the first one is named.
    """
    from origami_nlp.proof import (
        MeshCertificate,
        check_proof as check,
        read_certificate,
    )

    certificate = read_certificate(proof)
    size = len(certificate.minima) if isinstance(certificate, MeshCertificate) else 0
    with progress(f"check of {proof}", size) as report:
        found = check(certificate, lambda done, total: report(done, total))
    out.say("\n".join(found.lines))
    out.write("json", found.to_dict)
    if found.refused:
        raise typer.Exit(1)


SMALLEST, LARGEST = 16, 4097


@bounded
@takes_scene(o.SceneFile, springs=False)
@writes("json", "figure", "html", "npz")
def landscape(
    out: Output,
    scene: Source,
    size: o.Size = 401,
    passes: Annotated[
        bool, typer.Option("--passes", help="Find the passes between minima and draw the paths.")
    ] = False,
    seed: o.Seed = 0,
) -> None:
    """Map the energy landscape of SCENE: exact boundaries, minima, space, critical points and passes."""
    from origami_nlp.barriers import find_barriers
    from origami_nlp.chart import chart_of, landscape as coordinates
    from origami_nlp.critical import find_critical_points
    from origami_nlp.display import InteractivePage
    from origami_nlp.landscape import draw_landscape, find_landscape, landscape_to_dict
    from origami_nlp.space import find_space

    stated = scene.read()
    if not SMALLEST <= size <= LARGEST:
        raise OptionError(f"--size = {size} must lie between {SMALLEST} and {LARGEST}")
    if chart_of(stated) is None:
        why = (
            coordinates(stated, 8).reason
            or "it has one symmetric degree of freedom only; origami-nlp minima -o FILE.png draws its energy"
        )
        raise OptionError(f"scene has no landscape over two coordinates: {why}")
    if stated.contact != "full":
        why = f"the admissible space in it needs contact = 'full', not {stated.contact!r}"
        out.refuse(why, "json")
    result = search(stated, scene.name, seed=seed, full=True, escape=False)
    with progress("boundary"):
        exact = find_landscape(result, size=size)
    exact.print_to(out.console)
    barriers = None
    if passes or out.files("json"):
        with progress("passes between minima"):
            barriers = find_barriers(stated, result, seed=seed)
        for step in barriers.passes:
            kind = f"{step.pass_kind}, {step.energy:.9g} J"
            out.say(f"pass {step.from_state} - {step.to_state}: {kind}")
    if out.files("json"):
        with progress("space and critical points"):
            space = find_space(stated)
            critical = find_critical_points(stated, result, seed=seed)
        out.say(critical.verdict(space.euler_characteristic).text)
        out.write("json", landscape_to_dict, exact, space, critical, barriers)
    out.write("npz", _npz, exact)
    out.write("figure", draw_landscape, exact, barriers)
    out.save("html", lambda file: InteractivePage(exact.view_content(barriers)).save(file))


def _npz(exact: ExactLandscape) -> bytes:
    import numpy as np

    from origami_nlp.landscape import to_arrays

    content = io.BytesIO()
    np.savez_compressed(content, **to_arrays(exact))
    return content.getvalue()
