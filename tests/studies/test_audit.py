"""Published candidates: read strictly, and each artefact named for what it is."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from origami_nlp.closed_forms import wedge3
from origami_nlp.errors import OptionError, SceneFileError
from origami_nlp.folding import check_admissible
from origami_nlp.kkt import State, project
from origami_nlp.minima import find_minima
from origami_nlp.pattern import examples
from origami_nlp.problem import Model
from studies import (
    as_markdown,
    audit_candidates,
    audit_to_dict,
    chart_distance,
    read_candidates,
)
from studies.__main__ import app
from studies.audit import CAUSES, PanelAudit, distance_from_stationary
from studies.audit_table import HEADS, totals
from studies.chart_states import chart_end, chart_point
from studies.closing import closing_alphas, mean_of_rows
from studies.published import Candidate, parse_csv, parse_json
from tests.command_line import run
from tests.computed_once import once, panel_result
from tests.independent import rotations

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / ".." / "shared" / "reference" / "authors_candidates.json"
STEP = math.pi / 256


@pytest.fixture(scope="module")
def reference() -> tuple[Candidate, ...]:
    if not REFERENCE.exists():
        pytest.skip("the authors' candidates are not on this machine")
    return read_candidates(REFERENCE)


def record(phi: object, **changes: object) -> dict[str, object]:
    return {"degree": 6, "alpha": "pi/4", "ratio": 1.0, "phi": phi} | changes


# --- the reader ---------------------------------------------------------------------------------

BAD = {
    "not json": ("{", "not valid JSON"),
    "no records": ('{"states": []}', '"records"'),
    "empty": ("[]", "no record"),
    "a number": ("[3]", "record 1 = '3' must be a table"),
    "unknown key": (json.dumps([record([0] * 4, colour=1)]), "unknown key 'colour'"),
    "missing": (json.dumps([{"degree": 6}]), "missing alpha, ratio, phi"),
    "twice": (json.dumps([record([0] * 4, rk=1.0)]), "'ratio' is given twice"),
    "degree": (json.dumps([record([0] * 4, degree=5)]), "degree = 5 must be 6 or 8"),
    "alpha": (json.dumps([record([0] * 4, alpha="__import__('os')")]), "is not an angle"),
    "alpha range": (json.dumps([record([0] * 4, alpha="pi")]), "must lie between 0 and pi/2"),
    "ratio": (json.dumps([record([0] * 4, ratio=-1)]), "must be a positive number"),
    "nan": ('[{"degree": 6, "alpha": 0.7, "ratio": NaN, "phi": [0, 0, 0, 0]}]', "positive number"),
    "length": (json.dumps([record([0] * 5)]), "phi has 5 entries"),
    "range": (json.dumps([record([0, 0, 0, 4])]), "phi[4] = 4 is outside [-pi, pi]"),
    "asymmetric": (json.dumps([record([0, 0, 0, 0, 0, 0.1])]), "phi[6] = 0.1 differs from phi[2]"),
    "text": (json.dumps([record("0,0,0,0")]), "must be a list of angles"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_records_are_named_in_one_line(case: str) -> None:
    text, message = BAD[case]
    with pytest.raises(SceneFileError) as caught:
        parse_json(text)
    assert message in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("degree,alpha,ratio,phi_1,phi_2,phi_3", "at least one record"),
        ("degree,alpha,ratio,psi_1\n6,1,1,0", "unknown column 'psi_1'"),
        ("degree,alpha,ratio,phi_2,phi_1,phi_3\n8,1,1,0,0,0", "phi_1 .. phi_N"),
        ("degree,alpha,ratio,phi_1,phi_2,phi_3\n8,1,1,0,0", "record 1 has 5 cells"),
        ("degree,alpha,ratio,phi_1,phi_2,phi_3\nsix,1,1,0,0,0", "degree = 'six'"),
        ("degree,alpha,ratio,phi_1,phi_2,phi_3\n8,1,one,0,0,0", "ratio = 'one'"),
        ("degree,alpha,ratio,phi_1,phi_2,phi_3\n8,1,1,0,,0", "is not an angle"),
    ],
)
def test_bad_csv_is_named_in_one_line(text: str, message: str) -> None:
    with pytest.raises(SceneFileError) as caught:
        parse_csv(text)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_csv_and_json_read_the_same(tmp_path: Path) -> None:
    rows = "degree,alpha,rk,phi_1,phi_2,phi_3,phi_4\n6,pi/4,1,-pi,0.1,0.2,0\n8,pi/6,100,0.1,-0.2,0.3,\n"
    (tmp_path / "states.csv").write_text(rows)
    from_csv = read_candidates(tmp_path / "states.csv")
    data = [
        record(["-pi", 0.1, 0.2, 0.0]),
        record([0.1, -0.2, 0.3], degree=8, alpha="pi/6", ratio=100),
    ]
    assert from_csv == parse_json(json.dumps({"records": data}))
    assert from_csv[0].fold_angles == (-math.pi, 0.1, 0.2, 0.0, 0.2, 0.1)
    assert from_csv[1].fold_angles == (0.1, -0.2, 0.3, -0.2, 0.1, -0.2, 0.3, -0.2)
    with pytest.raises(SceneFileError, match=r"must end in \.json or \.csv"):
        (tmp_path / "states.txt").write_text("")
        read_candidates(tmp_path / "states.txt")
    with pytest.raises(SceneFileError, match="cannot read"):
        read_candidates(tmp_path / "absent.json")


# --- charts, closure, stationarity --------------------------------------------------------------


def states_at(alpha: float, v: float, fold: float) -> list[np.ndarray]:
    """All states of the degree-8 family at a chart point, from the closed form."""
    found = (wedge3(2, alpha, v, fold, branch).value for branch in (1, -1))
    return [np.array([y[0], fold, y[1]]) for y in found if np.isfinite(y).all()]


def test_chart_point_inverts_the_closed_form() -> None:
    model, seen = Model(examples.degree8("pi/6", 1.0)), set()
    for v in (-0.7, -0.2, 0.3, 0.6):
        for fold in (-0.8, 0.5):
            for x in states_at(math.pi / 6, v, fold):
                assert np.abs(model.closure(x)[0]).max() < 1e-12
                assert chart_point(model, x) == pytest.approx((v, fold), abs=1e-9)
                seen.add((v > 0, fold > 0))
    assert len(seen) == 4


def test_chart_ends_where_the_manifold_does_not() -> None:
    alpha, fold = math.pi / 6, 1.1
    model = Model(examples.degree8(alpha, 1.0))
    edge = math.asin(math.sin(2 * alpha) * math.sin(fold / 2) ** 2)
    for beyond, ends in ((0.3 * STEP, True), (9 * STEP, False)):
        states = [x for sign in (1, -1) for x in states_at(alpha, sign * (edge + beyond), fold)]
        assert states
        for x in states:
            assert ("J = 0" in chart_end(model, x, STEP)) == ends
    book = Model(examples.degree6("pi/4", 1.0))
    near, _ = project(book, np.array([-1.7, 0.12, -0.13, -1.35]), ())
    assert "(0, 0)" in chart_end(book, near, STEP)
    away = book.reduce(np.array(panel_result(book.scene).minima[0].fold_angles))
    assert chart_end(book, away, STEP) == ""


def test_closing_alphas_find_the_vertex_of_a_state() -> None:
    for degree, make, alpha in ((8, examples.degree8, 5), (6, examples.degree6, 3)):
        scene = make(f"{alpha}*pi/12", 1.0)
        model = Model(scene)
        x = model.reduce(
            np.array(find_minima(scene, prove=False, escape=False).minima[0].fold_angles)
        )
        assert any(abs(a - alpha * math.pi / 12) < 1e-12 for a in closing_alphas(degree, x))
    assert closing_alphas(8, np.array([0.3, 0.4, 2.9])) == ()


def test_mean_of_two_rows_is_recognised() -> None:
    h, fold = math.pi / 128, 17 * math.pi / 128
    (up,), (down,) = (states_at(math.pi / 12, v, fold) for v in (h, -h))
    assert mean_of_rows((up + down) / 2) == pytest.approx(math.pi / 12)
    assert mean_of_rows(up) is None


def test_exact_minima_are_stationary_and_moved_ones_are_not() -> None:
    scene = examples.degree6("5*pi/12", 100.0)
    model = Model(scene)
    for m in panel_result(scene).minima:
        x = model.reduce(np.array(m.fold_angles))
        assert distance_from_stationary(State(model, x, 1e-7)) < 1e-9
        y, residual = project(model, x - 0.05 * np.sign(x), ())
        assert residual < 1e-12
        assert distance_from_stationary(State(model, y, 1e-7)) > 1e-3


# --- the audit ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def small() -> tuple[list[dict[str, object]], dict[int, str]]:
    """Candidates made so that each must have one cause, by number."""
    scene = examples.degree6("pi/4", 1.0)
    model = Model(scene)
    x = model.reduce(np.array(panel_result(scene).minima[0].fold_angles))

    def closed(phi2: float, phi3: float, guess: float = -1.0) -> list[float]:
        y = np.array([guess, phi2, phi3, guess])
        for _ in range(50):  # phi_1 and phi_4 from the two equations, the chart coordinates held
            f, jac = model.closure(y)
            y[[0, 3]] -= np.linalg.lstsq(jac[:, [0, 3]], f, rcond=None)[0]
        assert np.abs(model.closure(y)[0]).max() < 1e-12
        return y.tolist()

    at = [round(v / STEP) * STEP for v in x[1:3]]
    exact = closed(*at, guess=x[0])
    near = closed(at[0] + STEP, at[1], guess=x[0])
    chain = closed(35 * STEP, -39 * STEP, guess=-2.5)
    rows = [
        (exact, "exact"),
        (exact, "duplicate"),
        (near, "duplicate"),
        ([-3.0, 0.3, 0.4, 1.0], "does not close"),
        (chain, "grid jag"),
        (closed(10 * STEP, -11 * STEP, guess=-1.5), "chart edge"),
        ([-3.0, 0.3, 0.4, 1.0], "does not close"),  # a row that is no state, twice over
    ]
    data = [record(phi) for phi, _ in rows]
    causes = {n: cause for n, (_, cause) in enumerate(rows, start=1)}
    # phi_2 = +pi where the handle of alpha_1 = pi/3 has phi_2 = -pi: the same geometry, the wrong side
    data.append(record([math.pi - 2 * 2.3, math.pi, 2.3, -math.pi], alpha="pi/3"))
    causes[len(data)] = "wrong side"
    # on that handle, with the right side: the energy falls along it by 0.6 rad
    data.append(record([math.pi - 4.0, -math.pi, 2.0, -math.pi], alpha="pi/3"))
    causes[len(data)] = "on a handle"
    other = examples.degree6("pi/3", 1.0)
    crossing, residual = project(Model(other), np.array([-1.65, 2.27, 2.27, -1.65]), ())
    assert residual < 1e-12 and np.abs(crossing).max() < 3  # no fold angle at +-pi
    assert "cross" in check_admissible(other.vertex, Model(other).expand(crossing)).reason
    data.append(record(crossing.tolist(), alpha="pi/3"))
    causes[len(data)] = "not admissible"
    return data, causes


@pytest.fixture(scope="module")
def panels(small: tuple[list[dict[str, object]], dict[int, str]]) -> tuple[PanelAudit, ...]:
    return once("audit", lambda: audit_candidates(parse_json(json.dumps(small[0]))))


def test_every_artefact_is_named(
    small: tuple[list[dict[str, object]], dict[int, str]], panels: tuple[PanelAudit, ...]
) -> None:
    found = {a.candidate.number: a.cause for p in panels for a in p.audited}
    assert found == small[1]
    for p in panels:
        assert sum(p.count(cause) for cause in CAUSES) == len(p.audited)
        for a in p.audited:
            assert a.reason


def test_descents_lose_energy_and_end_at_listed_minima(panels: tuple[PanelAudit, ...]) -> None:
    followed = 0
    for p in panels:
        model = p.result.model
        for a in p.audited:
            if a.cause not in ("exact", "on a handle", "grid jag", "chart edge"):
                continue
            followed += 1
            assert a.minimum is not None and a.admissible and a.drop > 0
            x = np.array(a.candidate.independent)
            minimum = p.result.minima[a.minimum - 1]
            end = model.reduce(np.array(minimum.fold_angles))
            assert model.energy(x) - minimum.energy == pytest.approx(a.drop, rel=1e-6, abs=1e-12)
            assert np.abs(end - x).max() == pytest.approx(a.distance, abs=1e-6)
            assert chart_distance(model, x, end) == pytest.approx(
                a.grid_steps * p.grid_step, abs=1e-6
            )
    assert followed >= 4


def test_a_point_on_a_handle_slides_along_it(panels: tuple[PanelAudit, ...]) -> None:
    """phi_2 = phi_4 = -pi, phi_1 + 2 phi_3 = pi: the descent ends at the parabola's lowest point."""
    panel = next(p for p in panels if p.alpha == math.pi / 3)
    (a,) = [a for a in panel.audited if a.cause == "on a handle"]
    assert "creases 2, 6" in a.reason and "crease 4" in a.reason and a.minimum
    end = panel.result.minima[a.minimum - 1].fold_angles
    phi_3 = np.linspace(math.pi / 2, math.pi, 200_001)
    k, rest = panel.result.scene.stiffness, panel.result.scene.rest_angles
    u = k[0] * (math.pi - 2 * phi_3 - rest[0]) ** 2 + 2 * k[2] * (phi_3 - rest[2]) ** 2
    assert end[2] == pytest.approx(phi_3[u.argmin()], abs=1e-4)
    assert a.distance == pytest.approx(2 * (end[2] - 2.0), abs=1e-6)


