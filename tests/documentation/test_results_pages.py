"""Pages under "Published results": what a Python block prints is what stands below it."""

import pytest

from tests.documentation import shell
from tests.documentation.pages import ROOT, blocks, name_of

PAGES = sorted((ROOT / "docs" / "results").glob("*.md"))
DEAR = {"vertices4", "motifs", "waterbombs"}


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=[pytest.mark.slow] if p.stem in DEAR else []) for p in PAGES],
    ids=name_of,
)
def test_python_prints_what_is_shown(page, capsys):
    names, compared = {"__name__": "__main__"}, 0
    found = blocks(page)
    for block, after in zip(found, [*found[1:], None], strict=True):
        if block.language != "python":
            continue
        exec(compile(block.text, f"block of line {block.line}", "exec"), names)
        said = capsys.readouterr().out
        if said:
            assert after is not None and after.language == "text", f"line {block.line}: not shown"
            wrong = shell.differs(after.text, said)
            assert not wrong, f"line {block.line}: {wrong}"
            compared += 1
    assert compared
