"""A state and a stratum: derivatives against differences, one state against many, and two vertices as one programme."""

from __future__ import annotations

import math
import pickle
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
import pytest

from origami_nlp import Model, Scene, State, Vertex, classify, examples, find_minima
from origami_nlp.kkt import newton, project
from origami_nlp.programme import (
    ClosedContacts,
    Contact,
    ContactWords,
    Local,
    LoopClosure,
    Parameters,
    Programme,
)
from tests.computed_once import panel_result

SCENES = {
    "wedge": examples.degree6("pi/3", 1),
    "two mirrors": examples.degree8("pi/6", 1),
    "free": examples.degree6("pi/4", 100, symmetry="none"),
    "rotation": Scene(Vertex((math.pi / 3,) * 6), (1.0, 2.0) * 3, (0.4, -0.3) * 3, symmetry="C3"),
    "no contact": examples.degree6("pi/3", 1, contact="none"),
}


def some_state(model: Model, seed: int = 0) -> np.ndarray:
    x = np.random.default_rng(seed).uniform(-1.5, 1.5, model.size)
    y, residual = project(model, x)
    assert residual < 1e-13
    return y


@pytest.mark.parametrize("name", SCENES)
def test_derivatives_are_those_of_the_values(name: str) -> None:
    model = Model(SCENES[name]).loaded(np.linspace(-0.2, 0.3, Model(SCENES[name]).size))
    x = some_state(model)
    contacts = (*model.limits[:2], *model.every_gap[:3])
    rng = np.random.default_rng(1)
    weights = rng.normal(size=model.equation_count + len(contacts))

    def lagrangian(y: np.ndarray) -> float:
        return model.energy(y) / model.scale - float(weights @ model.constraints(y, contacts)[0])

    h = 1e-4
    _, jac = model.constraints(x, contacts)
    slope = model.local(x).gradient - jac.T @ weights
    hessian = model.lagrangian_hessian(x, weights, contacts)
    for _ in range(4):
        d = rng.normal(size=model.size)
        d /= np.linalg.norm(d)
        ahead, here, behind = (lagrangian(x + s * h * d) for s in (1, 0, -1))
        assert (ahead - behind) / (2 * h) == pytest.approx(slope @ d, abs=1e-6)
        assert (ahead - 2 * here + behind) / h**2 == pytest.approx(d @ hessian @ d, abs=1e-4)


@pytest.mark.parametrize("name", SCENES)
def test_many_states_are_as_each_of_them(name: str) -> None:
    model = Model(SCENES[name])
    x = np.random.default_rng(2).uniform(-3, 3, (5, model.size))
    contacts = (*model.limits[:3], *model.every_gap[:4])
    weights = np.random.default_rng(3).normal(size=(5, model.equation_count + len(contacts)))
    many = model.local(x)
    f, jac = model.constraints(x, contacts)
    hessians = model.lagrangian_hessian(x, weights, contacts)
    moved, left = project(model, x, contacts[:1])
    admissible = model.admissible(moved)
    for k in range(5):
        one = model.local(x[k])
        for field in ("gradient", "closure", "closure_jacobian", "gaps", "gaps_jacobian"):
            assert getattr(many, field)[k] == pytest.approx(getattr(one, field), abs=1e-14)
        g, a = model.constraints(x[k], contacts)
        assert f[k] == pytest.approx(g, abs=1e-14) and jac[k] == pytest.approx(a, abs=1e-14)
        h = model.lagrangian_hessian(x[k], weights[k], contacts)
        assert hessians[k] == pytest.approx(h, abs=1e-12)
        alone, residual = project(model, x[k], contacts[:1])
        if max(residual, left[k]) <= 1e-12:
            assert moved[k] == pytest.approx(alone, abs=1e-9)
            # layers are ordered for one state only
            assert admissible[k] or model.refuses(alone)
    none = model.local(x[:0])
    assert none.gaps_jacobian.shape == (0, len(model.every_gap), model.size)


def test_a_stratum_is_what_the_minima_say() -> None:
    for panel in examples.panels()[3:6]:
        result = panel_result(panel)
        for m in result.minima:
            state = State(result.model, result.model.reduce(np.array(m.fold_angles)))
            again = pickle.loads(pickle.dumps(state))
            assert (again.x == state.x).all() and again.residual == state.residual
            assert state.refused == "" and state.energy == pytest.approx(m.energy)
            if m.kind in ("interior", "contact-pinned"):
                at = state.on(state.pieces[0])
                assert np.abs(at.imbalance).max() < 1e-12
                moments = (
                    at.forces * result.model.scale / [result.model.weight(c) for c in at.contacts]
                )
                assert moments == pytest.approx([c.multiplier for c in m.contacts], rel=1e-9)
                stiffness = at.stiffness * result.model.scale
                assert stiffness == pytest.approx(min(m.hessian_eigenvalues), rel=1e-9)


