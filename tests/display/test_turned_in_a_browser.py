"""The page that can be turned, in a real browser without network."""

from collections.abc import Iterator
from pathlib import Path

import pytest

import origami_nlp as o
from tests.browser import CHROMIUM, Browser, browser
from tests.computed_once import panel_result

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on PATH")
WEIGHT = "space.positions.reduce((a, v) => a + Math.abs(v), 0)"
"""A number that changes when what is drawn folds."""


PAINTED = """
(() => {
    render();
    const canvas = Object.assign(document.createElement("canvas"), {width: 400, height: 400});
    const pen = canvas.getContext("2d");
    pen.drawImage($('space').querySelector('canvas'), 0, 0, 400, 400);
    const pixels = pen.getImageData(0, 0, 400, 400).data;
    const found = {mountain: 0, valley: 0, upper: 0, lower: 0, nothing: 0};
    for (let k = 0; k < pixels.length; k += 4) {
      const [r, g, b, a] = pixels.slice(k, k + 4);
      if (a < 128 || Math.min(r, g, b) > 250) found.nothing += 1;
      else if (r > 2 * g && r > 2 * b) found.mountain += 1;
      else if (b > 2 * r && b > 1.5 * g) found.valley += 1;
      else if (r > g && g > b && r > 150 && r - b > 30) found.upper += 1;
      else if (b > g && g > r && r > 90) found.lower += 1;
    }
    return Object.fromEntries(Object.entries(found).map(([k, v]) => [k, v / 160000]));
})()
"""
"""Shares of the picture that have the colours of the key."""


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = tmp_path_factory.mktemp("browser")
    page = folder / "report.html"
    o.view(panel_result(o.examples.degree6("pi/3", 1.0), full=True), page)
    with browser(folder / "profile") as found:
        found.open(page)
        found.until("!!document.querySelector('#profile figure')")
        yield found
        assert not found.errors
        assert all(url.startswith(("file:", "data:", "blob:")) for url in found.asked)


def test_states_and_paths_are_chosen_and_the_slider_folds(opened: Browser) -> None:
    count = opened.ask("$('state').options.length")
    assert count == len(opened.ask("DATA.stations.map(s => s.title)")) > 3
    assert not opened.ask("$('step').disabled")  # it opens on its first path
    weights = []
    for k in range(count):
        opened.ask(f"$('state').value = {k}; $('state').dispatchEvent(new Event('change'))")
        weights.append(opened.ask(WEIGHT))
        angles = opened.ask("$('lines').textContent")
        assert "fold angles" in angles and "residuals" in angles
        opened.ask("render()")
        said = opened.ask("[...space.overlay.querySelectorAll('text')].map(t => t.textContent)")
        marks = opened.ask(f"DATA.stations[{k}].marks.map(m => m.label)")
        assert set(marks) <= set(said)
        assert opened.ask("$('step').disabled")
    assert len(set(weights)) > 2
    opened.ask("$('path').value = 1; $('path').dispatchEvent(new Event('change'))")
    last = opened.ask("Number($('step').max)")
    folded, reported = [], []
    for k in (0, 2, last):
        opened.ask(f"$('step').value = {k}; $('step').dispatchEvent(new Event('input'))")
        folded.append(opened.ask(WEIGHT))
        reported.append(opened.ask("$('where').textContent"))
    assert len(set(folded)) == 3 and len(set(reported)) == 3
    assert f"step {last + 1} of" in reported[-1]
    # what is drawn lies by the stored corners, up to the paper's thickness
    off = opened.ask(
        "(() => {const p = space.positions, s = DATA.tracks[0].states.at(-1);"
        "const at = p.filter((_, n) => n % 3 === 0).map((_, n) => p.slice(3 * n, 3 * n + 3));"
        "return Math.max(...s.corners.map(c => Math.min(...at.map(a => Math.hypot(...sub(a, c))))))})()"
    )
    assert off < 0.01


def test_paper_and_creases_are_painted(opened: Browser) -> None:
    """A state with mountains, valleys and both sides of the paper in sight shows them as pixels."""
    opened.ask("chooseState(0)")
    shares = opened.ask(PAINTED)
    assert all(share > 0.001 for share in shares.values()), shares
    assert 0.3 < shares["nothing"] < 0.95


@pytest.mark.parametrize("width", [1280, 400])
def test_nothing_is_wider_than_the_screen(opened: Browser, width: int) -> None:
    opened.resize(width, 900)
    opened.until(f"innerWidth === {width}")
    opened.until("$('space').clientWidth === $('space').querySelector('canvas').clientWidth")
    assert opened.ask("document.documentElement.scrollWidth") <= width
    for name in ("state", "path", "step", "before", "after"):
        left, right = opened.ask(
            f"(() => {{const r = $('{name}').getBoundingClientRect(); return [r.left, r.right]}})()"
        )
        assert 0 <= left < right <= width


def test_alone_a_state_turns_until_it_is_touched(tmp_path: Path) -> None:
    """As in a frame on the landing page of the site."""
    page = tmp_path / "page.html"
    o.view(panel_result(o.examples.degree6("pi/3", 1.0), full=True), page)
    with browser(tmp_path / "profile") as found:
        found.open(page, 400, 400, "#turning")
        found.until("!!document.querySelector('#space canvas')")
        names = "['title', 'state', 'path', 'lines', 'space']"
        seen = found.ask(f"{names}.filter(n => $(n).getClientRects().length)")
        assert seen == ["state", "space"]
        size = found.ask("[document.documentElement.scrollWidth, document.body.scrollHeight]")
        assert max(size) <= 400
        where = "space.camera.position.toArray()"
        first = found.ask(where)
        found.until(f"length(sub({where}, {first})) > 0.01")
        canvas = "$('space').querySelector('canvas')"
        for kind in ("mousePressed", "mouseReleased"):
            press = {"type": kind, "x": 200, "y": 250, "button": "left", "clickCount": 1}
            found.call("Input.dispatchMouseEvent", **press)
        stopped = found.ask(where)
        found.ask("new Promise(done => setTimeout(done, 200))")
        assert found.ask(where) == stopped
        found.ask(f"{canvas}.dispatchEvent(new KeyboardEvent('keydown', {{key: 'ArrowUp'}}))")
        assert found.ask(where) != stopped
        found.ask("$('after').click()")
        assert found.ask("$('state').value") == "1"
        assert not found.errors
