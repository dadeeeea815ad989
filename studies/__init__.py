"""The study of the source paper: audit of its candidates, appendix A, the numbers of section 5, its figures."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
