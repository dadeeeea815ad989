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
PAGE = PACKAGE.parent / "docs" / "tolerances.md"
SMALL = 1e-5
"""Module constants below this are tolerances, until somebody says what else they are."""
BESIDE_THE_TABLE = {
    "barriers/full.MEET": "accuracy of a path's energy between its samples",
    "barriers/thin.SHORTEST": "step: bisection stops at rounding",
    "barriers/thin.SNAP": "accuracy with which `thin_at` finds an end, from `INDEPENDENT`",
    "chart/region.SLIVER": "drawing: area that is rounding between two lines",
    "paper/cone/phase_curves.NEAREST": "where curves end before a limit that closed forms lose",
    "paper/cone/phase_curves.ON_LINE": "rounding of a contouring library",
    "paper/cone/phase_curves.RATIO_LIMITS": "range of a stiffness ratio",
    "paper/cone/roots.FREE": "room for rounding in a bound",
    "paper/cone/roots.WIDER": "room for rounding in an enclosure",
    "paper/cone/rules.SLACK": "rounding of a difference of two angles",
    "contact/force_cone.TOLERANCE": "rounding of unit generators of a cone",
    "contact/margin.CARRIES": "moment that carries nothing",
    "critical/find.FIRM": "accuracy of multipliers beside a singular state, where links decide",
    "critical/result.ROUNDING": "moments that are stated as 0",
    "kkt/descent.RISE": "energy of a contact tolerance, where a path is polished",
    "kkt/descent.SHORTEST": "step",
    "kkt/neighbours.STEPS": "steps",
    "minima/curve.ACCURACY": "error of a curve's series, whose roots are polished",
    "minima/full_space.KEPT": "symmetry of the shortest step of a path",
    "starts/closing.EXPLORED": "closure of explored states; ends are closed to rounding, then polished",
    "starts/closing.(QUADRATIC, SETTLING)": "steps of Gauss-Newton: the square of the first is `EXPLORED`, or less",
    "minima/descents.FLAT_SLOPE": "torque left in explored states, which are polished afterwards",
    "minima/descents.SADDLE": "curvature of explored states, relative to that of the springs",
    "minima/descents.SINGULAR": "eigenvalues of explored states whose inverses are rounding",
    "minima/descents.TINY": "progress of an explored state",
    "minima/descents.(FIRST_REACH, REACH, SHORTEST)": "lengths of steps",
    "minima/ipopt.TOLERANCE": "accuracy that IPOPT is asked for",
    "pattern/crease_pattern.CLOSED": "accuracy of coordinates in a file",
    "pattern/digits.LIGHT": "weight of what groups share, beside corners",
    "pattern/digits.SOFT": "weight of rows that depend on others",
    "pattern/drawn.GRID": "corners of drawn facets that are one vertex",
    "pattern/scene.(SMALLEST, LARGEST)": "range of a stiffness, in any unit",
    "proof/": "unit roundoff, the accuracy of sines that is trusted, widths to which boxes are bisected",
    "facets/crossings.DEEP": "facets that touch, over a sheet's size: rounding along walks of 100 creases",
    "sheets/clearance.TOUCH": "facets that touch, over a sheet's size, as `DEEP`",
    "sheets/crossroads.MEET": "accuracy with which a state where curves meet is found",
    "sheets/crossroads.SNAP": "accuracy with which a state where curves meet is found",
    "sheets/curve.SHORTEST": "step",
    "sheets/curve.SHUT": "rounding of a fold angle that stays at pi along a curve",
    "sheets/descent.AT_LIMIT": "rounding of a fold angle that is set to pi",
    "sheets/descent.STILL": "torque left in states that are judged afterwards",
    "sheets/curves.FLAT": "accuracy with which a state where curves meet is found",
    "sheets/drawing.CANCELS": "areas whose sum says which way a picture is up",
    "sheets/crossroads.ON_PLANE": "a plane of states is one already searched",
    "sheets/interpolant.FITS": "error of polynomials along a curve, whose wells are polished",
    "sheets/interpolant.REAL": "error of roots of polynomials, which are polished",
    "facets/labels.GRID": "places that labels take for one: what agrees is checked by closure",
    "facets/borders.SEEN": "distance from which borders are looked at, whose gaps must be closed to `CLOSES`",
    "facets/meeting.SEEN": "distance from which gaps are looked at, that must be closed to `CLOSES`",
    "sheets/pressing.FLAT": "curvature that is left to the judge",
    "sheets/pressing.SHORTEST": "step",
    "sheets/pressing.SLIPS": "steps",
    "sheets/rows.LOADED": "moment that carries nothing",
    "sheets/rows.NEAR": "gaps that carry forces on the way; those of the end are solved for",
    "sheets/rows.SOFTEST": "curvature of a step",
    "sheets/rows.STILL": "torque left in states that are judged afterwards",
    "facets/touches.PARALLEL": "sine of two sides without a common normal: slopes of gaps go as its inverse",
    "numerics/factors.WEIGHT": "regularisation, which iterations take back",
    "facets/equations.SQUARED": "rounding of squares of singular values",
    "facets/stacks.THIN": "overlap that is rounding between two borders, over a sheet's size",
    "facets/features.CLOSE": "gaps that do not tell the side on which facets are",
    "facets/features.APART": "rounding of a gap, over a sheet's size",
    "springs/checking.BALANCE": "error of energies that were asked for, relative",
    "springs/conic.ACCURACIES": "accuracies that a solver is asked for",
    "springs/ways.EXACT": "relative excess of a barrier from which one more sample is taken",
    "paper/events.SEEN": "accuracy of a double zero",
    "space/result.SAME_POINT": "points of a picture",
    "paper/transitions.BRACKET": "step: width to which a sweep closes in",
}
"""Small constants that stand elsewhere, with the reason; a room is named as a whole by "room/"."""


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
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and "origami_nlp.numerics" in str(node.module):
                for alias in node.names:
                    rooms.setdefault(alias.name, set()).add(path.relative_to(PACKAGE).parts[0])
    return rooms


