"""`origami-nlp minima`: find, classify and show the energy minima of a scene."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search
from origami_nlp.cli.source import Source, takes_scene
from origami_nlp.errors import OptionError

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult


@takes_scene(o.SceneFile)
def minima(
    scene: Source,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    fold: o.StatesFold = None,
    mesh: o.StatesMesh = None,
    html: o.HtmlFile = None,
    animate: o.AnimateFile = None,
    max_starts: o.MaxStarts = 100_000,
    effort: o.Effort = "normal",
    workers: o.Workers = 1,
    seconds: o.Seconds = None,
    full: o.Full = False,
    noise: o.Noise = None,
    prove: o.Prove = None,
    certificate: o.CertificateFile = None,
) -> None:
    """Find the energy minima of SCENE that have its symmetry; --full says which are stable states."""
    from origami_nlp.minima import (
        check_mesh,
        draw_minima,
        find_vertexwise,
    )
    from origami_nlp.verbs import write_fold, write_mesh

    out = Output(
        json=json,
        figure=figure,
        fold=fold,
        mesh=mesh,
        certificate=certificate,
        html=html,
        animate=animate,
    )
    if mesh:
        check_mesh(mesh)
    options: dict[str, Any] = {
        "seed": seed,
        "max_starts": max_starts,
        "effort": effort,
        "workers": workers,
        "full": full,
        "noise": noise,
        "prove": o.wanted_proof(prove),
        "seconds": seconds,
    }
    if scene.is_fold and scene.vertex is None:
        scenes = scene.read_all()
        if len(scenes) > 1:
            for option, file in (
                ("figure", figure),
                ("fold", fold),
                ("mesh", mesh),
                ("certificate", certificate),
                ("animate", animate),
            ):
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
        (stated,) = scenes.values()
    else:
        stated = scene.read()
    result = search(stated, scene.name, **options)
    result.tell(out.console)
    out.write("json", result.to_dict)
    out.save("figure", draw_minima, result)
    out.save("fold", write_fold, result)
    out.save("mesh", write_mesh, result)
    out.save("certificate", _write_certificate, result)
    out.turn(result)


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
