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
BESIDE_THE_TABLE = {
    "lengths of steps, and of first, last and tried ones [rad, or shares of a range]": """
        continuation/line.SHARE continuation/event_curve.AHEAD continuation/event_curve.STEPS barriers/passes.OFF
        chart/boundary.CLOSE chart/cells.RADIUS chart/mesh.DIFFERENCE
        cli/timed.SHORTEST
        paper/links.RADII paper/cone/phase.DIFFERENCE paper/critical.DIFFERENCE paper/critical.NEAR
        pattern_problem/faces.ASIDE kkt/level.BESIDE_FLAT
        kkt/neighbourhood.RADII kkt/neighbourhood.STEPS kkt/descent_witness.DOWNHILL kkt/descent_witness.FAR
        kkt/descent_witness.STEPS kkt/descent_witness.SHOWN
        paper/landscape.PIECE paths/job.OFF_BRANCH paths/job.LEAST_SPAN paths/job.OVER
        paper/transitions.SIDE
        continuation/curve.STEPS continuation/flat.ARRIVED continuation/flat.BESIDE_FLAT
        continuation/branch_point.FAR pattern_states/judgement.FAR_ALONG
        continuation/one_sided_branches.TRIALS continuation/diagram.STEPS pattern_states/curve.SHORTEST
        pattern_states/curve.STEP pattern_states/curves.LONG search/layers.AJAR
        pattern_problem/pop_signs.JUMPS
        escapes/terrain.FIRST search/descent_path.TRIED search/descent_path.RISE
        search/ipopt.BESIDE pattern_states/search.BESIDE pattern_states/near_folded.INSIDE
    """,
    "shares by which an algorithm goes on, gives up, or refines": """
        contact/margin.LEAST_DAMPING contact/margin.SOFT
        pattern_problem/compiled_closure.FALLS pattern_problem/stacks.GRID escapes/paths.CERTAIN
        kkt/neighbourhood.GOES kkt/descent_witness.DOWN
        continuation/events.POLE pattern_states/branch_points.FORMS
        search/newton.FAR_FROM_SINGULAR search/newton.LEAVES pattern_states/interpolant.ON_CURVE
        inverse_design/infeasibility.WEIGHTY
        search/descend.SOFT search/moments.SHORTEST_SHARE
    """,
    "descents that decide nothing: where they stop, and how near to each other their ends are one": """
        search/descend.NAMES
    """,
    "what a formula is resolved to by its pieces": """
        pattern/hinge_types.AS_STATED pattern_problem/labels.FINE
    """,
    "what is shown, or said in words": """
 chart/boundary.GRID chart/boundary.SLIVER
        paper/morse.ROUNDING pattern/fold_notes.LOOKS_LIKE_PI
        pattern/fold_notes.SMALLEST_FOLD pattern/fold_notes.UP
        pattern_problem/poses.MOVES paper/space.EXTENDED pattern/hinge_data.TURNED
    """,
    "shares of a drawing: what is joined, what is straight, what is rounding": """
        pattern/coordinate_repair.DRAWN pattern/coordinate_repair.SHARES
        drawings/sheet.RUNGS drawings/sheet.COARSE drawings/svg.STRAIGHT
        pattern/pattern_file.LARGEST_SNAP
    """,
    "definitions of the source paper": """
        contact/segments.SLOPE contact/segments.STIFFNESS
    """,
    "data: stiffnesses and their ratios, and ranges of what is asked for": """
        pattern_problem/admissible.LARGEST_TOLERANCE validity/finding.LARGEST_TOLERANCE validity/faults.MILLI
        paper/cone/phase.RATIOS
        paper/cone/phase.RATIO_LIMITS pattern/coordinate_repair.COARSE
        pattern/example_patterns.QUAD_STIFFNESS
        pattern/examples.RATIOS pattern/numbers_read.SMALLEST
        pattern/example_vertices.STIFFNESS pattern/hinge_types.WIDTHS pattern/hinge_data.UNITS
    """,
    "options of IPOPT and of a conic solver": """
        search/ipopt.BESIDE_OPTIONS search/ipopt.NEARBY search/ipopt.OPTIONS search/ipopt.TOLERANCE
        numerics/conic.ACCURACIES
    """,
    "where curves end before a limit that closed forms lose": """
        paper/cone/phase.NEAREST
    """,
    "breaks of hinge laws": """
        problem/hinge_laws.AT_BREAK
    """,
    "symmetry of the shortest step of a path": """
        minima/full_space.KEPT
    """,
    "widths, radii and shares of boxes in proofs, whose claims do not rest on them": """
        proof/boxes.WIDER proof/boxes.EXACT
        proof/proving.LOW
        proof/flat.NARROW proof/flat.RADII proof/roots.FAR
        proof/boxes.SMALLEST proof/proving.BESIDE proof/proving.WIDTHS
        proof/check.START proof/check.NEAR proof/check.CLOSED proof/check.LEAST proof/check.BEFORE
        proof/vertex_check.NARROW proof/vertex_check.BESIDE proof/vertex_check.ONE_LINE
        proof/vertex_check.WIDER proof/vertex_check.NEAR_FLAT
        proof/quads.ALIKE proof/quads.WIDEST
    """,
    "bounds on rounding in proofs": """
        proof/flat.CLEAR
    """,
    "room for rounding": """
        paper/cone/roots.FREE paper/cone/roots.WIDER paper/cone/rules.SLACK
        numerics/factors.BACKWARD
    """,
    "torque, curvature and error left in explored states, which are polished": """
        pattern_states/judgement.LEFT
        search/newton.STILL pattern_states/interpolant.FITS pattern_states/interpolant.REAL
    """,
    "accuracy of published states, and of the grid that they lie on": """
        paper/audit.CLOSED paper/audit.ON_GRID paper/candidates.PRINTED
    """,
    "weights of rows and steps": """
        pattern/coordinate_repair.SOFT numerics/factors.WEIGHT
        search/newton.WEIGHTS
    """,
}
"""Small constants that stand elsewhere, by what they are."""


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


def small_constants() -> Iterator[str]:
    """Module constants below `SMALL` outside the table, tuples of them included: room/module.NAME."""
    for module, tree in sources():
        for node in tree.body:
            for name, value in assigned(node):
                if literals(value):
                    yield f"{module}.{name}"


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


def test_nothing_small_stands_elsewhere_without_a_reason():
    listed = [name for names in BESIDE_THE_TABLE.values() for name in names.split()]
    assert len(listed) == len(set(listed))
    assert set(small_constants()) == set(listed)


def test_every_small_number_has_a_name():
    assert not list(unnamed())
