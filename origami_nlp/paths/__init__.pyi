from .atlas import Atlas as Atlas
from .boundary import (
    BifurcationSet as BifurcationSet,
    CurvePoint as CurvePoint,
    EventCurve as EventCurve,
    find_bifurcation_set as find_bifurcation_set,
)
from .driver import Driver as Driver, OwnForces as OwnForces
from .family import (
    Family as Family,
    family_of as family_of,
    pattern_family as pattern_family,
    with_generic_symmetry as with_generic_symmetry,
)
from .figure import draw_atlas as draw_atlas, draw_boundaries as draw_boundaries
from .interactive import view_paths as view_paths
from .load import load_path as load_path
from .load_figure import draw_load as draw_load
from .load_interactive import view_path as view_path
from .load_records import (
    ConfirmedSnap as ConfirmedSnap,
    Leg as Leg,
    LoadPoint as LoadPoint,
    Snap as Snap,
)
from .load_result import LoadPath as LoadPath
from .parameter_range import (
    ParameterRange as ParameterRange,
    parse_parameter_range as parse_parameter_range,
)
from .plane import Plane as Plane
from .records import (
    EVENT_WORDS as EVENT_WORDS,
    BranchEnd as BranchEnd,
    KindRange as KindRange,
    Multiplier as Multiplier,
    PathBranch as PathBranch,
    PathEvent as PathEvent,
    PathPoint as PathPoint,
    Residuals as Residuals,
    SearchCheck as SearchCheck,
    StateAt as StateAt,
)
from .smooth import smooth as smooth
from .survey import follow as follow, follow_family as follow_family
