from . import rounds as rounds
from .batch_closure import (
    CLOSED as CLOSED,
    POOR as POOR,
    QUADRATIC as QUADRATIC,
    SETTLING as SETTLING,
    STEPS as STEPS,
    Closing as Closing,
)
from .batch_states import (
    SLOTS as SLOTS,
    Ends as Ends,
    Samples as Samples,
    joined as joined,
    put as put,
)
from .contact_closed_form import close_pinched as close_pinched
from .contact_strata import ContactStrata as ContactStrata, Row as Row, list_strata as list_strata
from .crossings import (
    NAMELESS as NAMELESS,
    VertexCrossings as VertexCrossings,
    model_rows as model_rows,
)
from .family import Listed as Listed, StartFamily as StartFamily
from .hinge_sets import HingeSets as HingeSets
from .moments import Moments as Moments, is_chain as is_chain
from .near_flat import NearFlat as NearFlat, NearFolded as NearFolded
from .options import (
    EFFORTS as EFFORTS,
    OWN as OWN,
    SearchOptions as SearchOptions,
    options_of as options_of,
)
from .projected import BATCH as BATCH, Projected as Projected
from .rounds import (
    CORNER as CORNER,
    DRAWN as DRAWN,
    GIVEN as GIVEN,
    SOURCES as SOURCES,
    Rounds as Rounds,
)
from .singular import (
    FlatFoldings as FlatFoldings,
    RigidStates as RigidStates,
    flat_foldings as flat_foldings,
)
from .strata import (
    Corners as Corners,
    Interior as Interior,
    NearCorners as NearCorners,
    Strata as Strata,
)
from .touching import (
    ContactStarts as ContactStarts,
    Touches as Touches,
    contact_starts as contact_starts,
    model_strata as model_strata,
)
