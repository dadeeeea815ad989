"""What a design is asked for: a vertex or a pattern, states it shall hold, and what its springs may be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np

from origami_nlp.arguments import (
    check_angles,
    check_flag,
    check_number,
    check_type,
    refuse,
    shown,
)
from origami_nlp.errors import OptionError
from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSURE_TOL, DESIGN_SNAP, OUTSIDE, ROUNDED
from origami_nlp.pattern import Pattern, Scene, Vertex
from origami_nlp.pattern_problem import pose

TURNS = 4 * math.pi
"""Largest rest angle of a wound spring [rad]: two turns."""
FAR = 0.1
"""Farthest that closure may move a fold angle that was asked for [rad]: N angles, each read to 2 deg, are off by
2 sqrt(N) deg together, 5.7 deg for N = 8; what is farther is another state."""


@dataclass(frozen=True)
class Target:
    """A state that the springs shall hold.

    Attributes
    ----------
    name
        For tables and for `EnergyBounds`.
    fold_angles
        All N of them [rad]; moved onto closure, and onto contacts that they nearly close.
    margin
        Share of the margin of the whole design that this state must have: twice as stiff for 2.
    """

    name: str
    fold_angles: tuple[float, ...]
    margin: float = 1.0

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.strip():
            raise OptionError(f"states[].name = {shown(self.name)} must be text")
        margin = check_number(f"state {self.name!r}: margin", self.margin, 0.0)
        if margin == 0.0:
            raise OptionError(f"state {self.name!r}: margin = 0 must be positive")


@dataclass(frozen=True)
class EnergyBounds:
    """Bounds of an energy between two states [J]: equal ones for an exact value.

    Attributes
    ----------
    first, second
        Names of states.
    least, most
        Of a difference of energies, bounds of U(first) - U(second); of a barrier, of the highest energy on the way from
        `first` to `second` less that of `first`.
    """

    first: str
    second: str
    least: float = 0.0
    most: float = math.inf

    def __post_init__(self) -> None:
        who = f"energy between {shown(self.first)} and {shown(self.second)}"
        if self.first == self.second:
            raise OptionError(f"{who}: it is between two states, not of one and itself")
        bounds = (self.least, self.most)
        if any(isinstance(v, bool) or not isinstance(v, Real) for v in bounds):
            raise OptionError(f"{who}: {shown(bounds)} must be numbers [J]")
        if not self.least <= self.most or self.least == math.inf or self.most == -math.inf:
            raise OptionError(f"{who}: [{self.least:g}, {self.most:g}] must be least <= most [J]")


@dataclass(frozen=True)
class Targets:
    """A question: which springs hold these states?

    Parameters
    ----------
    origami
        What is folded: a vertex, of which a scene also states symmetry, contact and stops, or a whole pattern.  The
        springs that it has do not count.
    states
        The states wanted.
    stiffness
        Bounds of each crease [N m/rad], both positive.
    rest_angles
        Bounds of each rest angle [rad], within [-pi, pi] (the default); with ``preload=True`` of wound springs, by
        default two turns either way.
    preload
        Whether springs may be wound beyond [-pi, pi], or the largest torque beyond what a rest angle gives [N m].
    energies
        Differences of energy that are asked for.
    barriers
        Barriers between two states that are asked for; with one degree of freedom the springs are made for them, with
        more they are not known.
    full_space
        Hold the states also where motions break the symmetry.
    equal
        Of a pattern, which creases have equal springs: ``""`` none, ``"letters"`` all of one assignment, or a number
        for each crease, the same for equal ones.
    source
        What was read, as it was typed: a file, or an example; the report is titled by it.
    """

    origami: Any
    states: tuple[Target, ...]
    stiffness: tuple[float, float] = (0.005, 0.5)
    rest_angles: tuple[float, float] | None = None
    preload: float | bool = False
    energies: tuple[EnergyBounds, ...] = ()
    barriers: tuple[EnergyBounds, ...] = ()
    full_space: bool = True
    equal: str | tuple[int, ...] = ""
    source: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "origami", self._plain())
        for key in ("states", "energies", "barriers"):
            object.__setattr__(self, key, tuple(getattr(self, key)))
        names = [t.name for t in self.states]
        if not names:
            raise OptionError("states is empty: give at least one [[states]] with fold_angles_deg")
        if twice := [name for k, name in enumerate(names) if name in names[:k]]:
            raise OptionError(f"two states are called {twice[0]!r}: give each a name of its own")
        for ask in (*self.energies, *self.barriers):
            for name in (ask.first, ask.second):
                if name not in names:
                    what = f"energy or barrier of {shown(name)}"
                    raise OptionError(f"{what}: states are {', '.join(names)}")
        if any(ask.least < 0.0 for ask in self.barriers):
            raise OptionError("a barrier is not below 0 J")
        check_flag("full_space", self.full_space)
        low, high = _pair("stiffness", self.stiffness)
        if not 0 < low <= high:
            said = f"stiffness = [{low:g}, {high:g}]"
            raise OptionError(f"{said} must be 0 < least <= most [N m/rad]")
        if self.rest_angles is not None:
            low, high = _pair("rest_angles", self.rest_angles)
            most = TURNS if self.preload is True else math.pi
            if not -most - OUTSIDE <= low <= high <= most + OUTSIDE:
                wound = "" if self.preload is True else "; preload = true lets springs be wound"
                said = f"rest_angles = [{low:.6g}, {high:.6g}]"
                raise OptionError(f"{said} must rise in [-{most:.6g}, {most:.6g}] rad{wound}")
        if not isinstance(self.preload, bool):
            check_number("preload", self.preload, 0.0)

    def _plain(self) -> Scene | Pattern:
        """Return what is folded with equal springs at rest in the flat state."""
        stated, equal = self.origami, self.equal
        if isinstance(stated, Vertex):
            stated = Scene(stated, (1.0,) * stated.degree, (0.0,) * stated.degree, "none")
        if isinstance(stated, Scene):
            why = {"equal": "its symmetry says which springs are equal"}
            refuse("vertex", why, equal=equal or None)
            n = stated.degree
            plain = {"stiffness": (1.0,) * n, "rest_angles": (0.0,) * n, "preload": (), "loads": ()}
            return replace(stated, **plain)  # type: ignore[arg-type]
        check_type("origami", stated, Pattern)
        why = {"preload": "its springs rest within [-pi, pi]"}
        refuse("pattern", why, preload=self.preload or None)
        if equal not in ("", "letters") and (
            isinstance(equal, str) or len(equal) != stated.creases
        ):
            many = f"{stated.creases} numbers, one a crease"
            raise OptionError(f"equal = {shown(equal)} must be '', 'letters' or {many}")
        return stated.with_springs(1.0, 0.0)

    @property
    def rest(self) -> tuple[float, float]:
        """Bounds of each rest angle [rad]."""
        if self.rest_angles is not None:
            return self.rest_angles
        most = TURNS if self.preload is True else math.pi
        return -most, most

    @cached_property
    def model(self) -> Any:
        """The problem with the symmetry, of equal springs."""
        return pose(self.origami)

    def made(self, stiffness: np.ndarray, torque: np.ndarray) -> Scene | Pattern:
        """Return the scene, or the pattern, with the stiffness and torque k phi0 of each kind of crease."""
        k, tau = stiffness[self.kinds], torque[self.kinds]
        rest = np.clip(tau / k, -math.pi, math.pi)
        if isinstance(self.origami, Pattern):
            return self.origami.with_springs(k.tolist(), rest.tolist())
        wound = np.where(np.abs(tau / k) > math.pi * (1 + ROUNDED), tau - k * rest, 0.0)
        springs = {"stiffness": k, "rest_angles": rest, "preload": wound}
        given: Any = {name: tuple(v.tolist()) for name, v in springs.items()}
        return replace(self.origami, **given)

    @cached_property
    def free(self) -> Any:
        """The problem in which the states must stand: without the symmetry where that is asked for."""
        return self.model.whole if self.full_space else self.model

    @cached_property
    def kinds(self) -> np.ndarray:
        """Which kind of crease each crease is, equal where the symmetry asks for equal springs, shape [N]."""
        named = list(self.origami.assignment) if self.equal == "letters" else self.equal
        if named:
            return np.unique(named, return_inverse=True)[1]
        own = self.model
        return np.rint(own.expand(np.arange(own.size, dtype=float))).astype(int)

    @cached_property
    def placed(self) -> tuple[ClosedTarget, ...]:
        """The states where they close: exact fold angles of every target."""
        return tuple(place(self.model, t) for t in self.states)


@dataclass(frozen=True)
class ClosedTarget:
    """A target moved onto closure and onto the contacts that it nearly closes.

    Attributes
    ----------
    target
        As asked.
    state
        Exact to rounding, in the problem with the symmetry.
    moved
        Largest change of a fold angle [rad].
    """

    target: Target
    state: State
    moved: float


def place(model: Any, target: Target) -> ClosedTarget:
    """Move a target onto closure.

    Parameters
    ----------
    model
        The problem.
    target
        With N fold angles.

    Returns
    -------
    ClosedTarget
        The state nearest by, with contacts that the target closes to 1e-4 rad held closed.

    Raises
    ------
    OptionError
        If it does not keep the symmetry, does not close nearby, or is not admissible.
    """
    who = f"state {target.name!r}"
    many = len(model.expand(np.zeros(model.size)))
    phi = check_angles(f"{who}: fold_angles", target.fold_angles, many, one=True)
    x = model.reduce(phi)
    broken = float(np.abs(model.expand(x) - phi).max())
    if broken > DESIGN_SNAP:
        raise OptionError(
            f"{who}: fold angles break the symmetry {model.symmetry} by {math.degrees(broken):.3g} deg: "
            "write [model] symmetry = 'none'"
        )
    k = int((beyond := -model.fold_limits.room(x)).argmax())
    if beyond[k] > FAR:
        far = (
            f"{math.degrees(x[k]):.6g} deg is beyond its limit by {math.degrees(beyond[k]):.3g} deg"
        )
        raise OptionError(f"{who}: a fold angle of {far}; degrees are given as fold_angles_deg")
    x = model.fold_limits.clip(x)
    near, residual = project(model, x)
    # what is typed holds contacts to a few digits: they are closed exactly, where that is near enough
    contacts = State(model, near, DESIGN_SNAP).pieces[0] if residual <= CLOSURE_TOL else ()
    if contacts:
        held, left = project(model, near, contacts)
        if left <= CLOSURE_TOL and np.abs(held - near).max() <= 2 * DESIGN_SNAP:
            near, residual = held, left
    if residual > CLOSURE_TOL:
        raise OptionError(f"{who}: no closed state nearby (closure {residual:.1e})")
    state = State(model, near)
    if state.refused:
        raise OptionError(f"{who} is not admissible: {state.refused}")
    moved = float(np.abs(model.expand(near) - phi).max())
    if moved > FAR:
        near_by = f"the closed state found nearby is {math.degrees(moved):.3g} deg away"
        raise OptionError(f"{who} does not close: {near_by}, more than {math.degrees(FAR):.3g}")
    return ClosedTarget(target, state, moved)


def _pair(name: str, value: Sequence[float]) -> tuple[float, float]:
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise OptionError(f"{name} = {shown(value)} must be two numbers [least, most]")
    return check_number(f"{name}[1]", value[0]), check_number(f"{name}[2]", value[1])
