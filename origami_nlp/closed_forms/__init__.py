"""Closed-form completions of symmetric vertices, generated from the verified SymPy expressions.

Conventions: creases counter-clockwise in the e1-e2 plane, b_1 = e1; fold angles in radians, valley
> 0; H = Q(b_1, phi_1/2) Q(b_2, phi_2) .. Q(b_k, phi_k/2) over the wedge between neighbouring mirror
creases; only the lift q = +1.  Nothing here loads SymPy or CasADi; `python -m origami_nlp.symbolic.generate` rewrites
the generated modules.
"""

from origami_nlp.closed_forms._chart import ChartPoint, Reason
from origami_nlp.closed_forms._cone import (
    MIXED,
    SHALLOW,
    STEEP,
    ConeAngles,
    cone_contact_elevation,
    cone_fold_angles,
    cone_partial_angles,
    cone_roots,
)
from origami_nlp.closed_forms._degree6 import degree6
from origami_nlp.closed_forms._dihedral import wedge3

__all__ = [
    "MIXED",
    "SHALLOW",
    "STEEP",
    "ChartPoint",
    "ConeAngles",
    "Reason",
    "cone_contact_elevation",
    "cone_fold_angles",
    "cone_partial_angles",
    "cone_roots",
    "degree6",
    "wedge3",
]
