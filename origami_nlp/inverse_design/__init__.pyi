from .contact_choice import solve as solve
from .convex import (
    ConvexDesign as ConvexDesign,
    ConvexOptimum as ConvexOptimum,
    scene_of as scene_of,
    springs_of as springs_of,
)
from .examples import EXAMPLES as EXAMPLES
from .figure import draw_design as draw_design
from .finding import design as design
from .infeasibility import Infeasibility as Infeasibility, why_not as why_not
from .result import Design as Design, HeldBarrier as HeldBarrier, HeldState as HeldState
from .targets import (
    BarrierAsk as BarrierAsk,
    ClosedTarget as ClosedTarget,
    EnergyGap as EnergyGap,
    Target as Target,
    Targets as Targets,
    place as place,
)
from .targets_file import Ask as Ask, parse_targets as parse_targets, read_targets as read_targets
from .transition_paths import (
    TransitionPath as TransitionPath,
    height as height,
    paths_between as paths_between,
)
