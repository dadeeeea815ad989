"""Random points (r_k, nu_0) of cones."""

import math

import numpy as np

from origami_nlp.paper import cone

RATIOS = (1e-4, 1e4)


def points(degree, number, seed):
    """Random (r_k, nu_0): r_k log-uniform with its extremes, nu_0 uniform in its range with both signs."""
    rng = np.random.default_rng([seed, degree])
    ratios = 10 ** rng.uniform(*np.log10(RATIOS), number)
    ratios[:2] = RATIOS
    return ratios, rng.uniform(-cone.Cone(degree).steep_end, math.pi / 2, number)
