"""States over parameters as data frames: a row a point, with what the scene itself says of it."""

import numpy as np
import pytest

import origami_nlp as o

pytest.importorskip("pandas")


def angles(frame, count):
    return frame[[f"phi_{k}_rad" for k in range(1, count + 1)]].to_numpy()


def test_an_atlas_has_a_row_a_point():
    atlas = o.follow(o.examples.degree6("pi/4"), "ratio=1:1.1", checks=1, full=False)
    frame = o.to_frame(atlas)
    points = [(b, p) for b in atlas.branches for p in b.points]
    assert len(frame) == len(points) > 4
    assert set(frame["parameter"]) == {"ratio"} and set(frame["unit"]) == {atlas.parameter.unit}
    for phi, row in zip(angles(frame, 6), frame.to_dict("records"), strict=True):
        energy = o.examples.degree6("pi/4", ratio=row["t"]).energy(phi)  # from the angles alone
        assert np.isclose(row["energy_J"], energy, rtol=1e-12, atol=0)
        (branch,) = (b for b in atlas.branches if b.id == row["branch"])
        (kind,) = {r.kind for r in branch.kind_ranges if r.low < row["t"] < r.high} or {row["kind"]}
        assert row["kind"] == kind


@pytest.mark.slow  # a second look at what other tests of the room say
def test_curves_of_events_have_a_row_a_point():
    few = {"lines": 1, "across": 0, "effort": "quick"}
    found = o.find_bifurcation_set(
        o.examples.degree6("pi/3"), "ratio=0.3:0.4", "alpha=59deg:60deg", **few
    )
    frame = found.to_frame()
    assert len(frame) == sum(len(curve.points) for curve in found.curves) > 1
    assert set(frame["curve"]) == {curve.id for curve in found.curves}
    for name, low, high in (("1", 0.3, 0.4), ("2", np.radians(59), np.radians(60))):
        assert frame[f"t_{name}"].between(low - 1e-12, high + 1e-12).all()
    assert (np.abs(angles(frame, 6)) <= np.pi).all()
