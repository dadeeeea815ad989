"""The public face explains itself: whole docstrings whose examples run, names under TAB, types for outsiders."""

import doctest
import inspect
import re
import rlcompleter
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from functools import wraps
from importlib import import_module
from pathlib import Path

import pytest

import origami_nlp

PACKAGE = Path(origami_nlp.__file__).parent
WITH_EXAMPLES = sorted(
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
    for path in PACKAGE.rglob("*.py")
    if ">>> " in path.read_text()
)
FINDERS = [name for name in origami_nlp.__all__ if name.startswith("find_")]
SECTION = re.compile(r"^([A-Z]\w+)\n-{3,}\n", re.MULTILINE)


# ---------------------------------------------------------------- examples


def same(a: object, b: object) -> bool:
    """Whether two arguments ask for the same: scenes are compared, results are not."""
    return a is b or (not hasattr(a, "told") and a == b)


def found_once(find: Callable, kept: list) -> Callable:
    """Keep what `find` returns, for calls with equal scenes and options, or the very same results."""

    @wraps(find)
    def ask(*given, **options):
        for old, old_options, answer in kept:
            if len(given) == len(old) and options == old_options:
                if all(map(same, given, old)):
                    return answer
        answer = find(*given, **options)
        kept.append((given, options, answer))
        return answer

    return ask


KEPT: dict[str, list] = {name: [] for name in FINDERS}


DEAR = (
    "origami_nlp paths.result chart.boundary display.result search.options "
    "barriers.find paths.boundary paths.survey contact.segments "
    "continuation.tracer inverse_design.finding inverse_design.result "
    "paths.load minima.completeness minima.figure minima.minimum minima.result paper.cone.phase "
    "paper.critical paper.landscape paper.space "
    "pattern_problem.lattice pattern_problem.tube results verbs"
).split()
"""Modules whose examples take seconds: they run with the long studies."""


@pytest.mark.parametrize(
    "module",
    [
        pytest.param(m, marks=[pytest.mark.slow] if m.removeprefix("origami_nlp.") in DEAR else [])
        for m in WITH_EXAMPLES
    ],
)
def test_examples_say_what_they_show(module, monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    for name in FINDERS:  # the same search in several examples
        once = found_once(getattr(origami_nlp, name), KEPT[name])
        monkeypatch.setattr(origami_nlp, name, once)
    result = doctest.testmod(import_module(module))
    assert result.attempted and not result.failed


# ---------------------------------------------------------------- docstrings


def section(doc: str, name: str) -> str | None:
    """Text of a section of a numpydoc docstring."""
    parts = SECTION.split(doc)
    return dict(zip(parts[1::2], parts[2::2], strict=True)).get(name)


def stated(doc: str, name: str) -> set[str]:
    """Names that a section explains: those that start a line of their own."""
    heads = re.findall(r"^(\S.*)$", section(doc, name) or "", re.MULTILINE)
    return {word.strip() for head in heads for word in head.split(" : ")[0].split(",")}


def lacking(what: Callable) -> Iterator[str]:
    """What the docstring of a function or class leaves out."""
    doc = inspect.getdoc(what) or ""
    if inspect.isclass(what):
        names = {f.name for f in fields(what) if f.name[0] != "_"} if is_dataclass(what) else set()
        if not is_dataclass(what) and "__init__" in vars(what):
            names = set(inspect.signature(what).parameters)
        yield from sorted(names - stated(doc, "Parameters") - stated(doc, "Attributes"))
        return
    signature = inspect.signature(what)
    yield from sorted(set(signature.parameters) - {"self"} - stated(doc, "Parameters"))
    if signature.return_annotation not in ("None", None) and section(doc, "Returns") is None:
        yield "Returns"
    complains = re.search(r"^\s+(raise|check_\w+\() *\S", inspect.getsource(what), re.MULTILINE)
    if complains and section(doc, "Raises") is None:
        yield "Raises"


def functions_and_classes(face: object) -> dict[str, Callable]:
    found = {name: getattr(face, name) for name in face.__all__}
    return {n: f for n, f in found.items() if inspect.isfunction(f) or inspect.isclass(f)}


@pytest.mark.parametrize("name", functions_and_classes(origami_nlp))
def test_a_public_name_says_all_and_shows_an_example(name):
    what = getattr(origami_nlp, name)
    assert not list(lacking(what))
    assert ">>> " in (section(inspect.getdoc(what), "Examples") or "")


def test_methods_of_public_classes_say_what_they_take():
    classes = [c for c in functions_and_classes(origami_nlp).values() if inspect.isclass(c)]
    lacks = {
        f"{c.__name__}.{name}": missing
        for c in classes
        for name, method in inspect.getmembers(c, inspect.isroutine)
        if name[0] != "_" and str(getattr(method, "__module__", "")).startswith("origami_nlp")
        if len(inspect.signature(method).parameters) > 1 or inspect.ismethod(method)
        if (missing := list(lacking(method)))
    }
    assert not lacks


# ---------------------------------------------------------------- what a user's tools see


def test_dir_and_tab_show_the_face_and_load_nothing():
    code = (
        "import sys, origami_nlp as o; shown = dir(o); assert set(o.__all__) <= set(shown);"
        "assert not {'casadi', 'matplotlib', 'scipy', 'sympy'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    offered = rlcompleter.Completer({"o": origami_nlp}).attr_matches("o.find_")
    assert {f"o.{name}(" for name in FINDERS} == set(offered)
    assert len(FINDERS) > 5
