"""Long vertices are polished and judged by short cuts: the same as without; and the constant internal moment."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, State, Vertex, find_minima
from origami_nlp.kkt import certificates, polishing
from origami_nlp.pattern_problem import passing_moment, pose
from origami_nlp.problem import Contact
from tests.independent.rotations import about
from tests.search.test_moment_map import draw


def test_independent_contacts_all_open_at_once(monkeypatch):
    rng = np.random.default_rng(0)
    for r, t in ((14, 20), (20, 20)):
        rows = rng.normal(size=(r, t))
        names = tuple(Contact("limit", v, 1) for v in range(r))
        fast = certificates.cone(rows, names)
        monkeypatch.setattr(certificates, "MANY_ROWS", 99)
        slow = certificates.cone(rows, names)
        monkeypatch.undo()
        assert fast[0] == slow[0] == t
        assert fast[2] == slow[2] == ()
        assert (rows @ fast[1] > 0).all()
    rows[-1] = -rows[0]  # these two cannot open
    assert certificates.cone(rows, names)[2] == (names[0], names[-1])


def folded(scene, phi):
    """Frames of the facets after each crease, and the deformed creases, by matrices alone."""
    frame, frames, creases = np.eye(3), [], []
    for a, p in zip(scene.vertex.azimuths, phi, strict=True):
        b = np.array([math.cos(a), math.sin(a), 0.0])
        creases.append(frame @ b)
        frame = frame @ about(b, p)
        frames.append(frame)
    return frames, np.array(creases)


@pytest.mark.parametrize("n", [5, 9])
def test_one_moment_in_the_frame_of_every_facet(n):
    scene = draw(n)
    found = find_minima(scene, max_starts=60, effort="quick", prove=False, escape=False)
    for minimum in found.minima[:4]:
        phi = np.array(minimum.fold_angles)
        frames, creases = folded(scene, phi)
        assert np.abs(frames[-1] - np.eye(3)).max() < 1e-12
        free, m = np.abs(phi) < math.pi, np.array(minimum.moment)
        torque = np.array(scene.stiffness) * (phi - np.array(scene.rest_angles))
        size = 1 + np.abs(m).max()
        assert np.abs(torque - creases @ m)[free].max() < 1e-10 * size
        assert minimum.moment_residual < 1e-10 * size
        at_limit = ~free  # the springs push creases at a limit on
        assert (np.sign(phi[at_limit]) * (creases @ m - torque)[at_limit] > 0).all()
        for start in range(
            1, n
        ):  # numbered from another crease: the same vector, seen from its facet
            k = np.roll(np.arange(n), -start)
            v = Vertex(tuple(np.array(scene.vertex.sector_angles)[k].tolist()))
            springs = (tuple(np.array(s)[k].tolist()) for s in (scene.stiffness, scene.rest_angles))
            turned = Scene(v, *springs, "none", "fold-limits")
            other = passing_moment(turned, pose(turned), phi[k])
            in_facet = about((0, 0, 1), -scene.vertex.azimuths[start]) @ frames[start - 1].T @ m
            assert np.abs(np.array(other.vector) - in_facet).max() < 1e-9 * size
        multipliers = (
            State(found.model, phi)
            .on(
                tuple(
                    Contact("limit", int(v), 1 if phi[v] > 0 else -1)
                    for v in np.flatnonzero(at_limit)
                )
            )
            .multipliers[:3]
        )
        half = 0.5 * found.model.scale * multipliers
        assert np.abs(half - m).max() < 1e-9 * size


def test_flat_creases_determine_no_moment():
    scene = Scene(Vertex(("pi/3",) * 6), (1,) * 6, (0,) * 6, "none", "fold-limits")
    assert passing_moment(scene, pose(scene), np.zeros(6)) is None
    assert passing_moment(scene, pose(scene), np.array([math.pi, -math.pi] * 3)) is None


@pytest.mark.parametrize("n", [4, polishing.LARGE + 1])
def test_a_step_where_closure_leaves_nothing_free(n):
    """Many creases, as many independent rows: what is solved for is closure alone (an error before)."""
    rng = np.random.default_rng(0)
    jacobian = np.eye(n) + 0.1 * rng.normal(size=(n, n)) / math.sqrt(n)
    factors = np.linalg.svd(jacobian, full_matrices=False)
    system = polishing._System(np.zeros(n), np.zeros(n), np.eye(n), jacobian, factors)
    values = rng.normal(size=n)
    assert jacobian @ system.step(values) == pytest.approx(-values, abs=1e-12)
    assert math.isfinite(polishing._uncertainty(system))
