"""Map over two parameters: how many stable states, between exact curves."""

import origami_nlp as o

scene = o.examples.degree6(1.1)
few = {"lines": 2, "across": 0, "effort": "quick"}
found = o.find_bifurcation_set(scene, "ratio=1:4", "alpha=63deg:75deg", **few)
print(found)
o.draw(found, "map_two_parameters.png")
