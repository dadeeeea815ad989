from .examples import HINGE_EXAMPLES as HINGE_EXAMPLES, bistable_strip as bistable_strip
from .figure import draw_hinge as draw_hinge
from .finding import fit_hinge as fit_hinge
from .result import HingeRest as HingeRest, MeasuredHinge as MeasuredHinge
