from .descend import (
    CLOSES_NOT as CLOSES_NOT,
    NO_LOWER as NO_LOWER,
    STAYS as STAYS,
    CompiledDescent as CompiledDescent,
    DescentEnd as DescentEnd,
    Slot as Slot,
    StartState as StartState,
    compile_descents as compile_descents,
)
from .descent_path import (
    DescentPath as DescentPath,
    descent_path as descent_path,
    lower_beside as lower_beside,
    side_of_saddles as side_of_saddles,
)
from .draws import DEEP as DEEP, MOST_TRIED as MOST_TRIED, Draws as Draws
from .follow import Follower as Follower
from .ipopt import (
    OPTIONS as OPTIONS,
    ByIpopt as ByIpopt,
    Confirmation as Confirmation,
    IpoptAnswer as IpoptAnswer,
    Solved as Solved,
    confirm as confirm,
    solve as solve,
    solve_apart as solve_apart,
    solve_with as solve_with,
)
from .newton import (
    BESIDE_FLAT as BESIDE_FLAT,
    TRUST as TRUST,
    ByNewton as ByNewton,
    Descended as Descended,
    close as close,
    descend_by_newton as descend_by_newton,
    stationary_beside as stationary_beside,
)
from .options import (
    EFFORTS as EFFORTS,
    OWN as OWN,
    SearchOptions as SearchOptions,
    options_of as options_of,
)
from .starts import (
    Changed as Changed,
    FoldedCreases as FoldedCreases,
    StartKind as StartKind,
    Touch as Touch,
    Uniform as Uniform,
    at_limits as at_limits,
    given as given,
    hinge_rests as hinge_rests,
    on_grid as on_grid,
    other_wells as other_wells,
)
from .ways import Relabelled as Relabelled, WayDown as WayDown, way_down as way_down
