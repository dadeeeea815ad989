"""One minimum, and the record of the search that found it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from origami_nlp.files import Brief
from origami_nlp.kkt import ContactForce, Escape, Kind
from origami_nlp.minima.coverage import StrataCount
from origami_nlp.minima.flags import StateFlags
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.minima.ipopt import Confirmation
from origami_nlp.numerics import CLOSES, STATIONARY
from origami_nlp.show import to_plain

TRIALS = 20
"""Scenes with random errors that minima are followed into."""


@dataclass(frozen=True, repr=False)
class Survival(Brief):
    """How often a minimum was still one after random errors.

    Attributes
    ----------
    degrees
        Standard deviation of the errors: of rest and sector angles in degrees, of stiffnesses as a share, in radians.
    kept
        Trials in which the state could be followed, and was a certified minimum with full errors.
    trials
        All.
    springs
        Of patterns whose closure has as many equations as creases: trials kept with errors of the springs alone; with
        errors of positions rigid facets of such a sheet do not fold.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.miura("pi/3"), noise=0.05)
    >>> [str(m.survival) for m in result.minima]
    ['20 of 20', '20 of 20']
    """

    degrees: float
    kept: int
    trials: int
    springs: int | None = None

    def __str__(self) -> str:
        alone = "" if self.springs is None else f" (springs {self.springs})"
        return f"{self.kept} of {self.trials}{alone}"


def contact_to_dict(contact: ContactForce) -> dict[str, Any]:
    """Return a contact as plain data: of creases, facets, corners, side and place what there is."""
    touching = ("creases", "facets", "corners", "side", "place")
    return {k: v for k, v in to_plain(contact).items() if v or k not in touching}


@dataclass(frozen=True, repr=False)
class Minimum(Brief):
    """A local minimum of the energy among admissible states of the modelled symmetry.

    Attributes
    ----------
    energy
        In the scene's units (J for N m/rad).
    fold_angles
        All N [rad], valley positive.
    kind
        ``interior``, ``contact-pinned``, ``contact-touching`` or ``degenerate``.
    local_dimension
        Dimension of the feasible set at the state: the model's degrees of freedom where it is full, 1 on a handle, 0 if
        isolated.
    closure_residual
        Largest entry of loop closure.
    kkt_residual
        Largest entry of the stationarity residual, with the stiffness scaled to one and relative to the torques
        that balance.
    polished
        True: Newton reached rounding, or the state is an exact singular one.  (A state that is neither is no
        minimum but undecided.)
    hits
        Starts that ended here; 0 for an isolated flat folding, which is found by listing, not by descent.
    contacts
        Closed contacts with their moments [N m per rad of opening], positive where they push.
    certificate
        Why it is a minimum, in words.
    hessian_eigenvalues
        Tangential stiffness [N m/rad], on the subspace that keeps loaded contacts closed, per unit length in
        the space of all N fold angles.
    full_space
        Verdict in the full contact-admissible space, where it was asked for.
    solver
        What IPOPT says when it is started at the state with its multipliers; None with too many fold angles for it,
        or fewer than equations.
    moment
        The moment m that passes round the vertex [N m], k_i (phi_i - phi0_i) = m . c_i at each free crease, in the
        frame of the facet between crease N and crease 1 (`kkt.PassingMoment`); None where free creases do not
        determine it.
    moment_residual
        Largest part of a free crease's torque that this leaves [N m]; nan without a moment.
    winding
        How often the state winds round the axis of the symmetry; 1 without one (`Scene.windings`).
    softest_mode
        Fold angles [N] of the mode with the smallest of `hessian_eigenvalues`, of unit length, its largest entry
        positive; empty where there is no stiffness, or more than one mode has it.
    escape
        How much energy it takes to leave the state; None where it was not asked for.
    survival
        How many random errors of the scene it survives, where that was asked for (``noise``).

    Examples
    --------
    >>> import origami_nlp as o
    >>> lowest = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16).minima[0]
    >>> lowest.kind, lowest.closure_residual < 1e-12, len(lowest.hessian_eigenvalues)
    ('interior', True, 2)
    """

    energy: float
    fold_angles: tuple[float, ...]
    kind: Kind
    local_dimension: int
    closure_residual: float
    kkt_residual: float
    polished: bool
    hits: int
    contacts: tuple[ContactForce, ...]
    certificate: str
    hessian_eigenvalues: tuple[float, ...]
    full_space: FullSpace | None = None
    solver: Confirmation | None = None
    moment: tuple[float, float, float] | None = None
    moment_residual: float = math.nan
    winding: int = 1
    softest_mode: tuple[float, ...] = field(default=(), repr=False)
    escape: Escape | None = None
    survival: Survival | None = None

    @property
    def softest(self) -> float:
        """Smallest stiffness [N m/rad], per unit length of all N fold angles; inf where contacts leave nothing free."""
        return min(self.hessian_eigenvalues, default=math.inf)

    @property
    def shallow(self) -> bool:
        """Whether a way out is known that climbs next to nothing, see `Escape.shallow`."""
        return self.escape is not None and self.escape.shallow

    @property
    def flags(self) -> StateFlags:
        """What is bad about it, or to be known before it is used: each flag with cause and cure."""
        verdict = self.full_space and self.full_space.verdict
        return StateFlags(
            degenerate=self.kind == "degenerate",
            multipliers_not_unique=not all(c.unique for c in self.contacts),
            touching_without_moment=self.kind == "contact-touching",
            isolated=self.local_dimension == 0,
            shallow=self.shallow,
            solver_disagrees=self.solver is not None and not self.solver.agrees,
            residual_above_tolerance=self.closure_residual > CLOSES
            or self.kkt_residual > STATIONARY,
            unstable_in_full_space=verdict == "unstable",
            not_decided_in_full_space=verdict == "undecided",
        )


@dataclass(frozen=True, repr=False)
class Rejected(Brief):
    """A state that solves ended at and that is not listed.

    Attributes
    ----------
    verdict
        What it is instead of a minimum.
    reason
        Why.
    fold_angles
        All N [rad].
    energy
        In the scene's units.
    hits
        Random starts that ended here.
    """

    verdict: str
    reason: str
    fold_angles: tuple[float, ...]
    energy: float
    hits: int


@dataclass(frozen=True, repr=False)
class SearchReport(Brief):
    """What the search did.

    Attributes
    ----------
    starts
        States from which descents began.
    feasible_starts
        Those that were admissible; the others were dropped.
    solves
        Of IPOPT, which confirms each minimum; for large degrees it also searches.
    iterations
        Of IPOPT, over all solves.
    statuses
        IPOPT's return statuses over all solves.
    outcomes
        Converged starts by what their end state is.
    expected_undiscovered
        Chao's estimate of the number of minima that no drawn start reached: a lower bound in expectation, no guarantee.
    stopped_by
        ``"rule"``, ``"cap"``, ``"time"``, or ``"complete"``: nothing was left to sample.
    seconds
        Of wall time.
    seed
        Of the random starts.
    effort
        What was asked for.
    by_source
        Starts by where they began: corners of the state space, near them, on strata, in the interior, on touches.
    stalled
        Descents that ended nowhere.
    failed
        What was left out, by reason: ends of descents that are no state (they do not close), and parts of the search,
        named, at which linear algebra broke down.
    seen_once
        Minima that one drawn start reached.
    quiet
        Drawn starts since the last new minimum.
    corners
        States that fold limits alone leave without freedom, from which descents began.
    every_corner
        Whether these are all of them, each judged then.
    strata
        With full contact and without symmetry: which strata with touches were started, by class.
    complete
        Why nothing is missing, where that is known; "" elsewhere.
    refused
        Guesses at which no minimum is listed, each with the reason (`hits` is 0).
    rejected
        Distinct answers that are no minimum, with the reason and hits.
    undecided
        Those that may or may not be one, by name: not polished, or not certified.
    """

    starts: int
    feasible_starts: int
    solves: int
    iterations: int = field(default=0, kw_only=True)
    statuses: dict[str, int]
    outcomes: dict[str, int]
    expected_undiscovered: float
    stopped_by: str
    seconds: float
    seed: int
    effort: str = field(default="normal", kw_only=True)
    by_source: dict[str, int] = field(default_factory=dict, kw_only=True)
    stalled: int = field(default=0, kw_only=True)
    failed: dict[str, int] = field(default_factory=dict, kw_only=True)
    seen_once: int = field(default=0, kw_only=True)
    quiet: int = field(default=0, kw_only=True)
    corners: int = field(default=0, kw_only=True)
    every_corner: bool = field(default=False, kw_only=True)
    complete: str = field(default="", kw_only=True)
    strata: tuple[StrataCount, ...] = field(default=(), kw_only=True)
    refused: tuple[Rejected, ...] = field(default=(), repr=False)
    rejected: tuple[Rejected, ...] = field(default=(), repr=False)
    undecided: tuple[Rejected, ...] = field(default=(), repr=False)
