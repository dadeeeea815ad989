"""Property tests draw the same examples every time, and fresh ones with the long studies.

`pytest` is derandomised: it says the same on every machine.  `pytest -m slow` also repeats every
property test with random examples; what fails there is kept as an `@example` of its test.
"""

import gc
import importlib
import os

# small matrices: threads of linear algebra only get into each other's way, here and in started processes;
# said before NumPy loads
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import pytest  # noqa: E402
from hypothesis import HealthCheck, settings  # noqa: E402

from tests import computed_once  # noqa: E402

# a machine may be as slow as it is
patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("fixed", patient, derandomize=True)
settings.register_profile("random", patient, print_blob=True)


def _long(config):
    return config.option.markexpr == "slow"


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config):
    gc.disable()  # until all is collected: a fifth of the time of collection
    # what a file has computed serves its other tests; long studies are shared out one by one
    if getattr(config.option, "dist", "no") == "load" and not _long(config):
        config.option.dist = "loadfile"
    if not config.option.hypothesis_profile:
        settings.load_profile("random" if _long(config) else "fixed")


@pytest.fixture(scope="session", autouse=True)
def _folder_of_the_run(tmp_path_factory, pytestconfig):
    own = tmp_path_factory.getbasetemp()
    # workers of pytest-xdist have a folder each within that of the run
    computed_once.folder = own.parent if hasattr(pytestconfig, "workerinput") else own


SHARED = {
    "origami_nlp.chart.boundary": "_boundary",
}
"""What takes most of a search, the proof that nobody asked for, and most of a picture, the boundary of the chart;
barriers out of minima as well, and both of patterns."""


@pytest.fixture(scope="session", autouse=True)
def _once_a_scene(_folder_of_the_run):
    """Tests search and draw the same scenes again, through the package, the command line and the documentation."""
    with pytest.MonkeyPatch.context() as patch:
        for module, name in SHARED.items():
            true = getattr(importlib.import_module(module), name)
            patch.setattr(f"{module}.{name}", computed_once.by_scene(true))
        proved = importlib.import_module("origami_nlp.pattern_states.proved")
        patch.setattr(proved, "prove_sheet", computed_once.prove_sheet)
        patch.setattr(proved, "prove", computed_once.prove)
        find = importlib.import_module("origami_nlp.pattern_states.find")
        patch.setattr(find, "with_escapes", computed_once.by_states(find.with_escapes))
        yield


def pytest_collection_finish():
    gc.freeze()
    gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    if _long(config):
        for item in items:
            if getattr(getattr(item, "obj", None), "is_hypothesis_test", False):
                item.add_marker(pytest.mark.slow)
