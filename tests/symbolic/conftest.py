"""One run of the whole catalogue, shared by the tests that read its results."""

import time
from dataclasses import dataclass

import pytest

from symbolic.catalogue import Result, claims, decide_all


@dataclass(frozen=True)
class Run:
    results: list[Result]
    seconds: float


@pytest.fixture(scope="session")
def run() -> Run:
    start = time.perf_counter()
    results = decide_all(claims())
    return Run(results, time.perf_counter() - start)
