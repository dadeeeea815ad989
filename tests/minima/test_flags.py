"""Flags: each goes up for its own reason and no other, says cause and cure, and travels with the result.

``python -m tests.minima.test_flags`` writes `docs/flags.md`.
"""

import dataclasses
import json
import math
from functools import cache
from pathlib import Path

import pytest

from origami_nlp import MinimaResult, Scene, Vertex, examples, find_minima
from origami_nlp.display import Table
from origami_nlp.minima import ResultFlags, StateFlags
from origami_nlp.pattern_states import PatternFlags

PAGE = Path(__file__).parents[2] / "docs" / "flags.md"
HEAD = """# Flags: what can be bad about a result

`result.flags` and `result.minima[0].flags` hold one boolean for each way in which a list of minima, or one of them, can
be bad or needs care. `print(result.flags)` shows those that are up with cause and cure, `result.flags.to_frame()` all
of them, and `if result.flags: ...` asks whether any is up. In JSON they stand under `flags`. This page is made from
the docstrings.
"""


def page():
    """What `docs/flags.md` has to be."""
    parts = [HEAD]
    kinds = {ResultFlags: "Of a result", StateFlags: "Of a state", PatternFlags: "Of a pattern"}
    for kind, title in kinds.items():
        words = kind.__doc__.partition("Attributes")[0].split("\n\n")
        parts += [f"## {title}\n", *(" ".join(w.split()) + "\n" for w in words if w.strip())]
        rows = [(f"`{name}`", *reason) for name, reason in kind.reasons().items()]
        parts.append(Table(("flag", "cause", "cure"), rows).markdown())
    return "\n".join(parts)


def test_the_page_is_made_from_the_docstrings():
    assert PAGE.read_text() == page(), "run: python -m tests.minima.test_flags"


@pytest.mark.parametrize("kind", [ResultFlags, StateFlags, PatternFlags])
def test_every_flag_has_a_cause_and_a_cure(kind):
    names = [f.name for f in dataclasses.fields(kind)]
    reasons = kind.reasons()
    assert list(reasons) == names
    for cause, cure in reasons.values():
        assert cause.endswith(".") and cure.endswith(".") and len(cause) > 30 and len(cure) > 15
    assert not kind() and repr(kind()) == f"{kind.__name__}()"
    one = kind(**{names[0]: True})
    words = " ".join(str(one).split())
    assert one and one.up == (names[0],) and f"1 of {len(names)}" in words
    assert reasons[names[0]].cause.split(".")[0][:20] in words
    frame = pytest.importorskip("pandas") and one.to_frame()
    assert list(frame["up"]) == [True] + [False] * (len(names) - 1)
    assert names[0] in one._repr_html_() and names[1] not in one._repr_html_()


@cache
def proved():
    """Degree 6, alpha_1 = pi/3, equal springs: proved but for flat foldings, one of four unstable, two degenerate."""
    return find_minima(examples.degree6("pi/3", ratio=1), max_starts=32, full=True)


def test_a_proved_list_has_one_flag_and_its_states_have_theirs():
    result = proved()
    assert result.completeness.status == "proved-except-singular"
    assert result.flags.up == ("singular_states_open",)
    kinds = {m.kind: set(m.flags.up) for m in result.minima}
    assert kinds["contact-pinned"] == {"unstable_in_full_space"}
    assert kinds["contact-touching"] == {"touching_without_moment"}
    assert kinds["degenerate"] == {"degenerate", "multipliers_not_unique"}


def search_with(**changes):
    """The result as if nothing had been proved and the search had gone otherwise."""
    result = dataclasses.replace(proved(), completeness=None)
    return dataclasses.replace(result, search=dataclasses.replace(result.search, **changes))


@pytest.mark.parametrize(
    ("changes", "up"),
    [
        ({}, set()),
        ({"stopped_by": "cap"}, {"search_stopped_early"}),
        ({"stalled": 10_000}, {"starts_ended_nowhere"}),
        ({"seen_once": 2}, {"reached_once"}),
        ({"quiet": 0}, {"still_finding"}),
    ],
)
def test_a_search_that_went_badly_says_so(changes, up):
    good = {"stopped_by": "rule", "seen_once": 0, "quiet": 9}
    result = search_with(**good | changes)
    assert set(result.flags.up) == up | {"may_miss_minima"}
    assert all(
        name in result.report(verbose=True) and name in result.to_html(picture=False) for name in up
    )


def test_a_proof_that_adds_minima_says_so():
    scene = Scene(
        Vertex.from_degrees((120, 33, 42, 111, 54)),
        (3.88, 9.16, 2.56, 1.53, 1.46),
        (-2.47, -0.74, 1.53, -1.78, 2.71),
        "none",
        "fold-limits",
    )
    careless = find_minima(scene, max_starts=4, prove=True, escape=False)
    assert {"proof_added_minima", "facets_may_cross"} == set(careless.flags.up)


def noisy(noise, **options):
    """A square cross whose sector angles were measured with an error."""
    a = math.pi / 2
    angles = (a + noise, a - noise, a + noise, a - noise)
    return Scene(Vertex(angles), (1, 1, 1, 1), (1, 0.2, 1, 0.2), **options)


def test_a_scene_that_was_changed_says_so():
    averaged = noisy(1e-4, symmetry="D2", symmetry_tolerance=1e-3)
    assert averaged.adjusted > 0
    flags = find_minima(averaged, prove=False, full=False).flags
    assert flags.made_symmetric and flags.stability_not_asked
    moved = find_minima(noisy(1e-9, symmetry="none"), prove=False).flags
    assert moved.geometry_moved and not moved.made_symmetric and not moved.stability_not_asked
    kept = find_minima(noisy(1e-2, symmetry="none"), prove=False).flags
    assert not kept.geometry_moved and not kept.made_symmetric


def test_what_is_wrong_with_a_state():
    state = dataclasses.replace(proved().minima[0], full_space=None)
    assert state.flags.up == ()

    def up(**changes):
        return set(dataclasses.replace(state, **changes).flags.up)

    assert up(local_dimension=0) == {"isolated"}
    assert up(closure_residual=1e-9) == {"residual_above_tolerance"}
    assert up(kkt_residual=1e-9) == {"residual_above_tolerance"}
    assert up(kkt_residual=math.nan) == set()  # where nothing has to balance
    assert up(solver=dataclasses.replace(state.solver, moved=0.02, lower=True)) == {
        "solver_disagrees"
    }
    open_ = dataclasses.replace(proved().minima[0].full_space, verdict="undecided")
    assert up(full_space=open_) == {"not_decided_in_full_space"}
    bad = dataclasses.replace(state, closure_residual=1e-9)
    result = dataclasses.replace(proved(), minima=(bad,))
    assert set(result.flags.up) == {
        "residual_above_tolerance",
        "stability_not_asked",
        "singular_states_open",
    }
    empty = dataclasses.replace(proved(), minima=())
    assert set(empty.flags.up) == {"nothing_found", "singular_states_open"}


def test_flags_travel_with_json_and_older_files_are_read():
    data = json.loads(json.dumps(proved().to_dict()))
    assert data["flags"] == dataclasses.asdict(proved().flags)
    assert data["minima"][0]["flags"]["unstable_in_full_space"] is True
    assert MinimaResult.from_dict(data).flags == proved().flags
    del data["flags"]
    for state in data["minima"]:
        del state["flags"]
    again = MinimaResult.from_dict(data)
    assert [m.flags for m in again.minima] == [m.flags for m in proved().minima]


if __name__ == "__main__":
    PAGE.write_text(page())
