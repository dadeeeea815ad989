"""SVG drawn by hand: red mountains, blue valleys, black border."""

import origami_nlp as o

lines = {"red": "0,1 1,.8 2,1 M1,.8 1,2", "blue": "1,0 1,.8", "black": "0,0 2,0 2,2 0,2 0,0"}
paths = [f'<path stroke="{ink}" fill="none" d="M{p}"/>' for ink, p in lines.items()]
with open("hand.svg", "w") as file:
    file.write(f'<svg xmlns="http://www.w3.org/2000/svg">{"".join(paths)}</svg>')
sheet = o.read_pattern("hand.svg", stiffness=0.02, rest_angle=1.2)
found = o.find_minima(sheet)
print([(state.energy, state.kind) for state in found.minima])
o.draw(found, "svg_by_hand.png")
