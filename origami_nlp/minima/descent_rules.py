"""What steers the steps of a descent."""

from __future__ import annotations

from origami_nlp.numerics import CHOSEN

FLAT_SLOPE = 1e-10
"""Torque that is left where a descent has converged, relative to the largest that balance."""
NO_SLOPE = FLAT_SLOPE / 100
"""A crease with less of it stays where it is: of a contact that others close rounding times the condition is left,
and steps that this sends against its limit end there."""
SADDLE = -1e-7
"""Eigenvalue (of a Hessian that is 1 for springs alone) below which a stationary state is left downhill."""
EARLY = 0.3
"""A contact that pulls more than this share of the torque that is left is let go before the rest has converged."""
FIRST_REACH, REACH, SHORTEST = 1.0, 2.0, 1e-9
"""Longest step of a fold angle [rad]: at first, ever, and where a descent gives up."""
GROWTH, CUT = 1.7, 0.3
"""By how much the reach changes after a step that was taken, and after one that was not."""
ESCAPES, ESCAPE = 3, 0.05
"""How often a saddle is left, and by how much [rad]."""
NEAR = 0.3
"""Furthest that a state is moved onto a contact [rad]."""
NEXT = 1 + 2 * CHOSEN
"""A fold limit at up to this times a step, which is rounded itself, is reached by it; so far apart two are at one."""
STALLED = 6
"""Steps without progress after which a descent stops."""
MOST_STEPS = 45
"""Steps of a descent."""
LONG_CHAIN, MOST_ONE_BY_ONE = 9, 24
"""Creases from which Newton's directions are swept; and up to which fold limits are met, and left, one by one."""
LEAST_PIVOT = 1e-2
"""Pivots (1 for springs alone) are at least this."""
STIFF = 1e3
"""Stiffness against what does not close, relative to the largest of the Hessian: closed states do not feel it, but it
makes pivots positive where only states that do not close have negative curvature."""
