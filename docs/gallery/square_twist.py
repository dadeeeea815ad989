"""Square twist: facets that bend tend to rigid ones as they stiffen."""

import origami_nlp as o
from origami_nlp.pattern import with_bending

rigid = o.examples.pattern("squaretwist")
for stiffness in (0.01, 0.1, 1, 10, None):  # of diagonals, per length; None: rigid facets
    sheet = rigid if stiffness is None else with_bending(rigid, stiffness)
    found = o.find_minima(sheet, starts=4, escape=False)
    inside = [state.energy for state in found.minima if state.kind == "interior"]
    print(stiffness, len(found.minima), min(inside))
o.draw(found, "square_twist.png")
