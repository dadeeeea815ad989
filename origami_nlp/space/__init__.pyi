from .figure import draw_space as draw_space
from .find import find_space as find_space
from .result import Space as Space
from .transitions import find_transitions as find_transitions
