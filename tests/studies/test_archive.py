"""The archive: complete, described, the same each time, and its states close by rotations of our own."""

import csv
import hashlib
import json
import time
import tomllib

import numpy as np
import pytest

from origami_nlp.actuation import actuate
from origami_nlp.errors import OutOfTime
from studies import archive as of, counts
from studies.archive import DICTIONARY, write_archive
from tests.command_line import run
from tests.independent.flat_descents import Sheet


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def hashes(folder):
    return {
        str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest()
        for p in folder.rglob("*")
        if p.is_file()
    }


def check(folder):
    """Go through what was written: checksums, dictionary, scenes, and states by their numbers."""
    found = hashes(folder)
    sums = dict(line.split("  ")[::-1] for line in (folder / "SHA256SUMS").read_text().splitlines())
    assert sums == {name: value for name, value in found.items() if name != "SHA256SUMS"}
    tables = {name for name in found if name.endswith(".csv")} - {"dictionary.csv"}
    described = {(r["file"], r["column"]) for r in rows(folder / "dictionary.csv")}
    columns = {(t, c) for t in tables for c in rows(folder / t)[0]}
    assert described == columns == {(f, c) for f, c, *_ in DICTIONARY}
    assert all(r["meaning"] for r in rows(folder / "dictionary.csv"))
    listed = {r["scene"]: int(r["states"]) for r in rows(folder / "lists.csv")}
    states = rows(folder / "states.csv")
    assert listed == {n: sum(s["scene"] == n for s in states) for n in listed}
    for state in states:
        assert state["certificate"]
        phi = np.radians([float(d) for d in state["fold_angles"].split()])
        sheet, k, rest = scene_of(folder / "scenes", state["scene"])
        assert np.abs(sheet.closure(phi)[0]).max() < 1e-6
        assert float(state["energy"]) == pytest.approx(float(k @ (phi - rest) ** 2) / 2, rel=1e-6)
    for row in rows(folder / "curves.csv"):
        phi = np.radians([float(d) for d in row["fold_angles"].split()])
        sheet, k, rest = scene_of(folder / "scenes", row["scene"])
        assert np.abs(sheet.closure(phi)[0]).max() < 1e-6
        assert float(row["energy"]) == pytest.approx(float(k @ (phi - rest) ** 2) / 2, rel=1e-6)
    for row in rows(folder / "waterbombs.csv"):
        n = int(row["creases"])
        at = np.arange(n) * 2 * np.pi / n
        corners = np.vstack([[0.0, 0.0], np.column_stack([np.cos(at), np.sin(at)])])
        phi = np.radians([float(row["mountain"]), float(row["valley"])] * (n // 2))
        assert np.abs(phi).max() < np.pi + 1e-6
        assert np.abs(Sheet(corners, [(0, i + 1) for i in range(n)]).closure(phi)[0]).max() < 1e-6
    stated = json.loads(of.BOXES.read_text())["boxes"]
    assert [
        [float(r[c]) for c in ("first", "second", "fourth")]
        for r in rows(folder / "at_most_four.csv")
    ] == stated
    assert rows(folder / "counts.csv")
    return found


def scene_of(folder, name):
    if (folder / f"{name}.toml").exists():
        scene = tomllib.loads((folder / f"{name}.toml").read_text())
        a = np.array([angle(x) for x in scene["vertex"]["sector_angles"]])
        azimuth = np.concatenate([[0.0], np.cumsum(a)[:-1]])
        corners = np.vstack([[0.0, 0.0], np.column_stack([np.cos(azimuth), np.sin(azimuth)])])
        k, rest = scene["creases"]["stiffness"], [angle(x) for x in scene["creases"]["rest_angles"]]
        ends = [(0, i + 1) for i in range(len(a))]
    else:
        scene = json.loads((folder / f"{name}.json").read_text())
        corners, ends = np.array(scene["corners"]), scene["creases"]
        k, rest = scene["stiffness"], np.radians(scene["rest_angles_deg"])
    return Sheet(corners, ends), np.array(k), np.array(rest)


def angle(text):
    """Radians, or a fraction of pi such as 31*pi/90."""
    if isinstance(text, int | float):
        return float(text)
    sign, (times, _, over) = (-1 if text[0] == "-" else 1), text.lstrip("-").partition("pi")
    return sign * float(times.rstrip("*") or 1) * np.pi / float(over.lstrip("/") or 1)


def test_a_small_archive_is_complete_and_the_same_twice(tmp_path, monkeypatch):
    monkeypatch.setattr(of, "VERTICES", {"six": of.VERTICES["six"]})
    monkeypatch.setattr(of, "SHEETS", (("metasheet", 2),))
    monkeypatch.setattr(of, "TWISTS", (44.9,))
    both = [tmp_path / name for name in ("one", "two")]
    for folder in both:
        folder.mkdir()
        write_archive(folder)
    assert check(both[0]) == hashes(both[1])


@pytest.mark.slow
def test_the_archive_by_its_command_is_complete_and_its_proof_is_confirmed(tmp_path):
    import subprocess
    import sys

    for name in ("one", "two"):
        subprocess.run([sys.executable, "-m", "studies", "archive", tmp_path / name], check=True)
    assert check(tmp_path / "one") == hashes(tmp_path / "two")
    assert run("check-proof", tmp_path / "one" / "certificates" / "six-limits.json").code == 0
    listed = {
        r["scene"]: (r["states"], r["complete"]) for r in rows(tmp_path / "one" / "lists.csv")
    }
    assert listed["six"] == listed["six-limits"] == ("6", "proved")


@pytest.mark.slow
def test_counts_of_twists():
    found = [counts.count_states("twists", 1, c, 1.0) for c in counts.CONTACTS]
    assert [(c.family, c.size, c.creases, c.vertices) for c in found] == [("twists", 1, 12, 4)] * 2
    assert all(c.certified == c.states for c in found)
    figure = counts.draw_counts(found)
    assert len(figure.axes[0].lines) >= 2


def test_twists_are_the_square_twist_of_the_examples_as_a_grid():
    one, other = (Sheet(s.corners, s.ends) for s in (counts.twists(1), counts.twists(2)))
    angles = {tuple(np.round(np.degrees(np.sort(np.arccos(np.clip((u * np.roll(u, -1, 0)).sum(1), -1, 1)))), 6))
              for sheet in (one, other) for _, u in sheet.rings}  # fmt: skip
    assert angles == {(60.0, 90.0, 90.0, 120.0)}


def test_the_page_has_the_numbers_of_the_recorded_run():
    recorded = json.loads(of.COUNTS.read_text())["counts"]
    page = (of.COUNTS.parent / "validation" / "sheet_counts.md").read_text(encoding="utf-8")
    assert [c for c in page.splitlines() if c.startswith("| ") and " x " in c] == lines(recorded)
    again = [counts.count_states("metasheet", n, "full", 20.0).states for n in (2, 3)]
    assert again == [
        c["states"]
        for c in recorded
        if (c["family"], c["contact"]) == ("metasheet", "full") and c["size"] < 4
    ]


def test_a_mesh_that_folds_flat_is_counted_by_its_proof_and_by_the_check():
    """202 is what the search of minutes lists as well (docs/validation/proof.md)."""
    found = counts.count_states("miura", 3, "fold-limits", 60.0)
    assert (found.states, found.certified, found.complete) == (202, 202, "proved by curves")
    late = counts.count_states("miura", 4, "fold-limits", 1e-3)
    assert (late.states, late.complete, late.is_whole) == (0, "searched", False)
    assert "time was over" in late.left_out


def test_springs_of_a_sheet_keep_their_time():
    with pytest.raises(OutOfTime, match=r"twists:4x4.*the time was over"):
        counts.sheet("twists", 4, 1e-3)
    began = time.monotonic()
    late = counts.count_states("twists", 8, "full", 1.0)
    assert time.monotonic() - began < 30 and not late.states and late.left_out


@pytest.mark.slow
def test_thousands_of_branches_are_compared_within_the_time():
    began = time.process_time()
    seen = actuate(counts.twists(5), seconds=10.0)
    assert time.process_time() - began < 15 and seen.left_out and seen.unique is None


def lines(recorded):
    """Rows of the table of the page."""
    out, seen = [], {(c["family"], c["size"]): {} for c in recorded}
    for c in recorded:
        whole = counts.SheetCount(**c).is_whole
        at_least = "" if whole else "at least "
        proved = " (proved)" if c["complete"].startswith("proved") else ""
        seen[c["family"], c["size"]][c["contact"]] = f"{at_least}{c['states']}{proved}"
    for family in counts.SIZES:
        for (name, size), both in seen.items():
            if name == family and len(both) == 2:
                out.append(f"| {name} | {size} x {size} | {both['full']} | {both['fold-limits']} |")
    return out
