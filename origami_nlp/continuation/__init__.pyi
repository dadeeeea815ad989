from .branch_segments import (
    AGAIN as AGAIN,
    LATE as LATE,
    START as START,
    BranchSegment as BranchSegment,
    SpecialPoint as SpecialPoint,
)
from .curve import (
    BoundaryCurve as BoundaryCurve,
    HeldCurve as HeldCurve,
    Point as Point,
    boundary_of as boundary_of,
    closing as closing,
    correct as correct,
    evaluate as evaluate,
    follow_boundary as follow_boundary,
    trace_held as trace_held,
)
from .diagram import (
    STEPS as STEPS,
    BifurcationDiagram as BifurcationDiagram,
    nearest as nearest,
)
from .equilibrium import Equilibrium as Equilibrium, EquilibriumCurve as EquilibriumCurve
from .event_curve import EventPoint as EventPoint, EventTracer as EventTracer
from .flat import flat_event as flat_event, flat_roots as flat_roots
from .line import (
    GeometryLine as GeometryLine,
    Line as Line,
    ParameterLine as ParameterLine,
    load_line as load_line,
)
from .one_sided_branches import is_equilibrium as is_equilibrium
from .tracer import (
    CLOSED_CURVE as CLOSED_CURVE,
    SINGULAR as SINGULAR,
    ContinuationOptions as ContinuationOptions,
    End as End,
    Trace as Trace,
    advance as advance,
    trace as trace,
    trace_ahead as trace_ahead,
)
