"""All minima of a strip within fold limits (`strip_states`), with a proof.

Each curve is cut into boxes of theta.  The slope U' of the energy has no zero in a box, by its value in the middle and
U'' over the box; or U'' has none, and then U' has one at most, which signs of U' at the ends decide.
"""

from __future__ import annotations

import itertools
import math
import time
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.pattern import Pattern, laid_flat
from origami_nlp.proof.flat_sheets import SheetProof
from origami_nlp.proof.sheet_certificate import OpenInterval, stated_sheet
from origami_nlp.proof.strip_certificate import (
    CertifiedCurve,
    CertifiedMinimum,
    CertifiedStop,
    CertifiedTouch,
    StatedLaw,
    StripCertificate,
    TouchingBox,
)
from origami_nlp.proof.strip_contact import (
    TOUCHING,
    UNKNOWN,
    FacetTouch,
    StripContact,
    why_no_strip_contact,
)
from origami_nlp.proof.strip_ends import CurveEnds, StripMinimum
from origami_nlp.proof.strip_energy import (
    LIMIT,
    OPEN,
    TOGETHER,
    StopTouch,
    StripEnergy,
    ThetaStretch,
    kinds_of_boxes,
)
from origami_nlp.proof.strip_states import as_strip, why_no_strip

NARROWEST = 2.0**-44
"""Width of theta below which a box is left open [rad]."""
BEYOND = math.nextafter(0.5 * math.pi, math.inf)
"""Not below pi/2, which is between two doubles."""
FIRST = np.array([-BEYOND, -1.0, -0.1, 0.13, 1.0, BEYOND])
"""Where the first boxes end [rad]: the flat state, theta = 0, is within one, at any depth."""


@dataclass(frozen=True, kw_only=True)
class StripProof(SheetProof):
    """What is proved of a strip: all closed states lie on curves through the flat state.

    Attributes
    ----------
    row
        Creases along the row, from 0.
    claims
        What is claimed of each curve, box by box, for a certificate.
    """

    minima: tuple[StripMinimum, ...]
    row: tuple[int, ...]
    claims: tuple[CertifiedCurve, ...] = field(repr=False)

    @property
    def states(self) -> str:
        """Where all closed states are, in words."""
        return f"lie on {self.curves} curves through the flat state"


def prove_strip(
    pattern: Pattern, *, contact: bool = False, boxes: int = 1_000_000, until: float = math.inf
) -> StripProof:
    """Find every minimum of the energy of a strip within fold limits, with a proof.

    Parameters
    ----------
    pattern
        Vertices of degree four in a row on flat paper.
    contact
        Whether facets must not cross.
    boxes
        At most so many boxes of theta; what is left is undecided.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    StripProof
        All minima, but for what is undecided.

    Raises
    ------
    OptionError
        If the pattern is no such strip, or its contact cannot be proved: `why_no_strip` and
        `why_no_strip_contact` say why.

    Examples
    --------
    >>> from origami_nlp.pattern import make_pattern
    >>> from origami_nlp.proof import prove_strip
    >>> points = [[0, 0], [1, 0.1], [0.2, 1], [-1, 0.3], [-0.3, -1]]
    >>> faces = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)]
    >>> vertex = make_pattern(points, faces).with_springs(stiffness=0.01, rest_angles=[1.0, -0.5, 0.8, 0.9])
    >>> proof = prove_strip(vertex)
    >>> proof.curves, len(proof.minima), proof.undecided
    (2, 2, ())
    """
    strip, why = as_strip(pattern)
    if strip is None or (why := why_no_strip(pattern)):
        raise OptionError(f"pattern = {pattern.title}: no strip that can be proved: {why}")
    if contact and (why := why_no_strip_contact(pattern)):
        raise OptionError(f"pattern = {pattern.title}: no strip whose contact can be proved: {why}")
    started = time.process_time()
    pattern = laid_flat(pattern)
    k = len(strip.corners)
    signs = np.array([(1, *rest) for rest in itertools.product((1, -1), repeat=k)], float).T
    energy = StripEnergy(strip, pattern, signs)
    facets = StripContact(pattern) if contact else None
    ends, curves, examined = along_curves(energy, facets, boxes, until)
    with np.errstate(all="ignore"):
        minima = ends.minima()
    return StripProof(
        curves=signs.shape[1],
        minima=tuple(minima),
        maxima=ends.maxima,
        undecided=tuple(ends.open),
        deviation=0.0,
        moved=strip.moved,
        boxes=examined,
        seconds=time.process_time() - started,
        contact=contact,
        row=tuple(strip.row),
        claims=tuple(curves),
    )


