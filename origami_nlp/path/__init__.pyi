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
from .tracer import (
    SINGULAR as SINGULAR,
    End as End,
    Steps as Steps,
    Trace as Trace,
    advance as advance,
    trace as trace,
)
