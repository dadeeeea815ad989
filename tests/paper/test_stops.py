"""The admissible space between stops: against pixels of the chart, and against the Morse count of critical points."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o


def stopped(seed):
    """A random symmetric vertex of degree 6 or 8 with stops."""
    rng = np.random.default_rng(seed)
    eight = seed % 3 == 0
    alpha = float(rng.uniform(0.2, 1.4) if eight else rng.uniform(0.4, 1.3))
    scene = (o.examples.degree8 if eight else o.examples.degree6)(alpha)
    of, k = np.array(scene.group.orbit), max(scene.group.orbit) + 1
    low, high = -rng.uniform(0.3, 3.1, k), rng.uniform(0.3, 3.1, k)
    low[rng.random(k) < 0.25], high[rng.random(k) < 0.25] = -math.pi, math.pi
    rest, limits = (
        rng.uniform(-1.5, 1.5, k)[of],
        zip(low[of].tolist(), high[of].tolist(), strict=True),
    )
    return replace(
        scene, rest_angles=tuple(rest.tolist()), limits=tuple(limits), symmetry=scene.group.name
    )


def check_count(scene, rings=16):
    """The Euler characteristic is the Morse count, which asks another way; the minima are those of the search."""
    space = o.find_space(scene, rings=rings)
    low, high = scene.limit_angles
    assert ((space.mesh.fold_angles >= low) & (space.mesh.fold_angles <= high)).all()
    for k, name in enumerate(space.mesh.cover.chain.walls):
        here = space.mesh.on >> k & 1 == 1
        if name.endswith("(stop)"):
            crease, angle = name.removeprefix("phi_").split(" degrees")[0].split(" = ")
            at = space.mesh.fold_angles[here, int(crease) - 1]
            assert np.allclose(at, math.radians(float(angle)), rtol=0, atol=1e-5)
            assert len(set(at.tolist())) <= 1
    found = o.find_critical_points(scene)
    assert found.morse_sum == space.euler_characteristic
    assert max((p.residual for p in found.points), default=0.0) < 1e-12
    return found


@pytest.mark.slow  # a second look at what other tests of the room say
def test_critical_points_count_the_euler_characteristic():
    scene = stopped(8)
    found = check_count(scene)
    search = o.find_minima(scene, escape=False, prove=False, full=False)
    ours, theirs = ([m.fold_angles for m in each.minima] for each in (found, search))
    assert np.abs(np.subtract(sorted(ours), sorted(theirs))).max() < 1e-3
    held = [p for p in found.minima if any("(stop)" in name for name in p.contacts)]
    assert held and all(min(p.multipliers) > 0 for p in held)


def test_where_only_a_book_is_left_the_space_is_a_handle():
    """All creases valley: the paper folds in half alone, and the stops that hold it are its contacts."""
    space = o.find_space(replace(o.examples.degree6("pi/4"), limits=(0.0, 2.0)), rings=16)
    (handle,) = space.handles
    assert np.allclose(handle.fold_angles[:, [1, 2, 4, 5]], 0.0, atol=1e-12)
    assert {0.0, 2.0} == {float(v) for v in handle.fold_angles[[0, -1], 0]}
