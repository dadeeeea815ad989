"""Springs for states that are given: convex programs, proofs that there are none, and the check of every answer."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
