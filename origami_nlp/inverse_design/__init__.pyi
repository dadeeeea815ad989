from .contact_choice import solve as solve
from .convex import (
    ConvexDesign as ConvexDesign,
    ConvexOptimum as ConvexOptimum,
    scene_of as scene_of,
    springs_of as springs_of,
)
from .examples import EXAMPLES as EXAMPLES, example_targets as example_targets
from .figure import draw_design as draw_design
from .finding import design as design
from .infeasibility import Infeasibility as Infeasibility, why_not as why_not
from .library import (
    LibraryProgram as LibraryProgram,
    fewest_wells as fewest_wells,
    read_library as read_library,
    wells_library as wells_library,
)
from .library_design import (
    LibraryDesign as LibraryDesign,
    design_with_library as design_with_library,
)
from .result import Design as Design, HeldBarrier as HeldBarrier, HeldState as HeldState
from .robustness import (
    Loss as Loss,
    LostAt as LostAt,
    Tolerance as Tolerance,
    line_of as line_of,
    lost_at as lost_at,
    tolerance_of as tolerance_of,
)
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
