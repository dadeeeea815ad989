"""How many digits the references are computed with: a file asks for its own by `pytest.mark.usefixtures`."""

import pytest


@pytest.fixture
def fifty_digits():
    """Of mpmath, by which intervals and forms are judged."""
    with pytest.importorskip("mpmath").mp.workdps(50):
        yield
