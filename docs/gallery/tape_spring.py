"""Tape spring: a crease that is stiff while straight, and buckles."""

import origami_nlp as o
from origami_nlp.hinges import HINGE_EXAMPLES

found = o.find_minima(o.parse_scene(HINGE_EXAMPLES["tape-spring"]()))
for state in found.minima:
    print(state.energy, state.fold_angles[0], state.escape.barrier)
o.draw(found, "tape_spring.png")
