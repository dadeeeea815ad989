from . import cone as cone
from .events import Event as Event
from .family import Transition as Transition, TransitionSweep as TransitionSweep
from .transitions import find_transitions as find_transitions
