"""FOLD in and out: a crease pattern as a dict, its states as folded frames."""

import json

import origami_nlp as o

found = o.find_minima(o.examples.crease_pattern("miura", 2, 2))
o.write_fold(found, "states.fold")
with open("states.fold") as file:
    frames = json.load(file)["file_frames"]
print([frame["frame_title"] for frame in frames])
print(found.coordinates(1))  # [corners, 3], as in the first frame
o.draw(found, "fold_in_out.png")
