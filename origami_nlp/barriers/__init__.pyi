from .figure import draw_barriers as draw_barriers
from .find import find_barriers as find_barriers
from .passes import Known as Known, Pass as Pass
from .result import Barriers as Barriers
