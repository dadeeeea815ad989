from . import cone as cone
from .events import Event as Event
from .family import Sweep as Sweep, Transition as Transition
from .transitions import find_transitions as find_transitions
