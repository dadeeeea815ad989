from . import rounds as rounds
from .closing import Closing as Closing, Point as Point, balance as balance
from .corners import Corners as Corners
from .crossings import Crossings as Crossings, model_rows as model_rows
from .family import Listed as Listed, StartFamily as StartFamily
from .foldings import FlatFoldings as FlatFoldings, flat_foldings as flat_foldings
from .given import Given as Given
from .grown import Grown as Grown, families_in_turn as families_in_turn
from .hinge_sets import HingeSets as HingeSets
from .moments import Moments as Moments, is_chain as is_chain
from .near_corners import NearCorners as NearCorners
from .near_flat import NearFlat as NearFlat
from .near_folded import NearFolded as NearFolded
from .on_limits import states_on_limits as states_on_limits
from .options import (
    EFFORTS as EFFORTS,
    OWN as OWN,
    SearchOptions as SearchOptions,
    options_of as options_of,
)
from .pinches import close_pinched as close_pinched
from .popped import Popped as Popped, creases_around as creases_around
from .projected import BATCH as BATCH, Projected as Projected
from .rest import RestState as RestState
from .rigid import RigidStates as RigidStates
from .rounds import (
    CORNER as CORNER,
    DRAWN as DRAWN,
    GIVEN as GIVEN,
    SOURCES as SOURCES,
    Rounds as Rounds,
)
from .samples import Ends as Ends, Samples as Samples, joined as joined, put as put
from .strata import Interior as Interior, Strata as Strata
from .touch_strata import Row as Row, TouchStrata as TouchStrata, list_strata as list_strata
from .touches import (
    Touches as Touches,
    TouchStarts as TouchStarts,
    model_strata as model_strata,
    touch_starts as touch_starts,
)
from .uniform import Uniform as Uniform, UniformShut as UniformShut
