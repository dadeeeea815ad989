"""All critical points of the energy on the contact-admissible symmetric set X, and the Morse identity.

X has two dimensions, with edges where one contact is closed, vertices where more are, one-dimensional handles, and
the flat state, where two branches of X meet in a point.  A state p contributes 1 - chi(lower link of p) to the Euler
characteristic of X (Goresky and MacPherson, Stratified Morse theory, part I; for a polyhedron Banchoff, 1967):

- interior: grad U vanishes on the tangent plane; (-1)^index.
- edge: grad U vanishes along the edge; with mu > 0 (the energy rises into X) (-1)^index along the edge, with
  mu < 0 nothing, because half of the link is lower and it is one arc.
- vertex, handle, singular state, or a multiplier or curvature that vanishes: counted on the link itself.

Interior points come from Newton on the KKT system from thousands of states spread over X, edge points from Newton from
every point of every traced edge; each sign change of dU/ds along an edge must be met by one of them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.arguments import check_flag, check_type, check_whole
from origami_nlp.critical.edges import Edge, touches
from origami_nlp.critical.link import RADII, Link, closed_rows, link_of
from origami_nlp.critical.points import KktPoints, kkt_newton
from origami_nlp.critical.result import (
    ROUNDING,
    CriticalPoint,
    CriticalPoints,
    Kind,
    MinimaComparison,
    Part,
)
from origami_nlp.critical.strata import FACE_SAMPLES, StratifiedSet, StratumVertex, strata_of
from origami_nlp.kkt import State, Stratum
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import (
    BALANCED,
    FIRM,
    NEAR_SINGULAR_TOL,
    RISES,
    SETTLED,
    STATIONARY,
    distinct,
    rank,
)
from origami_nlp.pattern import Scene, as_scene
from origami_nlp.problem import Contact, Model, Parameters, Problem

MOST_SAMPLES = 10_000_000
"""Random states that memory bears."""


def find_critical_points(
    scene: Scene,
    result: MinimaResult | None = None,
    *,
    samples: int = FACE_SAMPLES,
    seed: int = 0,
    all_links: bool = False,
) -> CriticalPoints:
    """Find every critical point of the energy on the contact-admissible symmetric set X.

    Critical in the sense of stratified Morse theory: on the inside, the edges and the vertices of X.

    Parameters
    ----------
    scene
        What is folded.
    result
        Of `find_minima` on the same scene; the lists of minima are then compared.
    samples
        Random states that are spread over X as starts of Newton.
    seed
        Of those states.
    all_links
        Also count the sampled link of every regular point, and report disagreement as a doubt.

    Returns
    -------
    CriticalPoints
        In order of energy; their contributions sum to the Euler characteristic of X where none is missing.

    Raises
    ------
    OptionError
        If the scene has dead loads, not two symmetric degrees of freedom or not full contact, or an argument is not
        what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> found = o.find_critical_points(o.examples.degree6("pi/4", ratio=0.01), samples=16)
    >>> found.morse_sum, len(found.minima)
    (1, 2)
    """
    scene = as_scene(scene, "a search for all critical points", "find_minima takes a pattern")
    scene.check_no_forces("critical points")
    if result is not None:
        check_type("result", result, MinimaResult)
    check_whole("samples", samples, 1, MOST_SAMPLES)
    check_whole("seed", seed, 0)
    check_flag("all_links", all_links)
    strata = strata_of(scene, samples=samples, seed=seed)
    model = Model(scene)
    doubts: list[str] = []
    points = [_vertex_point(model, vertex, doubts) for vertex in strata.vertices]
    vertices = np.array([v.x for v in strata.vertices]).reshape(-1, model.size)
    points += _interior_points(model, strata, doubts, all_links)
    points += _edge_points(model, strata, vertices, doubts, all_links)
    _warn_of_neighbours(model, points, vertices, doubts)
    points.sort(key=lambda p: rank(p.energy / model.scale, p.fold_angles))
    found = CriticalPoints(scene, tuple(points), None, tuple(doubts))
    return found if result is None else compare_minima(found, result)


def _interior_points(
    model: Problem, strata: StratifiedSet, doubts: list[str], all_links: bool
) -> list[CriticalPoint]:
    """Critical points at which nothing touches."""
    starts = np.concatenate([strata.faces, *(edge.x[1:-1:2] for edge in strata.edges)])
    x, _, residual = _distinct(model, kkt_newton(model, starts))
    # Newton approaches a stationary flat state slowly and stops beside it: its vertex counts for it
    # vertices at which closure loses rank: two circles of directions, or none
    tips = [v.x for v in strata.vertices if v.links and len(v.links[0].circles) != 1]
    out = []
    for state, error in zip((State(model, y) for y in x), residual, strict=True):
        if any(touches(state, row) for row in closed_rows(state)):
            continue  # the strata of closed contacts are looked at by themselves
        if any(np.abs(state.x - tip).max() <= RADII[-1] for tip in tips):
            continue
        plane = state.on().tangent
        curvature = np.linalg.eigvalsh(plane.T @ state.on().hessian @ plane)
        regular = np.abs(curvature).min() > _firm(model)
        if not regular or all_links:
            index, contribution, kind, how = count_links(
                model.parameters, links_of(state, doubts), doubts
            )
        if regular:
            index = int((curvature < 0).sum())
            # Morse: a nondegenerate interior point of index k adds (-1)^k
            if all_links and contribution != (-1) ** index:
                doubts.append(f"link and index disagree at {in_degrees(state.x)}")
            contribution, how = (-1) ** index, f"reduced Hessian, index {index}"
            kind = ("minimum", "saddle", "maximum")[index]
        out.append(_point(state, index, contribution, "interior", kind, (), (), float(error), how))
    return out


def _firm(model: Problem) -> float:
    """Return the multiplier and curvature, scaled, from which they decide."""
    return FIRM * float((model.parameters.stiffness / model.multiplicity).min())


def _edge_points(
    model: Problem, strata: StratifiedSet, vertices: np.ndarray, doubts: list[str], all_links: bool
) -> list[CriticalPoint]:
    """Critical points along the edges, handles included."""
    out: list[CriticalPoint] = []
    found = np.zeros((0, model.size))
    for row in dict.fromkeys(edge.row for edge in strata.edges):
        edges = [(edge, side) for edge, side in zip(strata.edges, strata.sides, strict=True)]
        edges = [(edge, side) for edge, side in edges if edge.row == row]
        starts = np.concatenate([edge.x for edge, _ in edges])
        x, multipliers, residual = _distinct(model, kkt_newton(model, starts, (row,)))
        for y, push, error in zip(x, multipliers[:, 0], residual, strict=True):
            state, known = State(model, y), np.concatenate([vertices, found])
            if len(known) and np.abs(known - y).max(axis=1).min() <= SETTLED:
                continue
            if state.refused or not touches(state, row):
                continue
            found = np.concatenate([found, y[None]])
            side = min(edges, key=lambda e: np.abs(e[0].x - y).max(axis=1).min())[1]
            out.append(
                _edge_point(state.on((row,)), side, float(push), float(error), doubts, all_links)
            )
        for edge, _ in edges:
            doubts += _unmet(model, edge, found, vertices)
    return out


def _warn_of_neighbours(
    model: Model, points: list[CriticalPoint], vertices: np.ndarray, doubts: list[str]
) -> None:
    """Record points so near to a vertex that the vertex's link may have counted them already."""
    for p in points:
        if p.stratum in ("interior", "boundary", "handle"):
            x = model.reduce(np.array(p.fold_angles))
            if np.abs(vertices - x).max(axis=1).min(initial=np.inf) <= RADII[0]:
                doubts.append(f"{in_degrees(x)} lies inside the sampled link of a vertex")


