from .boundary import (
    BifurcationSet as BifurcationSet,
    CurvePoint as CurvePoint,
    EventCurve as EventCurve,
    Plane as Plane,
    find_bifurcation_set as find_bifurcation_set,
)
from .driver import Driver as Driver, OwnForces as OwnForces
from .family import (
    Family as Family,
    family_of as family_of,
    with_generic_symmetry as with_generic_symmetry,
)
from .figure import draw_boundaries as draw_boundaries, draw_path as draw_path
from .interactive import view_path as view_path
from .load import load_path as load_path
from .parameter_range import (
    ParameterRange as ParameterRange,
    parse_parameter_range as parse_parameter_range,
)
from .records import (
    Leg as Leg,
    PathBranch as PathBranch,
    PathEvent as PathEvent,
    PathPoint as PathPoint,
    Residuals as Residuals,
    SearchCheck as SearchCheck,
    Snap as Snap,
)
from .result import Atlas as Atlas, LoadPath as LoadPath, Path as Path
from .survey import follow as follow, follow_family as follow_family
