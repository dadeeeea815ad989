"""Minima of grids against the exact ones: orders, constants, and false minima."""

from __future__ import annotations

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.chart import chart_of
from origami_nlp.minima import MinimaResult
from studies import GridErrors, count_grid_minima, draw_grid_convergence, grid_errors
from studies.grid_convergence import SIZES
from tests.computed_once import panel_result, shared

INTERIOR = ("degree8", "pi/4", 1.0)
WALL = ("degree8", "pi/12", 100.0)


def search(family: str, alpha: str, ratio: float) -> MinimaResult:
    return panel_result(getattr(o.examples, family)(alpha, ratio))


@shared
def errors(family: str, alpha: str, ratio: float) -> tuple[GridErrors, ...]:
    return grid_errors(search(family, alpha, ratio), shifts=10)


def test_sizes_are_those_of_the_study():
    assert SIZES == (65, 129, 257, 513, 1025)


@pytest.mark.slow
def test_interior_minima_converge_at_the_expected_order():
    for error in errors(*INTERIOR):
        assert error.sort == "interior"
        assert error.order("energy") == pytest.approx(2.0, abs=0.2)
        assert error.order("distance") == pytest.approx(1.0, abs=0.2)
        assert (error.energy > 0).all()  # from above: every grid point is an admissible state
        assert (np.diff(error.worst("energy")) < 0).all()


def chart_hessian(scene, branch, place):
    """Second derivatives of the energy over the chart, by central differences."""
    chart, h = chart_of(scene), 1e-4
    steps = np.array([(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1), (0, 0)])
    x, y = (np.array(place) + h * steps).T
    u = scene.energy(chart.fold_angles(branch, x, y))
    cross = (u[4] - u[5] - u[6] + u[7]) / 4
    return np.array([[u[0] + u[1] - 2 * u[8], cross], [cross, u[2] + u[3] - 2 * u[8]]]) / h**2


@pytest.mark.slow
def test_interior_errors_keep_to_their_constants():
    """The cell's own corner gives a bound: dU <= e.H e/2 with |e_i| <= h_i/2, and H bounds the place in turn."""
    result = search(*INTERIOR)
    for minimum, error in zip(result.minima, errors(*INTERIOR), strict=True):
        branches, place = chart_of(result.scene).locate(np.array(minimum.fold_angles))
        hessian = chart_hessian(result.scene, branches[0], place)
        low, _ = np.linalg.eigvalsh(hessian)
        for k in (2, 3, 4):  # small cells: the well is a parabola there
            cell = error.cell[k] / 2 * np.array([1.0, 0.5])  # the elevations span half as much
            bound = 0.5 * np.abs(hessian).dot(cell).dot(cell)
            assert error.energy[k].max() <= 1.05 * bound
            assert error.distance[k].max() <= 1.05 * np.sqrt(2 * bound / low)


@pytest.mark.slow
def test_minima_pinned_at_a_curved_wall_lose_half_the_order():
    error = errors(*WALL)[1]
    assert error.sort == "contact"
    assert error.order("energy") == pytest.approx(1.0, abs=0.25)
    assert error.order("distance") == pytest.approx(0.5, abs=0.25)
    # it really is a slower kind of convergence than inside
    inside = errors(*WALL)[0]
    assert inside.order("energy") > error.order("energy") + 0.6


def test_handles_are_invisible_to_grids():
    result = search("degree6", "pi/3", 1.0)
    found = grid_errors(result, (65, 129), shifts=2)
    assert [e.sort for e in found].count("handle") == 2
    assert all(np.isnan(e.order("energy")) for e in found if e.sort == "handle")


def test_counts_share_states_and_keep_their_meaning():
    results = [search("degree6", "pi/3", 1.0), search("degree6", "pi/3", 100.0)]
    together = count_grid_minima(results, (65, 129))
    apart = [row for r in results for row in count_grid_minima([r], (65, 129))]
    assert list(together) == apart
    for row in together:
        assert 0 < row.claimed <= min(row.found, row.exact)
        assert row.false == row.found - row.claimed
    # jags of the boundary: the finer the grid, the more of them
    coarse, fine = [row for row in together if row.scene.endswith("100")]
    assert fine.false > coarse.false > 0


def test_grid_errors_want_a_chart():
    result = search(*INTERIOR)
    flat = MinimaResult(
        o.examples.degree6(symmetry="none"), result.minima, result.search, model=result.model
    )
    with pytest.raises(o.OrigamiError, match="chart"):
        grid_errors(flat)


@pytest.mark.slow
@pytest.mark.parametrize(
    "ending", ["png", *(pytest.param(e, marks=pytest.mark.slow) for e in ("pdf", "svg"))]
)
def test_figure(ending, tmp_path):
    counts = {"degree 8": count_grid_minima([search(*WALL)], (65, 129))}
    figure = draw_grid_convergence((*errors(*INTERIOR), *errors(*WALL)), counts)
    figure.savefig(tmp_path / f"figure.{ending}")
    assert (tmp_path / f"figure.{ending}").stat().st_size > 5000
    assert len(figure.axes) == 3


@pytest.mark.slow
def test_every_interior_minimum_converges():
    """All panels: second order in energy and first in place, unless the well is narrower than coarse cells."""
    checked = 0
    for scene in o.examples.panels():
        result = panel_result(scene)
        for error in grid_errors(result, shifts=12):
            if error.sort != "interior" or not np.isfinite(error.worst("energy")).all():
                continue
            # a well that ends at a wall within the coarsest cell is still a wall to that grid
            if error.distance[-1].max() > 3 * error.cell[-1]:
                continue
            assert error.order("energy") == pytest.approx(2.0, abs=0.6), error
            assert error.order("distance") == pytest.approx(1.0, abs=0.3), error
            checked += 1
    assert checked >= 20
