"""A scene as a nonlinear program: closure, contacts, what is modelled, and the one test of admissibility."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
