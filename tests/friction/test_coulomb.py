"""The least Coulomb coefficient: by statics of a strip by hand, and by linear programs over cones with many sides."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import linprog
from typer.testing import CliRunner

import origami_nlp as o
from origami_nlp.cli import app
from origami_nlp.errors import OptionError
from origami_nlp.friction import least_coulomb
from origami_nlp.kkt import State
from origami_nlp.pattern import as_pattern, make_pattern
from origami_nlp.pattern_problem import PatternProblem

ROOT = Path(__file__).parents[2]
SIDES = 96


def strip(widths, k, rest):
    """Three facets in a row, the last one narrower, so that its end stands on the first."""
    x = np.concatenate([[0.0], np.cumsum(widths)])
    ends = [(0.0, 1.0)] * 3 + [(0.25, 0.75)]
    corners = np.array([[a, b] for a, pair in zip(x, ends, strict=True) for b in pair])
    facets = [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(3)]
    return make_pattern(corners, facets).with_springs(list(k), list(rest))


@pytest.mark.parametrize("widths", [(2.0, 1.5, 1.0), (2.0, 1.2, 1.0)])
@pytest.mark.parametrize("distance", [0.8, 1.0])
@pytest.mark.parametrize("rest", [(2.9, 2.4), (2.6, 2.9)])
def test_a_strip_that_stands_on_itself(widths, distance, rest):
    """Torques k (phi - rest) = N dy/dphi + T dx/dphi of the end of the strip, in the plane across its creases."""
    _, b, c = widths
    inner = math.acos((b * b + distance**2 - c * c) / (2 * b * distance))
    outer = math.acos((b * b + c * c - distance**2) / (2 * b * c))
    phi, k = np.array([math.pi - inner, math.pi - outer]), np.array([1.0, 0.7])
    one, both = phi[0], phi.sum()
    x = np.array([-b * math.sin(one) - c * math.sin(both), -c * math.sin(both)])
    y = np.array([b * math.cos(one) + c * math.cos(both), c * math.cos(both)])
    normal, along = np.linalg.solve(np.stack([y, x], axis=1), k * (phi - rest))
    found = least_coulomb(strip(widths, k, rest), phi.tolist())
    assert len(found.contacts) == 2
    if normal <= 0:
        assert found.coefficient == math.inf
        return
    assert found.coefficient == pytest.approx(abs(along) / normal, rel=1e-6)
    assert sum(c.force for c in found.contacts) == pytest.approx(normal, rel=1e-6)
    assert sum(found.friction) == pytest.approx(abs(along), rel=1e-6) and found.residual < 1e-7


def motion(corners, moved):
    """Turn and shift of a facet, from its corners before and after (Kabsch)."""
    a, b = corners.mean(axis=0), moved.mean(axis=0)
    u, _, vt = np.linalg.svd((corners - a).T @ (moved - b))
    turn = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    return turn, b - turn @ a


def by_lines(pattern, phi, touches, coefficient, limits=()):
    """Whether cones with `SIDES` sides hold a state: a linear program, arms by differences of places of facets.

    limits: creases that are folded flat, and push back.
    """
    problem = PatternProblem(pattern)
    z, h = State(problem, phi).kernel, 1e-6
    torque = z.T @ (pattern.stiffness * (phi - pattern.rest))
    place = problem.crossings.poses.polygons

    def seen(x, touch):
        """The point of contact as carried by the second facet, seen from the first."""
        i, j = touch.facets
        first, second = (motion(place(phi)[f], place(x)[f]) for f in (i, j))
        p = touch.points(problem.placed(phi))[0]
        return first[0].T @ (second[0] @ p + second[1] - first[1])

    columns = []
    for touch in touches:
        p = touch.points(problem.placed(phi))
        normal = touch.sign * np.cross(p[2] - p[1], p[3] - p[1])
        normal /= np.linalg.norm(normal)
        u = np.linalg.svd(normal[None])[2][1:]
        arm = np.stack(
            [(seen(phi + h * d, touch) - seen(phi - h * d, touch)) / (2 * h) for d in z.T]
        )
        for angle in np.linspace(0, 2 * np.pi, SIDES, endpoint=False):
            force = normal + coefficient * (math.cos(angle) * u[0] + math.sin(angle) * u[1])
            columns.append(arm @ force)
    columns += [-np.sign(phi[i]) * z[i] for i in limits]
    a = np.array(columns).T
    return linprog(np.zeros(a.shape[1]), A_eq=a, b_eq=torque, method="highs").status == 0


def test_cones_of_lines_agree_in_space():
    rng = np.random.default_rng(4)
    sheet = strip((2.0, 1.5, 1.0), (1.0, 0.7), (2.9, 2.4))
    inner = math.acos((1.5**2 + 1 - 1) / (2 * 1.5))
    phi = np.array([math.pi - inner, math.pi - math.acos(1.5**2 / 3.0)])
    cases = [(sheet, phi)]
    result = o.find_minima("metasheet:3x3", effort="quick", escape=False)
    for minimum in result.minima:
        if any(len(c.facets) == 2 for c in minimum.contacts):
            made = result.pattern
            cases.append(
                (
                    made.with_springs(
                        made.stiffness.tolist(),
                        (made.rest + 0.02 * rng.normal(size=made.creases)).tolist(),
                    ),
                    np.array(minimum.fold_angles),
                )
            )
    checked = 0
    for pattern, phi in cases[:4]:
        found = least_coulomb(pattern, phi.tolist())
        problem = PatternProblem(pattern)
        closed = problem.closed(phi)
        every = dict.fromkeys((*closed.base, *(c for b in closed.branches for o in b for c in o)))
        touches = [problem.touch(c) for c in every if not c.is_limit]
        if len(touches) < len(every) or any(t.type == "edge-edge" for t in touches):
            continue
        checked += 1
        if found.coefficient in (0, math.inf):
            assert by_lines(pattern, phi, touches, 100.0) == (found.coefficient == 0)
            continue
        # cones of lines are inside round ones, and hold them where the coefficient is larger by 1 / cos(pi / SIDES)
        assert by_lines(pattern, phi, touches, found.coefficient * (1 + 2e-3))
        assert not by_lines(pattern, phi, touches, found.coefficient * (1 - 2e-3))
    assert checked


def test_what_needs_no_friction_and_what_is_refused():
    sheet = o.examples.pattern("miura", 2, 2).with_springs(1.0, 0.8)
    phi = o.find_minima(sheet, escape=False).minima[0].fold_angles
    assert least_coulomb(sheet, list(phi)).coefficient == 0
    off = sheet.with_springs(1.0, 0.9)
    assert (
        least_coulomb(off, list(phi)).coefficient == math.inf
    )  # nothing touches that could hold it
    with pytest.raises(OptionError, match="does not close"):
        least_coulomb(sheet, [0.5, 0.1, 0.1, 0.3])
    with pytest.raises(OptionError, match="each of 4"):
        least_coulomb(sheet, [0.5])


@pytest.mark.parametrize("seed", range(3))
def test_facets_that_may_lie_in_either_order_are_held_in_both(seed):
    """The set of states is a union there: forces of one order do not hold the other, nor those of both at once."""
    sheet, rng = as_pattern("miura:2x3"), np.random.default_rng(seed)
    phi = np.radians([180.0, 180.0, -180.0, 180.0, -180.0, -180.0, -180.0])
    rest = phi + 0.3 * rng.normal(size=7)
    sheet = sheet.with_springs([1.0] * 7, np.clip(rest, -3.1, 3.1).tolist())
    problem = PatternProblem(sheet)
    pieces = [[c for c in one if not c.is_limit] for one in problem.closed(phi).combinations()]
    assert len(pieces) == 4

    def holds(piece, coefficient):
        touches = [problem.touch(c) for c in piece]
        return by_lines(sheet, phi, touches, coefficient, range(7))

    found = least_coulomb(sheet, phi.tolist())
    if found.coefficient == math.inf:
        assert not all(holds(piece, 100.0) for piece in pieces)
    else:
        assert all(holds(piece, found.coefficient * (1 + 2e-3)) for piece in pieces)
        less = found.coefficient * (1 - 2e-3)
        assert not less or not all(holds(piece, less) for piece in pieces)


def test_the_command_asks_about_the_state_in_the_file(tmp_path):
    file, target = ROOT / "docs" / "files" / "standing_strip.fold", tmp_path / "held.json"
    run = CliRunner().invoke(app, ["friction", str(file), "--facets", "-o", str(target)])
    assert run.exit_code == 0 and "corner 7 of facet 3 on facet 1" in run.output
    found = o.load(target)
    k, rest = np.array([1.0, 0.7]), np.array([2.9, 2.4])
    phi = math.pi - math.acos(0.75)  # a triangle of sides 1, 1.5 and 1
    x = np.array([-1.5 * math.sin(phi) - math.sin(2 * phi), -math.sin(2 * phi)])
    y = np.array([1.5 * math.cos(phi) + math.cos(2 * phi), math.cos(2 * phi)])
    normal, along = np.linalg.solve(np.stack([y, x], axis=1), k * (phi - rest))
    assert found.coefficient == pytest.approx(abs(along) / normal, rel=1e-6)
    assert found.draw().axes and f"{found.coefficient:.6g}" in found.verdict
    for words, why in (("--state", "leave out"), ("--torque", "leave out")):
        done = CliRunner().invoke(app, ["friction", str(file), "--facets", words, "1"])
        assert isinstance(done.exception, OptionError) and why in str(done.exception)
    done = CliRunner().invoke(app, ["friction", str(file.with_name("pattern.fold")), "--facets"])
    assert "describes no folded state" in str(done.exception)


def test_a_minimum_held_by_contact_needs_no_friction():
    for minimum in o.find_minima("metasheet:3x3", effort="quick", escape=False).minima:
        sheet = as_pattern("metasheet:3x3")
        hold = least_coulomb(sheet, minimum.fold_angles)
        assert hold.coefficient == 0 and hold.residual < 1e-7