def along_curves(
    energy: StripEnergy, facets: StripContact | None, most: int, until: float
) -> tuple[CurveEnds, list[CertifiedCurve], int]:
    """Cut curves into boxes of theta in which the energy is known.

    Returns
    -------
    ends : CurveEnds
        Where it is least.
    curves : list of CertifiedCurve
        What is claimed of each box.
    boxes : int
        How many were examined: so many at most, until then (`time.monotonic`).
    """
    many = energy.signs.shape[1]
    touches: dict[tuple[float, float, float], tuple[FacetTouch | StopTouch, ...]] = {}
    curve = np.repeat(np.arange(many), len(FIRST) - 1)
    lower, upper = (np.tile(ends, many) for ends in (FIRST[:-1], FIRST[1:]))
    cover: list[np.ndarray] = []
    examined = 0
    with np.errstate(all="ignore"):
        while len(curve):
            stop = examined + len(curve) > most or time.monotonic() > until
            examined += len(curve)
            found = kinds_of_boxes(energy, curve, lower, upper, facets, touches)
            # at a limit facets may be flat on others: asked of the state at last (`_limit_contact`)
            found[-1][
                (found[0] == LIMIT) & (found[-1] == UNKNOWN) & (upper - lower <= TOGETHER)
            ] = TOUCHING
            split = (
                ((found[0] == OPEN) | (found[-1] == UNKNOWN))
                & (upper - lower > NARROWEST)
                & (not stop)
            )
            cover.append(np.array([curve, lower, upper, *found])[:, ~split])
            middle = 0.5 * (lower + upper)[split]
            lower, upper = np.r_[lower[split], middle], np.r_[middle, upper[split]]
            curve = np.r_[curve[split], curve[split]]
        boxes_of = np.concatenate(cover, axis=1)
        order = np.lexsort((boxes_of[1], boxes_of[0]))
        ends = CurveEnds(energy, facets, touches)
        curves = []
        for number in range(many):
            own = [ThetaStretch(*b) for b in boxes_of[:, order].T.tolist() if b[0] == number]
            ends.along(own)
            curves.append(_claims(energy.signs[:, number], own, touches))
    return ends, curves, examined


def _claims(
    signs: np.ndarray,
    boxes: list[ThetaStretch],
    touches: dict[tuple[float, float, float], tuple[FacetTouch | StopTouch, ...]],
) -> CertifiedCurve:
    """Return what is claimed of the boxes of a curve."""
    claims = tuple(box.claim for box in boxes)
    return CertifiedCurve(
        tuple(signs.astype(int).tolist()),
        (*(box.lower for box in boxes), boxes[-1].upper),
        claims,
        tuple(
            TouchingBox(
                k,
                tuple(
                    CertifiedTouch(*t[:2]) for t in touches[box[:3]] if isinstance(t, FacetTouch)
                ),
                tuple(
                    CertifiedStop(t.crease, 1 if t.side > 0 else -1)
                    for t in touches[box[:3]]
                    if isinstance(t, StopTouch)
                ),
            )
            for k, (box, claim) in enumerate(zip(boxes, claims, strict=True))
            if claim == "touching"
        ),
    )


def certificate_of_strip(pattern: Pattern, proof: StripProof) -> StripCertificate:
    """Return the proof of a strip in the form that is written to a file and checked.

    Parameters
    ----------
    pattern
        The strip.
    proof
        Of it.

    Returns
    -------
    StripCertificate
        All that is claimed.

    Raises
    ------
    OptionError
        If a facet is of several pieces: the check knows none.
    """
    return StripCertificate(
        **stated_sheet(pattern),
        limits=pattern.limits,
        laws=tuple(
            None if law is None else StatedLaw(law.breaks, law.coefficients) for law in pattern.laws
        ),
        contact=proof.contact,
        row=proof.row,
        curves=proof.claims,
        minima=tuple(
            CertifiedMinimum(
                tuple(m.fold_angles.tolist()),
                m.radius,
                m.signs,  # type: ignore[arg-type]
                m.theta,
                m.touching,
                tuple(CertifiedStop(c, s) for c, s in m.stops),  # type: ignore[arg-type]
            )
            for m in proof.minima
        ),
        maxima=proof.maxima,
        undecided=tuple(
            OpenInterval(tuple(low.tolist()), tuple(high.tolist()), why)
            for low, high, why in proof.undecided
        ),
    )
