"""One minimum, and the record of the search that found it."""

from __future__ import annotations

from dataclasses import dataclass, field

from origami_nlp.kkt import ContactForce, Kind
from origami_nlp.minima.full_space import FullSpace


@dataclass(frozen=True)
class Minimum:
    """A local minimum of the energy among admissible states of the modelled symmetry.

    energy: [the scene's units, J for N m/rad].  fold_angles: all N, [rad].
    kind, local_dimension, certificate, contacts: see `judge.classify.Classification`.
    closure_residual: largest entry of loop closure.  kkt_residual: largest entry of the
    stationarity residual, with the stiffness scaled to one and relative to the torques that
    balance.
    polished: True: Newton reached rounding, or the state is an exact singular one.  (A state that is neither is no
    minimum but undecided.)
    hits: random starts that ended here; 0 for an isolated flat folding, which is found by listing,
    not by descent.  hessian_eigenvalues: tangential stiffness [N m/rad], on the subspace that keeps
    loaded contacts closed, per unit length in the space of all N fold angles.
    full_space: verdict in the full contact-admissible space, where it was asked for.
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


@dataclass(frozen=True)
class Rejected:
    """A state that solves ended at and that is not listed: verdict, reason, fold angles, energy, hits."""

    verdict: str
    reason: str
    fold_angles: tuple[float, ...]
    energy: float
    hits: int


@dataclass(frozen=True)
class SearchReport:
    """What the search did.

    starts, solves: random starts, and IPOPT solves (a start that makes facets cross is solved again
    with planes).
    statuses: IPOPT's return statuses over all solves.  outcomes: converged starts by what their end
    state is.
    expected_undiscovered: Boender and Rinnooy Kan's estimate of the number of minima that no start
    reached.
    stopped_by: ``"rule"`` or ``"cap"``.  rejected: distinct answers that are no minimum, with the
    reason and hits.  undecided: those that may or may not be one, by name: not polished, or not
    certified.  iterations: of IPOPT, over all solves.
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
    rejected: tuple[Rejected, ...] = field(default=(), repr=False)
    undecided: tuple[Rejected, ...] = field(default=(), repr=False)