def test_a_row_that_does_not_close_is_no_duplicate(panels: tuple[PanelAudit, ...]) -> None:
    first, again = (a for p in panels for a in p.audited if a.cause == "does not close")
    assert first.twin is None and again.twin == first.candidate.number
    assert again.closes_at == first.closes_at
    panel = next(p for p in panels if p.alpha == math.pi / 4)
    assert panel.count("does not close") == 2 and panel.count("duplicate") == 2


def test_command_writes_json_and_markdown(
    small: tuple[list[dict[str, object]], dict[int, str]], tmp_path: Path
) -> None:
    source = tmp_path / "states.json"
    source.write_text(json.dumps(small[0][:2]))
    target, table = tmp_path / "out.json", tmp_path / "out.md"
    done = run("audit", source, "-o", target, "-o", table, commands=app)
    assert done.code == 0 and "2 published candidates" in done.out
    data = json.loads(target.read_text())
    assert data["schema"] == "origami-nlp/audit/1"
    assert data["totals"]["exact"] == data["totals"]["duplicate"] == 1
    assert [c["number"] for c in data["panels"][0]["candidates"]] == [1, 2]
    assert "| degree 6, pi/4, 1 | 2 | 1 | 1 |" in table.read_text()
    bad = tmp_path / "bad.json"
    bad.write_text("[]")
    for wrong in ([bad], [source, "-o", tmp_path / "no" / "out.json"]):
        code, _, err = run("audit", *wrong, commands=app)
        assert code == 2 and err.count("\n") == 1


