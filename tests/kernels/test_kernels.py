"""The same answers on every processor: kernels of OpenBLAS, and NumPy without its code for AVX-512, as processors."""

import json
import math
import subprocess
import sys

import numpy as np
import pytest

from origami_nlp.numerics import CHOSEN, coarse, first_largest, rank
from tests.kernels.answers import GROUPS, answered
from tests.kernels.compare import KERNELS, compared, differences

CORES = """
import ctypes, numpy, scipy.linalg
names = ("scipy_openblas_get_corename64_", "scipy_openblas_get_corename")
for path in {line.split()[-1] for line in open("/proc/self/maps") if "openblas" in line}:
    library = ctypes.CDLL(path)
    for name in names:
        if hasattr(library, name):
            get = getattr(library, name)
            get.restype = ctypes.c_char_p
            print(get().decode())
a = numpy.random.default_rng(0).normal(size=(50, 6, 6))
print(numpy.linalg.solve(a, a[::-1]).tobytes().hex()[:4000])
"""


def core(kernel):
    """What NumPy and SciPy run on with a kernel, and digits that it leaves."""
    from os import environ

    command = [sys.executable, "-c", CORES]
    done = subprocess.run(
        command, env={**environ, **KERNELS[kernel]}, capture_output=True, text=True, check=True
    )
    *names, digits = done.stdout.split()
    return names, digits


@pytest.mark.skipif(sys.platform != "linux", reason="reads which libraries are loaded")
def test_kernels_are_others_and_round_otherwise():
    (haswell, digits), (prescott, others) = core("Haswell"), core("Prescott")
    if not haswell:
        pytest.skip("linear algebra is no OpenBLAS here")
    assert not set(haswell) & set(prescott) and digits != others


@pytest.mark.slow  # .ci/run asks a part of all tests on the oldest kernel
def test_answers_are_the_same_on_two_kernels():
    """Of a vertex of degree 4."""
    count, wrong = compared("vertices", "Prescott", "0:1")
    assert count == 1 and not wrong


@pytest.mark.slow
@pytest.mark.parametrize("kernel", [*KERNELS][1:])
@pytest.mark.parametrize("group", GROUPS)
def test_all_answers_are_the_same_on_all_kernels(group, kernel):
    count, wrong = compared(group, kernel)
    assert count > 3 and not wrong


def test_the_comparison_sees_what_differs():
    one = {"kind": "interior", "why": "closes to 2e-16", "x": [1.0, 2.0], "seconds": 1.0, "n": 3}
    same = {"kind": "interior", "why": "closes to 7e-17", "x": [1.0, 2 + 1e-9], "seconds": 3.0}
    assert not list(differences(one, same | {"n": 3}))
    for wrong in ({"kind": "degenerate"}, {"x": [1.0]}, {"x": [1.0, 2.1]}, {"n": 4}, {"why": "no"}):
        assert len(list(differences(one, one | wrong))) == 1, wrong


def test_answers_hold_what_is_printed_and_the_data():
    answer = answered(next(GROUPS["vertices"]())[1])
    assert answer["printed"] and answer["data"]["schema"].startswith("origami-nlp/")
    json.dumps(answer)


# ---------------------------------------------------------------- the rules


def test_coarse_numbers_do_not_feel_rounding():
    rng = np.random.default_rng(0)
    a = rng.normal(size=(2000, 6)) * 10.0 ** rng.uniform(-9, 9, (2000, 1))
    b = a * (1 + 1e-15 * rng.uniform(-1, 1, a.shape))
    off = np.abs(coarse(a) - a).max(axis=1) / np.abs(a).max(axis=1)
    assert (coarse(a) == coarse(b)).all() and (a != b).any()
    assert CHOSEN / 8 < off.max() <= CHOSEN
    assert (coarse(np.zeros((1, 3))) == 0).all() and (coarse(a) == coarse(coarse(a))).all()


def test_of_equal_entries_the_first_is_taken_however_they_are_rounded():
    rng = np.random.default_rng(0)
    a = rng.integers(-3, 4, (2000, 5)) / 3
    b = a + 1e-15 * rng.uniform(-1, 1, a.shape)
    assert (first_largest(b) == a.argmax(axis=1)).all() and (b.argmax(axis=1) != a.argmax(1)).any()
    assert first_largest(np.array([-math.inf, -math.inf])) == 0
    assert first_largest(np.array([-math.inf, 1.0, 1 + 1e-3])) == 2


def test_images_of_one_energy_stand_in_an_order_that_rounding_does_not_change():
    states = [(0.5, (1.0, -2.0)), (0.5, (1.0, 2.0)), (0.25, (3.0, 0.0))]
    noise = np.random.default_rng(0).uniform(-1e-15, 1e-15, (50, 3, 3))
    orders = {
        tuple(sorted(range(3), key=lambda k: rank(states[k][0] + e[k, 0], states[k][1] + e[k, 1:])))
        for e in noise
    }
    assert orders == {(2, 0, 1)}
