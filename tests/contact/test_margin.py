"""Contact moments and load margins against independent solves."""

from __future__ import annotations

import math

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact.force_cone import distance_to_boundary
from origami_nlp.contact.margin import LoadMargin, load_margin, moments_of, under_load
from origami_nlp.kkt import (
    State,
    classify,
    find_multipliers,
    newton,
)
from origami_nlp.minima import JudgedState, MinimaResult
from origami_nlp.numerics import null_space, quaternion as quat
from origami_nlp.programme import (
    Contact,
    Model,
)
from tests.computed_once import panel_result, shared, thinned

MULTIPLIER_FD = 1e-6
"""Relative agreement of contact moments with finite differences of the optimal energy."""
MULTIPLIER_MP = 1e-10
"""Relative agreement of contact moments with a 50-digit solve."""

PINNED = {
    "creases on each other": ("degree6", "pi/3", 1.0, "creases 1 and 4"),
    "creases on each other, stiff mountains": ("degree6", "pi/3", 100.0, "creases 1 and 4"),
    "creases on each other, soft": ("degree6", "5*pi/12", 100.0, "creases 1 and 4"),
    "fold limit": ("degree6", "5*pi/12", 100.0, "+pi at creases 2, 6"),
    "fold limit, degree 8": ("degree8", "pi/12", 0.01, "-pi at creases 1, 5"),
    "fold limit, degree 8, pi/6": ("degree8", "pi/6", 0.01, "-pi at creases 1, 5"),
    "axis": ("degree8", "pi/12", 100.0, "crease 3 on the axis"),
    "axis, pi/6": ("degree8", "pi/6", 100.0, "crease 3 on the axis"),
}
"""Pinned states of the paper's panels: family, alpha_1, r_k, and words of their contact."""


def search(name: str) -> MinimaResult:
    family, alpha, ratio, _ = PINNED[name]
    return panel_result(getattr(o.examples, family)(alpha, ratio))


def minimum_of(name: str) -> JudgedState:
    (minimum,) = [
        m
        for m in search(name).minima
        if m.kind == "contact-pinned" and PINNED[name][3] in m.contacts[0].text
    ]
    return minimum


def state_of(name: str) -> tuple[Model, np.ndarray]:
    model = search(name).model
    return model, model.reduce(np.array(minimum_of(name).fold_angles))


def pinned(result: MinimaResult) -> list[np.ndarray]:
    return [
        result.model.reduce(np.array(m.fold_angles))
        for m in result.minima
        if m.kind == "contact-pinned"
    ]


def held(model: Model, x: np.ndarray) -> tuple[Contact, ...]:
    choices = model.closed(x).combinations()
    assert choices
    return choices[0]


@shared
def margin_of(name: str) -> LoadMargin:
    return load_margin(State(*state_of(name)))


def random_scene(n: int, symmetry: str, seed: int) -> o.Scene:
    """A random vertex with random springs, without symmetry or with a mirror (degree 6)."""
    rng = np.random.default_rng(seed)
    mirror = [0, 1, 2, 3, 2, 1] if symmetry == "D1" else list(range(n))
    half = rng.dirichlet(np.full(3, 4.0)) * math.pi
    sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * math.pi
    if symmetry == "D1":
        sectors = np.r_[half, half[::-1]]
    rest = rng.uniform(-3.1, 3.1, n)[mirror]
    stiffness = np.exp(rng.normal(size=n))[mirror]
    return o.Scene(o.Vertex(tuple(sectors)), tuple(stiffness), tuple(rest), symmetry)


RANDOM = (
    (4, "none", 6),
    (5, "none", 2),
    *(
        pytest.param(*one, marks=pytest.mark.slow)
        for one in (
            (6, "D1", 7),
            (4, "none", 16),
            (5, "none", 3),
            (6, "none", 1),
            (6, "none", 2),
            (6, "D1", 3),
        )
    ),
)
"""Degree, symmetry and seed of random scenes that have a pinned state."""


# ---------------------------------------------------------------- multipliers


