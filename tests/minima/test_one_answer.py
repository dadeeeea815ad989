"""One answer: the list of stable states, the frame and the words of the report count the same."""

import math
from dataclasses import replace

import numpy as np
import pytest

from origami_nlp import (
    Scene,
    Vertex,
    examples,
    find_barriers,
    find_minima,
)
from origami_nlp.errors import OptionError
from tests.computed_once import panel_result

REST = -110, 90, -90, 90, -110, 90, -90, 90
"""Of a vertex of which an older list had one count in each place."""


@pytest.mark.parametrize("kind", ["symmetric vertex", "vertex", "sheet", "crowded vertex"])
def test_the_list_and_the_frame_count_the_same(kind):
    found = {
        "symmetric vertex": lambda: panel_result(examples.degree6("pi/3", 1), full=True),
        "vertex": lambda: find_minima(examples.miura("pi/3"), prove=False),
        "sheet": lambda: find_minima("metasheet:2x2", prove=False),
        "crowded vertex": lambda: find_minima(
            Scene(Vertex((math.pi / 4,) * 8), (0.03,) * 8, tuple(np.radians(REST)), "auto", "full"),
            prove=False,
        ),
    }[kind]()
    rows = found.to_frame()
    assert set(map(type, rows["stable"])) <= {bool}
    assert sum(rows["stable"]) == len(found.stable) > 0
    for state, stable, shallow in zip(found.minima, rows["stable"], rows["shallow"], strict=True):
        assert stable == any(state is one for one in found.stable) and not (stable and shallow)


def test_without_contact_nothing_is_called_stable():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(vertex, (1, 2, 3, 2), (1.0, -0.5, 0.3, 0.8), "none", "fold-limits")
    found = find_minima(scene, prove=False)
    assert found.minima and not found.stable and not any(found.to_frame()["stable"])


def test_a_verb_takes_the_minima_of_its_own_origami_only():
    scene = examples.degree6("pi/4", ratio=0.01)
    stops = replace(scene, limits=((-3.0, 3.0),) * 6)
    others = [
        stops,
        replace(scene, contact="fold-limits"),
        examples.degree6("pi/4", ratio=2),
        examples.degree8(),
        "metasheet:2x3",
    ]
    for other in others:
        result = find_minima(other, max_starts=4)
        with pytest.raises(OptionError):
            find_barriers(scene, result)
    with pytest.raises(OptionError):
        find_barriers(scene, scene)
