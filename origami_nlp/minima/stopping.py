"""When is there no more to find?  The Bayesian rule of Boender and Rinnooy Kan.

With n local searches from random starts that ended at w distinct minima, and every number and size of
basins equally likely beforehand, the expected number of minima not yet seen is w (w + 1) / (n - w
- 2) (Boender and Rinnooy Kan, "Bayesian stopping rules for multistart global optimization methods",
Math. Programming 37, 1987).  The search stops when this falls to one half.
"""

from __future__ import annotations

import math


def expected_undiscovered(searches: int, found: int) -> float:
    """Return the expected number of undiscovered minima; inf while too few searches say anything."""
    spare = searches - found - 2
    if found == 0:
        return 0.0 if searches else math.inf
    return found * (found + 1) / spare if spare > 0 else math.inf


def enough(searches: int, found: int, threshold: float = 0.5) -> bool:
    """Tell whether the expected number of undiscovered answers is at most `threshold`."""
    return expected_undiscovered(searches, found) <= threshold
