"""The generated modules are up to date, load no SymPy, and refuse bad input."""

import subprocess
import sys

import numpy as np
import pytest
from origami_nlp.symbolic.generate import modules

from origami_nlp.closed_forms import (
    Reason,
    cone_contact_elevation,
    cone_fold_angles,
    cone_partial_angles,
    cone_roots,
    degree6,
    wedge3,
)
from origami_nlp.errors import OrigamiError


def test_generated_modules_are_up_to_date():
    for path, text in modules().items():
        assert path.read_text(encoding="utf-8") == text, (
            f"run python -m origami_nlp.symbolic.generate: {path}"
        )


def test_import_loads_neither_sympy_nor_casadi():
    code = (
        "import sys, origami_nlp.closed_forms;"
        "print([m for m in ('sympy', 'casadi', 'matplotlib') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_singular_points_are_flagged_not_guessed():
    book = degree6(0.7, 0.9, 0.0, 0.0)
    assert book.reason == Reason.SINGULAR
    assert np.all(np.isnan(book.value)) and np.all(np.isnan(book.first))
    flat8 = wedge3(2, 0.7, 0.0, 0.0, -1)
    assert flat8.reason == Reason.SINGULAR
    flat12 = wedge3(3, 0.5, 0.0, 0.0, -1)
    assert flat12.reason == Reason.FOLD
    assert np.abs(flat12.value).max() < 1e-15
    assert np.all(np.isnan(flat12.first))
    assert degree6(0.7, 0.9, np.nan, 0.1).reason == Reason.NOT_FINITE


def test_second_singular_point_of_degree6_creases_1_and_4_coincide():
    """Regular triangle of sector angles: at cos phi = -1/(1 + ..) crease 4 lies on crease 1."""
    a = np.pi / 3  # spherical triangle with sides pi/3: cos(angle) = cos a / (1 + cos a) = 1/3
    phi = np.pi - np.arccos(1 / 3)
    for sign in (1, -1):
        point = degree6(a, a, sign * phi, sign * phi)
        assert point.reason == Reason.SINGULAR or np.abs(point.first).max() > 1e12
    beside = degree6(a, a, phi + 1e-3, phi + 1e-3)
    assert beside.reason != Reason.SINGULAR


def test_reason_of_missing_states():
    assert wedge3(2, np.pi / 4, 0.1, 2.0, -1).reason == Reason.NO_SOLUTION
    assert wedge3(2, np.pi / 4, 0.1, 2.0, -1).existence < 0
    assert np.isnan(wedge3(2, np.pi / 4, 0.1, 2.0, -1).value).all()


def test_cone_contact():
    assert cone_contact_elevation(6) == pytest.approx(np.pi / 6, rel=1e-15)
    assert cone_contact_elevation(12) == pytest.approx(np.pi / 3, rel=1e-15)
    for degree in (6, 8, 10, 12, 1000):
        v = cone_contact_elevation(degree)
        assert cone_partial_angles(degree, v).value[1] == pytest.approx(-np.pi / 2, rel=1e-13)
        assert cone_partial_angles(degree, -v).value[0] == pytest.approx(np.pi / 2, rel=1e-13)
        assert cone_partial_angles(degree, v).value[0] < np.pi / 2


@pytest.mark.parametrize(
    "call",
    [
        lambda: degree6(-0.1, 1.0, 0.1, 0.2),
        lambda: degree6(2.0, 1.5, 0.1, 0.2),
        lambda: wedge3(1, 0.5, 0.1, 0.2, 1),
        lambda: wedge3(2, 2.0, 0.1, 0.2, 1),
        lambda: wedge3(2, 0.5, 0.1, 0.2, 0),
        lambda: cone_roots(7, 0.1),
        lambda: cone_roots(4, 0.1),
        lambda: cone_roots(6, 4.0),
        lambda: cone_fold_angles(6, 0.1, [1, 1]),
        lambda: cone_fold_angles(6, 0.1, [1, 1, 0]),
    ],
)
def test_bad_input_is_refused(call):
    with pytest.raises(OrigamiError):
        call()
