"""A scene as a nonlinear program: its values and derivatives at one state or many, and what is admissible."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.folding import check_admissible, pair_depths
from origami_nlp.numerics import ANSWERED, CONTACT_TOL, LOADED, OUTSIDE
from origami_nlp.problem.compiled import Functions, compile_structure, mapped
from origami_nlp.problem.contact import Contact, LoopClosure, openings
from origami_nlp.problem.kinematics import Kinematics
from origami_nlp.problem.posed import PosedProblem
from origami_nlp.problem.touching import (
    ClosedContacts,
    ContactWords,
    PairForce,
    closed_contacts,
    contact_words,
    guess_gaps,
    rays_together,
)

MOST_COMPILED = 24
"""Creases up to which the functions of a vertex without symmetry and gaps are compiled; above, closed forms do."""

MOST_ANSWERED = 4096
"""States whose admissibility is kept."""


@dataclass(frozen=True, eq=False)
class Local:
    """Values and first derivatives at one state x, or at K states; energies are divided by `Model.scale`.

    Attributes
    ----------
    x
        [..., n] [rad].
    gradient
        Of the energy, [..., n].
    closure
        Residuals of loop closure, [..., m].
    closure_jacobian
        [..., m, n].
    gaps
        Of `Structure.gaps`, facet pairs without sign, [..., c].
    gaps_jacobian
        [..., c, n].
    """

    x: np.ndarray
    gradient: np.ndarray
    closure: np.ndarray
    closure_jacobian: np.ndarray
    gaps: np.ndarray
    gaps_jacobian: np.ndarray

    def openings(self, contacts: Sequence[Contact]) -> tuple[np.ndarray, np.ndarray]:
        """How far contacts are open (>= 0 where they are), [..., r], and the gradients of that, [..., r, n]."""
        return openings(self.x, self.gaps, self.gaps_jacobian, contacts)


class Model(PosedProblem):
    """The nonlinear program of a scene: what solvers and certificates see of it (`protocol.Problem`).

    States wind round the axis of the symmetry as often as the scene says, or once.
    States x have the n variables of the model, `expand(x)` all N fold angles.  Printing it says what is modelled,
    what is left out, and why.  Compiled functions are shared between scenes of one structure; a pickled
    model leaves them behind and finds them again.

    Parameters
    ----------
    scene
        The scene to pose.

    Raises
    ------
    SceneError
        If `scene` is no scene.

    Examples
    --------
    >>> from origami_nlp import examples
    >>> from origami_nlp.problem import Model
    >>> model = Model(examples.degree6("pi/3", ratio=1))
    >>> model.size, model.equation_count, model.dof
    (4, 2, 2)
    """

    @cached_property
    def functions(self) -> Functions:
        """Symbols and compiled functions, shared by all scenes of the same structure."""
        return compile_structure(self.structure)

    def __getstate__(self) -> dict[str, Any]:
        left = {k: v for k, v in self.__dict__.items() if k not in ("functions", "_kept")}
        return left | {"_answered": {}}

    def loaded(self, load: np.ndarray) -> Model:
        """Return the same problem with load . phi less of energy; it shares the compiled functions.

        Parameters
        ----------
        load
            Conjugate to the variables, over `scale`, shape [n].
        """
        other = copy.copy(self)
        vars(other).pop("own_symmetries", None)
        p = self.parameters
        other.parameters = replace(p, load=p.load + np.asarray(load, dtype=float))
        return other

    def drift(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact],
        change: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Differentiate the KKT system along a change of the parameters.

        Parameters
        ----------
        x, multipliers, contacts
            As for `lagrangian_hessian`, at one state.
        change
            Of `Parameters.vector`.

        Returns
        -------
        torque, constraints : numpy.ndarray
            Change of the gradient of U - multipliers . (closure, openings), [n], and of these, [m + r].
        """
        m = self.equation_count
        mu = self.weights(contacts, multipliers[m:])
        p = self.parameters.at(x)
        still = np.zeros(len(p) - len(change))  # of the pieces of laws
        torque, closure, gaps = self.functions.drift(
            x, p, multipliers[:m], mu, np.append(change, still)
        )
        # fold limits stay where they are whatever the parameters are
        moved = [0.0 if c.is_limit else c.side * float(gaps[c.index, 0]) for c in contacts]
        return torque[:, 0], np.concatenate([closure[:, 0], moved])

    @cached_property
    def _chain(self) -> Kinematics | None:
        """Closed forms of a long chain, whose compiled Hessian would take minutes to build; None where it does not."""
        plain = self.equation_count == 3 and not self.structure.gaps
        return Kinematics(self) if plain and self.size > MOST_COMPILED else None

    def _call(self, name: str, x: np.ndarray, *more: Any) -> list[np.ndarray]:
        """Evaluate a compiled function at one state [n] or at states [K, n]; results [..., rows, columns]."""
        if self._chain is not None:
            values = self._of_chain(self._chain, name, np.atleast_2d(x), *more)
            return [v[0] for v in values] if x.ndim == 1 else values
        if x.ndim == 1:
            return list(self.functions.evaluators[name](x, self.parameters.at(x), *more))
        k = len(x)
        if k == 0:  # CasADi maps over one state at least
            spare = [
                np.zeros((1, np.size(m))) if np.ndim(m) < 2 else np.zeros((1, m.shape[-1]))
                for m in more
            ]
            return [out[:0] for out in self._call(name, np.zeros((1, self.size)), *spare)]
        columns = (x, self.parameters.at(x), *more)
        full = mapped(self.structure, name, k)(*(np.reshape(c, -1) for c in columns))
        return [
            f.reshape(len(f), k, -1).transpose(1, 0, 2)
            if f.size
            else np.zeros((k, *f.shape[:1], 0))
            for f in full
        ]

    def _of_chain(
        self, chain: Kinematics, name: str, x: np.ndarray, *more: Any
    ) -> list[np.ndarray]:
        """Return what the compiled function does at states [K, n]."""
        at, k, n = chain.fold(x), len(x), self.size
        if name == "rays":
            return [at.axes.swapaxes(1, 2)]
        if name == "lift":
            return [at.end[:, :1, None]]
        if name == "hessian":
            weight, lam, _ = more
            h = chain.closure_hessian(at, np.broadcast_to(lam, (k, 3)))
            return [h + np.reshape(weight, (-1, 1, 1)) * self.parameters.hessian(x)]
        value, jacobian = chain.closure(at)
        if name == "closure":
            return [value[..., None], jacobian]
        none = np.zeros((k, 0, 1)), np.zeros((k, 0, n))
        return [self.parameters.torque(x)[..., None], value[..., None], jacobian, *none]

    def local(self, x: np.ndarray) -> Local:
        """Evaluate values and first derivatives.

        Parameters
        ----------
        x
            One state [n] or states [K, n] [rad].

        Returns
        -------
        Local
            Energy gradient, closure and gaps with their Jacobians; energies over `scale`.
        """
        # of the state that was asked for last it is kept: contacts, admissibility and steps ask one after the other
        key = x.tobytes() if x.ndim == 1 else None
        kept = self.__dict__.get("_kept")
        if key is not None and kept and kept[0] == key and kept[1] is self.parameters:
            return kept[2]  # type: ignore[no-any-return]
        found = self._local(x if key is None else x.copy())
        if key is not None:
            self.__dict__["_kept"] = key, self.parameters, found
        return found

    def _local(self, x: np.ndarray) -> Local:
        grad, g, jac, gaps, jac_gaps = self._call("local", x)
        lead, n, m, c = x.shape[:-1], self.size, self.equation_count, len(self.structure.gaps)
        return Local(
            x,
            grad.reshape(*lead, n),
            g.reshape(*lead, m),
            jac.reshape(*lead, m, n),
            gaps.reshape(*lead, c),
            jac_gaps.reshape(*lead, c, n),
        )

    def closure(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate the loop-closure equations and their Jacobian.

        Parameters
        ----------
        x
            States, shape [..., n] [rad].

        Returns
        -------
        values : numpy.ndarray
            Shape [..., m]; 0 where the vertex closes.
        jacobian : numpy.ndarray
            Shape [..., m, n].
        """
        g, jac = self._call("closure", x)
        return g[..., 0], jac

    def constraints(
        self, x: np.ndarray, contacts: Sequence[Contact] = ()
    ) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate closure and the openings of contacts, [..., m + r], and their Jacobian [..., m + r, n]."""
        if not contacts:
            return self.closure(x)
        if all(c.is_limit for c in contacts):
            (g, jac), none = self.closure(x), np.zeros((*x.shape[:-1], 0))
            values, slopes = openings(x, none, none[..., None], contacts)
        else:
            local = self.local(x)
            g, jac = local.closure, local.closure_jacobian
            values, slopes = local.openings(contacts)
        return np.concatenate([g, values], axis=-1), np.concatenate([jac, slopes], axis=-2)

    def hessian(
        self, x: np.ndarray, lam: np.ndarray, mu: np.ndarray, weight: float = 1.0
    ) -> np.ndarray:
        """Evaluate the Hessian [..., n, n] of weight U + lam . closure + mu . gaps; lam [..., m], mu [..., c]."""
        weights = weight if x.ndim == 1 else np.full(len(x), weight)
        return self._call("hessian", x, weights, lam, mu)[0]

    def lagrangian_hessian(
        self,
        x: np.ndarray,
        multipliers: np.ndarray,
        contacts: Sequence[Contact] = (),
        weight: float = 1.0,
    ) -> np.ndarray:
        """Hessian of weight U - multipliers . (closure, openings), energies over `scale`.

        Parameters
        ----------
        x
            States, shape [..., n] [rad].
        multipliers
            Of closure and contacts, shape [..., m + r].
        contacts
            r of them.
        weight
            Of the energy.

        Returns
        -------
        numpy.ndarray
            Shape [..., n, n].
        """
        m = self.equation_count
        # the compiled Hessian adds what the Lagrangian subtracts
        mu = -self.weights(contacts, multipliers[..., m:])
        return self.hessian(x, -multipliers[..., :m], mu, weight)

    def loops(self, x: np.ndarray) -> list[LoopClosure]:
        """Return closure to second order at a state [n]: one loop."""
        unit = np.eye(self.equation_count)
        # weight 0 and multiplier -1: the Hessian of one equation alone
        bent = np.array([self.lagrangian_hessian(x, -w, (), 0.0) for w in unit])
        return [LoopClosure(np.arange(self.size), self.closure(x)[1], bent)]

    def rays(self, x: np.ndarray) -> np.ndarray:
        """Return the deformed rays of the piece, [..., rays, 3]."""
        return np.swapaxes(self._call("rays", x)[0], -1, -2)

    def lifts_to_one(self, x: np.ndarray) -> Any:
        """Return whether states [..., n] are on the lift q = +1 (q = -1 closes too but is no sheet of paper)."""
        q = self._call("lift", x)[0][..., 0, 0]
        return bool(q > 0) if x.ndim == 1 else q > 0

    def closed(
        self, x: np.ndarray, tolerance: float = CONTACT_TOL, local: Local | None = None
    ) -> ClosedContacts:
        """Find every contact of a state that is closed.

        Parameters
        ----------
        x
            The state, shape [n] [rad].
        tolerance
            Opening [rad] up to which a contact counts as closed.
        local
            Of `Model.local` at x, where it is known.

        Returns
        -------
        ClosedContacts
            Those that are closed, and the alternatives where facets may pass on either side.
        """
        local = self.local(x) if local is None else local
        return closed_contacts(self, x, local.gaps, lambda: self.rays(x), tolerance)

    def together(self, x: np.ndarray, contacts: Sequence[Contact]) -> list[tuple[Contact, ...]]:
        """Return, for each two creases that lie on each other at x [n], the gaps among `contacts` that keep them so."""
        return rays_together(self, self.rays(x), contacts)

    def words(self, contact: Contact, x: np.ndarray) -> ContactWords:
        """Name the facets and creases that touch in a contact that is closed at x [n]."""
        return contact_words(self, contact, lambda: self.rays(x))

    def meeting(self, contact: Contact, x: np.ndarray) -> np.ndarray:
        """Zero: features of a vertex meet along rays."""
        return np.zeros(3)

    def margin(self, contact: Contact, x: np.ndarray) -> float:
        """inf: which contacts meet inside each other is what `closed` says."""
        return math.inf

    def guess(self, x: np.ndarray, pull: np.ndarray, pair_force: PairForce) -> tuple[Contact, ...]:
        """Guess which contacts an answer x [n] of a solver closes: slack smaller than force, or both tiny.

        pull [n]: size of the multiplier of each variable's bound; pair_force: largest multiplier of the plane that
        separates a facet pair, None if all may press.
        """
        rows = []
        room = self.fold_limits.room(x)
        for v in range(self.size if self.has_limits else 0):
            slack, force = room[v], abs(pull[v])
            if slack <= ANSWERED or (slack <= LOADED and force > slack):
                rows.append(self.fold_limits.contact(v, x[v]))
        if self.structure.gaps:
            rows += guess_gaps(self, self.local(x).gaps, self.rays(x), rows, pair_force)
        return tuple(dict.fromkeys(rows))

    def about_to_close(self, x: np.ndarray, length: float) -> tuple[Contact, ...]:
        """Return fold limits, mirrors and the axis, where open but closed by a step of `length` [rad] at most."""
        gaps = self.local(x).gaps
        room = self.fold_limits.room(x)
        slack = [(self.fold_limits.contact(v, x[v]), room[v]) for v in range(self.size)]
        slack = slack if self.has_limits else []
        slack += [(c, gaps[c.index]) for c in self.gaps if c.index in self.walls]
        return tuple(c for c, opening in slack if CONTACT_TOL < abs(opening) <= 2 * length)

    def beyond(self, x: np.ndarray, tolerance: float = OUTSIDE) -> tuple[Contact, ...]:
        """Return the fold limits, mirrors and axis contacts that a state x [n] is beyond by more than `tolerance`."""
        over = ~self.fold_limits.inside(x, tolerance) & self.has_limits
        out = list(self.fold_limits.contacts(x, over))
        if self.walls:
            gaps = self.local(x).gaps
            out += [Contact("gap", i, 1) for i in self.walls if gaps[i] < -tolerance]
        return tuple(out)

    def crossed(self, x: np.ndarray, tolerance: float = OUTSIDE) -> tuple[tuple[int, int], ...]:
        """Return the modelled facet pairs that cross at a state x [n] by more than `tolerance`."""
        pairs = self.structure.pairs
        depth = self._depths(x[None])[0] if pairs else ()
        return tuple(pair for pair, d in zip(pairs, depth, strict=True) if d > tolerance)

    def _depths(self, x: np.ndarray) -> np.ndarray:
        """How deep each modelled facet pair crosses at states [K, n]: sine of an angle, [K, pairs]."""
        rays = self.rays(x) if len(x) > 1 else self.rays(x[0])[None]
        return pair_depths(rays, self.structure.pairs)

    def refuses(self, x: np.ndarray, tolerance: float = OUTSIDE) -> str:
        """Return why a closed state is not admissible.  The one test of a single state.

        Lift, fold limits, facets that cross anywhere in the vertex, layers that have no order with the symmetry
        of the scene; what the scene's contact does not ask for is not looked at.

        Parameters
        ----------
        x
            The state, shape [n] [rad].
        tolerance
            What counts as rounding [rad].

        Returns
        -------
        str
            The reason; "" where the state is admissible.
        """
        known, key = self._answered, (x.tobytes(), tolerance, self.parameters.sectors.tobytes())
        if key not in known:
            if len(known) >= MOST_ANSWERED:
                known.clear()
            known[key] = self._refuses(x, tolerance)
        return known[key]

    def _refuses(self, x: np.ndarray, tolerance: float) -> str:
        if not self.lifts_to_one(x):
            return "closes with q = -1: not a sheet of paper"
        if not self.fold_limits.inside(x, tolerance).all():
            if over := self.beyond(x, tolerance):
                return f"beyond the fold limit {self.name(over[0])}"
            return f"a fold angle exceeds {self.bound:.4g}: not modelled"
        if self.scene.contact != "full":
            return ""
        beyond = self.beyond(x, tolerance)
        elements = self.scene.group.elements
        why = check_admissible(self.scene.vertex, self.expand(x), elements=elements).reason
        if why or not beyond:
            return why
        what = self.name(beyond[0])
        return (
            f"beyond the contact '{what}': its layers have no order with the symmetry of the scene"
        )

    def admissible(self, x: np.ndarray, tolerance: float = OUTSIDE) -> np.ndarray:
        """Return which closed states are admissible: `refuses` for many, but touching layers are not ordered.

        Where nothing but the boundary of a full-dimensional set touches, this is all of admissibility.

        Parameters
        ----------
        x
            States, shape [K, n] [rad].
        tolerance
            What counts as rounding [rad].

        Returns
        -------
        numpy.ndarray
            Of bool, shape [K].
        """
        good = np.isfinite(x).all(axis=1) & self.fold_limits.inside(x, tolerance).all(axis=1)
        where = np.flatnonzero(good)
        where = where[self.lifts_to_one(x[where])] if len(where) else where
        if self.walls and len(where):
            gaps = self.local(x[where]).gaps
            where = where[(gaps[:, self.walls] >= -tolerance).all(axis=1)]
        if self.structure.pairs and len(where):
            where = where[(self._depths(x[where]) <= tolerance).all(axis=1)]
        good[:] = False
        good[where] = True
        return good
