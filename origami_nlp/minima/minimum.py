"""A state of a vertex or a pattern, judged."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from origami_nlp.display import shown
from origami_nlp.escapes import Escape
from origami_nlp.io import ShortRepr, to_plain
from origami_nlp.kkt import OMIT, ContactForce, Kind, Verdict
from origami_nlp.minima.flags import StateFlags
from origami_nlp.minima.full_space import FullSpace
from origami_nlp.numerics import CLOSURE_TOL, STATIONARY
from origami_nlp.search import Confirmation

TRIALS = 20
"""Scenes with random errors that minima are followed into."""


@dataclass(frozen=True, repr=False)
class Survival(ShortRepr):
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
    springs: int | None = field(default=None, metadata=OMIT)

    def __str__(self) -> str:
        alone = "" if self.springs is None else f" (springs {self.springs})"
        return f"{self.kept} of {self.trials}{alone}"


@dataclass(frozen=True, repr=False)
class JudgedState(ShortRepr):
    """A state of a vertex or a pattern, judged: a local minimum of the energy among admissible states, or why not.

    Of a vertex with an imposed symmetry, among states that have it.

    Attributes
    ----------
    energy
        In the units of the springs (J for N m/rad).
    fold_angles
        All N [rad], valley positive.
    verdict
        ``minimum`` (strict, certified), ``saddle`` or ``not stationary`` (there are lower states arbitrarily near),
        ``not admissible`` (it does not close, is beyond a limit, or facets cross) or ``undecided``.
    certificate
        What is proved, in words; of a state that is no minimum the reason.
    kind
        Of a minimum ``interior``, ``contact-pinned``, ``contact-touching`` or ``degenerate``; else empty.
    local_dimension
        Dimension of the feasible set at a minimum.
    dof
        Variables less the rank of closure; -1 where that was not computed.
    closure_residual
        Largest entry of loop closure.
    kkt_residual
        Largest entry of the stationarity residual, relative to the torques that balance; nan where nothing has to
        balance.  At a degenerate minimum of a pattern it need not be small.
    hits
        Starts that led here; 0 for what a proof or curves added.
    contacts
        Active constraints with their Lagrange multipliers, positive where they push.
    hessian_eigenvalues
        Tangential stiffness [N m/rad] with loaded contacts closed, per unit length in the space of all N fold angles;
        of patterns with many creases the smallest alone.
    crossings
        Pairs of facets (1-based) that intersect, of a pattern.
    full_space
        Verdict without the imposed symmetry, where it was asked for.
    solver
        What IPOPT says when it is started at the state with its multipliers; None where it was not asked.
    winding
        How often the state winds round the axis of the symmetry; 1 without one (`Scene.windings`).
    softest_mode
        Unit eigenvector [N] of the smallest of `hessian_eigenvalues`, its largest entry positive; empty where that is
        not unique.
    escape
        How much energy it takes to leave a minimum; None where it was not asked for.
    survival
        How many random errors of the scene it survives, where that was asked for (``noise``).

    Examples
    --------
    >>> import origami_nlp as o
    >>> lowest = o.find_minima("miura:2x2", effort="quick").minima[0]
    >>> lowest.kind, lowest.closure_residual < 1e-12, len(lowest.hessian_eigenvalues)
    ('interior', True, 1)
    """

    ALSO = ("flags", "softest")

    energy: float = field(metadata=shown("energy", "J", ".9g"))
    fold_angles: tuple[float, ...]
    verdict: Verdict = field(metadata=shown("verdict"))
    certificate: str = field(metadata=shown("why"))
    kind: Literal[Kind, ""] = ""
    local_dimension: int = 0
    dof: int = field(default=-1, metadata=OMIT)
    closure_residual: float = math.nan
    kkt_residual: float = math.nan
    hits: int = 0
    contacts: tuple[ContactForce, ...] = ()
    hessian_eigenvalues: tuple[float, ...] = ()
    crossings: tuple[tuple[int, int], ...] = field(default=(), metadata=OMIT)
    full_space: FullSpace | None = field(default=None, metadata=OMIT)
    solver: Confirmation | None = field(default=None, metadata=OMIT)
    winding: int = field(default=1, metadata=OMIT)
    softest_mode: tuple[float, ...] = field(default=(), repr=False)
    escape: Escape | None = field(default=None, metadata=OMIT)
    survival: Survival | None = field(default=None, metadata=OMIT)

    @cached_property
    def phi(self) -> np.ndarray:
        """`fold_angles` as an array, [N] [rad]."""
        return np.array(self.fold_angles)

    @property
    def softest(self) -> float:
        """Smallest stiffness of a minimum [N m/rad], per unit length of all N fold angles; inf where contacts leave
        nothing free.
        """
        return min(self.hessian_eigenvalues, default=math.inf if self.kind else math.nan)

    @property
    def refuted(self) -> bool:
        """Whether it is known to be no minimum: a lower state lies beside it, or torque is left."""
        return self.verdict in ("saddle", "not stationary")

    @property
    def shallow(self) -> bool:
        """Whether an escape path is known that climbs next to nothing, see `Escape.shallow`."""
        return self.escape is not None and self.escape.shallow

    @property
    def flags(self) -> StateFlags:
        """What is bad about it, or to be known before it is used: each flag with cause and cure."""
        verdict = self.full_space and self.full_space.verdict
        unbalanced = self.kkt_residual > STATIONARY and self.kind != "degenerate"
        return StateFlags(
            degenerate=self.kind == "degenerate",
            multipliers_not_unique=not all(c.unique for c in self.contacts),
            touching_without_moment=self.kind == "contact-touching",
            isolated=bool(self.kind) and self.local_dimension == 0,
            shallow=self.shallow,
            solver_disagrees=self.solver is not None and not self.solver.agrees,
            residual_above_tolerance=self.closure_residual > CLOSURE_TOL or unbalanced,
            unstable_in_full_space=verdict == "unstable",
            not_decided_in_full_space=verdict == "undecided",
        )

    def title(self, number: int) -> str:
        """Name the state by its kind and energy.

        Parameters
        ----------
        number
            Of the state, from 1.

        Returns
        -------
        str
            Such as "state 1: interior, 0.0090858 J", with the verdict in the full space where that was asked for.
        """
        full = f", {self.full_space.verdict}" if self.full_space else ""
        kind = f"{self.kind or self.verdict}{', shallow' * self.shallow}"
        return f"state {number}: {kind}, {self.energy:.6g} J{full}"

    def frame_entries(self) -> dict[str, Any]:
        """Return what a frame of a FOLD file holds of it besides coordinates and fold angles, by our own keys."""
        return {
            "energy": self.energy,
            "kind": self.kind,
            "certificate": self.certificate,
            "closureResidual": self.closure_residual,
            "kktResidual": to_plain(self.kkt_residual),
            "multipliers": [{"contact": c.text, "moment": c.multiplier} for c in self.contacts],
            **({"fullSpace": self.full_space.verdict} if self.full_space else {}),
        }
