"""One table of tolerances: levels in order, each entry with its derivation and users, and nothing beside it unsaid."""

import ast
import itertools
import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

import origami_nlp

PACKAGE = Path(origami_nlp.__file__).parent
TABLE = PACKAGE / "numerics" / "tolerances.py"
SMALL = 0.1
"""Floats below this are tolerances, until somebody says what else they are."""
DRAWN = "chart/axes display/ figure drawing picture strip panel phase_figure"
"""Modules, rooms, and names of modules in any room, whose small numbers are sizes in pictures."""


class Entry(NamedTuple):
    """One tolerance."""

    level: str
    name: str
    value: float
    derivation: str


def entries() -> list[Entry]:
    """The table as it stands in the module; levels are its comments."""
    lines = TABLE.read_text().splitlines()
    body = ast.parse(TABLE.read_text()).body
    values: dict[str, float] = {}
    out = []
    for node, after in itertools.pairwise(body):
        if not isinstance(node, ast.Assign):
            continue
        assert isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        (target,) = node.targets
        assert isinstance(target, ast.Name)
        values[target.id] = number(node.value, values)
        level = [m[1] for m in map(re.compile(r"# (\w+)$").match, lines[: node.lineno]) if m]
        text = " ".join(str(after.value.value).split())
        out.append(Entry(level[-1] if level else "exact", target.id, values[target.id], text))
    return out


def number(node: ast.expr, known: dict[str, float]) -> float:
    """The value of literals, powers and names."""
    expression = compile(ast.Expression(node), "constant", "eval")
    return float(eval(expression, {"__builtins__": {}}, dict(known)))  # our own source, no data


@cache
def users() -> dict[str, set[str]]:
    """Rooms by what they import of `numerics`."""
    rooms: dict[str, set[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        if "origami_nlp.numerics" not in (text := path.read_text()):
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ImportFrom) and "origami_nlp.numerics" in str(node.module):
                for alias in node.names:
                    rooms.setdefault(alias.name, set()).add(path.relative_to(PACKAGE).parts[0])
    return rooms


def rooms_that_use(name: str) -> list[str]:
    """Rooms whose modules import an entry."""
    return sorted(users().get(name, set()))


def literals(node: ast.AST) -> list[float]:
    """Floats between 0 and `SMALL` that are written in some code."""
    found = (n.value for n in ast.walk(node) if isinstance(n, ast.Constant))
    return [v for v in found if isinstance(v, float) and 0 < v < SMALL]


def is_drawn(module: str) -> bool:
    """Return whether small numbers of a module are sizes in pictures."""
    kinds = DRAWN.split()
    return module.split("/")[-1] in kinds or module.startswith(tuple(k for k in kinds if "/" in k))


@cache
def sources() -> tuple[tuple[str, ast.Module], ...]:
    """Modules beside the table and what is generated, room/module with its code."""
    paths = {p.relative_to(PACKAGE).with_suffix("").as_posix(): p for p in PACKAGE.rglob("*.py")}
    return tuple(
        (module, ast.parse(path.read_text()))
        for module, path in sorted(paths.items())
        if path != TABLE and not module.startswith("closed_forms/") and not is_drawn(module)
    )


def assigned(node: ast.stmt) -> list[tuple[str, ast.expr]]:
    """Names that a statement gives a value, each with its own."""
    if isinstance(node, ast.AnnAssign) and node.value is not None:
        return [(ast.unparse(node.target), node.value)]
    if not isinstance(node, ast.Assign):
        return []
    (target,), value = node.targets, node.value
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        return [(ast.unparse(t), v) for t, v in zip(target.elts, value.elts, strict=True)]
    return [(ast.unparse(target), value)]


def unnamed() -> Iterator[str]:
    """Small floats within functions and classes that are no default value: room/module:line."""
    for module, tree in sources():
        defaults: set[ast.AST] = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.arguments):
                given = [d for d in (*node.defaults, *node.kw_defaults) if d is not None]
                defaults.update(n for d in given for n in ast.walk(d))
            elif isinstance(node, ast.ClassDef):
                fields = (v for statement in node.body for _, v in assigned(statement))
                defaults.update(n for v in fields for n in ast.walk(v))
        for top in tree.body:
            if not assigned(top):
                for node in set(ast.walk(top)) - defaults:
                    if isinstance(node, ast.Constant) and literals(node):
                        yield f"{module}:{node.lineno} {node.value}"


def test_levels_are_in_order():
    table = entries()
    assert {e.level for e in table} == {"exact", "polished", "coarse"}
    of = {
        level: [e.value for e in table if e.level == level]
        for level in ("exact", "polished", "coarse")
    }
    assert max(of["exact"]) <= min(of["polished"])
    assert max(of["polished"]) <= min(of["coarse"])


def test_values_are_what_is_imported():
    from origami_nlp import numerics

    for e in entries():
        assert getattr(numerics, e.name) == e.value, e.name


def test_derived_values():
    """What a derivation says in numbers holds."""
    value = {e.name: e.value for e in entries()}
    eps = math.ulp(1.0)
    assert value["EPS"] == eps
    assert value["CONTACT_TOL"] == pytest.approx(math.sqrt(eps / 2), rel=0.1)
    assert value["RESOLVED"] == pytest.approx(10 * value["CONTACT_TOL"])
    assert value["ROUNDED"] == pytest.approx(50 * eps, rel=0.2)
    # what closure misses at the smallest radius, 1e-6, can be distinguished from rounding of following
    assert value["FOLLOWED"] < 1e-6**2
    assert value["ROUNDED"] < value["DEPENDENT"] < value["CONTACT_TOL"]
    assert value["ROUNDED"] < value["INDEPENDENT"] < value["RESOLVED"]
    assert value["OUTSIDE"] < (2e-4) ** 3


def test_every_entry_is_used():
    assert [e.name for e in entries() if not rooms_that_use(e.name)] == []


def test_every_small_number_has_a_name():
    assert not list(unnamed())
