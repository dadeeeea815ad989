"""Load curve of a waterbomb, with other points laid over it."""

import numpy as np

import origami_nlp as o

path = o.load_path(o.examples.waterbomb(), 2, to=-0.06)
figure = o.draw(path)
angle = np.array([95, 80, 60, 40, 20, 5])  # made up: yours come from a test rig
torque = np.array([-0.002, -0.011, -0.023, -0.034, -0.043, -0.049])
figure.axes[0].plot(angle, torque, "k+", label="measured")
figure.axes[0].legend()
print(path.snaps[0].t, path.start_stiffness)
figure.savefig("force_displacement.png")
