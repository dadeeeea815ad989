"""The notation page names what exists."""

import dataclasses
import re
from importlib import import_module

import pytest

import origami_nlp
from tests.documentation.pages import ROOT


def named() -> list[str]:
    """Names of the package in the last column of the tables of the notation page."""
    rows = [
        line for line in (ROOT / "docs" / "notation.md").read_text().splitlines() if line[:1] == "|"
    ]
    cells = [re.split(r"(?<!\\)\|", row)[3] for row in rows]
    return sorted(
        {name for cell in cells for name in re.findall(r"`([A-Za-z_][\w.]*)`(?! \()", cell)}
    )


def found(name: str) -> bool:
    """Whether a dotted name, from the package on, is a module, an attribute, or a field of a dataclass."""
    thing, where = origami_nlp, "origami_nlp"
    for part in name.split("."):
        where += f".{part}"
        if dataclasses.is_dataclass(thing) and part in {
            field.name for field in dataclasses.fields(thing)
        }:
            return name.endswith(part)
        try:
            thing = getattr(thing, part, None) or import_module(where)
        except ImportError:
            return False
    return True


@pytest.mark.parametrize("name", [name for name in named() if name != "origami_nlp"])
def test_names_of_the_notation_page_exist(name):
    assert found(name)


def test_the_notation_page_names_much():
    assert len(named()) > 40 and not found("JudgedState.lambda_") and not found("kkt.Lambda")
