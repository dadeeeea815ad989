"""A state of a sheet, and what was found out about it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from origami_nlp.files import Brief, from_plain
from origami_nlp.kkt import ALONE, TRACED, Escape, Kind, Verdict
from origami_nlp.minima import Survival


@dataclass(frozen=True, repr=False)
class SheetContact(Brief):
    """One contact of a state and what it carries.

    Attributes
    ----------
    type
        ``"fold-limit"``, ``"vertex-face"``, ``"edge-edge"`` or ``"face-face"``.
    where
        The crease at a fold limit, or the two facets that touch, that of the face first; 0-based.
    force
        Moment of a fold limit [N m], force of a touch [N m per unit of the corners]; positive where it pushes.
    corners
        Of a touch: the corner that is on a face and three of the face, or two ends of each side; 0-based.
    between
        The least and the largest force that balance the springs, where others balance them as well; inf where there is
        no largest.
    side
        Of facets face to face, as in faceOrders of a FOLD file: +1 where the second one lies on the side of the first
        one's normal, -1 where it lies on the other; else 0.
    place
        Of facets face to face, the point of the second one at which the force acts, in the sheet's reference state.
    """

    type: str
    where: tuple[int, ...]
    force: float
    corners: tuple[int, ...] = ()
    between: tuple[float, float] | None = None
    side: int = 0
    place: tuple[float, ...] = ()

    def features(self) -> str:
        """Say what touches, 1-based."""
        if self.type == "fold-limit":
            return f"crease {self.where[0] + 1} at its fold limit"
        a, b = (f + 1 for f in self.where)
        if self.type == "face-face":
            at = ", ".join(f"{x:.4g}" for x in self.place)
            which = "front" if self.side > 0 else "back"
            return f"facet {b} flat on the {which} of facet {a} at ({at})"
        p, q, r, s = (c + 1 for c in self.corners)
        if self.type == "edge-edge":
            return f"side {p}-{q} of facet {a} on side {r}-{s} of facet {b}"
        return f"corner {p} of facet {b} on facet {a}"

    def words(self) -> str:
        """Say what touches and what it carries, 1-based."""
        carries = "moment" if self.type == "fold-limit" else "force"
        return f"{self.features()}: {carries} {self._carried()}"

    def _carried(self) -> str:
        if self.between is None:
            return f"{self.force:.6g}"
        low, high = self.between
        return f"{self.force:.6g}, not unique: {low:.4g} to {high:.4g}"

    def to_dict(self) -> dict[str, Any]:
        """Return plain data; facets, creases and corners 1-based."""
        low, high = self.between or (self.force, self.force)
        data = {
            "type": self.type,
            "where": [i + 1 for i in self.where],
            "corners": [i + 1 for i in self.corners],
            "force": self.force,
            "force_least": low,
            "force_most": high if math.isfinite(high) else None,
        }
        return {**data, "side": self.side, "place": list(self.place)} if self.place else data

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> SheetContact:
        """Rebuild a contact from `to_dict`."""
        force, low = float(data["force"]), float(data["force_least"])
        high = math.inf if data["force_most"] is None else float(data["force_most"])
        where, corners = (tuple(int(i) - 1 for i in data[key]) for key in ("where", "corners"))
        between = None if low == high == force else (low, high)
        side, place = int(data.get("side", 0)), tuple(map(float, data.get("place", ())))
        return cls(data["type"], where, force, corners, between, side, place)


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
    contacts: tuple[SheetContact, ...]
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
        return self.certificate, *(c.words() for c in self.contacts if c.type != "fold-limit")

    def moved(self, by: np.ndarray) -> SheetState:
        """Return the state of a sheet that lies elsewhere in its reference state, moved by a vector [3]."""
        places = [
            tuple((np.array(c.place) + by).tolist()) if c.place else () for c in self.contacts
        ]
        contacts = (replace(c, place=x) for c, x in zip(self.contacts, places, strict=True))
        return replace(self, contacts=tuple(contacts))

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
            "contacts": [c.to_dict() for c in self.contacts],
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
            tuple(SheetContact.from_dict(c) for c in data["contacts"]),
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
