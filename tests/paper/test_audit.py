"""Published candidates: read strictly, and each artefact named for what it is."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from origami_nlp.errors import SceneFileError
from origami_nlp.kkt import project
from origami_nlp.paper import Audit, audit_candidates, read_candidates
from origami_nlp.paper.audit import CAUSES
from origami_nlp.pattern import examples
from origami_nlp.pattern_problem import pose
from tests.command_line import run
from tests.computed_once import minima_once, panel_result

REFERENCE = Path(__file__).parents[3] / "shared" / "reference" / "authors_candidates.json"
STEP = math.pi / 256
known = pytest.mark.skipif(not REFERENCE.exists(), reason="authors_candidates.json is not here")


def record(phi: object, **changes: object) -> dict[str, object]:
    return {"degree": 6, "alpha": "pi/4", "ratio": 1.0, "phi": phi} | changes


BAD = {
    "{": "not valid JSON",
    '{"states": []}': '"records"',
    json.dumps([record([0] * 4, colour=1)]): "colour",
    json.dumps([{"degree": 6}]): "it takes each of degree, alpha, ratio, phi once",
    json.dumps([record([0] * 4, alpha="__import__('os')")]): "not an angle",
    json.dumps([record([0, 0, 0, 4])]): "phi[4]",
    json.dumps([record([0, 0, 0, 0, 0, 0.1])]): "phi[6]",
}


@pytest.mark.parametrize("text", BAD)
def test_bad_records_are_named_in_one_line(text: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.json"
    file.write_text(text)
    with pytest.raises(SceneFileError) as caught:
        read_candidates(file)
    assert BAD[text] in str(caught.value) and "\n" not in str(caught.value)
    assert run("paper", "audit", file).code == 2


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Audit, list[str]]:
    """Candidates made so that each must have one cause, audited; and these causes."""
    scene = examples.degree6("pi/4", 0.01)
    model = pose(scene)
    x = model.reduce(np.array(panel_result(scene).minima[0].fold_angles))

    def closed(phi2: float, phi3: float, guess: float) -> list[float]:
        y = np.array([guess, phi2, phi3, guess])
        for _ in range(50):  # phi_1 and phi_4 from closure, the chart coordinates held
            f, jac = model.closure(y)
            y[[0, 3]] -= np.linalg.lstsq(jac[:, [0, 3]], f, rcond=None)[0]
        assert np.abs(model.closure(y)[0]).max() < 1e-12
        return y.tolist()

    at = [round(v / STEP) * STEP for v in x[1:3]]
    other = pose(examples.degree6("pi/3", 1.0))
    crossing, _ = project(other, np.array([-1.65, 2.27, 2.27, -1.65]), ())
    rows = [
        (closed(at[0], at[1], x[0]), "pi/4", "exact"),
        (closed(at[0], at[1], x[0]), "pi/4", "duplicate"),
        (closed(at[0] + STEP, at[1], x[0]), "pi/4", "duplicate"),
        ([-3.0, 0.3, 0.4, 1.0], "pi/4", "does not close"),
        (closed(35 * STEP, -39 * STEP, -2.5), "pi/4", "grid jag"),
        (closed(10 * STEP, -11 * STEP, -1.5), "pi/4", "chart edge"),
        # phi_2 = +pi where the handle of alpha_1 = pi/3 has phi_2 = -pi: the same geometry, the wrong side
        ([math.pi - 2 * 2.3, math.pi, 2.3, -math.pi], "pi/3", "wrong side"),
        ([math.pi - 4.0, -math.pi, 2.0, -math.pi], "pi/3", "on a handle"),
        (crossing.tolist(), "pi/3", "not admissible"),
    ]
    file = tmp_path_factory.mktemp("audit") / "made.json"
    records = [record(phi, alpha=a, ratio=0.01 if a == "pi/4" else 1.0) for phi, a, _ in rows]
    file.write_text(json.dumps(records))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("origami_nlp.paper.audit.find_states", minima_once)  # panels
        return audit_candidates(read_candidates(file)), [cause for *_, cause in rows]


def test_every_artefact_is_named(made: tuple[Audit, list[str]]) -> None:
    found, causes = made
    assert [
        a.cause
        for a in sorted((a for p in found.panels for a in p.candidates), key=lambda a: a.number)
    ] == causes
    total = [int(cell) for cell in found.table().rows[-1][1:]]
    assert total[0] == len(causes) == sum(total[1 : 1 + len(CAUSES)])


@known
@pytest.mark.slow
def test_all_published_candidates() -> None:
    found = audit_candidates(read_candidates(REFERENCE))
    total = [int(cell) for cell in found.table().rows[-1][1:]]
    assert total == [659, 29, 179, 46, 162, 79, 30, 133, 0, 1, 0, 43, 29, 36]