def shifted_energy(model: Model, x: np.ndarray, row: Contact, opening: float) -> float:
    """Least energy near x (scene's units) with the contact's limit moved: opening of `row` at least `opening`."""
    f = model.functions
    g, lower, upper = (
        [f.piece.equations],
        [0.0] * model.equation_count,
        [0.0] * model.equation_count,
    )
    if row.is_limit:
        g.append(math.pi - row.side * f.x[row.index])
    else:
        g.append(row.side * f.gaps[row.index])
    problem = {"x": f.x, "p": f.p, "f": f.energy, "g": ca.vertcat(*g)}
    # warm: a soft state lies in a shallow basin, which IPOPT's usual first steps would leave
    ipopt: dict[str, int | float | str] = {
        "print_level": 0, "sb": "yes", "tol": 1e-13, "bound_relax_factor": 0.0,
        "compl_inf_tol": 1e-14, "dual_inf_tol": 1e-9,
        "mu_init": 1e-7, "slack_bound_push": 1e-7, "slack_bound_frac": 1e-7,
    }  # fmt: skip
    solver = ca.nlpsol("s", "ipopt", problem, {"print_time": False, "ipopt": ipopt})  # type: ignore[dict-item]
    answer = solver(x0=x, p=model.parameters.vector, lbg=[*lower, opening], ubg=[*upper, math.inf])
    y = np.asarray(answer["x"]).ravel()
    assert np.abs(y - x).max() < 0.1
    return model.energy(y)


@pytest.mark.parametrize("name", thinned(list(PINNED), 3))
def test_moment_is_the_slope_of_the_optimal_energy_under_a_shifted_limit(name: str) -> None:
    model, x = state_of(name)
    rows = held(model, x)
    assert len(rows) == 1
    moment = minimum_of(name).contacts[0].multiplier
    slopes = []
    for h in (2e-4, 1e-4):
        ahead, behind = (shifted_energy(model, x, rows[0], s * h) for s in (1, -1))
        slopes.append((ahead - behind) / (2 * h))
    richardson = (4 * slopes[1] - slopes[0]) / 3
    assert moment * model.weight(rows[0]) == pytest.approx(richardson, rel=MULTIPLIER_FD)


def mp_multipliers(model: Model, x: np.ndarray, row: Contact) -> list[mp.mpf]:
    """Solve the KKT system of one held contact to 50 digits, from the geometry up; D_n wedges of creases only."""
    n, order = model.size, model.structure.order
    p = model.parameters
    sectors, k, rest = ([mp.mpf(v) for v in a.tolist()] for a in (p.sectors, p.stiffness, p.rest))
    azimuth = [sum(sectors[:i], mp.mpf(0)) for i in range(n - 1)] + [mp.pi / order]
    flat = [(mp.cos(a), mp.sin(a), mp.mpf(0)) for a in azimuth]

    def constraints(v: list[mp.mpf]) -> list[mp.mpf]:
        q, rays = tuple(mp.mpf(c) for c in quat.IDENTITY), []
        for i, b in enumerate(flat):
            rays.append(quat.rotate(q, b))
            half = v[i] / (4 if i in (0, n - 1) else 2)
            q = quat.multiply(q, quat.fold(mp.cos(half), mp.sin(half), b))
        if order == 1:
            out = [q[1], q[3]]
        else:
            normal = quat.rotate(q, (mp.sin(mp.pi / order), -mp.cos(mp.pi / order), mp.mpf(0)))
            out = [normal[1] + mp.cos(mp.pi / order)]
        if row.is_limit:
            return [*out, mp.mpf(math.pi) - row.side * v[row.index]]
        gap = model.structure.gaps[row.index]
        if gap.type == "axis":
            return [*out, rays[gap.rays[0]][1]]
        r, j = gap.rays
        plane = quat.cross(rays[j], rays[j + 1])
        return [*out, row.side * quat.dot(plane, rays[r]) / mp.sin(sectors[j])]

    def residual(u: list[mp.mpf]) -> list[mp.mpf]:
        v, multipliers = u[:n], u[n:]
        out = [k[i] * (v[i] - rest[i]) for i in range(n)]
        h = mp.mpf(10) ** -30
        for i in range(n):
            ahead = constraints([*v[:i], v[i] + h, *v[i + 1 :]])
            behind = constraints([*v[:i], v[i] - h, *v[i + 1 :]])
            out[i] -= sum(
                m * (a - b) / (2 * h) for m, a, b in zip(multipliers, ahead, behind, strict=True)
            )
        return out + constraints(v)

    # Newton with the Jacobian of double precision: each step gains about ten digits
    local = model.local(x)
    _, a = local.openings((row,))
    jac = np.vstack([local.closure_jacobian, a])
    start = np.linalg.lstsq(jac.T, local.gradient, rcond=None)[0]
    hessian = model.hessian(x, -start[:-1], -model.weights((row,), start[-1:]))
    count = len(jac)
    inverse = np.linalg.inv(np.block([[hessian, -jac.T], [jac, np.zeros((count, count))]]))
    u = [mp.mpf(float(v)) for v in (*x, *start)]
    for _ in range(12):
        f = residual(u)
        if max(abs(v) for v in f) < mp.mpf(10) ** -50:
            break
        u = [
            u[i] - sum(mp.mpf(float(inverse[i, j])) * f[j] for j in range(len(f)))
            for i in range(len(u))
        ]
    assert max(abs(v) for v in residual(u)) < mp.mpf(10) ** -48
    return u[n:]