def _edge_point(
    held: Stratum, side: int, push: float, residual: float, doubts: list[str], all_links: bool
) -> CriticalPoint:
    """Judge one critical point of an edge; `side` is the sign of the opening inside X, 0 on handles and slits."""
    state, row, model = held.state, held.contacts[0], held.state.problem
    assert held.dimension == 1  # Newton does not settle where closure and contact are dependent
    curvature, firm = held.stiffness, _firm(model)
    index = int(curvature < 0) if abs(curvature) > firm else None
    part: Part = "boundary" if side else "handle"
    # a handle is held from two sides: its multipliers are not unique
    moment = (side * push * model.scale / model.weight(row),) if side else ()
    contacts = _contact_names(state) or (model.name(row),)
    by_formula = side and index is not None and abs(push) > firm
    if not by_formula or all_links:
        _, contribution, kind, how = count_links(model.parameters, links_of(state, doubts), doubts)
    if by_formula:
        pushes = side * push > 0
        # mu < 0: U falls into X, the lower link is one arc, chi = 1, and the point adds nothing
        expected = (-1) ** index if pushes else 0  # type: ignore[operator]
        if all_links and contribution != expected:
            doubts.append(f"link and multiplier disagree at {in_degrees(state.x)}")
        contribution = expected
        kind = "regular" if not pushes else ("minimum", "saddle")[index]  # type: ignore[index]
        how = (
            f"multiplier {'> 0' if pushes else '< 0: not essential'}, index {index} along the edge"
        )
    return _point(state, index, contribution, part, kind, contacts, moment, residual, how)


