"""Design of a switch: springs that hold two given states with the largest margin."""

import origami_nlp as o

switch = o.design("switch")
print(switch)
o.draw(switch, "design_switch.png")
