"""What an atlas is made of: branches with their points and kinds, events, checks, counts, and states at one value."""

from __future__ import annotations

from dataclasses import dataclass, field

from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import ContactForce, Kind
from origami_nlp.problem import STOP

EVENT_WORDS = {
    "fold": "limit point",
    "nonsmooth-fold": "limit point at a contact",
    "branching": "branch point",
    "closes": "contact closes",
    "leaves": "contact opens",
    "breaks-symmetry": "loses stability without its symmetry",
    "singular": "closure loses rank",
    "yields": "hinge yields, its rest angle moves",
    "unloads": "hinge turns back, elastic about its moved rest angle",
}
"""Types of events as reports say them."""
COUNTED = ("interior", "contact-pinned", "contact-touching", "degenerate")
"""Kinds of minima."""


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
    range: tuple[float, Unbounded]


@dataclass(frozen=True, repr=False)
class PathPoint(ShortRepr):
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


@dataclass(frozen=True, repr=False)
class PathBranch(ShortRepr):
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

    def kind_at(self, k: int) -> str:
        """Return what the point at position k is, see `KindRange.kind`."""
        return next(r.kind for r in self.kind_ranges if r.points[0] <= k <= r.points[1])


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


@dataclass(frozen=True, repr=False)
class PathEvent(ShortRepr):
    """A state at which something changes.

    Attributes
    ----------
    id
        From 1.
    type
        ``fold``, ``nonsmooth-fold``, ``closes``, ``leaves``, ``branching``, ``breaks-symmetry`` or ``singular``; of
        load paths also ``yields`` and ``unloads``.
    t
        The parameter in its unit.
    fold_angles
        All N [rad].
    contact
        That closes or leaves as t grows, or the creases that yield or turn back, in words; "" elsewhere.
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

    def words(self, *, growing: bool = True) -> str:
        """Return what happens as the parameter grows, or falls: what closes the one way opens the other.

        Parameters
        ----------
        growing
            Whether it grows.

        Returns
        -------
        str
            With the contact, or the crease that reaches or leaves its stop.
        """
        other = {"closes": "leaves", "leaves": "closes"}
        kind = self.type if growing else other.get(self.type, self.type)
        said = EVENT_WORDS.get(kind, kind)
        angle, stop, who = self.contact.partition(f" {STOP} at ")
        if stop and kind in other:
            does, they = {"closes": ("reaches", "reach"), "leaves": ("leaves", "leave")}[kind]
            return (
                f"{who} {they} their stops: {angle}"
                if "," in who
                else f"{who} {does} its stop: {angle}"
            )
        return f"{said}: {self.contact}" if self.contact else said


@dataclass(frozen=True)
class SearchCheck:
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
    complete
        ``proved`` (or ``proved-except-singular``, ``not-proved``) where a proof was asked for, ``traced`` where one
        degree of freedom was traced to all its ends, that the time limit ended the search where it did; "" elsewhere.
    """

    t: float
    states: int
    followed: int
    new_branches: int
    missed: int
    expected_undiscovered: Unbounded
    starts: int
    seconds: float
    morse: str = ""
    complete: str = ""


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
    verdict, kind, certificate, local_dimension, contacts
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
    local_dimension: int
    contacts: tuple[ContactForce, ...]
    eigenvalue: float
    kkt_residual: float
    closure_residual: float
    stays: tuple[float, float] | None
