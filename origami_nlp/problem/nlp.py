"""A nonlinear program as CasADi symbols, for any solver."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np


@dataclass(frozen=True, eq=False)
class Nlp:
    """Symbols of min f(x, p) subject to lower <= g(x, p) <= upper; bounds on x are the caller's."""

    x: ca.SX
    p: ca.SX
    f: ca.SX
    g: ca.SX
    lower: np.ndarray
    upper: np.ndarray
