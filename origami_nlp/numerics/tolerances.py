"""The one table of tolerances, each derived; angles in radians, energies over the mean stiffness.

Three levels.  *Exact*: what rounding alone leaves.  *Polished*: what a state that Newton took to rounding knows of its
contacts.  *Coarse*: what IPOPT's answers, and states read from files, are good for.

Near a singular state (flat, flat-folded, creases on each other) quantities follow powers of the distance d: closure
misses by d^2, an opening grows as d^2 or d^3, multipliers as 1/d.  So an opening of eps is a distance of sqrt(eps):
nothing finer than `CONTACT_TOL` can be distinguished from touching, and nothing coarser may be called so.
"""

EPS = 2.0**-52
"""Spacing of doubles at 1."""

# exact
NONZERO = 1e-300
"""Divisors are at least this, so that 0 over 0 is 0: no number that comes of sums of doubles near 1 is so small."""
ROUNDED = 1e-14
"""Largest entry of loop closure that rounding leaves: some 50 eps, a product of up to a few tens of folds."""
CLOSURE_TOL = 1e-12
"""A state closes: rounding of a product of up to 1,000 folds, and of sector angles made exact."""
SUMMED = 2e-14
"""Relations between sector angles [rad] that miss by less hold: sums of up to 14, each typed to 1e-15."""
FOLLOWED = 1e-13
"""Closure of points of a curve or small sphere: at distance d from a singular state any point closes to d^2, so at
the smallest radii (1e-6) only residuals below this are conclusive."""
OUTSIDE = 1e-12
"""A state is beyond a fold limit, a mirror, the axis or another facet: more than closing to `CLOSURE_TOL` can do, and
less than the depth of third order, (2e-4)^3, that crossing facets show on the smallest sphere around a singular
state."""
EXPLORED = 1e-11
"""Closure and held gaps of states on their way, which are closed to `CLOSURE_TOL` at the end, and fold angles [rad]
that stay at a limit on the way: ten times `CLOSURE_TOL`, so that one step of Newton more is saved."""
STATIONARY = 1e-11
"""Torque without balance, relative to the largest: 1e-16 through a KKT system of condition 1e5."""
LEVEL = 1e-12
"""Energies whose difference is no larger, relative to them and to the mean stiffness, are level: a sum of some hundred
rounded terms, with room."""
CURVED = 1e-12
"""Eigenvalues of a reduced Hessian below this share of the largest do not count as positive, and singular values in
least squares and eigenvalues of J'J below it do not count at all: n eps, with room."""
STEP_NOISE = 1e-10
"""Length of a step of Newton [rad] that is only rounding: `STATIONARY` over a tenth of the curvature of springs."""
DEPENDENT = 1e-10
"""Singular values of closure and contacts below this belong to constraints that are dependent all along a set: four
decades above `ROUNDED`, and below the distance at which a singular state is still distinguished, `CONTACT_TOL`."""
HELD = 1e-11
"""Contacts that miss being closed together by this, over the size of the pattern, are closed: `DEEP` / 100, which
is what facets that cross show."""
CARRIES = 1e-10
"""Multipliers over the mean stiffness up to this carry nothing: what is left of torque at `STATIONARY`, ten times."""

# polished
SAME_ENERGY = 1e-9
"""Energies, relative, that were found in different ways (sampled and exact, asked for and reached) are one: states are
known to `DUPLICATE_TOL`, so that energies of stationary ones differ by its square, and of others by a tenth of it."""
DEEP = 1e-9
"""Facets of a pattern that reach less than this share of its size into each other touch, and features further apart
are not looked at: rounding along walks of 100 creases, with room."""
INDEPENDENT = 1e-9
"""Slopes of contacts along unit directions, and singular values of unit rows, below this are zero: contacts that
differ do so by `RESOLVED` at least, equal ones by `ROUNDED`; two decades are left for products of slopes."""
BALANCED = 1e-9
"""Torque that multipliers >= 0 leave, relative to the largest: ten times what the linear program behind them (its
tolerance is 1e-10) leaves where too many contacts meet to list corners."""
INPUT_TOL = 1e-9
"""Stated angles [rad] and relative stiffnesses that differ by no more are meant to be equal: ten digits were typed."""
CONTACT_TOL = 1e-8
"""Opening of a closed contact: sqrt(eps / 2)."""
SINGULAR = 1e-8
"""Eigenvalues of a Hessian, 1 for springs alone, up to which its inverse is rounding: sqrt(eps / 2)."""
TINY = 1e-7
"""A step of a descent that moves no fold angle by more [rad] is no progress: its energy changes by the square of it."""
INSIDE = 1e-6
"""Share of their size by which features of facets meet inside each other: closer to a border more features meet, and
sides at less than a thousandth of a turn have no common normal to speak of (its square counts)."""
FIRM = 1e-7
"""Multipliers, and curvatures over that of the softest crease, up to this do not decide what a singular state is: they
are known to ten times `CONTACT_TOL` beside it, and states on small spheres around it decide."""
RANK = 1e-7
"""Singular values of closure (the largest are about 1) below this count as zero: they grow as the distance to the
singular state, and a state that touches to `CONTACT_TOL` is within a few times that of it."""
RESOLVED = 1e-7
"""Angles [rad] that differ, do so by more: relations between sector angles that miss by less are made exact, creases
and events that are closer are one.  Ten times `CONTACT_TOL`, so that none is taken for a contact."""
DUPLICATE_TOL = 1e-8
"""Two polished states whose fold angles differ by no more are one."""
SETTLED = 1e-6
"""Two ends of Newton, corners of curves, or roots on a circle are one: where a root is double, or curves touch, a
residual of `CLOSURE_TOL` is a distance of its square root."""
NEAR_CONTACT = 1e-6
"""A curve has reached a contact: the opening that is left after bisection of a step to 1e-9."""
DESIGN_ACTIVE = 1e-7
"""A rest angle this close to its bound [rad] is put there: a conic solver stops sqrt(1e-10) from an active bound at
worst, and less where the margin depends on it."""
DESIGN_FOUND = 1e-9
"""A minimum is the state that springs were made for [rad]: both are closed to `CLOSURE_TOL`, stiff to `DESIGN_MARGIN`
at least, and balanced to `ROUNDED`; their quotient is 1e-8 at worst, and 1e-14 as a rule."""

