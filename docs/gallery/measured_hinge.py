"""Measured hinge: a law with its band and wells, fitted to a table."""

import numpy as np

import origami_nlp as o

angle = np.linspace(-2.1, 2.1, 141)
torque = 0.01 * angle * ((angle / 1.05) ** 2 - 1)
torque += 3e-4 * np.random.default_rng(0).normal(size=141)  # made, so that it can be compared
table = np.c_[angle, torque]
np.savetxt("tape.csv", table, delimiter=",", header="angle_rad,torque_Nm", comments="")
hinge = o.fit_hinge("tape.csv")  # hinge.law goes into Scene(laws=...)
print([rest.angle for rest in hinge.rests])
o.draw(hinge, "measured_hinge.png")
