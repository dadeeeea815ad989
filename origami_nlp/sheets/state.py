"""A state of a sheet, and what was found out about it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np

from origami_nlp.files import Brief

Verdict: TypeAlias = Literal["minimum", "not a minimum", "undecided", "crosses", "no state"]
Kind: TypeAlias = Literal["interior", "contact-pinned", "contact-touching"]


@dataclass(frozen=True, repr=False)
class SheetContact(Brief):
    """One contact of a state and what it carries.

    Attributes
    ----------
    type
        ``"fold-limit"``, ``"vertex-face"`` or ``"edge-edge"``.
    where
        Creases at a fold limit, or the two facets that touch; 0-based.
    force
        Moment of a fold limit [N m], force of a touch [N m per unit of the corners]; positive where it pushes.
    """

    type: str
    where: tuple[int, ...]
    force: float

    def words(self) -> str:
        """Say what touches, 1-based."""
        if self.type == "fold-limit":
            return f"crease {self.where[0] + 1} at its fold limit"
        return f"facets {self.where[0] + 1} and {self.where[1] + 1} touch, {self.type}"


@dataclass(frozen=True, eq=False, repr=False)
class SheetState(Brief):
    """A state of a sheet, judged.

    Attributes
    ----------
    fold_angles
        In the order of the pattern's creases [rad], [n].
    energy
        In the units of the stiffness.
    verdict
        ``"minimum"`` (strict, certified), ``"not a minimum"`` (a lower state was found beside it), ``"crosses"``
        (facets pass through each other), ``"no state"`` (it does not close, or is beyond a limit), ``"undecided"``.
    kind
        Of a minimum: no contact, all contacts loaded, or some not; None otherwise.
    freedoms
        Creases less the rank of closure.
    closure_residual
        Largest entry of closure.
    kkt_residual
        Torque that closure and contacts do not balance, over the largest.
    eigenvalue
        Smallest curvature of the Lagrangian over the mean stiffness along what loaded contacts leave free; inf where
        they leave nothing; nan where it was not asked for.
    contacts
        What touches.
    crossings
        Pairs of facets that pass through each other.
    certificate
        What is proved, and why.
    """

    fold_angles: np.ndarray = field(repr=False)
    energy: float
    verdict: Verdict
    kind: Kind | None
    freedoms: int
    closure_residual: float
    kkt_residual: float
    eigenvalue: float
    contacts: tuple[SheetContact, ...]
    crossings: tuple[tuple[int, int], ...]
    certificate: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain data; facets and creases 1-based, what is not known is None."""
        return {
            "energy": self.energy,
            "fold_angles": self.fold_angles.tolist(),
            "verdict": self.verdict,
            "kind": self.kind,
            "freedoms": self.freedoms,
            "closure_residual": self.closure_residual,
            "kkt_residual": self.kkt_residual if math.isfinite(self.kkt_residual) else None,
            "eigenvalue": self.eigenvalue if math.isfinite(self.eigenvalue) else None,
            "contacts": [
                {"type": c.type, "where": [i + 1 for i in c.where], "force": c.force}
                for c in self.contacts
            ],
            "crossings": [[a + 1, b + 1] for a, b in self.crossings],
            "certificate": self.certificate,
        }
