"""The generator accepts a stable form only where it equals the derived one: exact polynomial identities."""

import pytest
import sympy as sp
from origami_nlp.symbolic.generate_forms import require_equal


def test_generation_stops_when_a_stable_form_is_wrong():
    a = sp.Symbol("a", real=True)
    require_equal(sp.sin(a + 1), sp.sin(a) * sp.cos(1) + sp.cos(a) * sp.sin(1))
    with pytest.raises(AssertionError):
        require_equal(sp.sin(2 * a), sp.sin(a) * sp.cos(a))
