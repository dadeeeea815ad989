from . import cone as cone
from .audit import (
    PanelAudit as PanelAudit,
    audit_candidates as audit_candidates,
    audit_table as audit_table,
    audit_to_dict as audit_to_dict,
)
from .candidates import Candidate as Candidate, read_candidates as read_candidates
from .events import Event as Event
from .family import Transition as Transition, TransitionSweep as TransitionSweep
from .transitions import find_transitions as find_transitions
