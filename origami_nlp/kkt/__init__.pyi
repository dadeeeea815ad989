from .certificates import judge_branch as judge_branch
from .classification import (
    Classification as Classification,
    Kind as Kind,
    Verdict as Verdict,
    classified as classified,
    classify as classify,
)
from .contact_forces import (
    OMIT as OMIT,
    ContactForce as ContactForce,
    contact_forces as contact_forces,
)
from .large import smallest_curvature as smallest_curvature
from .lower_dimensional import (
    lower_dimensional_at as lower_dimensional_at,
)
from .multipliers import Multipliers as Multipliers, find_multipliers as find_multipliers
from .neighbourhood import GOES as GOES, sample_neighbourhood as sample_neighbourhood
from .polishing import (
    Polished as Polished,
    Solve as Solve,
    exact_beside as exact_beside,
    newton as newton,
    polish as polish,
    polished_nearby as polished_nearby,
)
from .projection import project as project
from .singular_beside import (
    not_told_apart as not_told_apart,
    singular_beside as singular_beside,
)
from .state import State as State, Stratum as Stratum
from .tangent_cone import (
    TangentCone as TangentCone,
    by_known as by_known,
    combine as combine,
    cone_of as cone_of,
    loop_modes as loop_modes,
    tangent_cone as tangent_cone,
)