def _unmet(model: Problem, edge: Edge, found: np.ndarray, vertices: np.ndarray) -> list[str]:
    """Name sign changes of dU/ds along an edge at which no critical point was found."""
    pull = model.parameters.torque(edge.x)
    # a continuous dU/ds that changes sign has a zero in between: a check that shares nothing with Newton
    slope = np.einsum("kj,kj->k", pull, edge.tangent)
    size = BALANCED * float(np.abs(pull).max())
    known = np.concatenate([found, vertices])
    out = []
    for k in np.flatnonzero(slope[:-1] * slope[1:] < 0):
        if max(abs(slope[k]), abs(slope[k + 1])) <= size:
            continue
        a, b = edge.x[k], edge.x[k + 1]
        reach = 1.5 * float(np.linalg.norm(b - a)) + SETTLED
        away = np.linalg.norm(known - 0.5 * (a + b), axis=1).min(initial=np.inf)
        if away > reach:
            name = model.name(edge.row)
            out.append(f"dU/ds changes sign on '{name}' near {in_degrees(a)}: no point found")
    return out


def _vertex_point(model: Problem, vertex: StratumVertex, doubts: list[str]) -> CriticalPoint:
    """Judge a vertex by its link."""
    state = State(model, vertex.x)
    rows = _descriptions(state)
    held = state.on(rows)
    found = held.multiplier_set
    multipliers: tuple[float, ...] = ()
    size = 1.0 + float(np.abs(state.gradient).max())
    if rows and found.residual <= STATIONARY * size and (found.smallest >= 0).all():
        weights = np.array([model.weight(r) for r in rows])
        values = found.smallest * model.scale / weights
        multipliers = tuple(np.where(np.abs(values) < ROUNDING, 0.0, values).tolist())
    names = tuple(dict.fromkeys(model.name(r) for r in rows))
    if vertex.reason:
        doubts.append(f"the link of {in_degrees(vertex.x)} is not known: {vertex.reason}")
    _, contribution, kind, how = count_links(model.parameters, vertex.links, doubts)
    smooth = bool(vertex.links) and all(
        len(link.circles) == 1 and link.pieces == 1 and link.thin == 0 for link in vertex.links
    )
    part: Part = "corner" if smooth else "singular"
    if not smooth and vertex.links:
        how += "; " + shape_of(vertex.links[-1])
    return _point(state, None, contribution, part, kind, names, multipliers, state.residual, how)


