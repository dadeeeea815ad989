"""Critical points: the Morse identity, whatever the energy, and every KKT point that other searches find."""

import math

import numpy as np
import pytest

from origami_nlp import examples
from origami_nlp.closed_forms import degree6, wedge3
from origami_nlp.errors import OptionError
from origami_nlp.paper import find_critical_points
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import pose
from tests.computed_once import panel_points, thinned

PANELS = examples.panels()
SHAPES = list({s.vertex: s for s in PANELS}.values())


def random_energy(scene, rng):
    """Stiffness over almost three decades and any rest angles, on the variables of the problem."""
    n, expand = pose(scene).size, pose(scene).expand
    k, rest = expand(np.exp(rng.uniform(-3, 3, n))), expand(rng.uniform(-math.pi, math.pi, n))
    return Scene(scene.vertex, tuple(k), tuple(rest), scene.symmetry, "full", scene.mirror)


@pytest.mark.slow  # all panels
def test_points_of_the_panels_are_those_that_are_known():
    """Numbers of all points, as they were found by another search at commit 43a588e0; 43 minima, of sum 1 each."""
    found = [panel_points(k) for k in range(len(PANELS))]
    many = [18, 30, 28, 14, 27, 26, 14, 25, 25, 17, 16, 19, 19, 18, 19, 18, 18, 19]
    assert [len(f.points) for f in found] == many
    assert sum(len(f.minima) for f in found) == 43
    assert {(f.morse_sum, f.doubts) for f in found} == {(1, ())}


@pytest.mark.parametrize("shape", thinned(range(6), 3))
def test_the_sum_is_the_same_for_every_energy(shape):
    """The space does not know the springs: any point lost or misjudged alone breaks this."""
    rng = np.random.default_rng(shape)
    for _ in range(3):
        other = find_critical_points(random_energy(SHAPES[shape], rng))
        assert (other.morse_sum, other.doubts) == (1, ()), other.to_dict()
        assert max(p.residual for p in other.points) < 1e-12


def chart_points(scene, size):
    """Interior critical points by Newton on the generated closed forms, from every point of a grid of the chart."""
    rays = scene.group.rays
    creases = [ray.crease for ray in rays]
    k = np.array([scene.stiffness[c] * scene.group.orbit.count(r) for r, c in enumerate(creases)])
    rest = np.array([scene.rest_angles[c] for c in creases])
    first_is_d1 = len(creases) == 4
    y = np.linspace(-math.pi, math.pi, size + 2)[1:-1]
    out = []
    for branch in (1,) if first_is_d1 else (1, -1):
        q = np.stack(np.meshgrid(y, y if first_is_d1 else y / 2), axis=-1).reshape(-1, 2)
        for _ in range(30):
            if first_is_d1:
                c = degree6(rays[0].sector, rays[1].sector, q[:, 0], q[:, 1])
                free, order = [1, 2], [0, 3]
            else:
                c = wedge3(scene.group.order, rays[0].sector, q[:, 1], q[:, 0], branch)
                free, order = [1], [0, 2]
            good = c.ok & c.own_side
            q, value = q[good], c.value[good]
            first, second = c.first[good], c.second[good]
            if not first_is_d1:  # derivatives come by (elevation, phi_2)
                first, second = first[..., ::-1], second[..., ::-1, ::-1]
            pull = (value - rest[order]) * k[order]
            gradient = np.einsum("km,kmi->ki", pull, first)
            hessian = np.einsum("km,kmij->kij", pull, second)
            hessian += np.einsum("m,kmi,kmj->kij", k[order], first, first)
            for i, crease in enumerate(free):
                gradient[:, i] += k[crease] * (q[:, i] - rest[crease])
                hessian[:, i, i] += k[crease]
            step = -np.linalg.solve(hessian, gradient[..., None])[..., 0]
            step *= np.minimum(1, 0.1 / np.linalg.norm(step, axis=1, keepdims=True))
            q = q + step
        near = np.abs(step).max(axis=1) < 1e-9
        q, value = q[near], value[near]
        x = np.empty((len(q), len(creases)))
        x[:, order] = value
        x[:, free] = q[:, : len(free)]
        out.append(x[(np.abs(x) < math.pi - 1e-6).all(axis=1)])
    model = pose(scene)
    x = np.concatenate(out)
    kept = []
    for state in x:
        if all(np.abs(state - other).max() > 1e-5 for other in kept) and not model.refuses(state):
            kept.append(state)
    return model.expand(np.array(kept).reshape(-1, model.size))


@pytest.mark.parametrize("number", thinned([15, 8, 0], 3))
def test_interior_points_are_those_of_the_chart(number):
    """Both ways: nothing missing, nothing extra; the chart is regular at all interior points of these panels."""
    inner = [p.fold_angles for p in panel_points(number).points if p.stratum == "interior"]
    scanned = chart_points(PANELS[number], 61)
    assert len(inner) == len(scanned)
    for state in scanned:
        assert min(np.abs(np.subtract(state, p)).max() for p in inner) < 1e-6


def test_scenes_without_two_dof_are_refused():
    full = Scene(PANELS[0].vertex, PANELS[0].stiffness, PANELS[0].rest_angles, "none")
    for scene in (full, examples.degree6(contact="none")):
        with pytest.raises(OptionError):
            find_critical_points(scene)
