"""Scripts of the gallery print and draw what its pages show."""

import json

import pytest

from tests import gallery
from tests.documentation import shell

NAMES = " ".join(gallery.ORDER.values()).split()
DEAR = (
    "waterbomb_snap square_twist kresling_tube resch bistable_strip map_two_parameters noise paper_panel "
    "miura_sheet yoshimura design_switch cone tape_spring barrier_graph metasheet "
    "bar_and_hinge fold_in_out svg_by_hand thick_panels ipopt_by_hand miura_vertex"
).split()
"""Scripts of a second and more wait for the long studies."""
MOST_LINES = 15


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n in DEAR)) for n in NAMES]
)
def test_a_script_prints_and_draws_what_is_shown(name):
    shown = json.loads(gallery.RECORD.read_text())[name]
    printed, picture = gallery.run(name)
    assert not shell.differs(shown["printed"], printed), "run python -m tests.gallery"
    assert not shell.differs(shown["picture"], picture), "run python -m tests.gallery"


def test_every_script_is_short_and_stands_on_the_page():
    scripts = {path.stem: path.read_text() for path in gallery.SCRIPTS.glob("*.py")}
    assert set(scripts) == set(NAMES) == {p.stem for p in gallery.FIGURES.iterdir()}
    for name, text in scripts.items():
        assert sum(bool(line.strip()) for line in text.splitlines()) <= MOST_LINES, name
    assert gallery.PAGE.read_text() == gallery.page()
