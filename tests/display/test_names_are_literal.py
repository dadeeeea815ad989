"""Names of users are drawn as they are: a dollar sign begins no formula."""

import io
from dataclasses import replace

from origami_nlp import analyze_mobility, examples
from origami_nlp.display import draw_states
from origami_nlp.pattern_states import draw_mobility

NAME = r"a $\frac{$ b_c ^ \x"


def drawn(figure):
    """Return all texts of a figure that was drawn, which fails where one is a broken formula."""
    figure.savefig(io.BytesIO(), format="svg")
    return " ".join(
        text.get_text() for text in figure.findobj(match=lambda a: hasattr(a, "get_text"))
    )


def test_of_sheets():
    pattern = replace(examples.pattern("miura", rows=2, columns=2), name=NAME)
    figure = draw_states(pattern, [(NAME, pattern.reference)], f"{NAME}: {NAME}")
    assert drawn(figure).count(r"\frac{") == 3
    assert drawn(draw_mobility(analyze_mobility(pattern))).count(r"\frac{")
