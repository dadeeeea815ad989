from . import rounds as rounds
from .closing import Closing as Closing, Point as Point, balance as balance
from .crossings import Crossings as Crossings, model_rows as model_rows
from .family import Listed as Listed, StartFamily as StartFamily
from .hinge_sets import HingeSets as HingeSets
from .moments import Moments as Moments, is_chain as is_chain
from .near_flat import NearFlat as NearFlat, NearFolded as NearFolded
from .of_patterns import (
    Given as Given,
    Grown as Grown,
    Popped as Popped,
    Uniform as Uniform,
    UniformShut as UniformShut,
    creases_around as creases_around,
    families_in_turn as families_in_turn,
)
from .options import (
    EFFORTS as EFFORTS,
    OWN as OWN,
    SearchOptions as SearchOptions,
    options_of as options_of,
)
from .pinches import close_pinched as close_pinched
from .projected import BATCH as BATCH, Projected as Projected, states_on_limits as states_on_limits
from .rounds import (
    CORNER as CORNER,
    DRAWN as DRAWN,
    GIVEN as GIVEN,
    SOURCES as SOURCES,
    Rounds as Rounds,
)
from .samples import Ends as Ends, Samples as Samples, joined as joined, put as put
from .singular import (
    FlatFoldings as FlatFoldings,
    RestState as RestState,
    RigidStates as RigidStates,
    flat_foldings as flat_foldings,
)
from .strata import (
    Corners as Corners,
    Interior as Interior,
    NearCorners as NearCorners,
    Strata as Strata,
)
from .touch_strata import Row as Row, TouchStrata as TouchStrata, list_strata as list_strata
from .touches import (
    Touches as Touches,
    TouchStarts as TouchStarts,
    model_strata as model_strata,
    touch_starts as touch_starts,
)
