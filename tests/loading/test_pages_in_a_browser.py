"""The pages of followed states, in a real browser: their sliders fold along branches and legs."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.bifurcation import follow
from tests.browser import CHROMIUM, browser

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on PATH"),
]
DRAWN = "JSON.stringify(space.positions)"


def atlas() -> o.display.Viewable:
    return follow(o.examples.degree6("5*pi/12"), "ratio=1:5", checks=1, full=False)


def load() -> o.display.Viewable:
    scene = o.examples.degree6("5*pi/12")
    return o.load_path(scene, 1, to=-0.15, confirm=False, full=False)


@pytest.mark.parametrize("make", [atlas, load])
def test_the_slider_folds_along_each_path(
    make: Callable[[], o.display.Viewable], tmp_path: Path
) -> None:
    found = make()
    page = tmp_path / "page.html"
    found.view().save(page)
    tracks = found.view_content().tracks
    with browser(tmp_path / "profile") as opened:
        opened.open(page)
        opened.until(
            "!!document.querySelector('#space canvas') && !!document.querySelector('#maps figure')"
        )
        assert opened.ask("$('path').options.length") == len(tracks) + 1
        for number, track in enumerate(tracks, start=1):
            opened.ask(f"$('path').value = {number}; $('path').dispatchEvent(new Event('change'))")
            last = opened.ask("Number($('step').max)")
            assert last == len(track.states) - 1
            drawn, reported = [], []
            for k in (0, last // 2, last):
                opened.ask(f"$('step').value = {k}; $('step').dispatchEvent(new Event('input'))")
                drawn.append(opened.ask(DRAWN))
                reported.append(opened.ask("$('where').textContent"))
            moved = np.ptp([state.fold_angles for state in track.states], axis=0).max() > 0.01
            assert len(set(reported)) == 3 and (len(set(drawn)) == 3 or not moved)
        (tmp_path / "page.png").write_bytes(opened.screenshot(whole=True))
        assert not opened.errors
        assert all(url.startswith(("file:", "data:", "blob:")) for url in opened.asked)
