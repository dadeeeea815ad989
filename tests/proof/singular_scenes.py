"""Vertices with singular states, and these states, found without the package's proof."""

import itertools
import math

import numpy as np

from origami_nlp import Scene, Vertex, examples
from origami_nlp.problem import Kinematics, Model

KAWASAKI, CROSS, SIXTY = (60, 80, 120, 100), (90,) * 4, (60,) * 6
PAIRS, TWIST = (50, 60, 70, 110, 70), (90, 45, 90, 135)


def scene(degrees: tuple[int, ...], seed: int, symmetry: str = "none") -> Scene:
    """Random springs on a vertex; with a symmetry, the same on each orbit."""
    rng = np.random.default_rng(seed)
    n = len(degrees)
    k, rest = np.exp(rng.uniform(-1, 1, n)), rng.uniform(-3, 3, n)
    if symmetry != "none":
        plain = Scene(Vertex.from_degrees(degrees), (1.0,) * n, (0.0,) * n, symmetry, "fold-limits")
        orbit = Model(plain).variable_of_crease
        k, rest = k[orbit], rest[orbit]
    return Scene(Vertex.from_degrees(degrees), tuple(k), tuple(rest), symmetry, "fold-limits")


def flat_foldings(model: Model) -> np.ndarray:
    """All closed states with fold angles 0 and +-pi, [K, n]."""
    x = np.array(list(itertools.product((0, 1, -1), repeat=model.size))) * math.pi
    kinematics = Kinematics(model)
    at = kinematics.fold(x)
    return x[(np.abs(kinematics.closure(at)[0]).max(axis=1) < 1e-12) & (at.lift > 0)]


def touched(x: np.ndarray) -> list[tuple[int, ...]]:
    """All strata that a flat folding touches."""
    return list(itertools.product(*[(0, round(t)) if t else (0,) for t in x / math.pi]))


HANDLES = [
    (
        Scene(
            Vertex.from_degrees(CROSS),
            (1, 1.2, 0.8, 0.9),
            (0.7, -0.5, 1.1, 0.2),
            "none",
            "fold-limits",
        ),
        0,
        2,
    ),
    (examples.degree6("pi/3", 1.0, contact="fold-limits"), 1, 3),
]


def handles(plain: Scene, a: int, b: int) -> list[np.ndarray]:
    """States with creases a and b turned and in balance: the minimum of the energy on a line of closed states."""
    model = Model(plain)
    kinematics, out = Kinematics(model), []
    others = [i for i in range(model.size) if i not in (a, b)]
    for sides in itertools.product((0.0, math.pi, -math.pi), repeat=len(others)):
        for t, total in itertools.product((1, -1, 2, -2), np.arange(-4, 5) * math.pi / 2):
            line = np.tile(np.zeros(model.size), (3, 1))
            line[:, others] = sides
            line[:, a] = (0.0, 0.4, 1.0)
            line[:, b] = total - t * line[:, a]
            at = kinematics.fold(line)
            if np.abs(kinematics.closure(at)[0]).max() > 1e-12 or (at.lift <= 0).any():
                continue
            energy = model.energies(line)
            first = np.polyfit(line[:, a], energy, 2)
            x = line[0].copy()
            x[a] = -first[1] / (2 * first[0])
            x[b] = total - t * x[a]
            pair = np.abs(x[[a, b]])
            if pair.max() < math.pi - 0.01 and pair.min() > 0.01:
                out.append(x)
    return out
