"""Poisson's ratio of a Miura cell as it folds, with its closed form."""

import numpy as np
from matplotlib.figure import Figure

import origami_nlp as o

cell = o.examples.pattern("miura", 1, 1, cell=True)
motion = o.find_motion(cell)
ratio = np.array([lattice.poisson[1] for lattice in motion.lattices])
angle = np.abs(motion.fold_angles[:, np.abs(cell.directions[:, 0]) < 0.999]).max(axis=1)
closed = -(np.tan(np.pi / 3) ** 2) * np.cos(angle / 2) ** 2
print(np.abs(ratio - closed)[1:-1].max() < 1e-6)
axes = Figure(figsize=(5, 3.2), layout="constrained").add_subplot(ylabel="Poisson's ratio")
axes.plot(np.degrees(angle), ratio, "o", np.degrees(angle), closed, "-")
axes.set_xlabel("fold angle of the zigzags [deg]")
axes.figure.savefig("poisson_ratio.png")
