"""Hand-over to bar-and-hinge models: nodes, bars, hinges of a state."""

import numpy as np
from matplotlib.figure import Figure

import origami_nlp as o

found = o.find_minima("miura:2x3", starts=4)
sheet, (nodes, faces) = found.pattern, found.to_mesh(1)
bars = np.array([*sheet.ends, *sheet.other_sides, *((f[0], f[2]) for f in faces)])
length = np.linalg.norm(np.subtract(*nodes[sheet.ends.T]), axis=1)
hinges = np.c_[sheet.ends, sheet.stiffness / length, sheet.rest]  # stiffness per length
np.savez("hand_over.npz", nodes=nodes, bars=bars, hinges=hinges)  # numbered from 0
print(len(nodes), len(bars), hinges[0])
axes = Figure(figsize=(5, 4)).add_subplot(projection="3d", aspect="equal")
axes.view_init(50, 40)
axes.plot(*np.insert(nodes[bars], 2, np.nan, axis=1).reshape(-1, 3).T, "k.-")
axes.figure.savefig("bar_and_hinge.png")
