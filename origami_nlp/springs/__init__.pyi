from .conic import Answer as Answer, Programme as Programme, Rows as Rows
from .convex import (
    Found as Found,
    Posed as Posed,
    scene_of as scene_of,
    solve as solve,
    springs_of as springs_of,
)
from .finding import design as design
from .reasons import Reason as Reason, why_not as why_not
from .result import Design as Design, HeldState as HeldState
from .targets import (
    EnergyGap as EnergyGap,
    Placed as Placed,
    Target as Target,
    Targets as Targets,
    place as place,
)
from .targets_file import Ask as Ask, parse_targets as parse_targets, read_targets as read_targets
