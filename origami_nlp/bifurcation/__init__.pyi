from .boundary import (
    BifurcationSet as BifurcationSet,
    CurvePoint as CurvePoint,
    EventCurve as EventCurve,
    find_bifurcation_set as find_bifurcation_set,
)
from .branches import branches_of as branches_of, chains_of as chains_of, joined as joined
from .family import (
    Family as Family,
    family_of as family_of,
    pattern_family as pattern_family,
    with_generic_symmetry as with_generic_symmetry,
)
from .figure import (
    draw_atlas as draw_atlas,
    draw_boundaries as draw_boundaries,
    draw_ranges as draw_ranges,
    event_look as event_look,
    kinds_legend as kinds_legend,
)
from .find import follow as follow, follow_family as follow_family
from .interactive import view_paths as view_paths
from .judging import (
    Touching as Touching,
    breaking_eigenvalue as breaking_eigenvalue,
    parts_of as parts_of,
)
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
from .result import Atlas as Atlas
from .smooth import smooth as smooth
