from .family import print_transitions as print_transitions
from .figure import draw_space as draw_space
from .find import find_space as find_space
from .result import Space as Space, print_space as print_space
from .transitions import find_transitions as find_transitions
