from . import starts as starts
from .certificates import CURVED as CURVED, judge_branch as judge_branch
from .classification import (
    Classification as Classification,
    ContactForce as ContactForce,
    Kind as Kind,
    classify as classify,
)
from .descent import Followed as Followed, follow as follow
from .loads import (
    Sensitivity as Sensitivity,
    loaded_model as loaded_model,
    moments_of as moments_of,
    sensitivity as sensitivity,
)
from .multipliers import Multipliers as Multipliers, find_multipliers as find_multipliers
from .neighbours import project as project, search_spheres as search_spheres
from .polishing import (
    BESIDE as BESIDE,
    CLOSES as CLOSES,
    Polished as Polished,
    Solve as Solve,
    exact_beside as exact_beside,
    guess_active as guess_active,
    newton as newton,
    polish as polish,
)
from .starts import (
    BATCH as BATCH,
    StartStream as StartStream,
    flat_foldings as flat_foldings,
    project_batch as project_batch,
    rest_state as rest_state,
    rigid_states as rigid_states,
)
from .stationarity import distance_from_stationary as distance_from_stationary
from .thin import (
    handle_minima as handle_minima,
    states_on_limits as states_on_limits,
    thin_at as thin_at,
)
