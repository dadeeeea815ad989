from .choosing import Choice as Choice, choose as choose
from .conic import (
    DEFINITE as DEFINITE,
    Answer as Answer,
    Programme as Programme,
    Rows as Rows,
    smatrix as smatrix,
)
from .convex import (
    Found as Found,
    Posed as Posed,
    scene_of as scene_of,
    springs_of as springs_of,
)
from .examples import EXAMPLES as EXAMPLES, example_targets as example_targets
from .figure import draw_design as draw_design
from .finding import design as design
from .moving import Moved as Moved, move_targets as move_targets
from .pressing import solve as solve
from .reasons import Reason as Reason, why_not as why_not
from .result import Design as Design, HeldBarrier as HeldBarrier, HeldState as HeldState
from .robustness import (
    Ended as Ended,
    Loss as Loss,
    Tolerance as Tolerance,
    line_of as line_of,
    lost_at as lost_at,
    tolerance_of as tolerance_of,
)
from .targets import (
    BarrierAsk as BarrierAsk,
    EnergyGap as EnergyGap,
    Placed as Placed,
    Target as Target,
    Targets as Targets,
    place as place,
)
from .targets_file import Ask as Ask, parse_targets as parse_targets, read_targets as read_targets
from .ways import Way as Way, height as height, ways_between as ways_between
