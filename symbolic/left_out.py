"""Statements of the paper that the catalogue does not decide, and why."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LeftOut:
    """A place, what is said there, and why no formula decides it (or where it is measured)."""

    where: str
    what: str
    why: str


LEFT_OUT: tuple[LeftOut, ...] = (
    LeftOut(
        "abstract, sec. 3.1, 3.2",
        "18 of 41 and 14 of 45 symmetric minima stay minima; numbers in the corners of the panels",
        "results of a grid search; measured in docs/validation/states.md and docs/validation/landscapes.md",
    ),
    LeftOut(
        "sec. 2",
        "Resch patterns, helical and conformal groups, other vertices",
        "about other work or other crease patterns",
    ),
    LeftOut(
        "sec. 3, footnote; sec. 3.1",
        "efficient checks of self-intersection; an exhaustive search; a screening method",
        "a method and its merits, no formula",
    ),
    LeftOut(
        "sec. 3.1",
        "each region is one piece; two holes come into the interior; the 1-handles expand",
        "topology of a computed set; measured in docs/validation/landscapes.md",
    ),
    LeftOut(
        "sec. 3.1, 3.2",
        "metastable segments, how they grow with r_k, stick-slip, states that collide and vanish",
        "read off pictures; measured in docs/validation/landscapes.md",
    ),
    LeftOut(
        "sec. 3.2",
        "no topological transitions; the most stable states at r_k = 1; shallow boundaries go with "
        "metastability",
        "read off pictures; measured in docs/validation/landscapes.md and docs/validation/states.md",
    ),
    LeftOut(
        "sec. 4",
        "'right-side of each odd crease', figs. N-setup and 8-fold-symm-breaking-examples",
        "needs the figure; the formula of the construction is claim s4.breaking",
    ),
    LeftOut(
        "sec. 4, 5",
        "d-cone, flexoelectricity, Gibbs phase rule",
        "statements about other work, not about this model",
    ),
    LeftOut(
        "sec. 5, figs. cone-3, cone-4, cone-56",
        "'a large portion', 'nearly irrespective', 'primarily vertical', 'finer structure', 'less stable'",
        "words about a coloured picture, without a threshold",
    ),
    LeftOut(
        "sec. 5",
        "no branch was found with more than one stable state",
        "reports what the authors' optimiser found; true of any incomplete search",
    ),
    LeftOut(
        "sec. 5",
        "other fractions of stable branches than the plateaus at large r_k and the value at v_0 = 0",
        "depend on optimiser, starts and threshold; measured in docs/validation/cones.md",
    ),
    LeftOut(
        "sec. 5",
        "M_2 V up is stable for nearly every parameter set with r_k < 0.7 and v_0 > pi/8",
        "'nearly every' has no measure",
    ),
    LeftOut(
        "app. A",
        "step sizes, the closure tolerance 1e-9, robustness over three steps",
        "settings of a numerical method, no statement",
    ),
)
