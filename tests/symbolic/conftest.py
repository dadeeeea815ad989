"""One run of the whole catalogue, shared by the tests that read its results."""

import time
from dataclasses import dataclass

import pytest
from origami_nlp.symbolic.catalogue import Result, claims, decide_all
from origami_nlp.symbolic.claim import Verdict

from tests.computed_once import once


@dataclass(frozen=True)
class Run:
    results: list[Result]
    seconds: float


@pytest.fixture(scope="session")
def run() -> Run:
    def decide() -> tuple[list[Verdict], float]:
        start = time.process_time()
        verdicts = [r.verdict for r in decide_all(claims(), workers=1)]
        return verdicts, time.process_time() - start

    verdicts, seconds = once("catalogue", decide)
    return Run([Result(c, v) for c, v in zip(claims(), verdicts, strict=True)], seconds)
