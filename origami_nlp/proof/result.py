"""What a proof says: critical points, and what is left.

What steers a proof: none of it is part of what is proved, and all of it of how much is decided.
"""

from __future__ import annotations

from dataclasses import dataclass

from origami_nlp.arguments import check_whole


@dataclass(frozen=True)
class ProvedCriticalPoint:
    """A critical point that exists, and is the only one in its box.

    Attributes
    ----------
    x
        Variables of the model, [n] [rad]; an approximation in doubles.
    stratum
        +1 or -1 for a variable at +-pi, 0 for a free one, [n].
    moment
        As many numbers as there are closure equations, stiffness times rad in the scene's units.  Without symmetry
        m with k_i (x_i - rest_i) = m . c_i on free creases, in the frame of the facet between crease N and crease 1
        (its crease 1 is e1, e3 up).  With symmetry the multipliers of the piece's equations (`pieces`): k_v (x_v -
        rest_v) = sum_a m_a dg_a/dx_v, k_v summed over the creases of the variable.
    radius
        The largest |x_i - true x_i| is no larger [rad].
    unique_radius
        There is no other critical point of the stratum within this.
    index
        Negative eigenvalues of the reduced Hessian on the stratum; None where unclear.
    pinned_signs
        Sign of s_i (G_i - m . c_i): -1 where a closed crease pushes against its limit, +1 where it would leave, 0 where
        unclear; 0 for free ones, [n].
    energy
        In the scene's units.
    is_minimum
        True: index 0 and all signs -1. False: certainly none. None: not decided, which is left to the judge of states.
    touches
        Gaps that are closed (positions in `Structure.gaps`); full contact only.
    forces
        Multiplier of each, positive where it pushes, in the scene's units per unit of gap.
    judged
        Whether facets lie on each other, so that the package's test of layers says that it is admissible.
    """

    x: tuple[float, ...]
    stratum: tuple[int, ...]
    moment: tuple[float, ...]
    radius: float
    unique_radius: float
    index: int | None
    pinned_signs: tuple[int, ...]
    energy: float
    is_minimum: bool | None
    touches: tuple[int, ...] = ()
    forces: tuple[float, ...] = ()
    judged: bool = False


@dataclass(frozen=True)
class Cluster:
    """Boxes of one stratum that were neither excluded nor certified to hold one critical point.

    Attributes
    ----------
    lower, upper
        Their hull, [n] [rad].
    stratum
        As of a `ProvedCriticalPoint`.
    reason
        Why, in words.
    alone
        Whether it holds one critical point at most.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    stratum: tuple[int, ...]
    reason: str
    alone: bool = False


@dataclass(frozen=True)
class Proof:
    """All critical points of a scene within fold limits, by what was shown.

    Attributes
    ----------
    points
        Certified, in order of energy.
    singular
        States where closure loses rank, each isolated in the cluster's box.
    undecided
        Everything else that is left.
    boxes
        How many were treated.
    seconds
        Processor time that it took.
    finished
        Whether no box was left when it ended.
    flat
        What is shown of the flat state.
    flat_radius
        Within this of the flat state it is the only critical point [rad]; 0.0 where that is not shown.
    flat_is_minimum
        False where the flat state is shown not to be one; None: not decided here.
    crossing
        Critical points within fold limits, or at touches, that full contact does not admit: left out of `points`.
    """

    points: tuple[ProvedCriticalPoint, ...]
    singular: tuple[Cluster, ...]
    undecided: tuple[Cluster, ...]
    boxes: int
    seconds: float
    finished: bool
    flat: str
    flat_radius: float
    flat_is_minimum: bool | None
    crossing: int = 0

    @property
    def minima(self) -> tuple[ProvedCriticalPoint, ...]:
        """Critical points that are minima for certain."""
        return tuple(p for p in self.points if p.is_minimum)

    @property
    def complete(self) -> bool:
        """Whether every critical point is known, and of each whether it is a minimum."""
        decided = all(p.is_minimum is not None for p in self.points)
        return decided and not self.undecided and not self.singular


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
