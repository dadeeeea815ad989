from . import rounds as rounds
from .closing import EXPLORED as EXPLORED, Closing as Closing, Point as Point, balance as balance
from .crossings import Crossings as Crossings, model_rows as model_rows
from .foldings import flat_foldings as flat_foldings
from .hinge_sets import hinge_minima as hinge_minima
from .near_flat import flat_minima as flat_minima
from .near_folded import folded_minima as folded_minima
from .on_limits import states_on_limits as states_on_limits
from .pinches import close_pinched as close_pinched
from .projected import BATCH as BATCH, StartStream as StartStream
from .rest import rest_state as rest_state
from .rigid import rigid_states as rigid_states
from .rounds import (
    CORNER as CORNER,
    DRAWN as DRAWN,
    EFFORTS as EFFORTS,
    GIVEN as GIVEN,
    SOURCES as SOURCES,
    Effort as Effort,
    Rounds as Rounds,
    effort_of as effort_of,
    is_chain as is_chain,
)
from .samples import Ends as Ends, Samples as Samples, joined as joined, put as put
from .touch_strata import Row as Row, TouchStrata as TouchStrata, list_strata as list_strata
from .touches import (
    TouchStarts as TouchStarts,
    model_strata as model_strata,
    touch_starts as touch_starts,
)
