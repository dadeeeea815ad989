"""What the package says about itself is true, and the same everywhere."""

import re
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

import origami_nlp

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
CITATION = (ROOT / "CITATION.cff").read_text()


def entry(name):
    """A field of the citation's outermost level."""
    return re.search(rf"^{name}: *(.*)$", CITATION, re.MULTILINE).group(1).strip('"')


def test_the_version_is_one():
    assert PROJECT["version"] == origami_nlp.__version__ == entry("version")


def test_licence_and_types_are_what_they_are_said_to_be():
    assert PROJECT["license"] == entry("license") == "MIT"
    assert (ROOT / "LICENSE").read_text().startswith("MIT License")
    assert (ROOT / "origami_nlp" / "py.typed").exists()
    assert "Typing :: Typed" in PROJECT["classifiers"]
    # an SPDX expression and licence classifiers exclude each other (PEP 639)
    assert not any(c.startswith("License ::") for c in PROJECT["classifiers"])


def test_pythons_and_systems_are_those_that_are_supported():
    pythons = [c.split(" :: ")[-1] for c in PROJECT["classifiers"] if "Python :: 3." in c]
    least = re.fullmatch(r">=(3\.\d+)", PROJECT["requires-python"]).group(1)
    minors = [int(v.split(".")[1]) for v in pythons]
    assert pythons[0] == least and minors == list(range(minors[0], minors[-1] + 1))
    assert sys.version_info >= (3, minors[0])
    assert sorted(PROJECT["classifiers"]) == PROJECT["classifiers"]


def test_classifiers_are_known():
    known = pytest.importorskip("trove_classifiers").classifiers
    assert set(PROJECT["classifiers"]) <= set(known)


def test_the_citation_names_the_paper_and_is_valid():
    title = "Lagrangian approach to origami vertex analysis: Multistability"
    assert CITATION.count(title) == 2  # the paper, and its data
    for name in ("Grasinger", "Gillman", "Buskohl"):
        assert f"family-names: {name}" in CITATION
    cff = pytest.importorskip("cffconvert")
    cff.Citation(CITATION).validate()


def test_the_workflow_is_read_and_names_files_and_pythons_that_there_are():
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "ci.yml").read_text())
    assert set(workflow) == {"name", True, "permissions", "jobs"}  # YAML 1.1 reads "on" as true
    (job,) = workflow["jobs"].values()
    pythons = [c.split(" :: ")[-1] for c in PROJECT["classifiers"] if "Python :: 3." in c]
    assert job["strategy"]["matrix"]["python"] == pythons
    assert all(len({"uses", "run"} & set(step)) == 1 for step in job["steps"])
    said = "\n".join(step.get("run", "") for step in job["steps"])
    named = re.findall(r"\.ci/\w+(?:\.py)?", said)
    assert named and all((ROOT / name).is_file() for name in named)
