from .figure import draw_space as draw_space
from .find import Space as Space, analyse_space as analyse_space
from .table import print_space as print_space, print_transitions as print_transitions
from .transitions import find_transitions as find_transitions
