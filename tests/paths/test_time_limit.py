"""What a survey does when its time is over."""

import origami_nlp as o
from origami_nlp.paths import survey


def test_no_branch_is_begun_when_the_time_is_over(monkeypatch):
    """A sheet may have many minima, and each takes long to begin with."""
    begun, add = [], survey._Survey.add

    def late(self, *given, **options):
        begun.append(given)
        self.interrupted = True
        return add(self, *given, **options)

    monkeypatch.setattr(survey._Survey, "add", late)
    atlas = o.follow(o.examples.degree6("pi/3"), "ratio=0.2:1", checks=1, max_starts=16, full=False)
    assert len(begun) == 1 and atlas.interrupted
