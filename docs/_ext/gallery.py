"""The gallery: a page of each script of `docs/gallery`, with its picture and what it prints (`tests/gallery.py`)."""

from __future__ import annotations

import ast
import contextlib
import io
import json
import re
import runpy
import tempfile
from pathlib import Path
from unittest.mock import patch

from matplotlib.figure import Figure

FOLDER, RECORD = "gallery", "shown.json"
TURNED = (
    "miura_vertex miura_sheet kresling_tube yoshimura resch metasheet tape_spring thick_panels"
).split()
"""Scripts whose states are found anew when the site is built, and can be turned on its pages."""
FRAME = """```{{raw}} html
<iframe class="turning" loading="lazy" title="states of {name}; drag to turn"
src="../_static/turning/{name}.html"></iframe>
```"""


def page(name: str, text: str, printed: str) -> str:
    """Return the page of a script."""
    said = (ast.get_docstring(ast.parse(text)) or name).split("\n")
    body = "\n".join(said[1:]).strip()
    code = text.split('"""', 2)[2].strip()
    parts = [f"# {said[0].rstrip('.')}", body, f"```python\n{code}\n```"]
    if printed.strip():
        parts.append(f"```text\n{printed.rstrip()}\n```")
    parts.append(f"![what {name}.py draws](../figures/gallery/{name}.png)")
    if name in TURNED:
        parts.append(FRAME.format(name=name))
    return "\n\n".join(part for part in parts if part) + "\n"


def write(app) -> None:
    """Write the pages; those of scripts that are gone go."""
    folder = Path(app.srcdir) / FOLDER
    shown = json.loads((folder / RECORD).read_text())
    pages = {
        script.with_suffix(".md"): page(
            script.stem, script.read_text(), shown.get(script.stem, {}).get("printed", "")
        )
        for script in sorted(folder.glob("*.py"))
    }
    for old in folder.glob("*.md"):
        if old not in pages:
            old.unlink()
    for path, text in pages.items():
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def turn(app, failed: Exception | None) -> None:
    """Write the pages on which states turn."""
    if failed or app.builder.format != "html":
        return
    there = Path(app.outdir) / "_static" / "turning"
    there.mkdir(parents=True, exist_ok=True)
    for name in TURNED:
        script, page = Path(app.srcdir) / FOLDER / f"{name}.py", there / f"{name}.html"
        if not page.exists() or page.stat().st_mtime < script.stat().st_mtime:
            with (
                tempfile.TemporaryDirectory() as away,
                contextlib.chdir(away),
                contextlib.redirect_stdout(io.StringIO()),
                patch.object(Figure, "savefig", lambda *_, **__: None),
            ):
                runpy.run_path(str(script))["found"].view().save(page)


def links(app, name: str, source: list[str]) -> None:
    """Turn links to scripts into links to their pages."""
    source[0] = re.sub(rf"({FOLDER}/\w+)\.py\)", r"\1.md)", source[0])


def setup(app) -> dict:
    """Write the pages before sources are listed."""
    app.connect("builder-inited", write)
    app.connect("source-read", links)
    app.connect("build-finished", turn, priority=400)  # before `offline` looks at the pages
    return {"parallel_read_safe": True, "parallel_write_safe": True}
