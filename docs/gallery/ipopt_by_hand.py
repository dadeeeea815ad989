"""IPOPT by hand: the same problem from 40 starts; ends off the lines are no minima."""

import casadi as ca
import numpy as np
from matplotlib.figure import Figure

import origami_nlp as o

problem = o.pose("miura:2x2")  # o.solve(problem, start) is the short way, with contact
starts = np.random.default_rng(0).uniform(-2, 2, (40, problem.size))
nlp, quiet = problem.symbols().nlp(starts[0]), {"print_time": 0, "ipopt": {"print_level": 0}}
solve = ca.nlpsol("solve", "ipopt", {"x": nlp.x, "p": nlp.p, "f": nlp.f, "g": nlp.g}, quiet)
bounds = {"lbg": 0, "ubg": 0, "lbx": -np.pi, "ubx": np.pi, "p": problem.symbols().values}
ends = [problem.energy(np.array(solve(x0=x, **bounds)["x"]).ravel()) for x in starts]
minima = o.find_minima("miura:2x2", contact="fold-limits", prove=True).minima
axes = Figure(figsize=(5, 3.2), layout="tight").add_subplot(xlabel="start", ylabel="energy [J]")
axes.plot(sorted(ends), "o", [0, 39], [[m.energy for m in minima]] * 2, "k-")
axes.figure.savefig("ipopt_by_hand.png")
