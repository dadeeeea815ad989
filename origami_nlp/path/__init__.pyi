from .curve import (
    CLOSED_TO as CLOSED_TO,
    BoundaryCurve as BoundaryCurve,
    Point as Point,
    advance as advance,
    correct as correct,
    evaluate as evaluate,
    follow_boundary as follow_boundary,
)
