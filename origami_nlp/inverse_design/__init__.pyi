from .convex import ConvexDesign as ConvexDesign, scene_of as scene_of, solve as solve
from .figure import draw_design as draw_design
from .finding import design as design
from .infeasibility import Infeasibility as Infeasibility, why_not as why_not
from .result import Design as Design, HeldBarrier as HeldBarrier, HeldState as HeldState
from .targets import (
    ClosedTarget as ClosedTarget,
    EnergyBounds as EnergyBounds,
    Target as Target,
    Targets as Targets,
    place as place,
)
from .targets_file import (
    EXAMPLES as EXAMPLES,
    parse_targets as parse_targets,
    read_targets as read_targets,
)
from .transition_paths import (
    TransitionPath as TransitionPath,
    height as height,
    path_between as path_between,
)
