"""The one table of tolerances, each derived; angles in radians, energies over the mean stiffness.

Three levels.  *Exact*: what rounding alone leaves.  *Polished*: what a state that Newton took to rounding knows of its
contacts.  *Coarse*: what IPOPT's answers, and states read from files, are good for.

Near a singular state (flat, flat-folded, creases on each other) quantities follow powers of the distance d: closure
misses by d^2, an opening grows as d^2 or d^3, multipliers as 1/d.  So an opening of eps is a distance of sqrt(eps):
nothing finer than `TOUCHES` can be told from touching, and nothing coarser may be called so.
"""

EPS = 2.0**-52
"""Spacing of doubles at 1."""

# exact
ROUNDED = 1e-14
"""Largest entry of loop closure that rounding leaves: some 50 eps, a product of up to a few tens of folds."""
CLOSES = 1e-12
"""A state closes: rounding of a product of up to 1,000 folds, and of sector angles made exact."""
FOLLOWED = 1e-13
"""Closure of points of a curve or small sphere: at distance d from a singular state any point closes to d^2, so at
the smallest radii (1e-6) only residuals below this tell."""
OUTSIDE = 1e-12
"""A state is beyond a fold limit, a mirror, the axis or another facet: more than closing to `CLOSES` can do, and less
than the depth of third order, (2e-4)^3, that crossing facets show on the smallest sphere around a singular state."""
STATIONARY = 1e-11
"""Torque without balance, relative to the largest: 1e-16 through a KKT system of condition 1e5."""
CURVED = 1e-12
"""Eigenvalues of a reduced Hessian below this share of the largest do not count as positive: n eps, with room."""

# polished
TOUCHES = 1e-8
"""Opening of a closed contact: sqrt(eps / 2)."""
RANK = 1e-7
"""Singular values of closure (the largest are about 1) below this count as zero: they grow as the distance to the
singular state, and a state that touches to `TOUCHES` is within a few times that of it."""
SAME = 1e-8
"""Two polished states whose fold angles differ by no more are one."""
SETTLED = 1e-6
"""Two ends of Newton, corners of curves, or roots on a circle are one: where a root is double, or curves touch, a
residual of `CLOSES` is a distance of its square root."""
NEAR_CONTACT = 1e-6
"""A curve has reached a contact: the opening that is left after bisection of a step to 1e-9."""

# coarse
UNPOLISHED = 1e-5
"""Contacts and torques of an answer of IPOPT: its tolerance 1e-7 leaves sqrt(mu) ~ 1e-4.5 at weak contacts."""
BESIDE = 1e-3
"""Distance of IPOPT's answer from a singular state: the square root of its tolerance, with room."""
