"""The notebooks of the project as pages, with links that hold both beside the notebooks and on the site."""

from __future__ import annotations

import shutil
from pathlib import Path

BOOKS = "tutorials"
"""Folder of the site in which notebooks stand; beside the sources they stand in `notebooks/`."""


def copy(app) -> None:
    """Copy the notebooks into the sources; what is no longer there goes."""
    here, there = Path(app.srcdir) / BOOKS, Path(app.srcdir).parent / "notebooks"
    here.mkdir(exist_ok=True)
    wanted = {path.name: path for path in there.glob("*.ipynb")}
    for old in here.glob("*.ipynb"):
        if old.name not in wanted:
            old.unlink()
    for name, path in wanted.items():
        copied = here / name
        if not copied.exists() or copied.read_bytes() != path.read_bytes():
            shutil.copy2(path, copied)


def links(app, name: str, source: list[str]) -> None:
    """Turn links between `docs/` and `notebooks/` into links of the site."""
    up = "../" * name.count("/")
    if name.startswith(f"{BOOKS}/"):
        source[0] = source[0].replace("](../docs/", "](../")
    else:
        source[0] = source[0].replace(f"](../{up}notebooks/", f"]({up}{BOOKS}/")


def setup(app) -> dict:
    """Connect both."""
    app.connect("builder-inited", copy)
    app.connect("source-read", links)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
