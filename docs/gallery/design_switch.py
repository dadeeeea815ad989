"""Design of a switch: springs that hold two given states with the largest margin."""

import origami_nlp as o
from origami_nlp.inverse_design import EXAMPLES, parse_targets

targets, ask, name = parse_targets(EXAMPLES["switch"], source="switch")
switch = o.design(targets)
print(switch)
o.draw(switch, "design_switch.png")
