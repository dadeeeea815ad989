"""`origami-nlp minima`: find, classify and show the energy minima of a vertex or a pattern."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

from origami_nlp.arguments import refuse
from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import Interrupted, OptionError

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult


@takes_scene(o.OrigamiFile, whole=True)
def minima(
    scene: Source,
    each_vertex: Annotated[
        bool,
        typer.Option(
            "--each-vertex",
            help="FOLD file: every vertex by itself, equal ones once, as one table.",
        ),
    ] = False,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    fold: o.StatesFold = None,
    mesh: o.StatesMesh = None,
    html: o.HtmlFile = None,
    animate: o.AnimateFile = None,
    effort: o.Effort = "normal",
    max_starts: o.MaxStarts = None,
    starts: o.Starts = None,
    workers: o.Workers = None,
    seconds: o.Seconds = None,
    full: o.Full = False,
    noise: o.Noise = None,
    prove: o.Prove = None,
    certificate: o.CertificateFile = None,
) -> None:
    """Find the energy minima of ORIGAMI, a vertex or a pattern: its stable states.

    Of a scene they are those with its symmetry; --full says which are stable without it.  A FOLD file or an example is
    a pattern with all its vertices coupled; --vertex takes one of them, --each-vertex every one by itself.
    """
    from origami_nlp.minima import check_mesh, find_vertexwise
    from origami_nlp.pattern import Scene
    from origami_nlp.results import draw
    from origami_nlp.verbs import write_fold, write_mesh

    files = {"figure": figure, "fold": fold, "mesh": mesh, "certificate": certificate}
    out = Output(json=json, html=html, animate=animate, **files)
    if mesh:
        check_mesh(mesh)
    options: dict[str, Any] = {
        "seed": seed,
        "effort": effort,
        "max_starts": max_starts,
        "starts": starts,
        "workers": workers,
        "seconds": seconds,
        "full": full or None,
        "noise": noise,
        "prove": o.wanted_proof(prove),
    }
    if each_vertex:
        scenes = scene.read_all()
        for option, file in {**files, "animate": animate}.items():
            if file is not None:
                raise OptionError(
                    f"--{option} is for one vertex: choose one of {len(scenes)} with --vertex"
                )
        found = find_vertexwise(
            scenes, find=partial(search, name=scene.name), found=out.say, **options
        )
        found.tell(out.console)
        out.write("json", found.to_dict)
        out.turn(*found.results)
        return
    stated = scene.read_whole(contact=True)
    if not isinstance(stated, Scene):
        refuse("pattern", {"certificate": "its list is not proved"}, certificate=certificate)
        options["contact"] = scene.whole_contact
    stopped = False
    try:
        result = search(stated, scene.name, **options)
    except Interrupted as early:  # what was found is told and written all the same
        result, stopped = early.result, True
    result.tell(out.console)
    out.write("json", result.to_dict)
    out.save("figure", draw, result)
    out.save("fold", write_fold, result)
    out.save("mesh", write_mesh, result)
    out.save("certificate", _write_certificate, result)
    out.turn(result)
    if stopped:
        raise KeyboardInterrupt


def _write_certificate(result: MinimaResult, file: str) -> None:
    """Prove again, with the tree of boxes on record, and write it down."""
    from origami_nlp.programme import Model
    from origami_nlp.proof import certificate_of, prove, write_certificate

    found = result.completeness
    if found is None or not found.boxes:
        why = found.reason if found else "it was not asked for (--prove)"
        raise OptionError(f"--certificate: there is no proof to write: {why}")
    models = [Model(one) for one in result.scene.of_each_winding]
    proofs = [prove(model, record=True, most=found.boxes) for model in models]
    write_certificate(certificate_of(result.scene, *proofs), file)
