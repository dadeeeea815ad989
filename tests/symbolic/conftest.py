"""One run of the whole catalogue, shared by the tests that read its results."""

import pytest
from origami_nlp.symbolic.catalogue import Result, claims, decide_all

from tests.computed_once import once


@pytest.fixture(scope="session")
def run() -> list[Result]:
    verdicts = once("catalogue", lambda: [r.verdict for r in decide_all(claims(), workers=1)])
    return [Result(c, v) for c, v in zip(claims(), verdicts, strict=True)]
