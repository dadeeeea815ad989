"""Equilibria of a sheet from one state on, one way, through folds and contacts that close or leave."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from origami_nlp.facets import MOST_DENSE, Sheet, order_layers
from origami_nlp.numerics import BALANCED, CLOSES, INDEPENDENT, SETTLED, TOUCHES
from origami_nlp.path import End, Steps, Tally, advance, trace_ahead
from origami_nlp.sheet_loading.curve import LoadCurve, LoadedState
from origami_nlp.sheet_loading.ends import first_event
from origami_nlp.sheet_loading.events import Found, admissible, inner_events
from origami_nlp.sheet_loading.held import (
    Contact,
    creases_of,
    ordered,
    touches_of,
    touching_rows,
    without,
)
from origami_nlp.sheet_loading.touching import leaning, slid
from origami_nlp.sheet_loading.work import Work
from origami_nlp.sheets import closed_choices, closed_contacts

STEPS = Steps(first=1e-3, longest=0.1, shortest=1e-9, turn=0.1, sharpest=0.3, most=2_000)
"""Such that curves look smooth; lengths are root mean squares over creases."""
MOST_PIECES = 60
"""Of a branch: with more it is stopped by name."""
MOST_TOGETHER = 6
"""Contacts that close in one state of which all sets are tried."""
AHEAD = 1e-2
"""Step ahead of the end of a curve at which it is asked whether closure has a solution."""
TRIAL = 1e-5
"""Step after which a direction must still be one of equilibria."""
EVENT, STABLE = "event", "stable again"
AT_BORDERS = "facets meet at borders there, where no single gap keeps them apart: such states are not followed"


@dataclass(eq=False)
class Branch:
    """Equilibria in the order in which they were followed.

    Attributes
    ----------
    states
        Events included.
    events
        With the position of each in `states`, in order; the last is the end.
    """

    states: list[LoadedState] = field(default_factory=list)
    events: list[tuple[int, Found]] = field(default_factory=list)

    def add(self, event: Found) -> None:
        """Add an event with its state."""
        self.states.append(event.state)
        self.events.append((len(self.states) - 1, event))

    @property
    def end(self) -> Found:
        """Why it ends."""
        return self.events[-1][1]


@dataclass(frozen=True, eq=False)
class Follower:
    """Follows branches of one sheet under one load.

    Attributes
    ----------
    sheet, work
        The sheet, and what the load works on.
    low, high
        Range of T, the load over the mean stiffness.
    steps
        Of the tracer.
    tally
        What it cost.
    """

    sheet: Sheet
    work: Work
    low: float
    high: float
    steps: Steps
    tally: Tally = field(default_factory=Tally)

    def curve(self, held: Sequence[Contact]) -> LoadCurve:
        """Return the curves on which these contacts are held."""
        return LoadCurve(self.sheet, self.work, ordered(held), self.tally)

    def closed(self, phi: np.ndarray) -> tuple[Contact, ...]:
        """Return the contacts that are closed at a state."""
        shut = np.flatnonzero(math.pi - np.abs(phi) <= TOUCHES).tolist()
        touching = self.sheet.size <= MOST_DENSE
        return ordered([*shut, *closed_contacts(self.sheet, phi, touching).touches])

    def follow(self, phi: np.ndarray, load: float, toward: float) -> Branch:
        """Follow the equilibrium phi [n] at T = load, the load growing (1) or falling (-1) at first.

        The branch goes on through folds until it is stable again, or leaves the range.
        """
        branch = Branch()
        first = self.begin(phi, load, toward)
        if first is None:
            point, along = np.append(phi, load), np.append(np.zeros(len(phi)), toward)
            curve = self.curve(self.closed(phi))
            state = LoadedState(point, along, curve.system(point), np.zeros(len(curve.held)))
            meets = self.sheet.size <= MOST_DENSE and closed_choices(self.sheet, phi)
            why = AT_BORDERS if meets else "no equilibria go on from there over the load"
            branch.add(Found("singular", state, math.nan, why=why))
            return branch
        branch.states.append(first)
        for _ in range(MOST_PIECES):
            stop = self._piece(branch)
            if stop is None:
                return branch
            came = branch.states[-1]
            shut = creases_of(stop.contacts) if stop.type == "closes" else []
            layers = order_layers(self.sheet, came.phi) if shut else None
            if layers is not None and layers.verdict == "crosses":
                branch.add(Found("touches", came, 0.0, stop.contact, stop.contacts, layers.reason))
                return branch
            onward = self._onward(came, stop)
            if onward is None:
                why = f"{stop.contact}: no set of held contacts leads on"
                branch.add(Found("singular", came, math.nan, stop.contact, stop.contacts, why))
                return branch
            branch.states.append(onward)
            if onward.ahead * came.ahead < 0:
                branch.events[-1] = branch.events[-1][0], replace(stop, type="nonsmooth-fold")
            if self._again(branch, onward):
                branch.add(Found(STABLE, onward))
                return branch
        branch.add(
            Found("lost", branch.states[-1], math.nan, why=f"more than {MOST_PIECES} pieces")
        )
        return branch

    def _again(self, branch: Branch, state: LoadedState) -> bool:
        """Tell whether a branch that was unstable is stable here."""
        at = {k for k, _ in branch.events}  # closure may lose rank there
        return state.index == 0 and any(s.index for k, s in enumerate(branch.states) if k not in at)

    def _piece(self, branch: Branch) -> Found | None:
        """Follow the last state until what is held changes: the event there; None where the branch ends."""
        first = branch.states[-1]
        curve = self.curve(first.held)
        stop: list[Found] = []

        def before(states: Sequence[LoadedState]) -> int:
            for k, s in enumerate(states):
                inside = self.low <= s.x[-1] <= self.high and admissible(s)
                if not inside or self.sheet.crossings.find(s.phi) or slid(curve, s):
                    return k
            return len(states)

        def meet(a: LoadedState, b: LoadedState) -> LoadedState:
            stop.append(first_event(curve, a, b, self.low, self.high))
            return stop[-1].state

        curve.frame(first.x, first.tangent)  # the corrector goes across the last tangent
        states, _, why = trace_ahead(curve, first, self.steps, [End(before, EVENT, meet)])
        self.tally.steps += len(states)
        for k, state in enumerate(states):
            for event in inner_events(curve, branch.states[-1], state):
                if np.abs(curve.root * (event.state.x - first.x)).max() > SETTLED:
                    branch.add(event)
                    if event.type in ("lost", "singular"):
                        return None
            if k + 1 < len(states) or not stop:
                branch.states.append(state)
                if self._again(branch, state):
                    branch.add(Found(STABLE, state))
                    return None
        if not stop:
            last = branch.states[-1]
            why = self._open(last) or leaning(curve, last) or why
            branch.add(Found("singular", last, math.nan, why=why))
            return None
        branch.add(stop[-1])
        return stop[-1] if stop[-1].type in ("closes", "leaves") else None

    def _open(self, state: LoadedState) -> str:
        """Say that closure has no solution ahead, if that is what ends a curve."""
        curve = self.curve(state.held)
        phi = (state.x + AHEAD * state.tangent / curve.root)[:-1]
        held = np.zeros(len(phi), bool)
        held[creases_of(state.held)] = True
        residual = self.sheet.project(phi, held)[1]
        if residual <= CLOSES:
            return ""
        return (
            f"closure misses by {residual:.1e} ahead: its redundant equations have no common solution there, as with "
            "noise in the coordinates of a file"
        )

    def begin(self, phi: np.ndarray, load: float, toward: float) -> LoadedState | None:
        """Return the equilibrium phi [n] at T = load with what must be held as the load grows (1) or falls (-1).

        None where equilibria do not go on from there.
        """
        point, along = np.append(phi, load), np.append(np.zeros(len(phi)), toward)
        shut = self.closed(phi)
        for chosen in _sets(shut):
            curve = self.curve(chosen)
            if not self._independent(phi, chosen) or curve.system(point).residual > BALANCED:
                continue
            state = curve.where(point, -1, load, along)
            if state is not None and self._goes_on(curve, state, shut):
                return state
        return None

    def _onward(self, came: LoadedState, event: Found) -> LoadedState | None:
        """Return how equilibria go on from where contacts close or leave.

        Some of them are held: their forces must not fall below zero, and the others must open.  A way on
        which the load would turn back is taken only where no other is: those that close are all held if they can be,
        those that leave are all let go.
        """
        kept = without(came.held, event.contacts)
        idle = without(self.closed(came.phi), came.held) if touches_of(came.held) else ()
        open_to = ordered((*event.contacts, *touches_of(idle)))
        sets = list(_sets(open_to))
        if event.type == "leaves":  # what was closed without a force may have to take over
            sets = [s for s in reversed(sets) if without(event.contacts, s)]
        else:
            sets = [s for s in sets if s]
        back: LoadedState | None = None
        for chosen in sets or [event.contacts]:
            if not self._independent(came.phi, (*kept, *chosen)):
                continue
            curve = self.curve((*kept, *chosen))
            found = curve.where(came.x, -1, float(came.x[-1]), came.tangent)
            if found is None or np.abs(found.x - came.x).max() > SETTLED:
                continue
            for sign in (1.0, -1.0):
                state = curve.frame_of(found.x, found.system, sign * came.tangent)
                if state is None or not self._goes_on(curve, state, open_to):
                    continue
                if state.ahead * came.ahead > 0:
                    return state
                back = back or state
        return back

    def _independent(self, phi: np.ndarray, held: Sequence[Contact]) -> bool:
        """Tell whether gaps of touches are independent where creases are held; otherwise forces are not unique."""
        touches = touches_of(held)
        if not touches:
            return True
        z = self.sheet.kernel(phi, creases_of(held))
        rows = touching_rows(self.sheet, phi, touches).slopes @ z
        values = np.linalg.svd(rows, compute_uv=False)
        return len(touches) <= z.shape[1] and bool(values.min() > INDEPENDENT)

    def _goes_on(self, curve: LoadCurve, state: LoadedState, closed: tuple[Contact, ...]) -> bool:
        """Tell whether a short step in the direction of a state ends at an equilibrium.

        closed: contacts that may open there.
        """
        size, forces, rates = state.system.size, state.system.forces, state.rates
        weak = forces <= INDEPENDENT * size
        if (forces < -INDEPENDENT * size).any() or (rates[weak] < -INDEPENDENT * size).any():
            return False
        left = without(closed, state.held)
        way, opened = state.tangent[:-1], creases_of(left)
        if (np.sign(state.phi[opened]) * way[opened] > INDEPENDENT).any():
            return False
        if (touching_rows(self.sheet, state.phi, touches_of(left)).slopes @ way).min(
            initial=0.0
        ) < -INDEPENDENT:
            return False
        moved = advance(curve, state, TRIAL)
        if moved is None or not admissible(moved[0]):
            return False
        return not touches_of((*left, *state.held)) or not self.sheet.crossings.find(moved[0].phi)


def _sets(contacts: tuple[Contact, ...]) -> Iterator[tuple[Contact, ...]]:
    """Yield sets of contacts that may be held, larger ones first; of very many only all of them, and none."""
    if len(contacts) > MOST_TOGETHER:
        yield from (contacts, ())
        return
    for count in range(len(contacts), -1, -1):
        yield from itertools.combinations(contacts, count)
