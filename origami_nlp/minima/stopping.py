"""When is there no more to find?  What can be said without a proof, and no more than that.

Equal chances for all minima are not assumed: basins differ by factors of a thousand, and estimates that
assume so (Boender and Rinnooy Kan) were too small by factors of 5 to 40.  Chao's estimate from the minima seen once
and twice, f1 (f1 - 1) / (2 (f2 + 1)), is a lower bound in expectation for any chances (A. Chao, Scand. J. Statist. 11,
1984).  After N starts that found nothing new, the minima not yet seen draw less than a share 3/N of the starts, with
95 % confidence; nothing follows for their number.
"""

from __future__ import annotations

import math
from collections.abc import Sequence


def chao1(hits: Sequence[int]) -> float:
    """Return Chao's estimate of how many minima were never hit, from how often the others were."""
    once, twice = sum(h == 1 for h in hits), sum(h == 2 for h in hits)
    return once * (once - 1) / (2 * (twice + 1))


def chao1_error(hits: Sequence[int]) -> float:
    """Return the standard error of `chao1` (Chao 1987, from the variances of minima seen once and twice)."""
    once, twice = sum(h == 1 for h in hits), sum(h == 2 for h in hits)
    if not twice:
        return math.sqrt(max(once * (once - 1) / 2 + once * (2 * once - 1) ** 2 / 4, 0.0))
    r = once / twice
    return math.sqrt(twice * (r**4 / 4 + r**3 + r**2 / 2))


def unseen_share(quiet: int) -> float:
    """Return the share of starts that unseen minima draw at most (95 %), after `quiet` starts found nothing new."""
    return min(1.0, 3 / quiet) if quiet else 1.0
