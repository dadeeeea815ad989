"""What paths are made of: points, ranges of one kind, branches, events; checks and counts; legs and snaps of loads."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from origami_nlp.display import shown
from origami_nlp.io import ShortRepr, Unbounded
from origami_nlp.kkt import ContactForce

FROM_TO = shown("from, to", spec=".6g", between=" to ")
MOVES = shown("moves", spec="z.5f", between=" to ")
COUNTED = ("interior", "contact-pinned", "contact-touching", "degenerate")
"""Kinds of minima."""
PITCHFORK = "pitchfork"
"""Why a leg ends where stable states branch off, along which the load goes on."""
YIELDS, HOLDS = "yields", "unloads"
"""Types of events: a hinge comes to its yield torque; one that yields turns back, and is elastic again."""
STOPPED = "interrupted: the path goes on from where it ends here"
"""What an alarm says where the user (Ctrl-C) ended a path."""
COLLAPSE = "collapses"
"""Why a leg ends where hinges yield and nothing stable goes on."""


@dataclass(frozen=True, repr=False)
class PathPoint(ShortRepr):
    """One state of a path.

    Attributes
    ----------
    t
        The parameter, or the load, in its unit.
    fold_angles
        All N [rad].
    energy
        In the scene's units; under a load the energy without it [J].
    multipliers
        Of the contacts held closed.
    eigenvalue
        Smallest of the reduced Hessian [N m/rad]; nan where nothing can move.
    full_space_eigenvalue
        Smallest across the imposed symmetry, without it [N m/rad]; nan where there is none, or where it is not known.
    angle
        What a load works on; nan over a parameter.
    """

    t: float = field(metadata=shown())
    fold_angles: tuple[float, ...]
    energy: float = field(metadata=shown(unit="J"))
    multipliers: tuple[ContactForce, ...]
    eigenvalue: float = field(metadata=shown(unit="N m/rad"))
    full_space_eigenvalue: float
    angle: float = field(default=math.nan, metadata=shown())


@dataclass(frozen=True, repr=False)
class PathBranch(ShortRepr):
    """States of one kind that are followed one to the next, from one event, or end, to another.

    Attributes
    ----------
    id
        From 1.
    t
        The parameter at its ends, in its order.
    kind
        Of a minimum, or ``saddle``, or the verdict.
    index
        Number of directions in which the energy falls.
    certificate
        Of the state in the middle, in words; "" for saddles.
    points
        Its states, in order.
    ends
        Why it ends, first and last: ``range``, ``start`` (of a state that was given), or the type of the event, with
        words.
    """

    id: int = field(metadata=shown("branch"))
    t: tuple[float, float] = field(metadata=FROM_TO)
    kind: str = field(metadata=shown("kind"))
    index: int
    certificate: str = field(metadata=shown("certificate"))
    points: tuple[PathPoint, ...] = field(repr=False)
    ends: tuple[str, str] = field(metadata=shown("ends"))

    @property
    def stable(self) -> bool:
        """Whether it is of minima."""
        return self.kind in COUNTED

    @property
    def alarm(self) -> str:
        """What is odd where states of index 0 are no minima; else ""."""
        odd = not self.stable and self.kind != "saddle"
        return f"branch {self.id}: {self.kind}: {self.certificate}" if odd else ""


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

    id: int = field(metadata=shown("event"))
    type: str = field(metadata=shown("type"))
    t: float = field(metadata=shown("at", spec=".12g"))
    fold_angles: tuple[float, ...]
    contact: str = field(metadata=shown("contact"))
    residuals: Residuals
    located: bool = field(metadata=shown("located"))
    note: str = field(metadata=shown("note"))
    branches: tuple[int, ...] = field(metadata=shown("branches"))

    def words(self) -> str:
        """Return the type, with the contact or the creases."""
        return f"{self.type}: {self.contact}" if self.contact else self.type


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
    missed
        Minima on branches that the search did not find.
    complete
        ``proved`` (or ``proved-except-singular``, ``not-proved``) where a proof was asked for, ``traced`` where one
        degree of freedom was traced to all its ends, that the time limit ended the search where it did; "" elsewhere.
    """

    t: float = field(metadata=shown("searched at", spec=".6g"))
    states: int = field(metadata=shown("minima found"))
    followed: int = field(metadata=shown("on branches"))
    missed: int = field(metadata=shown("of these missed"))
    complete: str = field(default="", metadata=shown("complete"))


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
        Of each of them, in order.
    """

    t: tuple[float, float] = field(metadata=FROM_TO)
    minima: int = field(metadata=shown("minima"))
    kinds: tuple[str, ...] = field(metadata=shown("kinds"))

    def __str__(self) -> str:
        return f"{self.minima} ({FROM_TO['shown'].text(self.t)})"


@dataclass(frozen=True, repr=False)
class Snap(ShortRepr):
    """Where a state ends, and where it goes.

    Attributes
    ----------
    event
        Number of the event at which the state ends.
    t
        The load there.
    type
        ``fold``, ``nonsmooth-fold``, ``branching`` or ``flat state``.
    before, after
        Fold angles of the last state and, at the same load, of the one it descends to, all N [rad].
    angle
        What the load works on, before and after.
    released
        Energy that is lost, load included [J].
    kind, certificate
        Of the state after.
    """

    event: int = field(metadata=shown("snap at event"))
    t: float = field(metadata=shown("load", spec=".6g"))
    type: str = field(metadata=shown("type"))
    before: tuple[float, ...]
    after: tuple[float, ...]
    angle: tuple[float, float] = field(metadata=MOVES)
    released: float = field(metadata=shown("energy lost", "J", ".6g"))
    kind: str = field(metadata=shown("to a state"))
    certificate: str


@dataclass(frozen=True, repr=False)
class Leg(ShortRepr):
    """Stable states that the load passes one way.

    Attributes
    ----------
    toward
        1 where the load grows, -1 where it falls.
    points
        States in order.
    t, angle
        The load, and what it works on, first and last.
    why
        ``range``, ``snap``, ``pitchfork`` (stable states branch off, of which the next leg is one branch),
        ``yields`` and ``unloads`` (the next leg goes on with other hinges yielding), ``collapses``
        (hinges yield, and nothing stable goes on), or what stopped it.
    snap
        Number (1-based) of the snap that ends it, or None.
    stiffness
        Derivative of the load by what it works on where the leg begins [N m/rad, N/m, or 1/m of a factor]; inf where
        that stays, nan at a bifurcation, and where no state goes on.
    moved
        Of hinges that may yield: by how much the rest angles of all N have moved where the leg ends [rad]; else empty.
    """

    toward: int
    points: tuple[PathPoint, ...] = field(repr=False)
    t: tuple[float, float] = field(metadata=shown("load", spec=".6g", between=" to "))
    angle: tuple[float, float] = field(metadata=MOVES)
    why: str = field(metadata=shown("ends"))
    snap: int | None = field(metadata=shown("snap"))
    stiffness: Unbounded = field(default=math.nan, metadata=shown("stiffness", spec=".5g"))
    moved: tuple[float, ...] = field(
        default=(), metadata=shown("rest angles moved", "rad", "+z.3g")
    )
