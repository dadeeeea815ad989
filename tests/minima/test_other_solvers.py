"""Other packages that carry solvers of their own may be imported before or after ours."""

import importlib.util
import subprocess
import sys

import pytest

OURS = """
import origami_nlp
scene = origami_nlp.examples.miura()
states = origami_nlp.find_minima(
    scene, max_starts=16, prove=False, escape=False
).minima
"""
PROGRAMME = """
import numpy as np
from origami_nlp.numerics import linear
from origami_nlp.kkt import find_multipliers
linear.MOST_CORNERS = 0  # SciPy's HiGHS as well
assert abs(find_multipliers(np.ones((1, 3)), np.array([2.0])).upper - 2).max() < 1e-9
"""
HIGHSPY = """
import highspy
solver = highspy.Highs()
solver.setOptionValue("output_flag", False)
x = solver.addVariable(lb=1.0, ub=2.0, obj=1.0)
solver.run()
assert solver.getInfo().objective_function_value == 1.0
"""


@pytest.mark.slow  # a second look at what other tests of the room say
@pytest.mark.skipif(
    importlib.util.find_spec("highspy") is None, reason="highspy (extra test) is not installed"
)
@pytest.mark.parametrize(
    "order",
    [(HIGHSPY, OURS, PROGRAMME), pytest.param((OURS, PROGRAMME, HIGHSPY), marks=pytest.mark.slow)],
)
def test_highspy_before_and_after(order):
    """Two builds of HiGHS in one process crashed as long as ours came with CasADi."""
    code = "\n".join([*order, "print(len(states))"])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    assert int(done.stdout.splitlines()[-1]) > 0  # HiGHS 1.16 prints a banner of its own before
