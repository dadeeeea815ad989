"""How property tests draw: the same examples in the normal tests, random ones with the long studies."""

import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import settings

HERE = Path(__file__).parent
PROPERTY = "test_smallest_multipliers_satisfy_their_optimality_conditions"


def test_the_profile_follows_the_marker(request):
    random = request.config.option.markexpr == "slow"
    if not request.config.option.hypothesis_profile:
        assert settings().derandomize is not random


@pytest.mark.slow  # of whom it speaks: they say so themselves
def test_long_studies_repeat_the_property_tests_with_random_examples():
    command = [sys.executable, "-m", "pytest", "-q", "--collect-only"]
    file = HERE / "kkt" / "test_multiplier_sets.py"
    chosen = subprocess.run([*command, "-m", "slow", file], capture_output=True, text=True)
    assert PROPERTY in chosen.stdout
    assert "test_one_contact_described_many_times" not in chosen.stdout