@pytest.mark.parametrize("name", thinned([*PINNED], 2))
def test_moment_agrees_with_a_50_digit_solve(name: str) -> None:
    model, x = state_of(name)
    rows = held(model, x)
    with mp.workdps(90):
        exact = float(mp_multipliers(model, x, rows[0])[-1])
    contact = minimum_of(name).contacts[0]
    scaled = contact.multiplier * model.weight(rows[0]) / model.scale
    assert scaled == pytest.approx(exact, rel=MULTIPLIER_MP)


# ---------------------------------------------------------------- sensitivities


@pytest.mark.parametrize("name", ["creases on each other", "axis", "fold limit, degree 8"])
def test_sensitivities_are_the_derivative_of_re_solved_states(name: str) -> None:
    model, x = state_of(name)
    rows = held(model, x)
    response_to, motion_under = State(model, x).on(rows).response()
    rng = np.random.default_rng(0)
    root = np.sqrt(model.multiplicity)
    for _ in range(3):
        d = rng.normal(size=model.size)
        errors = []
        for h in (2e-3, 1e-3):
            ends = [newton(under_load(model, s * h * d), x, rows) for s in (1, -1)]
            assert all(state is not None and state.converged for state, _ in ends)
            response = (ends[0][1] - ends[1][1]) / (2 * h)
            motion = root * (ends[0][0].x - ends[1][0].x) / (2 * h)  # type: ignore[union-attr]
            errors.append(
                max(
                    np.abs(response - response_to @ d).max(),
                    np.abs(motion - motion_under @ d).max(),
                )
            )
        assert errors[1] < 1e-4 * max(1.0, float(np.abs(motion_under @ d).max()))
        assert errors[1] < 0.3 * errors[0] + 1e-9  # second order


def test_loads_and_moments_are_inverse_and_keep_the_norm() -> None:
    model = search("axis").model
    load = np.random.default_rng(1).normal(size=model.size)
    moments = moments_of(model, load)
    root = np.sqrt(model.multiplicity)
    assert model.reduce(moments) * root / model.scale == pytest.approx(load)
    assert np.linalg.norm(moments) == pytest.approx(model.scale * np.linalg.norm(load))
    # energy U - m . phi, up to a constant
    rng = np.random.default_rng(2)
    x, y = rng.normal(size=(2, model.size))
    change = model.energy_change(x, y) - moments @ (model.expand(y) - model.expand(x))
    assert under_load(model, load).energy_change(x, y) == pytest.approx(change)


# ---------------------------------------------------------------- margins


@pytest.mark.parametrize("name", thinned(list(PINNED), 3))
def test_panel_margins_are_confirmed_beside_the_critical_load(name: str) -> None:
    margin = margin_of(name)
    assert margin.status == "exact" and margin.ends == "opens" and margin.checked
    assert margin.below is not None and margin.above is not None
    assert margin.below.closed and margin.below.multiplier > 0
    assert not margin.above.closed and margin.above.gap > 1e-5
    assert np.linalg.norm(margin.moments) == pytest.approx(margin.norm)
    for crease in margin.creases:  # no load on one orbit alone can be weaker than the worst load
        root = math.sqrt(len(crease.creases))
        for value, end in zip((crease.positive, crease.negative), crease.ends, strict=True):
            if end == "opens":
                assert value * root >= margin.norm * (1 - 1e-6)


@pytest.mark.parametrize(("n", "symmetry", "seed"), RANDOM)
def test_random_pinned_scenes_are_confirmed(n: int, symmetry: str, seed: int) -> None:
    result = o.find_minima(
        random_scene(n, symmetry, seed), max_starts=24, prove=False, escape=False
    )
    states = pinned(result)
    assert states
    margin = load_margin(State(result.model, states[0]))
    assert margin.status == "exact"
    if margin.ends == "opens":
        assert margin.checked, margin
        assert margin.symmetry == symmetry
    else:  # the load path ends before: the margin is a lower bound, and says so
        assert margin.ends in margin.reason and not margin.checked


