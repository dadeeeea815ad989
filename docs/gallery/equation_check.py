"""Equation check: a formula of the source paper is refuted, its correction proved."""

import numpy as np
from matplotlib.figure import Figure
from origami_nlp.symbolic.catalogue import claim_by_id, decide_all

(decided,) = decide_all([claim_by_id("s4.partial-valley")], workers=1)
print(decided.verdict.verdict, decided.verdict.corrected_proved)
v, s = np.linspace(-np.pi / 2, np.pi / 2, 400), np.sin(np.pi / 6)  # six creases
ratio = (np.cos(v) + np.sign(v) * s) / (1 + np.sign(v) * np.cos(v) * s)
axes = Figure(figsize=(5, 3.2), layout="constrained").add_subplot(xlabel="elevation [rad]")
axes.plot(v, np.arccos(np.abs(ratio)), label="printed")
axes.plot(v, np.arccos(ratio), "--", label="corrected")
axes.set_ylabel("partial fold angle of a valley [rad]")
axes.legend()
axes.figure.savefig("equation_check.png")
