"""Miura vertex: stable as in the sheet, and folded in half."""

import origami_nlp as o

found = o.find_minima(o.examples.miura("pi/3"))
print(found)
o.draw(found, "miura_vertex.png")
