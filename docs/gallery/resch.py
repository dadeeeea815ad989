"""Resch's triangles: in the lowest state a tuck is closed, and presses."""

import origami_nlp as o

found = o.find_minima(o.examples.resch(), prove=False)
for state in found.minima:
    print(state.energy, [(c.text, c.multiplier) for c in state.contacts])
o.draw(found, "resch.png")