def rooms_that_use(name: str) -> list[str]:
    """Rooms whose modules import an entry."""
    return sorted(users().get(name, set()))


def page() -> str:
    """The page of the documentation."""
    head = ast.get_docstring(ast.parse(TABLE.read_text()))
    rows = [
        f"| {e.level} | `{e.name}` | {e.value:.2g} | {e.derivation} | {', '.join(rooms_that_use(e.name))} |"
        for e in entries()
    ]
    others = [f"| `{name}` | {why} |" for name, why in sorted(BESIDE_THE_TABLE.items())]
    return "\n".join(
        [
            "# Tolerances",
            "",
            str(head),
            "",
            "Written by `python -m tests.numerics.test_tolerances` from `origami_nlp/numerics/tolerances.py`.",
            "",
            "| level | name | value | notion and derivation | rooms that use it |",
            "| --- | --- | --- | --- | --- |",
            *rows,
            "",
            "Small constants elsewhere are step lengths, accuracies of data or of a benchmark, and rounding of closed",
            "forms of their own:",
            "",
            "| constant | what it is |",
            "| --- | --- |",
            *others,
            "",
        ]
    )


def small_constants() -> Iterator[str]:
    """Module-level floats below `SMALL` outside the table, tuples of them included: room/module.NAME."""
    for path in sorted(PACKAGE.rglob("*.py")):
        if path == TABLE:
            continue
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.Assign):
                targets, value = node.targets, node.value
            elif isinstance(node, ast.AnnAssign) and node.value is not None:
                targets, value = [node.target], node.value
            else:
                continue
            if isinstance(value, ast.Dict | ast.Call):
                continue
            literals = [n.value for n in ast.walk(value) if isinstance(n, ast.Constant)]
            if any(isinstance(v, float) and 0 < v < SMALL for v in literals):
                module = path.relative_to(PACKAGE).with_suffix("").as_posix()
                for target in targets:
                    yield f"{module}.{ast.unparse(target)}"


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
    assert value["TOUCHES"] == pytest.approx(math.sqrt(eps / 2), rel=0.1)
    assert value["RESOLVED"] == pytest.approx(10 * value["TOUCHES"])
    assert value["ROUNDED"] == pytest.approx(50 * eps, rel=0.2)
    # what closure misses at the smallest radius, 1e-6, can be told from rounding of following
    assert value["FOLLOWED"] < 1e-6**2
    assert value["ROUNDED"] < value["DEPENDENT"] < value["TOUCHES"]
    assert value["ROUNDED"] < value["INDEPENDENT"] < value["RESOLVED"]
    assert value["OUTSIDE"] < (2e-4) ** 3


def test_every_entry_is_used():
    assert [e.name for e in entries() if not rooms_that_use(e.name)] == []


def test_nothing_small_stands_elsewhere_without_a_reason():
    rooms = tuple(name for name in BESIDE_THE_TABLE if name.endswith("/"))
    found = {next((r for r in rooms if c.startswith(r)), c) for c in small_constants()}
    assert found == set(BESIDE_THE_TABLE)


def test_the_page_is_up_to_date():
    assert PAGE.read_text() == page(), "run python -m tests.numerics.test_tolerances"


if __name__ == "__main__":
    PAGE.write_text(page())
