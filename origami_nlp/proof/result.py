"""What a proof says: states that are shown, and what is left; and how much it may look at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.proof.reduced import Gap


@dataclass(frozen=True, eq=False)
class ProvedState:
    """A critical point that exists, and is the only one near.

    Attributes
    ----------
    fold_angles
        Of all creases, [N] [rad]; an approximation in doubles.
    radius
        None of them differs by more [rad].
    is_minimum
        True: a minimum.  False: certainly none.  None: not decided, which is left to the judge of states.
    index
        Negative eigenvalues of the reduced Hessian on the stratum; None where unclear.
    unique_radius
        There is no other critical point of the stratum within this [rad].
    stratum
        Of variables, +1 or -1 at a limit, 0 for a free one, [n]; of a vertex, as all that follows.
    moment
        Multipliers of closure in the scene's units.  Without symmetry m with k_i (x_i - rest_i) = m . c_i on free
        creases, in the frame of the facet between crease N and crease 1 (its crease 1 is e1, e3 up); with symmetry
        those of the piece's equations (`pieces`).
    pinned_signs
        Sign of s_i (G_i - m . c_i): -1 where a closed crease pushes against its limit, +1 where it would leave, 0 where
        unclear; 0 for free ones, [n].
    touches
        Gaps that are closed; full contact only.
    forces
        Multiplier of each, positive where it pushes, in the scene's units per unit of gap.
    """

    fold_angles: np.ndarray
    radius: float
    is_minimum: bool | None = True
    index: int | None = 0
    unique_radius: float = 0.0
    stratum: tuple[int, ...] = ()
    moment: tuple[float, ...] = ()
    pinned_signs: tuple[int, ...] = ()
    touches: tuple[Gap, ...] = ()
    forces: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class Region:
    """Fold angles between two states [N] [rad] in which something is left, and why.

    Attributes
    ----------
    singular
        Whether closure loses rank there.
    alone
        Whether it holds one critical point at most.
    """

    lower: np.ndarray
    upper: np.ndarray
    reason: str
    singular: bool = False
    alone: bool = False


@dataclass(frozen=True, kw_only=True)
class Proof:
    """All critical points of a vertex, or all minima of a sheet, but for what is left.

    Attributes
    ----------
    points
        What is shown, of a vertex in order of energy.
    regions
        What is left.
    boxes
        Boxes of fold angles, or intervals of curves, that were looked at.
    seconds
        Processor time that it took.
    over
        Over which states the statement ranges, in words; "": all closed states that contact admits.
    finished
        Whether no box was left when it ended.
    crossing
        Critical points within fold limits, or at touches, that full contact does not admit: left out of `points`.
    """

    points: tuple[ProvedState, ...]
    regions: tuple[Region, ...]
    boxes: int
    seconds: float
    over: str = ""
    finished: bool = True
    crossing: int = 0

    @property
    def minima(self) -> tuple[ProvedState, ...]:
        """Those that are minima for certain."""
        return tuple(p for p in self.points if p.is_minimum)

    @property
    def singular(self) -> tuple[Region, ...]:
        """Regions where closure loses rank."""
        return tuple(r for r in self.regions if r.singular)

    @property
    def undecided(self) -> tuple[Region, ...]:
        """All other regions."""
        return tuple(r for r in self.regions if not r.singular)

    @property
    def complete(self) -> bool:
        """Whether every critical point is known, and of each whether it is a minimum."""
        return not self.regions and all(p.is_minimum is not None for p in self.points)


def joined(proofs: Sequence[Proof]) -> Proof:
    """Return proofs of several sets of states as one."""
    return Proof(
        points=tuple(p for one in proofs for p in one.points),
        regions=tuple(r for one in proofs for r in one.regions),
        boxes=sum(one.boxes for one in proofs),
        seconds=sum(one.seconds for one in proofs),
        over=proofs[0].over,
        finished=all(one.finished for one in proofs),
        crossing=sum(one.crossing for one in proofs),
    )


@dataclass(frozen=True)
class ProofOptions:
    """How much a proof may look at.

    Attributes
    ----------
    boxes
        Boxes, or intervals of curves, after which it gives up: 10 million take about ten minutes.

    Raises
    ------
    OptionError
        If a field is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> vertex = o.Vertex.from_degrees((70, 80, 120, 90))
    >>> scene = o.Scene(vertex, (1, 2, 3, 2), (1, -0.5, 0.3, 0.8), "none", "fold-limits")
    >>> o.find_minima(scene, prove=o.ProofOptions(boxes=1)).completeness.status
    'not-proved'
    """

    boxes: int = 10_000_000

    def __post_init__(self) -> None:
        check_whole("boxes", self.boxes, 1)
