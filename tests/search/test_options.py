"""Options of a search, of continuation and of a proof: what is given has its effect, what makes no sense is refused."""

import dataclasses
import math

import pytest

import origami_nlp as o
from origami_nlp.continuation import ContinuationOptions
from origami_nlp.errors import OptionError
from origami_nlp.proof import ProofOptions
from origami_nlp.search import EFFORTS, SearchOptions

TWO_DOF = o.examples.degree6("pi/3")
QUARTIC = o.Scene(
    o.Vertex.from_degrees((70, 80, 120, 90)),
    (1, 2, 3, 2),
    (1, -0.5, 0.3, 0.8),
    "none",
    "fold-limits",
)


def searched(**changed):
    options = dataclasses.replace(EFFORTS["quick"], **changed)
    return o.find_minima(TWO_DOF, options=options, escape=False, prove=False)


def test_fields_of_a_search_have_their_effect():
    plain = searched()
    assert plain.search.effort == "own options"
    assert searched(in_a_row=40).search.drawn > plain.search.drawn
    assert searched(most_drawn=1).search.drawn <= plain.search.drawn


def test_an_effort_is_its_options():
    named = o.find_minima(TWO_DOF, effort="quick", escape=False, prove=False)
    assert named.search.by_source == searched().search.by_source
    assert [m.fold_angles for m in named.minima] == [m.fold_angles for m in searched().minima]


def test_fields_of_a_search_of_a_pattern_have_their_effect():
    def search(**changed):
        options = SearchOptions(**{"in_a_row": 1, **changed})
        return o.find_minima("metasheet:2x2", options=options, escape=False).search

    plain = search()
    assert search(in_a_row=90).drawn > plain.drawn
    assert search(most_traced=0).curves == 0 < plain.curves
    assert search(most_curves=1).curves == 1 < plain.curves
    assert search(in_a_row=0).drawn == 0


def test_fields_of_continuation_have_their_effect():
    scene = o.examples.degree6("5*pi/12")

    def path(**changed):
        return o.load_path(scene, 1, to=0.03, options=ContinuationOptions(**changed))

    plain = path()
    assert path(longest=0.005).steps > 2 * plain.steps
    assert path(turn=0.002).steps > plain.steps
    assert path(longest=0.005).legs[-1].points[-1].t == pytest.approx(plain.legs[-1].points[-1].t)
    stopped = path(longest=0.005, most=2)
    assert stopped.steps < plain.steps and stopped.legs[-1].points[-1].t != pytest.approx(0.03)


def test_fields_of_a_proof_have_their_effect():
    def asked(**options):
        return o.find_minima(QUARTIC, prove=ProofOptions(**options), escape=False).completeness

    proved = asked()
    assert proved.status == "proved"
    given_up = asked(boxes=5)
    assert given_up.status == "not-proved" and given_up.boxes < proved.boxes


@pytest.mark.parametrize(
    ("make", "name", "value"),
    [
        (SearchOptions, "most_drawn", 2.5),
        (SearchOptions, "in_a_row", -1),
        (ContinuationOptions, "longest", -1.0),
        (ContinuationOptions, "turn", math.nan),
        (ContinuationOptions, "growth", 0.5),
        (ContinuationOptions, "most", 0),
        (ProofOptions, "boxes", -3),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(make, name, value):
    with pytest.raises(OptionError) as refused:
        make(**{name: value})
    assert str(refused.value).startswith(f"{name} = {value}") and "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("origami", "parameter"),
    [(o.examples.degree6("pi/3"), "ratio=0.2:1"), ("metasheet:2x2", "stiffness[1]=0.5:2")],
    ids=("vertex", "pattern"),
)
def test_fields_of_continuation_have_their_effect_on_branches(origami, parameter):
    def followed(**changed):
        options = ContinuationOptions(**changed)
        return o.follow(origami, parameter, checks=1, max_starts=16, options=options)

    def points(atlas):
        return sum(len(branch.points) for branch in atlas.branches)

    plain, fine, cut = followed(), followed(longest=0.01), followed(longest=0.01, most=2)
    assert points(fine) > 2 * points(plain) > 0
    assert [e.type for e in fine.events] == [e.type for e in plain.events]
    assert [e.t for e in fine.events] == pytest.approx([e.t for e in plain.events], abs=1e-9)
    for t in (plain.parameter.low, 0.7, plain.parameter.high):
        energies = [[state.energy for state in atlas.at(t)] for atlas in (plain, fine)]
        assert energies[0] and energies[0] == pytest.approx(energies[1], rel=1e-9)
    # what is cut off says so, and reaches the end of the range nowhere
    assert points(cut) < points(fine)
    assert all("range" not in branch.ends for branch in cut.branches)


def test_options_of_another_kind_are_refused():
    for wrong in ({"options": "fast"}, {"prove": "now"}):
        with pytest.raises(OptionError, match=next(iter(wrong))):
            o.find_minima(TWO_DOF, **wrong)
    with pytest.raises(OptionError, match="options"):
        o.load_path(TWO_DOF, 1, to=0.03, options=3)


@pytest.mark.parametrize("kind", [SearchOptions, ContinuationOptions, ProofOptions])
def test_every_field_is_documented(kind):
    text = kind.__doc__.partition("Attributes")[2]
    named = {name for line in text.splitlines() for name in line.strip().split(", ")}
    assert {field.name for field in dataclasses.fields(kind)} <= named
    with pytest.raises(dataclasses.FrozenInstanceError):
        kind().most = 3
