"""Thick panels: tapered edges are stops, which hold the stable state."""

import origami_nlp as o
from origami_nlp.hinges import HINGE_EXAMPLES

found = o.find_minima(o.parse_scene(HINGE_EXAMPLES["thick-panel"]()))
for contact in found.minima[0].contacts:
    print(contact.text, contact.multiplier)  # the moment at the stop [N m]
o.draw(found, "thick_panels.png")