def _distinct(model: Problem, points: KktPoints) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Admissible KKT points that differ, most exact first: states, multipliers, residuals."""
    order = np.argsort(points.residual, kind="stable")
    order = order[model.admissible(points.x[order])] if len(order) else order
    order = order[distinct(points.x[order], SETTLED)]
    return points.x[order], points.multipliers[order], points.residual[order]


def _descriptions(state: State) -> tuple[Contact, ...]:
    """Return the closed contacts of a state, one description for each."""
    found = state.contacts
    return tuple(dict.fromkeys((*found.base, *(r for o in found.branches for r in o[0]))))


def _contact_names(state: State) -> tuple[str, ...]:
    """Name the closed contacts of a state."""
    return tuple(dict.fromkeys(state.problem.name(row) for row in _descriptions(state)))


def _point(state: State, *what: Any) -> CriticalPoint:
    """State a point; what: the fields of a `CriticalPoint` behind its energy."""
    return CriticalPoint(tuple((state.fold_angles + 0.0).tolist()), state.energy, *what)


def compare_minima(found: CriticalPoints, minima: MinimaResult) -> CriticalPoints:
    """Return the same points with their minima matched, in fold angles, to those of a search."""
    here = [k for k, p in enumerate(found.points) if p.kind == "minimum"]
    pairs = []
    for j, other in enumerate(minima.minima):
        for k in here:
            apart = np.abs(np.subtract(found.points[k].fold_angles, other.fold_angles)).max()
            if apart <= NEAR_SINGULAR_TOL:
                pairs.append((k, j))
                break
    lists = MinimaComparison(
        tuple(pairs),
        tuple(k for k in here if k not in {p[0] for p in pairs}),
        tuple(j for j in range(len(minima.minima)) if j not in {p[1] for p in pairs}),
    )
    return replace(found, comparison=lists)


def links_of(state: State, doubts: list[str]) -> tuple[Link, ...]:
    """Sample the links of a state, or record why they are not known."""
    try:
        return tuple(link_of(state, radius) for radius in RADII)
    except ValueError as error:
        doubts.append(f"the link of {in_degrees(state.x)} is not known: {error}")
        return ()


def count_links(
    hinges: Parameters, links: tuple[Link, ...], doubts: list[str]
) -> tuple[None, int, Kind, str]:
    """Return (no index, contribution, kind, how) from the links of a state at several radii, under other hinges."""
    if not links:
        return None, 0, "undecided", "link not known"
    counts = [link.lower(hinges) for link in links]
    chi, empty, whole = counts[-1]
    # 1 for a minimum (chi 0), -1 for a saddle (two lower arcs), 1 for a maximum (a whole circle has chi 0), 0 for
    # regular
    contribution = 1 - chi
    radii = " and ".join(f"{link.radius:g}" for link in links)
    how = f"sampled link at radii {radii} rad"
    if len(set(counts)) > 1:
        doubts.append(f"links of {in_degrees(links[0].center)} disagree between radii {radii}")
    elif links[-1].pieces == 0:
        how = "the link is empty"
    elif _first_order(links, hinges):
        how = "first order: slopes of U along the link"
    if empty:
        return None, contribution, "minimum", how
    if contribution == 0:
        return None, 0, "regular", how
    if contribution < 0:
        return None, contribution, "saddle", how
    return None, contribution, "maximum" if whole else "pinch", how


def _first_order(links: tuple[Link, ...], hinges: Parameters) -> bool:
    """Return whether slopes of U alone decide: firm at the ends of every arc, and with the same lower link."""
    for link in links:
        pull = hinges.torque(link.center)
        firm = RISES * float(np.linalg.norm(pull))
        for circle in link.circles:
            # where the slope decides, the sign of U - U(p) on the link is that of its part of first order in the radius
            slope = (circle.x - link.center) @ pull / link.radius
            change = hinges.energy_change(link.center, circle.x)
            ends = circle.inside & ~(np.roll(circle.inside, 1) & np.roll(circle.inside, -1))
            if (np.abs(slope[ends]) <= firm).any() or np.abs(slope).max() <= firm:
                return False
            if (np.diff(np.sign(slope[circle.inside])) != 0).sum() != (
                np.diff(np.sign(change[circle.inside])) != 0
            ).sum():
                return False
    return True


def shape_of(link: Link) -> str:
    """Describe what the link of a singular state is."""
    if link.pieces == 0:
        return "isolated state"
    parts = []
    full = sum(bool(c.inside.all()) for c in link.circles)
    arcs = link.pieces - full - link.thin
    for count, one in ((full, "circle"), (arcs, "arc"), (link.thin, "point")):
        if count:
            parts.append(f"{count} {one}{'s' * (count > 1)}")
    return "link: " + ", ".join(parts)


def in_degrees(x: np.ndarray) -> str:
    """Write the fold angles of the model's variables in degrees, for a doubt."""
    return "(" + ", ".join(f"{v:.3f}" for v in np.degrees(x)) + ") deg"
