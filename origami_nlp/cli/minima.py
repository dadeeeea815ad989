"""`origami-nlp minima`: find, classify and show the energy minima of a scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.search import search
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene, read_fold_scene, read_scene

if TYPE_CHECKING:
    from origami_nlp.minima import MinimaResult


def minima(
    scene: o.SceneOrFold,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    figure: o.FigureFile = None,
    fold: o.StatesFold = None,
    mesh: o.StatesMesh = None,
    max_starts: o.MaxStarts = 100_000,
    effort: o.Effort = "normal",
    workers: o.Workers = 1,
    full: o.Full = False,
    prove: o.Prove = None,
    certificate: o.CertificateFile = None,
    vertex: o.VertexNumber = None,
    frame: o.FrameNumber = None,
    symmetry: o.FoldSymmetry = None,
    contact: o.FoldContact = None,
    stiffness: o.FoldStiffness = None,
    rest_angle: o.FoldRestAngle = None,
    rest_angles: o.FoldRestAngles = None,
) -> None:
    """Find the energy minima of SCENE that have its symmetry; --full says which are stable states."""
    from origami_nlp.minima import (
        check_mesh,
        draw_minima,
        print_result,
        result_to_dict,
        write_fold,
        write_mesh,
    )

    out = Output(json=json, figure=figure, fold=fold, mesh=mesh, certificate=certificate)
    if mesh:
        check_mesh(mesh)
    stated = _read(
        scene,
        vertex=vertex,
        frame=frame,
        symmetry=symmetry,
        contact=contact,
        stiffness=stiffness,
        rest_angle=rest_angle,
        rest_angles=rest_angles,
    )
    result = search(
        stated,
        scene,
        seed=seed,
        max_starts=max_starts,
        effort=effort,
        workers=workers,
        full=full,
        prove=o.wanted_proof(prove),
    )
    print_result(result, out.console)
    out.write("json", result_to_dict, result)
    out.save("figure", draw_minima, result)
    out.save("fold", write_fold, result)
    out.save("mesh", write_mesh, result)
    out.save("certificate", _write_certificate, result)


def _write_certificate(result: MinimaResult, file: str) -> None:
    """Prove again, with the tree of boxes on record, and write it down."""
    from origami_nlp.proof import certificate_of, prove, write_certificate

    found = result.completeness
    if found is None or not found.boxes:
        why = found.reason if found else "it was not asked for (--prove)"
        raise OptionError(f"--certificate: there is no proof to write: {why}")
    proof = prove(result.model, record=True, most=found.boxes)
    write_certificate(certificate_of(result.scene, proof), file)


def _read(source: str, **options: Any) -> Scene:
    """Read a scene file, or one vertex of a FOLD file with its options (None: not given)."""
    given = {name: value for name, value in options.items() if value is not None}
    if not source.lower().endswith((".fold", ".json")):
        if given:
            raise OptionError(
                f"--{next(iter(given)).replace('_', '-')} is for FOLD files (.fold); "
                "a scene file states it itself"
            )
        return read_scene(source)
    if not 0 < given.get("stiffness", 1.0) < math.inf:
        raise OptionError(f"--stiffness = {given['stiffness']:g} must be positive and finite")
    if "rest_angle" in given:
        given["rest_angle"] = math.radians(given["rest_angle"])
    return read_fold_scene(source, **given)