def test_nothing_to_audit_is_an_error() -> None:
    with pytest.raises(OptionError):
        audit_candidates([])


# --- the authors' file --------------------------------------------------------------------------


def test_thirty_rows_do_not_close(reference: tuple[Candidate, ...]) -> None:
    """By rotation matrices; fifteen different ones, each listed on both branches; docs/validation/audit.md says so."""
    open_rows: list[tuple[object, tuple[float, ...]]] = []
    for c in reference:
        sectors = np.array(c.scene(c.alpha).vertex.sector_angles)
        m = rotations.fold(sectors, np.array(c.fold_angles))[1][0]
        if np.linalg.norm(m - np.eye(3)) > 1e-5:  # |M - I| is 2 sqrt(2) |vec q|
            open_rows.append((c.panel, c.fold_angles))
    different = {(panel, tuple(np.round(phi, 5))) for panel, phi in open_rows}
    assert len(open_rows) == 30 and len(different) == 15
    text = " ".join((ROOT / "docs" / "validation" / "audit.md").read_text(encoding="utf-8").split())
    assert "**Rows that are no states (30).**" in text and "15 different ones" in text


@pytest.mark.slow
def test_pi6_files_are_of_another_vertex(reference: tuple[Candidate, ...]) -> None:
    panel = audit_candidates([c for c in reference if c.degree == 8 and c.alpha == math.pi / 6])
    own = [a for p in panel for a in p.audited if a.cause == "does not close"]
    assert own
    for a in own:
        mean = mean_of_rows(np.array(a.candidate.independent))
        at = [b for b in a.closes_at if abs(b - 5 * math.pi / 12) < 1e-12]
        assert at or mean == pytest.approx(5 * math.pi / 12), a.reason
    assert not any(p.represented for p in panel)


