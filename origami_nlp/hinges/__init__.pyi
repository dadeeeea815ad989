from .figure import draw_hinge as draw_hinge
from .finding import fit_hinge as fit_hinge
from .result import MeasuredHinge as MeasuredHinge, Rest as Rest