@pytest.mark.parametrize(
    "name", thinned(["fold limit, degree 8", "fold limit", "creases on each other"], 3)
)
def test_a_loaded_scene_searched_from_scratch_agrees(name: str) -> None:
    """The load as other rest angles of an ordinary scene; every minimum searched anew."""
    margin, at = margin_of(name), minimum_of(name).fold_angles
    scene = search(name).scene
    for factor, closed in ((0.99, True), (1.01, False)):
        rest = np.array(scene.rest_angles) + factor * np.array(margin.moments) / scene.stiffness
        loaded = o.find_minima(
            o.Scene(
                scene.vertex, scene.stiffness, tuple(rest), scene.group.name, scene.contact,
                mirror=1,
            ),
            max_starts=64,
            prove=False, escape=False)  # fmt: skip
        distances = [np.linalg.norm(np.subtract(m.fold_angles, at)) for m in loaded.minima]
        near = loaded.minima[int(np.argmin(distances))]
        assert (near.kind == "contact-pinned") == closed


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", thinned(["axis, pi/6", "creases on each other, stiff mountains"], 2)
)
def test_every_load_in_the_ball_is_borne(name: str) -> None:
    margin = margin_of(name)
    model, x = state_of(name)
    rows = held(model, x)
    rng = np.random.default_rng(5)
    for _ in range(6):
        d = rng.normal(size=model.size)
        d *= 0.98 * margin.norm / model.scale / np.linalg.norm(d)
        y = x
        for part in np.linspace(0.1, 1.0, 10):
            solved, mu = newton(under_load(model, part * d), y, rows)
            assert solved is not None and solved.converged and mu.min() > 0
            y = solved.x
        what = classify(State(under_load(model, d), y))
        assert what.verdict == "minimum" and what.kind == "contact-pinned"


def test_a_touching_state_bears_nothing_and_a_handle_everything() -> None:
    result = search("creases on each other")
    model = result.model
    rng = np.random.default_rng(6)
    kinds = []
    for m in result.minima:
        x = model.reduce(np.array(m.fold_angles))
        margin = load_margin(State(model, x))
        kinds.append((m.kind, margin.status))
        if margin.status == "unbounded":
            rows = held(model, x)
            local = model.local(x)
            root = np.sqrt(model.multiplicity)
            _, a = local.openings(rows)
            z = null_space(local.closure_jacobian / root)
            b = (a / root @ z).T
            span = b @ np.linalg.pinv(b)
            for _ in range(20):  # loads normal to the handle, far beyond any spring's moment
                c = z.T @ (local.gradient / root) + span @ rng.normal(size=z.shape[1]) * 100
                assert find_multipliers(b, span @ c).residual < 1e-8
    assert ("contact-touching", "zero") in kinds
    assert kinds.count(("degenerate", "unbounded")) == 2


def test_margins_scale_with_the_stiffness() -> None:
    scene = search("fold limit").scene
    scaled = o.Scene(
        scene.vertex, tuple(1000 * k for k in scene.stiffness), scene.rest_angles, "D1", mirror=1
    )
    margin = load_margin(State(Model(scaled), state_of("fold limit")[1]), check=False)
    assert margin.norm == pytest.approx(1000 * margin_of("fold limit").norm, rel=1e-6)


# ---------------------------------------------------------------- cones of contact forces


def test_distance_to_the_boundary_of_a_cone() -> None:
    wedge = np.array([[1.0, 0.0], [0.0, 1.0]])
    found = distance_to_boundary(wedge, np.array([2.0, 3.0]))
    assert found is not None and found[0] == pytest.approx(2.0)
    assert found[1] == pytest.approx([1.0, 0.0])
    # redundant generators change nothing; a ray in one dimension
    more = np.column_stack([wedge, [1.0, 1.0], [3.0, 1.0]])
    again = distance_to_boundary(more, np.array([2.0, 3.0]))
    assert again is not None and again[0] == pytest.approx(2.0)
    ray = distance_to_boundary(np.array([[0.0, 0.0], [2.0, 4.0]]), np.array([0.0, 5.0]))
    assert ray is not None and ray[0] == pytest.approx(5.0)
    # generators that span everything positively: nothing opens
    assert distance_to_boundary(np.array([[1.0, -1.0]]), np.array([0.3])) is None
    star = np.array([[1.0, -0.5, -0.5], [0.0, 1.0, -1.0]])
    assert distance_to_boundary(star, np.array([0.1, 0.1])) is None


def test_distance_in_a_cone_agrees_with_the_set_of_multipliers() -> None:
    rng = np.random.default_rng(7)
    for _ in range(10):
        b = np.abs(rng.normal(size=(3, 5)))
        c = b @ rng.uniform(0.2, 1.0, 5)
        found = distance_to_boundary(b, c)
        assert found is not None
        distance, normal = found
        assert find_multipliers(b, c - 0.999 * distance * normal).residual < 1e-9
        assert find_multipliers(b, c - 1.001 * distance * normal).residual > 1e-9
        for d in rng.normal(size=(20, 3)):  # no other direction leaves the cone earlier
            assert find_multipliers(b, c + 0.99 * distance * d / np.linalg.norm(d)).residual < 1e-9


def test_rows_have_names() -> None:
    model, x = state_of("fold limit")
    assert model.name(held(model, x)[0]) == "phi = +pi at creases 2, 6"
