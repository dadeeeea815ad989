"""The paper's coordinates of a symmetric vertex: energy over them, contact boundaries, admissible region."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