# coarse
PLACES = 1e-6
"""Places and angles of a drawing, over its size and in radians, that differ by less are one: files are written with six
digits or more, and corners of patterns are a tenth or more apart."""
ANSWERED = 1e-6
"""Constraints of an answer of IPOPT hold to this, and bound forces above it are no remains of its barrier: ten times
its tolerance of 1e-7."""
NARROW = 1e-5
"""Corners of facets narrower than this [rad] have no contact: ten times `INSIDE`, which leaves nothing between their
sides."""
ENDPOINT_TOL = 1e-5
"""A path downhill ends at a known state [rad]: where the polish fails it stops within some of its shortest steps,
1e-6."""
BESIDE_SINGULAR = 1e-5
"""Distance [rad] at which a state is distinguished from a singular one, and a vertex from a flat one: any fold angles
close there to its square, a hundred times `CLOSURE_TOL`."""
SAME_DIRECTION = 1e-5
"""Unit directions, bases and slopes that differ by less are one: subspaces are intersected to `RANK`, whose error grows
with the number of loops that they pass, a hundred at most."""
RISES = 1e-4
"""Slope of the energy, or of a contact, along a unit direction, over the largest torque: less does not count as rising,
nor as leading beyond a contact.  Ten times `SAME_DIRECTION`, to which directions are known."""
DECREASE = 1e-4
"""Share of the decrease to first order that a step must bring (Armijo's rule; Nocedal and Wright, Numerical
Optimization, section 3.1)."""
NOISE = 1e-4
"""Measured or drawn patterns are off by up to this, over their size and in radians: four digits (`DESIGN_SNAP`)."""
UNPOLISHED = 1e-5
"""Contacts and torques of an answer of IPOPT: its tolerance 1e-7 leaves sqrt(mu) ~ 1e-4.5 at weak contacts."""
CHOSEN = 2.0**-16
"""What is chosen by comparison (the largest, the first, a direction to go in) is rounded to this share of the largest
first: on different processors it differs by rounding, 1e-16, times the condition of what it was solved from, 1e4 as a
rule and 1e8 next to singular states, so that one comparison in 1e7, or 1e3, is left to that; and steps rounded so still
gain four digits each."""
NEAR_SINGULAR_TOL = 1e-3
"""Distance of IPOPT's answer from a singular state: the square root of its tolerance, with room."""
UNBALANCED = 1e-3
"""A residual of multipliers above this, relative, is no rounding of any solver: nothing balances, and no range of them
is looked for.  Answers of IPOPT leave up to sqrt(mu), `UNPOLISHED`, over a condition of a hundred."""
LOADED = 1e-2
"""Slack [rad] up to which a fold limit is closed where the force of the solver on it is larger than that: on the
central path their product is mu, at most 1e-4 on the way, where both are 1e-2."""
NEARLY = 1e-2
"""Fold angles [rad] this close to 0 or +-pi are called so in words, and may be so a step on: half a degree."""
SAMPLED = 0.05
"""A state is one of a sampled curve, and two curves are one where they end [rad]: half of the longest step of 0.1
between samples, so that the nearest one is no further off."""
DESIGN_SNAP = 1e-4
"""Fold angles [rad] that people state for a design: a contact that is open by less is meant to be closed, four digits
were typed."""
DESIGN_MARGIN = 1e-6
"""Smallest margin of a design, over the mean stiffness: ten decades above rounding, and what a conic solver with its
tolerance of 1e-10 leaves after division by the worst condition, 1e4."""
SHALLOW = 1e-4
"""Escape barriers below this share of sum k pi^2 / 2, the energy of all creases folded by pi: an error d of every rest
angle changes energy differences by up to (2 d / pi) of it, so that 1e-4 is what d = 1.6e-4 rad = 0.009 degrees may make
or remove. Nobody makes springs that well."""
