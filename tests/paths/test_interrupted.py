"""Ctrl-C while states are followed: what was found is kept, and raised with the interrupt."""

import pytest

import origami_nlp as o
from origami_nlp.continuation import BifurcationDiagram
from origami_nlp.errors import Interrupted
from origami_nlp.paths import followed

SCENE = o.examples.degree6("pi/3", ratio=0.3)


@pytest.fixture
def after(monkeypatch):
    """Interrupt the user's way after so many half-branches."""

    def interrupt(many):
        follow, left = BifurcationDiagram._follow, [many]

        def counted(self, *given):
            left[0] -= 1
            if left[0] < 0:
                raise KeyboardInterrupt
            return follow(self, *given)

        monkeypatch.setattr(BifurcationDiagram, "_follow", counted)

    return interrupt


def test_follow_keeps_its_branches(after):
    whole = o.follow(SCENE, "ratio=0.2:1", checks=1, full=False)
    after(2)
    with pytest.raises(Interrupted) as stop:
        o.follow(SCENE, "ratio=0.2:1", checks=1, full=False)
    found = stop.value.result
    assert found.interrupted and 0 < len(found.branches) <= len(whole.branches)
    assert "interrupted" in str(found) and "time limit" not in str(found)


def test_a_load_path_keeps_its_legs(after):
    scene = o.examples.degree6("5*pi/12")
    whole = o.load_path(scene, 1, to=-0.2, unload=True)
    assert len(whole.legs) > 1
    after(2)
    with pytest.raises(Interrupted) as stop:
        o.load_path(scene, 1, to=-0.2, unload=True)
    found = stop.value.result
    assert found.interrupted and found.legs and "interrupted" in found.alarms[-1]
    assert found.legs[0].points[0] == whole.legs[0].points[0]


@pytest.mark.parametrize("what", ["follow", "load"])
def test_what_was_followed_is_kept_while_it_is_judged(monkeypatch, what):
    """Arcs that were not judged by then are undecided: no state is called stable that nobody looked at."""
    judged, own = [], followed.kind_of

    def second(arc, *, judged=True, seen=judged):
        seen.append(arc)
        if len(seen) == 2:
            raise KeyboardInterrupt
        return own(arc, judged=judged)

    monkeypatch.setattr(followed, "kind_of", second)
    with pytest.raises(Interrupted) as stop:
        if what == "follow":
            o.follow(SCENE, "ratio=0.2:1", checks=1, full=False)
        else:
            o.load_path(o.examples.degree6("5*pi/12"), 1, to=-0.2, unload=True)
    found = stop.value.result
    kinds = {b.kind for b in found.branches}
    assert found.interrupted and "undecided" in kinds and "interrupted" in str(found)
    assert what == "follow" or found.legs
