"""`origami-nlp check-proof`: replay a proof of completeness with an arithmetic of its own."""

from __future__ import annotations

import typer

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress


def check_proof(proof: o.ProofFile, json: o.JsonFile = None) -> None:
    """Check a proof that a list of minima is complete, claim by claim, in ball arithmetic.

    Exit code 1 if a claim is not confirmed: the first one is named.
    """
    from origami_nlp.proof import check_proof as check, read_certificate

    out = Output(json=json)
    certificate = read_certificate(proof)
    with progress(f"check of {proof}", len(certificate.nodes.kind)) as report:
        found = check(certificate, lambda done, total: report(done, total))
    out.say("\n".join(found.lines), highlight=False, soft_wrap=True)
    out.write("json", found.to_dict)
    if found.refused:
        raise typer.Exit(1)
