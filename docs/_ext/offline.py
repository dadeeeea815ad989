"""A site that needs no network: formulas are MathML, which browsers draw, and no page loads anything from elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.util import logging

LOADED = re.compile(
    r"<(?:script|img|iframe|source|video)\b[^>]*\bsrc=[\"']?(?P<src>(?:https?:)?//[^\"'\s>]+)"
    r"|<link\b(?=[^>]*\brel=[\"']?(?:stylesheet|preload|modulepreload|preconnect|icon))[^>]*\bhref=[\"']?"
    r"(?P<href>(?:https?:)?//[^\"'\s>]+)"
    r"|(?:url\(|@import)\s*[\"']?(?P<url>(?:https?:)?//[^\"'\s)]+)",
    re.IGNORECASE,
)
"""What a browser fetches by itself when a page or a style sheet is opened; links to follow are not among it."""


def loaded(text: str) -> Iterator[str]:
    """Yield each address from which a page or a style sheet loads a script, a style, a font or a picture."""
    for found in LOADED.finditer(text):
        yield next(part for part in found.groups() if part)


def check(app, failed: Exception | None) -> None:
    """Warn of each page that loads something from another place."""
    if failed or app.builder.format != "html":
        return
    folder = Path(app.outdir)
    for path in sorted([*folder.rglob("*.html"), *folder.rglob("*.css")]):
        for address in sorted(set(loaded(path.read_text(encoding="utf-8")))):
            name = path.relative_to(folder).as_posix()
            logging.getLogger(__name__).warning("%s loads %s", name, address)


def formula(node, display: str) -> str:
    """Return a formula as MathML."""
    return convert(node.astext().replace(r"\arg", r"\operatorname{arg}"), display=display)


def inline(writer, node) -> None:
    """Write a formula within a line."""
    writer.body.append(formula(node, "inline"))
    raise nodes.SkipNode


def block(writer, node) -> None:
    """Write a formula of its own."""
    writer.body.append(f'<div class="math">{formula(node, "block")}</div>')
    raise nodes.SkipNode


def setup(app) -> dict:
    """Draw formulas so, and look at the pages when they are built."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.connect("build-finished", check)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
