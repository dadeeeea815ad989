from .branch_points import split as split
from .clearance import Clearance as Clearance, Stretches as Stretches
from .curve import (
    ClosureCurve as ClosureCurve,
    follow_curve as follow_curve,
    follow_from_flat as follow_from_flat,
    tangents as tangents,
)
from .drawing import (
    draw_mobility as draw_mobility,
    draw_motion as draw_motion,
)
from .find import METHODS as METHODS, find_states as find_states
from .flat_folded import (
    FlatFolded as FlatFolded,
    list_branches as list_branches,
    list_flat_folded as list_flat_folded,
)
from .interpolant import (
    Interpolant as Interpolant,
    halves as halves,
    interpolate as interpolate,
    wells as wells,
)
from .judgement import (
    judge as judge,
    judge_end as judge_end,
)
from .mobility import (
    Mobility as Mobility,
    PatternFlags as PatternFlags,
    analyze_mobility as analyze_mobility,
)
from .motion import Motion as Motion, find_motion as find_motion
from .pass_graph import (
    PassGraph as PassGraph,
    PathDown as PathDown,
    graph_of_curves as graph_of_curves,
)
from .proved import hold_against as hold_against
