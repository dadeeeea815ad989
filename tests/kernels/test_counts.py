"""How many starts came back to the flat state does not hang on rounding, though closure is singular there."""

import os
import subprocess
import sys

from tests.kernels.compare import KERNELS


def test_starts_that_lead_back_to_the_flat_state_are_counted_alike() -> None:
    said = "import origami_nlp as o; s = o.find_minima(o.examples.pattern('miura', 1, 1, cell=True), effort='quick',"
    said += " escape=False).search; print(s.starts, s.open, s.flat)"
    counts = {
        subprocess.run(
            [sys.executable, "-c", said],
            env={**os.environ, **KERNELS[kernel], "ORIGAMI_NLP_COMPILED": "0"},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for kernel in ("Prescott", "Haswell")
    }
    assert len(counts) == 1 and counts != {""}
