"""`origami-nlp paper audit`: what published candidate states are, and which artefacts they are."""

from __future__ import annotations

from origami_nlp.cli import options as o
from origami_nlp.cli.output import Output
from origami_nlp.cli.progress import progress


def audit(
    file: o.Candidates,
    seed: o.Seed = 0,
    json: o.JsonFile = None,
    markdown: o.MarkdownFile = None,
) -> None:
    """Say of each published candidate in FILE which exact minimum it is, or which artefact."""
    from origami_nlp.paper import (
        as_markdown,
        audit_candidates,
        audit_to_dict,
        read_candidates,
        summary_table,
    )

    out = Output(json=json, markdown=markdown)
    candidates = read_candidates(file)
    with progress("audit", len(candidates)) as report:
        panels = audit_candidates(candidates, seed=seed, progress=report)
    out.say(summary_table(panels))
    out.write("json", audit_to_dict, panels)
    out.write("markdown", as_markdown, panels)
