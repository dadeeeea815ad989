"""Bistable strip: three hinges with two wells each make eight states."""

import origami_nlp as o
from origami_nlp.hinges import bistable_strip

found = o.find_minima(bistable_strip(3))
for state in found.minima:
    print(state.energy, state.fold_angles)
o.draw(found, "bistable_strip.png")
