from . import quaternion as quaternion
from .factors import (
    SYMMETRIC as SYMMETRIC,
    Factor as Factor,
    Matrix as Matrix,
    Normal as Normal,
    dense as dense,
)
from .groups import groups as groups
from .linear import (
    extremes as extremes,
    nearest as nearest,
    nearest_in_cone as nearest_in_cone,
    nonnegative_least_squares as nonnegative_least_squares,
    null_space as null_space,
    refined as refined,
    unbounded as unbounded,
)
from .merge_tree import Merge as Merge, MergeTree as MergeTree, merge_tree as merge_tree
from .roots import bracketed_roots as bracketed_roots, distinct as distinct
from .rounding import (
    coarse as coarse,
    first_largest as first_largest,
    rank as rank,
    residual_words as residual_words,
)
from .tolerances import (
    ANSWERED as ANSWERED,
    BALANCED as BALANCED,
    BESIDE as BESIDE,
    CHOSEN as CHOSEN,
    CLOSES as CLOSES,
    CURVED as CURVED,
    DEPENDENT as DEPENDENT,
    DESIGN_ACTIVE as DESIGN_ACTIVE,
    DESIGN_FOUND as DESIGN_FOUND,
    DESIGN_MARGIN as DESIGN_MARGIN,
    DESIGN_SNAP as DESIGN_SNAP,
    ENDS as ENDS,
    EPS as EPS,
    FOLLOWED as FOLLOWED,
    INDEPENDENT as INDEPENDENT,
    INSIDE as INSIDE,
    LEVEL as LEVEL,
    NEAR_CONTACT as NEAR_CONTACT,
    OUTSIDE as OUTSIDE,
    RANK as RANK,
    RESOLVED as RESOLVED,
    RISES as RISES,
    ROUNDED as ROUNDED,
    SAME as SAME,
    SAME_DIRECTION as SAME_DIRECTION,
    SETTLED as SETTLED,
    SHALLOW as SHALLOW,
    STATIONARY as STATIONARY,
    SUMMED as SUMMED,
    TOUCHES as TOUCHES,
    TYPED as TYPED,
    UNPOLISHED as UNPOLISHED,
)
from .vectors import cross as cross
