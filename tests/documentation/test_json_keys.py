"""The keys of JSON that the documentation lists are those that results have."""

import re
from dataclasses import fields

import pytest

import origami_nlp as o
from origami_nlp.inverse_design import Design
from origami_nlp.paths import Atlas, BifurcationSet
from tests.command_line import run
from tests.documentation.pages import ROOT

PAGE = (ROOT / "docs" / "reference" / "json.md").read_text(encoding="utf-8")
ROWS = re.findall(
    r"^\| `([a-z -]+)` \| `(\w+)` \| `(origami-nlp/\S+)` \| (.*) \|$", PAGE, re.MULTILINE
)
CLASSES = {
    one.__name__: one
    for one in (
        *(o.MinimaResult, o.LoadPath, Atlas, BifurcationSet, o.Motion, o.ContactReport),
        *(
            o.Barriers,
            o.CriticalPoints,
            o.Space,
            Design,
            o.Validity,
            o.LayerOrders,
        ),
    )
}


def test_every_class_has_its_row():
    assert {name for _, name, _, _ in ROWS} == set(CLASSES)


@pytest.mark.parametrize(("command", "name", "schema", "keys"), ROWS)
def test_schema_and_keys_are_those_of_the_class(command, name, schema, keys):
    of = CLASSES[name]
    written = [f.name for f in fields(of) if f.metadata.get("plain", True)]
    written += [key for key in getattr(of, "ALSO", ()) if key not in written]
    assert of.SCHEMA == schema and re.findall(r"`(\w+)`", keys) == written
    assert run(command.split()[0], "--help").code == 0
