"""What others draw and cut: SVG, .cp and DXF, read as lines, made one planar drawing, and written."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
