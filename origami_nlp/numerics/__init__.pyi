from . import quaternion as quaternion
from .linear import (
    extremes as extremes,
    has_ray as has_ray,
    nearest as nearest,
    nearest_in_cone as nearest_in_cone,
    nonnegative_least_squares as nonnegative_least_squares,
    null_space as null_space,
    refined as refined,
)
from .roots import bracketed_roots as bracketed_roots, distinct as distinct
from .tolerances import (
    BESIDE as BESIDE,
    CLOSES as CLOSES,
    CURVED as CURVED,
    EPS as EPS,
    FOLLOWED as FOLLOWED,
    NEAR_CONTACT as NEAR_CONTACT,
    OUTSIDE as OUTSIDE,
    RANK as RANK,
    ROUNDED as ROUNDED,
    SAME as SAME,
    SETTLED as SETTLED,
    STATIONARY as STATIONARY,
    TOUCHES as TOUCHES,
    UNPOLISHED as UNPOLISHED,
)
from .vectors import cross as cross
