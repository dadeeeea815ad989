"""What a load path is made of: legs with their points, snaps, and the searches that confirm them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from origami_nlp.io import ShortRepr, Unbounded

PITCHFORK = "pitchfork"
"""Why a leg ends where stable states branch off, along which the load goes on."""
YIELDS, HOLDS = "yields", "unloads"
"""Types of events: a hinge comes to its yield torque; one that yields turns back, and is elastic again."""
STOPPED = "interrupted: the path goes on from where it ends here"
"""What an alarm says where the user (Ctrl-C) ended a path."""
COLLAPSE = "collapses"
"""Why a leg ends where hinges yield and nothing stable goes on."""


@dataclass(frozen=True)
class ConfirmedSnap:
    """Searches before and after a snap, which know nothing of the path.

    Attributes
    ----------
    t
        Loads before the snap and after it, at which is searched.
    minima
        How many minima each search found.
    found
        Whether the state of the path before the snap, and the one after it, is among them.
    """

    t: tuple[float, float]
    minima: tuple[int, int]
    found: tuple[bool, bool]


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
        ``fold``, ``nonsmooth-fold``, ``branching``, ``breaks-symmetry`` or ``flat state``.
    before, after
        Fold angles of the last state and, at the same load, of the one it descends to, all N [rad].
    angle
        What the load works on, before and after.
    released
        Energy that is lost, load included [J].
    kind, certificate
        Of the state after.
    restabilises
        Load at which the unstable states that begin here become stable again; None where they do not, or were not
        followed so far.
    confirmed
        By a search; None where it was not asked for.
    """

    event: int
    t: float
    type: str
    before: tuple[float, ...]
    after: tuple[float, ...]
    angle: tuple[float, float]
    released: float
    kind: str
    certificate: str
    restabilises: float | None
    confirmed: ConfirmedSnap | None


@dataclass(frozen=True, repr=False)
class LoadPoint(ShortRepr):
    """A stable state on the path.

    Attributes
    ----------
    t
        The load.
    angle
        What the load works on.
    fold_angles
        All N [rad].
    energy
        Without the load of the path [J].
    eigenvalue
        Smallest of the reduced Hessian [N m/rad]; nan where nothing can move.
    """

    t: float
    angle: float
    fold_angles: tuple[float, ...]
    energy: float
    eigenvalue: float


@dataclass(frozen=True, repr=False)
class Leg(ShortRepr):
    """Stable states that the load passes one way.

    Attributes
    ----------
    toward
        1 where the load grows, -1 where it falls.
    points
        States in order.
    why
        ``range``, ``snap``, ``pitchfork`` (stable states branch off, of which the next leg is one branch),
        ``breaks-symmetry``, ``yields`` and ``unloads`` (the next leg goes on with other hinges yielding), ``collapses``
        (hinges yield, and nothing stable goes on), or what stopped it.
    snap
        Number (1-based) of the snap that ends it, or None.
    full_space
        ``stable``, ``unstable`` or ``undecided`` without the symmetry, judged at both ends and in the middle; empty
        where none is imposed, or it was not asked for.
    full_space_from
        First load at which it is not stable there; None where it is.
    symmetry
        That its states keep, such as ``"D2"``; ``"none"``, of a pattern empty.
    stiffness
        Derivative of the load by what it works on where the leg begins [N m/rad, N/m, or 1/m of a factor]; inf where
        that stays, nan at a bifurcation, and where no state goes on.
    moved
        Of hinges that may yield: by how much the rest angles of all N have moved where the leg ends [rad]; else empty.
    """

    toward: int
    points: tuple[LoadPoint, ...] = field(repr=False)
    why: str
    snap: int | None
    full_space: str
    full_space_from: float | None
    symmetry: str = ""
    stiffness: Unbounded = math.nan
    moved: tuple[float, ...] = ()

    @property
    def span(self) -> str:
        """From which load to which."""
        return f"{self.points[0].t:.6g} to {self.points[-1].t:.6g}"
