from . import quaternion as quaternion
from .linear import (
    RANK_TOLERANCE as RANK_TOLERANCE,
    extremes as extremes,
    has_ray as has_ray,
    nearest as nearest,
    nearest_in_cone as nearest_in_cone,
    nonnegative_least_squares as nonnegative_least_squares,
    null_space as null_space,
    refined as refined,
)
from .vectors import cross as cross
