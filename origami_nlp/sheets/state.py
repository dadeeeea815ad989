"""A state of a sheet, and what was found out about it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from origami_nlp.files import Brief
from origami_nlp.kkt import ALONE, TRACED, ContactForce, Escape, Kind, Verdict
from origami_nlp.minima import Survival, contact_to_dict
from origami_nlp.show import from_plain


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
        As the kernel says (`kkt.Classification`): ``"minimum"`` (strict, certified), ``"saddle"`` or ``"not
        stationary"`` (lower states are beside it), ``"not admissible"`` (facets pass through each other, or it does not
        close or is beyond a limit: then `freedoms` is -1), ``"undecided"``.
    kind
        Of a minimum: no contact, all contacts loaded, some not, or closure loses rank there and nothing balances the
        springs; None otherwise.
    freedoms
        Creases less the rank of closure.
    closure_residual
        Largest entry of closure.
    kkt_residual
        Torque that closure and contacts do not balance, over the largest; not small where a minimum is degenerate, or
        flat and alone.
    eigenvalue
        Smallest curvature of the Lagrangian over the mean stiffness along what loaded contacts leave free; inf where
        they leave nothing; nan where it was not asked for.
    contacts
        What touches.
    crossings
        Pairs of facets that pass through each other.
    certificate
        What is proved, and why.
    softest
        `eigenvalue` times the mean stiffness [N m/rad], per unit length of all fold angles: what the softest free
        motion resists with; inf where contacts leave nothing free.
    escape
        Of a minimum, how much energy it takes to leave it; None where it was not asked for.
    survival
        Of a minimum, how many random errors of the sheet it survives, where that was asked for (``noise``).
    """

    fold_angles: np.ndarray = field(repr=False)
    energy: float
    verdict: Verdict
    kind: Kind | None
    freedoms: int
    closure_residual: float
    kkt_residual: float
    eigenvalue: float
    contacts: tuple[ContactForce, ...]
    crossings: tuple[tuple[int, int], ...]
    certificate: str
    softest: float = math.nan
    escape: Escape | None = None
    survival: Survival | None = None

    @property
    def refuted(self) -> bool:
        """Whether it is known to be no minimum: a lower state lies beside it, or torque is left."""
        return self.verdict in ("saddle", "not stationary")

    @property
    def shallow(self) -> bool:
        """Whether a way out is known that climbs next to nothing, see `Escape.shallow`."""
        return self.escape is not None and self.escape.shallow

    def title(self, number: int) -> str:
        """Name the state, of some number, by its kind and energy."""
        kind = f"{self.kind or self.verdict}{', shallow' * self.shallow}"
        return f"state {number}: {kind}, {self.energy:.6g} J"

    def lines(self) -> tuple[str, ...]:
        """Say what is proved, and which facets touch."""
        return self.certificate, *(c.words() for c in self.contacts if not c.is_limit)

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
            "rigid": math.isinf(self.eigenvalue),
            "contacts": [contact_to_dict(c) for c in self.contacts],
            "crossings": [[a + 1, b + 1] for a, b in self.crossings],
            "certificate": self.certificate,
            "softest": self.softest if math.isfinite(self.softest) else None,
            "escape": _plain(self.escape),
            **({"survival": asdict(self.survival)} if self.survival else {}),
        }

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> SheetState:
        """Rebuild a state from `to_dict`.

        Parameters
        ----------
        data
            What `to_dict` returned.

        Returns
        -------
        SheetState
            The same.

        Raises
        ------
        KeyError, TypeError, ValueError
            If an entry is missing or wrong.
        """
        unknown = math.inf if data.get("rigid") else math.nan
        missing, lowest = data["kkt_residual"], data["eigenvalue"]
        return cls(
            np.array(data["fold_angles"], float),
            float(data["energy"]),
            data["verdict"],
            data["kind"],
            int(data["freedoms"]),
            float(data["closure_residual"]),
            math.nan if missing is None else float(missing),
            unknown if lowest is None else float(lowest),
            tuple(
                from_plain(ContactForce, c, {"multiplier_range": math.inf})
                for c in data["contacts"]
            ),
            tuple((int(a) - 1, int(b) - 1) for a, b in data["crossings"]),
            str(data["certificate"]),
            unknown if data.get("softest") is None else float(data["softest"]),
            _escape(data.get("escape")),
            from_plain(Survival, data["survival"]) if "survival" in data else None,
        )


def _plain(escape: Escape | None) -> dict[str, Any] | None:
    """Return plain data of an escape barrier; None for what is not known, or infinite."""
    if escape is None:
        return None
    return {**asdict(escape), "barrier": escape.barrier if escape.known else None}


def _escape(data: dict[str, Any] | None) -> Escape | None:
    """Rebuild an escape barrier from plain data: without a number there is no way out, or none was determined."""
    if data is None:
        return None
    none = math.inf if data["method"] in (TRACED, ALONE) else math.nan
    barrier = none if data["barrier"] is None else float(data["barrier"])
    return Escape(**{**data, "barrier": barrier, "top": tuple(map(float, data["top"]))})
