from .family import Listed as Listed
from .hinge_sets import HingeSets as HingeSets
from .moments import Moments as Moments, is_chain as is_chain
from .near_flat import NearFlat as NearFlat, NearFolded as NearFolded
from .options import (
    EFFORTS as EFFORTS,
    OWN as OWN,
    SearchOptions as SearchOptions,
    options_of as options_of,
)
from .singular import (
    FlatFoldings as FlatFoldings,
    flat_foldings as flat_foldings,
)
