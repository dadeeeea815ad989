"""Measured hinges: a law from angles and torques, how well it is known, and what it says of rest."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
