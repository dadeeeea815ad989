"""Waterbomb base: it snaps under a torque on its mountains."""

import origami_nlp as o

path = o.load_path(o.examples.waterbomb_base(), 1)
for snap in path.snaps:
    print(snap.t, snap.type, snap.kind)
o.draw(path, "waterbomb_snap.png")
