"""Miura vertex: stable as in the sheet, and folded in half."""

import origami_nlp as o

found = o.find_minima(o.examples.miura("pi/3"))
for state in found.minima:
    print(state.energy, state.escape.barrier, state.fold_angles)
o.draw(found, "miura_vertex.png")
