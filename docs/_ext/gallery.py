"""The gallery: a page of each script of `docs/gallery`, with its picture and what it prints (`tests/gallery.py`)."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

FOLDER, RECORD = "gallery", "shown.json"


def page(name: str, text: str, printed: str) -> str:
    """Return the page of a script."""
    said = (ast.get_docstring(ast.parse(text)) or name).split("\n")
    body = "\n".join(said[1:]).strip()
    code = text.split('"""', 2)[2].strip()
    parts = [f"# {said[0].rstrip('.')}", body, f"```python\n{code}\n```"]
    if printed.strip():
        parts.append(f"```text\n{printed.rstrip()}\n```")
    parts.append(f"![what {name}.py draws](../figures/gallery/{name}.png)")
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


def links(app, name: str, source: list[str]) -> None:
    """Turn links to scripts into links to their pages."""
    source[0] = re.sub(rf"({FOLDER}/\w+)\.py\)", r"\1.md)", source[0])


def setup(app) -> dict:
    """Write the pages before sources are listed."""
    app.connect("builder-inited", write)
    app.connect("source-read", links)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
