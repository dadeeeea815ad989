"""N -> infinity: observed orders and coefficients against series of the exact kinematics."""

import json

import numpy as np
import pytest
import sympy as sp
from typer.testing import CliRunner

from origami_nlp.closed_forms import cone_fold_angles
from origami_nlp.errors import OptionError
from origami_nlp.folding import fold_vertex
from origami_nlp.pattern import Vertex
from studies import limits
from studies.__main__ import app
from studies.cone_limits import DEGREES, inverted_cone_energy

LAST = 2 * np.pi / DEGREES[-1]


@pytest.mark.parametrize("elevation, ratio", [(0.6, 1.0), (0.1, 30.0), (0.78, 0.02)])
def test_orders_and_coefficients_are_those_of_the_series(elevation, ratio):
    for quantity in limits(elevation, ratio):
        if quantity.exact:
            assert quantity.expected_order == 0
            continue
        assert quantity.order == pytest.approx(quantity.expected_order, abs=0.05), quantity.name
        # what Richardson leaves is two powers of alpha smaller than the coefficient's own scale
        assert abs(quantity.coefficient - quantity.expected_coefficient) < 2 * LAST**2, quantity


@pytest.mark.slow
def test_series_of_both_roots_by_sympy():
    a, v = sp.symbols("alpha v", positive=True)
    steepness = (1 + sp.sin(a)) / sp.cos(a)  # cot(pi/4 - alpha/2)
    shallow = 2 * sp.atan(sp.tan(v / 2) / steepness)
    steep = 2 * sp.atan(sp.tan(v / 2) * steepness)
    for root, sign in ((shallow, -1), (steep, 1)):
        assert sp.simplify(sp.diff(root, a).subs(a, 0) - sign * sp.sin(v)) == 0
        assert sp.simplify(sp.diff(root, a, 2).subs(a, 0) / 2 - sp.sin(2 * v) / 4) == 0
    mean = (sp.cos(shallow) + sp.cos(steep)) / 2
    second = sp.diff(mean, a, 2).subs(a, 0) / 2
    assert sp.simplify(second + sp.sin(v) ** 2 * sp.cos(v)) == 0
    # inverted cone: steep(v) - shallow(v_0) at v near v_0, linear springs, first order in alpha
    r, x, v0 = sp.symbols("r x v_0", positive=True)
    mismatch = x + 2 * a * sp.sin(v0)  # x = |v| - v_0
    best = sp.solve(sp.diff(mismatch**2 + r * x**2, x), x)[0]
    energy = (mismatch**2 + r * x**2).subs(x, best) / ((1 + r) * v0**2)
    wanted = 4 * r * a**2 * sp.sin(v0) ** 2 / ((1 + r) * v0) ** 2
    assert sp.simplify(energy - wanted) == 0


@pytest.mark.parametrize("degree", [8, 32, 256])
def test_visible_area_from_the_folded_facets_themselves(degree):
    """Angle between facet 1 and the cone through crease 1, from the folded sheet in 3-D."""
    v = 0.6
    phi = cone_fold_angles(degree, v, [1] * (degree // 2)).value
    creases, _ = fold_vertex(Vertex((2 * np.pi / degree,) * degree), phi)
    odd = creases[::2]
    axis = np.linalg.svd(odd - odd.mean(axis=0))[2][-1]  # the plane of the tips of the odd creases
    facet = np.cross(creases[0], creases[1])
    cone = np.cross(creases[0], np.cross(axis, creases[0]))
    cosine = abs(facet @ cone) / np.linalg.norm(facet) / np.linalg.norm(cone)
    row = next(q for q in limits(v) if q.name == "visible area ratio, shallow flaps")
    assert cosine == pytest.approx(row.values[DEGREES.index(degree)], abs=1e-12)


@pytest.mark.parametrize("degree", [8, 12, 64])
@pytest.mark.parametrize("ratio", [0.05, 1.0, 20.0])
def test_inverted_cone_by_dense_scan(degree, ratio):
    rest_elevation, flaps = 0.5, [1] * (degree // 2)
    rest = cone_fold_angles(degree, rest_elevation, flaps).value
    stiffness = np.array([1.0, ratio] * (degree // 2))
    below = -np.linspace(0, np.pi / 2 - 2 * np.pi / degree, 20_001)
    first = cone_fold_angles(degree, below, flaps).value[:, :2]  # one flap stands for all
    energy = ((first - rest[:2]) ** 2 * stiffness[:2]).sum(axis=1)
    flat = (rest[:2] ** 2 * stiffness[:2]).sum()
    # a scan of step h is above a quadratic well by at most its curvature times h^2
    excess = energy.min() / flat - inverted_cone_energy(degree, rest_elevation, ratio)
    assert 0 <= excess + 1e-13 < 1e-6


def test_bad_arguments_are_named():
    with pytest.raises(OptionError, match="elevation"):
        limits(1.2)
    with pytest.raises(OptionError, match="ratio"):
        limits(0.5, -1)


def test_command_prints_every_quantity(tmp_path):
    out = tmp_path / "limits.json"
    result = CliRunner().invoke(app, ["limits", "-o", str(out)])
    assert result.exit_code == 0, result.output
    reported = json.loads(out.read_text())
    assert [row["name"] for row in reported["quantities"]] == [q.name for q in limits()]
    assert reported["degrees"] == list(DEGREES)