class TwoVertices:
    """Two vertices side by side, nothing shared: what a programme must offer, without being one vertex."""

    sparse = redundant = False

    def __init__(self, first: Model, second: Model) -> None:
        assert first.scale == second.scale
        self.parts, self.scale = (first, second), first.scale
        self.cut = first.size
        self.multiplicity = np.concatenate([first.multiplicity, second.multiplicity])
        p, q = first.parameters, second.parameters
        names = ("sectors", "stiffness", "rest", "load")
        joined = (np.concatenate([getattr(p, n), getattr(q, n)]) for n in names)
        self.parameters = Parameters(*joined)
        self.size, self.bound = first.size + second.size, max(first.bound, second.bound)
        self.equation_count = first.equation_count + second.equation_count
        self.freedom, self.symmetry = self.size - self.equation_count, "C1"
        self.has_limits = first.has_limits
        self.step_noise = max(first.step_noise, second.step_noise)

    @property
    def root(self) -> np.ndarray:
        return np.sqrt(self.multiplicity)

    def split(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return x[..., : self.cut], x[..., self.cut :]

    def ours(self, part: int, contact: Contact) -> Contact:
        shift = (self.cut if contact.is_limit else len(self.parts[0].every_gap)) if part else 0
        return Contact(contact.kind, contact.index + shift, contact.side)

    def theirs(self, contact: Contact) -> tuple[Model, int, Contact]:
        first = self.cut if contact.is_limit else len(self.parts[0].every_gap)
        part = int(contact.index >= first)
        back = Contact(contact.kind, contact.index - part * first, contact.side)
        return self.parts[part], part, back

    def both(self, name: str) -> tuple[Contact, ...]:
        return tuple(self.ours(k, c) for k, m in enumerate(self.parts) for c in getattr(m, name))

    limits = cached_property(lambda self: self.both("limits"))
    every_gap = cached_property(lambda self: self.both("every_gap"))
    gaps = cached_property(lambda self: self.both("gaps"))

    def expand(self, x: np.ndarray) -> np.ndarray:
        return np.concatenate(
            [m.expand(y) for m, y in zip(self.parts, self.split(x), strict=True)], axis=-1
        )

    def energy(self, x: np.ndarray) -> float:
        return self.scale * float(self.parameters.energy(x))

    def energies(self, x: np.ndarray) -> np.ndarray:
        return self.scale * self.parameters.energy(x)

    def energy_change(self, x: np.ndarray, y: np.ndarray) -> float:
        return self.scale * float(self.parameters.energy_change(x, y))

    def local(self, x: np.ndarray) -> Local:
        a, b = (m.local(y) for m, y in zip(self.parts, self.split(x), strict=True))

        def block(p: np.ndarray, q: np.ndarray) -> np.ndarray:
            top = np.concatenate([p, np.zeros((*p.shape[:-1], q.shape[-1]))], axis=-1)
            low = np.concatenate([np.zeros((*q.shape[:-1], p.shape[-1])), q], axis=-1)
            return np.concatenate([top, low], axis=-2)

        return Local(
            x,
            np.concatenate([a.gradient, b.gradient], axis=-1),
            np.concatenate([a.closure, b.closure], axis=-1),
            block(a.closure_jacobian, b.closure_jacobian),
            np.concatenate([a.gaps, b.gaps], axis=-1),
            block(a.gaps_jacobian, b.gaps_jacobian),
        )

    def closure(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        local = self.local(x)
        return local.closure, local.closure_jacobian

    def constraints(
        self, x: np.ndarray, contacts: Sequence[Contact] = ()
    ) -> tuple[np.ndarray, np.ndarray]:
        local = self.local(x)
        values, slopes = local.openings(contacts)
        return (
            np.concatenate([local.closure, values], axis=-1),
            np.concatenate([local.closure_jacobian, slopes], axis=-2),
        )

    def lagrangian_hessian(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact] = (),
        weight: float = 1.0,
    ) -> np.ndarray:
        out = np.zeros((self.size, self.size))
        m = self.parts[0].equation_count
        lam = (multipliers[:m], multipliers[m : self.equation_count])
        for part, (model, y) in enumerate(zip(self.parts, self.split(x), strict=True)):
            own = [(k, self.theirs(c)) for k, c in enumerate(contacts)]
            own = [(k, c) for k, (_, where, c) in own if where == part]
            mu = multipliers[self.equation_count :][[k for k, _ in own]]
            h = model.lagrangian_hessian(
                y, np.concatenate([lam[part], mu]), [c for _, c in own], weight
            )
            here = slice(part * self.cut, part * self.cut + model.size)
            out[here, here] = h
        return out

    def on_sheet(self, x: np.ndarray) -> bool:
        return all(m.on_sheet(y) for m, y in zip(self.parts, self.split(x), strict=True))

    def closed(
        self, x: np.ndarray, tolerance: float = 1e-8, local: Local | None = None
    ) -> ClosedContacts:
        found = [m.closed(y, tolerance) for m, y in zip(self.parts, self.split(x), strict=True)]

        def moved(part: int, contacts: Sequence[Contact]) -> tuple[Contact, ...]:
            return tuple(self.ours(part, c) for c in contacts)

        return ClosedContacts(
            tuple(c for k, f in enumerate(found) for c in moved(k, f.base)),
            tuple(tuple(moved(k, o) for o in b) for k, f in enumerate(found) for b in f.branches),
            tuple(
                (self.ours(k, a), self.ours(k, b))
                for k, f in enumerate(found)
                for a, b in f.implied
            ),
        )

    def about_to_close(self, x: np.ndarray, length: float) -> tuple[Contact, ...]:
        parts = zip(self.parts, self.split(x), strict=True)
        return tuple(
            self.ours(k, c) for k, (m, y) in enumerate(parts) for c in m.about_to_close(y, length)
        )

    def beyond(self, x: np.ndarray, tolerance: float = 1e-12) -> tuple[Contact, ...]:
        parts = zip(self.parts, self.split(x), strict=True)
        return tuple(
            self.ours(k, c) for k, (m, y) in enumerate(parts) for c in m.beyond(y, tolerance)
        )

    def refuses(self, x: np.ndarray, tolerance: float = 1e-12) -> str:
        parts = zip(self.parts, self.split(x), strict=True)
        return "; ".join(filter(None, (m.refuses(y, tolerance) for m, y in parts)))

    def admissible(self, x: np.ndarray, tolerance: float = 1e-12) -> np.ndarray:
        a, b = (m.admissible(y, tolerance) for m, y in zip(self.parts, self.split(x), strict=True))
        return a & b

    @property
    def own_symmetries(self) -> tuple[tuple[np.ndarray, int], ...]:
        return ((np.arange(self.size), 1),)

    def together(self, x: np.ndarray, contacts: Sequence[Contact]) -> list[tuple[Contact, ...]]:
        return []

    def name(self, contact: Contact) -> str:
        model, part, own = self.theirs(contact)
        return f"vertex {part + 1}: {model.name(own)}"

    def weight(self, contact: Contact) -> int:
        model, _, own = self.theirs(contact)
        return model.weight(own)

    def words(self, contact: Contact, x: np.ndarray) -> ContactWords:
        model, part, own = self.theirs(contact)
        return model.words(own, self.split(x)[part])

    def guess(self, x: np.ndarray, pull: np.ndarray, pair_force: object) -> tuple[Contact, ...]:
        raise NotImplementedError

    def excess(self, x: np.ndarray) -> float:
        return float(self.parameters.excess(x))

    def check_time(self) -> None:
        pass

    def doubt(self, x: np.ndarray) -> str:
        return ""

    def to_second_order(self, contacts: tuple[Contact, ...]) -> tuple[Contact, ...]:
        return contacts

    def loops(self, x: np.ndarray) -> list[LoopClosure]:
        return [
            replace(loop, variables=loop.variables + k * self.cut)
            for k, (model, part) in enumerate(zip(self.parts, self.split(x), strict=True))
            for loop in model.loops(part)
        ]

    def creases_of(self, variable: int) -> tuple[int, ...]:
        return (variable + 1,)

    def loaded(self, load: np.ndarray) -> object:
        raise NotImplementedError


def test_two_vertices_stand_where_one_does() -> None:
    """Minima, saddles and pinned states of two vertices are those of each, with the contacts of both."""
    first, second = examples.degree6("pi/3", 1), examples.degree6("pi/4", 1)
    one, two = panel_result(first), panel_result(second)
    pair: Programme = TwoVertices(one.model, two.model)
    kinds = set()
    for m in one.minima:
        for n in two.minima:
            parts = [r.model.reduce(np.array(s.fold_angles)) for r, s in ((one, m), (two, n))]
            state = State(pair, np.concatenate(parts))
            what = classify(state)
            assert what.verdict == "minimum", what.reason
            assert what.local_dimension == m.local_dimension + n.local_dimension
            assert state.energy == pytest.approx(m.energy + n.energy)
            moments = sorted(c.multiplier for c in what.contacts)
            wanted = sorted(c.multiplier for c in (*m.contacts, *n.contacts))
            assert moments == pytest.approx(wanted, abs=1e-10)
            kinds.add(what.kind)
            if {m.kind, n.kind} <= {"interior", "contact-pinned"}:
                polished, _ = newton(pair, state.x + 1e-4, state.pieces[0])
                assert polished is not None and polished.converged
                assert polished.x == pytest.approx(state.x, abs=1e-10)
                kinds.add("polished")
    assert len(kinds) == 4
    free = np.concatenate(
        [one.model.reduce(np.array(one.minima[0].fold_angles)), some_state(two.model)]
    )
    assert classify(State(pair, free)).verdict in ("not stationary", "not admissible")


def test_a_load_moves_the_minimum_as_its_response_says() -> None:
    result = find_minima(examples.degree6("pi/4", 1), max_starts=16, prove=False, escape=False)
    model = result.model
    x = model.reduce(np.array(result.minima[0].fold_angles))
    _, motion = State(model, x).on().response()
    load = 1e-5 * np.linspace(-1, 1, model.size)
    moved, _ = newton(model.loaded(model.root * load), x, ())
    assert moved is not None and moved.converged
    assert model.root * (moved.x - x) == pytest.approx(motion @ load, abs=1e-8)
