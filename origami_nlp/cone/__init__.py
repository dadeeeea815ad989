"""Waterbomb cones of any degree: branches, energies, minima of every branch, phase diagrams."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