def test_book_fold_takes_the_chains_of_pi4(reference: tuple[Candidate, ...]) -> None:
    chosen = [c for c in reference if c.panel == (6, round(math.pi / 4, 12), 1.0)]
    (panel,) = audit_candidates(chosen)
    chain = [a for a in panel.audited if "chain" in a.candidate.kind]
    assert len(chain) == len(chosen) - 1
    for a in chain:
        assert a.cause == "grid jag" and a.minimum is not None
        assert panel.result.minima[a.minimum - 1].fold_angles == pytest.approx(
            (-math.pi, 0, 0, -math.pi, 0, 0), abs=1e-9
        )
        assert a.stationarity > 5e-3  # further from stationary than the paper's own tolerance


@pytest.mark.slow
def test_documented_table_is_the_output_of_the_command(reference: tuple[Candidate, ...]) -> None:
    panels = audit_candidates(reference)
    text = (ROOT / "docs" / "validation" / "audit.md").read_text(encoding="utf-8")
    table = [line for line in as_markdown(panels).splitlines() if line.startswith("|")]
    assert len(table) > 20 and all(line in text for line in table)
    assert len(audit_to_dict(panels)["panels"]) == 18
    assert int(totals(panels)[HEADS.index("undecided")]) == 0


def test_documented_table_adds_up() -> None:
    text = (ROOT / "docs" / "validation" / "audit.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| degree (\d), .*?\| ([\d |]+) \|$", text, re.MULTILINE)
    (line,) = re.findall(r"^\| \*\*all\*\* \| (.*) \|$", text, re.MULTILINE)
    total = [int(cell.strip("* ")) for cell in line.split("|")]
    cells = np.array([[int(cell) for cell in row.split("|")] for _, row in rows])
    heads = text[: text.index("\n|---|")].splitlines()[-1].strip("| ").split(" | ")[1:]
    assert len(rows) == 18 and cells.sum(axis=0).tolist() == total and len(heads) == len(total)
    assert total[0] == sum(n for n, head in zip(total, heads, strict=True) if head in CAUSES) == 659
