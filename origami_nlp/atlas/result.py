"""What is known of the states over a parameter: branches, events, counts, and the checks by searches."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from origami_nlp.atlas.family import Family, Over
from origami_nlp.kkt import ContactForce, Kind
from origami_nlp.path import Web
from origami_nlp.pattern import Scene, scene_to_dict
from origami_nlp.show import Piece, Table, Told, Words, to_plain

SCHEMA = "origami-nlp/atlas/1"
COUNTED = ("interior", "contact-pinned", "contact-touching", "degenerate")


@dataclass(frozen=True)
class Multiplier:
    """What a closed contact carries on a branch.

    Attributes
    ----------
    contact
        In words.
    value
        Moment at each single contact [N m], positive where it pushes.
    range
        Smallest and largest value over the set of multipliers; inf where unbounded.
    """

    contact: str
    value: float
    range: tuple[float, float]


@dataclass(frozen=True)
class PathPoint:
    """One state of a branch.

    Attributes
    ----------
    t
        The parameter in its unit.
    fold_angles
        All N [rad].
    energy
        In the scene's units.
    multipliers
        Of the contacts held closed.
    eigenvalue
        Smallest of the reduced Hessian [N m/rad]; nan where nothing can move.
    full_space_eigenvalue
        Smallest across the imposed symmetry, without it [N m/rad]; nan where there is none, or where it is not known.
    """

    t: float
    fold_angles: tuple[float, ...]
    energy: float
    multipliers: tuple[Multiplier, ...]
    eigenvalue: float
    full_space_eigenvalue: float


@dataclass(frozen=True)
class KindRange:
    """What a branch is over a part of the parameter.

    Attributes
    ----------
    t
        Its ends, in the order of the branch.
    kind
        Of a minimum, or ``saddle``, or the verdict.
    index
        Number of directions in which the energy falls.
    certificate
        Of the state in the middle, in words; "" for saddles.
    points
        Positions of its first and last point in the branch.
    """

    t: tuple[float, float]
    kind: str
    index: int
    certificate: str
    points: tuple[int, int]

    @property
    def low(self) -> float:
        """Smallest t."""
        return min(self.t)

    @property
    def high(self) -> float:
        """Largest t."""
        return max(self.t)

    @property
    def stable(self) -> bool:
        """Whether it is a minimum."""
        return self.kind in COUNTED


@dataclass(frozen=True)
class BranchEnd:
    """Why a branch ends.

    Attributes
    ----------
    why
        ``range``, ``closed curve``, or the type of the event, with words.
    event
        Its number, or None.
    """

    why: str
    event: int | None


@dataclass(frozen=True)
class PathBranch:
    """States that are followed one to the next, through events.

    Attributes
    ----------
    id
        From 1.
    kind_ranges
        What it is, part by part.
    points
        Its states, in order.
    ends
        Why it ends, first and last.
    """

    id: int
    kind_ranges: tuple[KindRange, ...]
    points: tuple[PathPoint, ...] = field(repr=False)
    ends: tuple[BranchEnd, BranchEnd]


@dataclass(frozen=True)
class Residuals:
    """How exactly an event is located.

    Attributes
    ----------
    kkt
        Largest entry of the KKT system, torques relative to the largest.
    event
        Value of the event's own function; nan where it has none.
    """

    kkt: float
    event: float


@dataclass(frozen=True)
class PathEvent:
    """A state at which something changes.

    Attributes
    ----------
    id
        From 1.
    type
        ``fold``, ``nonsmooth-fold``, ``closes``, ``leaves``, ``branching``, ``breaks-symmetry`` or ``singular``.
    t
        The parameter in its unit.
    fold_angles
        All N [rad].
    contact
        That closes or leaves as t grows, in words; "" elsewhere.
    residuals
        How exactly it is located.
    located
        Whether both residuals are below 1e-11.
    note
        Why it is not located, or why nothing is followed from there.
    branches
        Numbers of the branches that meet there.
    """

    id: int
    type: str
    t: float
    fold_angles: tuple[float, ...]
    contact: str
    residuals: Residuals
    located: bool
    note: str
    branches: tuple[int, ...]


@dataclass(frozen=True)
class Check:
    """A search at one value of the parameter, beside what was followed.

    Attributes
    ----------
    t
        The parameter in its unit.
    states
        Minima that the search found.
    followed
        Minima on branches there, once its own states were followed too.
    new_branches
        Branches that begin with its states.
    missed
        Minima on branches that the search did not find.
    expected_undiscovered
        Of the search.
    starts
        Of the search.
    seconds
        Of the search, wall time.
    morse
        What the Morse identity says there, "" where it was not asked.
    """

    t: float
    states: int
    followed: int
    new_branches: int
    missed: int
    expected_undiscovered: float
    starts: int
    seconds: float
    morse: str = ""


@dataclass(frozen=True)
class Interval:
    """Minima between two changes of their number or kind.

    Attributes
    ----------
    t
        Its ends.
    minima
        Their number.
    kinds
        Number of each kind.
    """

    t: tuple[float, float]
    minima: int
    kinds: dict[str, int]


@dataclass(frozen=True)
class Cost:
    """What following cost.

    Attributes
    ----------
    steps
        Accepted.
    evaluations
        Of the KKT system.
    seconds
        Wall time of following and judging, without the checks.
    checks
        Wall time of the checks.
    """

    steps: int
    evaluations: int
    seconds: float
    checks: float


@dataclass(frozen=True)
class StateAt:
    """A state of a branch at one value of the parameter, judged there.

    Attributes
    ----------
    branch
        Its number; 0 for a state of this value alone.
    fold_angles
        All N [rad].
    energy
        In the scene's units.
    verdict, kind, certificate, contacts
        As `kkt.classify` says.
    eigenvalue
        Smallest of the reduced Hessian [N m/rad]; nan where nothing can move.
    kkt_residual, closure_residual
        Largest entry of the KKT system, torques relative to the largest, and of closure.
    stays
        From where to where it can be followed as a minimum; None for others.
    """

    branch: int
    fold_angles: tuple[float, ...]
    energy: float
    verdict: str
    kind: Kind | None
    certificate: str
    contacts: tuple[ContactForce, ...]
    eigenvalue: float
    kkt_residual: float
    closure_residual: float
    stays: tuple[float, float] | None


@dataclass(frozen=True, eq=False, repr=False)
class Atlas(Told):
    """All states that were found over a parameter.

    Attributes
    ----------
    scene
        The scene that the others differ from.
    over
        The parameter and its range.
    branches, events, checks
        In order of their numbers; checks in the order in which they were made.
    alarms
        What does not fit together, in words; empty where everything does.
    cost
        What it took.
    family, web, branch_of_arc
        The scenes, and what was followed, for `at`.
    """

    scene: Scene
    over: Over
    branches: tuple[PathBranch, ...]
    events: tuple[PathEvent, ...]
    checks: tuple[Check, ...]
    alarms: tuple[str, ...]
    cost: Cost
    family: Family
    web: Web
    branch_of_arc: dict[int, int]

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """Number and kinds of minima between the values at which they change."""
        ranges = [r for b in self.branches for r in b.kind_ranges if r.stable]
        cuts = sorted({self.over.low, self.over.high, *(t for r in ranges for t in r.t)})
        out: list[Interval] = []
        for a, b in itertools.pairwise(cuts):
            middle = 0.5 * (a + b)
            kinds = Counter(r.kind for r in ranges if r.low < middle < r.high)
            found = Interval((a, b), sum(kinds.values()), dict(sorted(kinds.items())))
            if out and out[-1].kinds == found.kinds:
                found = Interval((out[-1].t[0], b), found.minima, found.kinds)
                out.pop()
            out.append(found)
        return tuple(out)

    def at(self, value: float) -> tuple[StateAt, ...]:
        """Return the states of all branches at one value, polished and judged there.

        Parameters
        ----------
        value
            Of the parameter, in its unit.

        Returns
        -------
        tuple of StateAt
            Minima and saddles, in order of energy.

        Raises
        ------
        OptionError
            If it is outside what was followed.
        """
        from origami_nlp.atlas.judging import states_at

        return states_at(self, value)

    def table(self) -> Table:
        """Return one row an interval."""
        rows = [
            (
                f"{self._shown(i.t[0])} to {self._shown(i.t[1])}",
                str(i.minima),
                ", ".join(f"{n} {kind}" for kind, n in i.kinds.items()),
            )
            for i in self.intervals
        ]
        return Table((self.over.name, "minima", "kinds"), rows, columns="lrl")

    def told(self) -> Iterator[Piece]:
        """Return counts, events, branches, checks and what they cost."""
        yield self.table()
        rows = [
            (str(e.id), e.type, self._shown(e.t, 12), e.contact or "-", self._angles(e.fold_angles))
            for e in self.events
        ]
        yield Table(
            ("event", "type", self.over.name, "contact", "fold angles [deg]"), rows, columns="rllLL"
        )
        for b in self.branches:
            parts = "; ".join(
                f"{r.kind} {self._shown(r.t[0])} to {self._shown(r.t[1])}" for r in b.kind_ranges
            )
            yield Words(f"branch {b.id}: {parts}; ends: {b.ends[0].why}, {b.ends[1].why}")
        for e in self.events:
            if e.note:
                yield Words(f"event {e.id}: {e.note}")
        for c in self.checks:
            more = f", {c.missed} on branches that it missed" if c.missed else ""
            more += f"; {c.morse}" if c.morse else ""
            yield Words(
                f"check at {self._shown(c.t)}: {c.states} minima by search, {c.followed} on branches{more}; "
                f"{c.new_branches} new",
                "dim",
            )
        yield Words(
            f"{self.cost.steps} steps, {self.cost.evaluations} evaluations, {self.cost.seconds:.2f} s, and "
            f"{self.cost.checks:.2f} s for {len(self.checks)} searches.  States that no check found and no event "
            "leads to (isolated branches between the checks) are not here.",
            "dim",
        )
        yield from (Words(f"alarm: {line}", "bold") for line in self.alarms)

    def _shown(self, t: float, digits: int = 6) -> str:
        if self.over.unit == "rad":
            return f"{math.degrees(t):.{digits}g} deg"
        return f"{t:.{digits}g}" + (f" {self.over.unit}" if self.over.unit else "")

    @staticmethod
    def _angles(fold_angles: tuple[float, ...]) -> str:
        return ", ".join(f"{math.degrees(v):.2f}" for v in fold_angles)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        over = self.over
        return {
            "schema": SCHEMA,
            "scene": scene_to_dict(self.scene),
            "parameter": {
                "name": over.name,
                "unit": over.unit,
                "from": over.low,
                "to": over.high,
                "scale": "log" if over.log else "linear",
            },
            "branches": to_plain(self.branches),
            "events": to_plain(self.events),
            "intervals": to_plain(self.intervals),
            "checks": to_plain(self.checks),
            "alarms": list(self.alarms),
            "cost": to_plain(self.cost),
        }
