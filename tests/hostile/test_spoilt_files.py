"""Files of every format, spoilt: each is read or refused in a line, in its time and in 2 GB."""

import os
import subprocess
import sys

import pytest

from tests.documentation.pages import ROOT

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes of Unix")


def ends_well(count, first):
    words = [sys.executable, "-m", "tests.hostile", str(count), str(first)]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-1000:]


def test_two_of_each_format():
    ends_well(52, 0)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 3000, 500))
def test_three_thousand(first):
    ends_well(500, first)
