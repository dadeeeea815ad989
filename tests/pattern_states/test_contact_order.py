"""What touches at a state, and its order and multipliers as printed, hang on no rounding: of states, nor of kernels."""

import numpy as np

import origami_nlp as o
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge

# fold angles [rad] of a minimum of `resch:1x2` of which sides are shared by two facets, and start level
PRESSED = (0.7643559868232187, -1.939340977957689, 0.4820605546966459, -2.5312634054850065,
           -1.5781200978330272, -2.531263405485007, 0.21703791212232454, -1.7383616700147337,
           np.pi, -0.13244154838736696, 0.03661987801053614, np.pi,
           -1.5891062658001647, np.pi, -1.589106265800165, -1.7678531147506034)  # fmt: skip


def printed(phi: np.ndarray, compiled: bool, problem: PatternProblem | None = None) -> list[str]:
    """Judge a state, in C or in NumPy, and say what it is and what touches."""
    problem = problem or PatternProblem(o.examples.pattern("resch", 1, 2))
    if not compiled:
        vars(problem.crossings.poses)["compiled"] = None
    state = judge(problem, phi)
    facets = (f"{c.words()}; {c.facets} {c.corners}" for c in state.contacts)
    return [state.verdict, state.certificate, *facets]


def test_contacts_are_printed_alike_whatever_rounding_does_to_the_state() -> None:
    x, rng = np.array(PRESSED), np.random.default_rng(8)
    first = printed(x, True)
    assert first[0] == "minimum" and len(first) >= 6
    free = np.abs(x) < np.pi
    judged_before = PatternProblem(o.examples.pattern("resch", 1, 2))
    for k in range(16):
        near = x + free * rng.choice([-1e-15, 0.0, 1e-15], len(x))
        assert printed(near, k % 2 == 0) == first
        # the numbers that a problem gives to gaps as they come say nothing either
        assert k % 4 or printed(near, True, judged_before) == first
