"""A hinge as measured: its law, how well it is known, where it rests, what a cycle takes; the table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.display import Report, Section, Words, record_table, shown
from origami_nlp.pattern import LawFit

MUCH = 0.2
"""Share of the energy that the law stores, from which the area of the loop is a warning."""


@dataclass(frozen=True)
class HingeRest:
    """A well of a measured law, or an end of the data that the hinge is pushed to.

    Attributes
    ----------
    angle
        Of least energy nearby [rad].
    known
        95 % half-width of it [rad]; nan where it is not known.
    kind
        ``"well"`` or ``"end of the data"``.
    energy
        Above the least of the law [J].
    barrier
        Least energy to leave to another well, or to the end of the data [J].
    stiffness
        dtorque/dphi there [N m/rad].
    held
        Between which angles the loop's half-gap holds the hinge without load [rad]; equal without a loop.
    """

    angle: float = field(metadata=shown("phi", "rad", ".4g"))
    known: float = field(metadata=shown("+-", "rad", ".2g"))
    kind: str = field(metadata=shown("rest"))
    energy: float = field(metadata=shown("energy", "J", ".4g"))
    barrier: float = field(metadata=shown("to leave", "J", ".4g"))
    stiffness: float = field(metadata=shown("stiffness", "N m/rad", ".4g"))
    held: tuple[float, float] = field(metadata=shown("held by the loop", "rad", ".4g"))


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredHinge(LawFit, Report):
    """A hinge law fitted to measured torques, and what is known of it: besides its `LawFit`, where it rests.

    Attributes
    ----------
    data
        As measured.
    law
        The mean law, for `Scene(laws=)` and `Pattern.with_laws`, known where it was measured.
    knots
        Inner knots of the spline [rad].
    angle
        Where the next four are stated, [g] [rad].
    torque, band
        Of the mean law, with the 95 % half-width at each angle, [g] [N m]; nan if the noise is not known.
    slope_band
        95 % half-width of the stiffness, [g] [N m/rad].
    gap
        Half of what torques on loading are above those on unloading, [g] [N m]; 0 without a loop.
    residual_rms, residual_max
        Of torques less the law and the half-gap [N m].
    noise
        Standard deviation of a torque of weight 1 [N m]; nan if not known.
    correlation
        Of residuals that follow each other, for which the band is wider.
    loop_area, loop_error
        Energy that a cycle takes, with its 95 % half-width [J]; nan without loading and unloading.
    falling
        Intervals of angles in which the stiffness is negative for certain (95 % at each angle) [rad].
    unsure
        Share of the range in which the sign of the stiffness is not known.
    stored
        Largest less least energy of the mean law [J].
    rests
        Wells and ends that the hinge is pushed to, in order of angles.
    notes
        What to look at before the law is used.

    Examples
    --------
    >>> import numpy as np, origami_nlp as o
    >>> angle = np.radians(np.linspace(-90, 90, 61))
    >>> found = o.fit_hinge(o.HingeData(angle, 0.01 * (angle - 0.2)))
    >>> round(found.law.rest, 4), [round(rest.angle, 4) for rest in found.rests]
    (0.2, [0.2])
    """

    PICTURE = "draw_hinge"
    SCHEMA = "origami-nlp/hinge/1"
    rests: tuple[HingeRest, ...]
    notes: tuple[str, ...] = field(default=())

    @property
    def name(self) -> str:
        """Of the law."""
        return self.law.name

    @property
    def verdict(self) -> str:
        """What the law is, in a sentence."""
        wells = sum(rest.kind == "well" for rest in self.rests)
        many = {0: "no well", 1: "one well"}.get(wells, f"{wells} wells")
        falls = f"stiffness negative for certain {'on a part' if self.falling else 'nowhere'}"
        low, high = np.degrees([self.law.breaks[0], self.law.breaks[-1]])
        return f"{self.name}: known from {low:.4g} to {high:.4g} degrees, {many}, {falls}"

    def report_sections(self) -> Iterable[Section]:
        """Return the verdict, the wells, how well the law is known, and the notes."""
        yield Words(self.verdict, "bold")
        yield "Torque is dU/dphi: what holds the hinge at the angle, positive towards valley (phi > 0)."
        if self.rests:
            yield record_table(self.rests, "")
        names = "residual_rms residual_max noise correlation loop_area loop_error".split()
        known = [(name.replace("_", " "), getattr(self, name)) for name in names]
        said = ", ".join(f"{name} {v:.3g}" for name, v in known if math.isfinite(v))
        pieces = len(self.law.coefficients)
        yield f"{len(self.data.angle):,} rows, {pieces} cubics by BIC [N m, J]: {said}"
        spans = [f"[{math.degrees(a):.4g}, {math.degrees(b):.4g}]" for a, b in self.falling]
        where = f"{', '.join(spans)} degrees" if spans else "nowhere"
        open_ = f"its sign is not known on {round(100 * self.unsure, 2):g} % of the range"
        yield f"Stiffness negative for certain: {where}; {open_}"
        yield from (Words(f"Note: {note}", "bold") for note in self.notes)

    def _rows(self) -> Iterator[dict[str, object]]:
        columns = {
            "phi_rad": self.angle,
            "torque_N_m": self.torque,
            "band_N_m": self.band,
            "half_gap_N_m": self.gap,
            "stiffness_N_m_per_rad": self.law.slope(self.angle),
        }
        for row in zip(*(v.tolist() for v in columns.values()), strict=True):
            yield dict(zip(columns, row, strict=True))
