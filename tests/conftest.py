"""Property tests draw the same examples every time, and fresh ones with the long studies.

`pytest` is derandomised: it says the same on every machine.  `pytest -m slow` also repeats every
property test with random examples; what fails there is kept as an `@example` of its test.
"""

import os

# small matrices: threads of linear algebra only get into each other's way, here and in started processes;
# said before NumPy loads
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

from tests import computed_once  # noqa: E402

settings.register_profile("fixed", derandomize=True)
settings.register_profile("random", print_blob=True)


def _long(config):
    return config.option.markexpr == "slow"


def pytest_configure(config):
    if not config.option.hypothesis_profile:
        settings.load_profile("random" if _long(config) else "fixed")


@pytest.fixture(scope="session", autouse=True)
def _folder_of_the_run(tmp_path_factory, pytestconfig):
    own = tmp_path_factory.getbasetemp()
    # workers of pytest-xdist have a folder each within that of the run
    computed_once.folder = own.parent if hasattr(pytestconfig, "workerinput") else own


@pytest.fixture(scope="session", autouse=True)
def _unasked_proofs_once(_folder_of_the_run):
    """What takes most of a search is the proof that its list is complete; tests search the same scenes again."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("origami_nlp.minima.proved.prove", computed_once.proved_once)
        yield


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    if _long(config):
        for item in items:
            if getattr(getattr(item, "obj", None), "is_hypothesis_test", False):
                item.add_marker(pytest.mark.slow)
