"""Renew what pages show of their commands: `python -m tests.documentation --write [PAGE ...]`, from a checkout."""

import contextlib
import re
import shutil
import sys
import tempfile
from pathlib import Path

from tests.documentation import shell
from tests.documentation.pages import ROOT, blocks, markdown
from tests.documentation.test_commands import TERMINAL, run_block


def renew(page: Path) -> str:
    """The text of a page with what its commands print now; its Python runs, and what is marked as not run stays."""
    text, names = page.read_text(), {"__name__": "__main__"}
    for block in blocks(page):
        if block.run.startswith("not: "):
            continue
        if block.language not in TERMINAL or not re.search(r"^\$ ", block.text, re.MULTILINE):
            run_block(block, names)
            continue
        if block.file:
            Path(block.file).write_text(block.text)
        parts = re.split(r"(^\$ .*(?:\\\n.*)*\n?)", block.text, flags=re.MULTILINE)
        for k, line in enumerate(shell.commands(block.text)):
            _, said = shell.run_line(line)
            if parts[2 * k + 2].strip():
                parts[2 * k + 2] = shell.renewed(parts[2 * k + 2], said)
        text = text.replace(block.text, "".join(parts), 1)
    return text


if __name__ == "__main__":
    assert sys.argv[1:2] == ["--write"], __doc__
    for page in [Path(name).resolve() for name in sys.argv[2:]] or markdown():
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            shutil.copytree(ROOT / "docs" / "files", folder, dirs_exist_ok=True)
            page.write_text(renew(page))
