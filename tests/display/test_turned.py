"""The page that can be turned: its geometry and names against the package, its size, that it needs no network."""

import dataclasses
import json
import math
import re
from html.parser import HTMLParser
from importlib.resources import files
from typing import Any

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import display
from origami_nlp.chart import fold_vertex
from origami_nlp.display import (
    Body,
    Content,
    Crease,
    FoldedBody,
    Keyframe,
    Trajectory,
    rotation_onto,
)
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_problem import check_admissible
from tests.computed_once import panel_result

LARGEST = 2_000_000  # bytes of a page


@pytest.fixture(scope="module")
def result() -> MinimaResult:
    return panel_result(o.examples.degree6("pi/3", 1.0), full=True)


@pytest.fixture(scope="module")
def page(result: MinimaResult) -> str:
    return display.interactive_page(result.view_content())


def data_of(page: str) -> Any:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found[1])


def dihedral(points: np.ndarray, crease: Any, facets: Any) -> float:
    """The fold angle of a crease from corners alone: by the normals of the facets beside it, valley positive."""
    axis = points[crease["end"]] - points[crease["start"]]
    right, left = (
        np.cross(points[f[1]] - points[f[0]], points[f[2]] - points[f[0]])
        for f in (facets[crease["right"]], facets[crease["left"]])
    )
    sine = np.cross(right, left) @ axis / np.linalg.norm(axis)
    return math.atan2(sine, right @ left)


def test_states_on_the_page_are_those_of_the_package(page: str, result: MinimaResult) -> None:
    data = data_of(page)
    assert len(data["stations"]) == len(result.minima) > 3
    for station, m in zip(data["stations"], result.minima, strict=True):
        corners = np.array(station["corners"])
        rays, _ = fold_vertex(result.scene.vertex, np.array(m.fold_angles))
        ends = corners[1 : len(rays) + 1]  # beyond these are corners of the border
        turn = rotation_onto(ends, rays)
        assert np.abs(ends @ turn.T - rays).max() <= 1e-12 and not corners[0].any()
        assert station["energy"] == m.energy and f"{m.energy:.6g} J" in station["title"]
        # facets and creases of the body are so numbered that the corners alone give the fold angles back
        for crease, phi in zip(data["body"]["creases"], m.fold_angles, strict=True):
            found = dihedral(corners, crease, data["body"]["facets"])
            assert abs(math.remainder(found - phi, 2 * math.pi)) <= 1e-7


def test_contacts_are_named_with_their_moments(page: str, result: MinimaResult) -> None:
    data = data_of(page)
    assert any(m.contacts for m in result.minima)
    for station, m in zip(data["stations"], result.minima, strict=True):
        assert len(station["marks"]) == len(m.contacts)
        for mark, contact in zip(station["marks"], m.contacts, strict=True):
            assert "N m" in mark["label"] and any(contact.text in s for s in station["lines"])
            assert mark["loaded"] == (contact.multiplier_range[1] > 0)
            assert {c - 1 for c in contact.creases} <= set(mark["creases"])
            assert {f - 1 for f in contact.facets} <= set(mark["facets"])
        said = " ".join(station["lines"])
        assert m.certificate in said


def test_a_descent_is_a_path_of_admissible_states(page: str, result: MinimaResult) -> None:
    data = data_of(page)
    unstable = [m for m in result.minima if m.full_space and m.full_space.descent]
    assert len(data["tracks"]) == len(unstable) > 0
    for track, m in zip(data["tracks"], unstable, strict=True):
        assert m.full_space and m.full_space.descent
        stored = m.full_space.descent
        assert track["of"] == len(stored) and track["start"] == result.minima.index(m)
        assert np.all(np.diff(track["energy"]) < 0) and np.all(np.diff(track["parameter"]) > 0)
        for state, step in zip(track["states"], stored, strict=True):
            assert check_admissible(result.scene.vertex, np.array(step.fold_angles)).admissible
            rays, _ = fold_vertex(result.scene.vertex, np.array(step.fold_angles))
            corners = np.array(state["corners"])[1 : len(rays) + 1]
            assert np.abs(corners @ corners.T - rays @ rays.T).max() < 1e-5  # turned as a whole
            assert np.linalg.det(rotation_onto(rays, corners)) == pytest.approx(1)


class References(HTMLParser):
    """What a page would load."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        self.found += [
            v for k, v in attrs if k in ("src", "href", "srcset", "data", "action") and v
        ]


def test_page_is_small_and_loads_nothing(page: str) -> None:
    assert len(page.encode()) < LARGEST
    parser = References()
    parser.feed(page)
    assert all(reference.startswith("data:") for reference in parser.found)
    libraries = files("origami_nlp.display") / "page" / "libraries.min.js"
    own = page.replace(libraries.read_text("utf-8"), "").replace("http://www.w3.org/2000/svg", "")
    assert len(own) < 500_000 and not re.search(r"https?://|@import|url\(", own)


def test_text_of_a_user_stays_text(result: MinimaResult) -> None:
    name = "</script><b>&co<!--"
    scene = dataclasses.replace(result.scene, name=name)
    odd = display.interactive_page(dataclasses.replace(result, origami=scene).view_content())
    assert name not in odd and "<b>&co" not in odd
    assert data_of(odd)["title"] == scene.label


def test_jupyter_shows_the_page_in_a_frame_of_its_own(result: MinimaResult) -> None:
    shown = result.view()._repr_html_()
    (frame,) = re.findall(r'<iframe [^>]*srcdoc="([^"]*)"', shown)
    assert frame.startswith("&lt;!doctype html&gt;")


def sheet() -> Content:
    """Two squares and a crease between them: a body that is no single vertex."""
    body = Body(((0, 1, 2, 3), (0, 3, 4, 5)), (Crease(0, 3, 0, 1),))
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [-1, 1, 0], [-1, 0, 0.0]])
    states = []
    for phi in np.linspace(0, 2.5, 300):
        turned = corners.copy()
        turned[[4, 5], 0], turned[[4, 5], 2] = -math.cos(phi), math.sin(phi)
        states.append(FoldedBody(turned, np.array([phi]), phi**2 * (2 - phi), np.zeros((2, 3))))
    track = Trajectory("load", np.linspace(0, 1, 300), "load [N m]", tuple(states), np.eye(3), 0)
    return Content("sheet", body, (Keyframe("flat", states[0], np.eye(3)),), (track,))


def test_any_path_of_any_body_can_be_shown_and_long_ones_are_thinned() -> None:
    data = data_of(display.interactive_page(sheet()))
    (track,) = data["tracks"]
    assert track["of"] == 300 > len(track["states"]) > 50
    assert track["parameter"][0] == 0 and track["parameter"][-1] == 1
    stored = sheet().tracks[0]
    assert max(track["energy"]) == pytest.approx(max(s.energy for s in stored.states), rel=1e-6)
    for state in track["states"]:
        crease, facets = data["body"]["creases"][0], data["body"]["facets"]
        assert dihedral(np.array(state["corners"]), crease, facets) == pytest.approx(
            state["angles"][0], abs=1e-5
        )
