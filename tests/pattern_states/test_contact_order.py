"""What touches at a state, and its order and multipliers as printed, hang on no rounding: of states, nor of kernels."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from tests.computed_once import thinned

# fold angles [rad] of minima of `resch:1x2` of which sides are shared by two facets, and start level
PRESSED = (0.7643559868232187, -1.939340977957689, 0.4820605546966459, -2.5312634054850065,
           -1.5781200978330272, -2.531263405485007, 0.21703791212232454, -1.7383616700147337,
           np.pi, -0.13244154838736696, 0.03661987801053614, np.pi,
           -1.5891062658001647, np.pi, -1.589106265800165, -1.7678531147506034)  # fmt: skip
CROSSED = (0.9322342738053324, -2.1970227228477346, 0.39007920856941775, -1.6162452463944812,
           -2.0684555603543893, -2.5512601702110245, 0.6135405563321474, -2.3247161707578785,
           0.5768639803962333, -2.468985026653538, -2.318160230414078, 0.9502504354050573,
           -2.2306498820420146, 0.4232282860192824, -2.0785575924384627, 2.8115195843913874)  # fmt: skip


def printed(phi: np.ndarray, compiled: bool, problem: PatternProblem | None = None) -> list[str]:
    """Judge a state, in C or in NumPy, and say what it is and what touches."""
    problem = problem or PatternProblem(o.examples.pattern("resch", 1, 2))
    if not compiled:
        vars(problem.crossings.poses)["compiled"] = None
    state = judge(problem, phi)
    facets = (f"{c.words()}; {c.facets} {c.corners}" for c in state.contacts)
    return [state.verdict, state.certificate, *facets]


@pytest.mark.parametrize("phi", thinned([(PRESSED,), (CROSSED,)], 2), ids=["pressed", "crossed"])
def test_contacts_are_printed_alike_whatever_rounding_does_to_the_state(phi) -> None:
    x, rng = np.array(phi), np.random.default_rng(8)
    first = printed(x, True)
    assert first[0] == "minimum" and len(first) >= 6
    free = np.abs(x) < np.pi
    judged_before = PatternProblem(o.examples.pattern("resch", 1, 2))
    for k in range(16):
        near = x + free * rng.choice([-1e-15, 0.0, 1e-15], len(x))
        assert printed(near, k % 2 == 0) == first
        # the numbers that a problem gives to gaps as they come say nothing either
        assert k % 4 or printed(near, True, judged_before) == first
