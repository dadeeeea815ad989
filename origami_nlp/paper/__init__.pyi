from . import cone as cone
from .audit import Audit as Audit, audit_candidates as audit_candidates
from .candidates import Candidate as Candidate, read_candidates as read_candidates
from .critical import find_critical_points as find_critical_points
from .events import Event as Event
from .landscape import (
    ExactLandscape as ExactLandscape,
    find_landscape as find_landscape,
)
from .landscape_figure import draw_landscape as draw_landscape
from .morse import CriticalPoints as CriticalPoints
from .space import Space as Space, find_space as find_space
from .transitions import (
    Transition as Transition,
    Transitions as Transitions,
    find_transitions as find_transitions,
)
