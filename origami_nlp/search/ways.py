"""What goes down from the starts of a problem."""

from __future__ import annotations

from typing import TypeAlias

from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.search.follow import Follower
from origami_nlp.search.ipopt import ByIpopt
from origami_nlp.search.newton import ByNewton

WayDown: TypeAlias = Follower | ByIpopt | ByNewton


def way_down(problem: PatternProblem, *, ipopt: bool = False) -> WayDown:
    """Return what goes down from starts: compiled descents, Newton's method where a problem is too large for these.

    IPOPT where it is asked for, or where there is no compiler.
    """
    follower = Follower(problem)
    if follower.usable and not ipopt:
        return follower
    return ByNewton(problem) if follower.descents.is_large and not ipopt else ByIpopt(problem)
