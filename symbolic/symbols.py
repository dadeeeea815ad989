"""The paper's symbols, shared by all claims, and the circles their proofs run on."""

from __future__ import annotations

import sympy as sp

from .identities import Circle, circle

alpha = sp.Symbol("alpha", real=True)
"""Sector angle (alpha_1 of the paper)."""
upsilon = sp.Symbol("upsilon", real=True)
"""Elevation angle."""
phi1, phi2, phi3, phi4 = sp.symbols("phi_1:5", real=True)
"""Fold angles."""

ALPHA: Circle = circle(alpha, "alpha")
UPSILON: Circle = circle(upsilon, "upsilon")
HALF1, HALF2, HALF3, HALF4 = (
    circle(p / 2, f"{i}") for i, p in enumerate((phi1, phi2, phi3, phi4), start=1)
)
"""Circles of the half fold angles phi_i / 2."""


def generic_crease(name: str) -> Circle:
    """Circle of the azimuth of a crease in general position."""
    return circle(sp.Symbol(f"theta_{name}", real=True), f"theta{name}")


def generic_fold(name: str) -> Circle:
    """Circle of half a fold angle in general position."""
    return circle(sp.Symbol(f"psi_{name}", real=True) / 2, f"psi{name}")
