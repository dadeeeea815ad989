from . import inverse_design as inverse_design, paper as paper, sweep as sweep
from .barriers import Barriers as Barriers, find_barriers as find_barriers
from .contact import (
    ContactReport as ContactReport,
    find_contacts as find_contacts,
    find_segments as find_segments,
)
from .continuation import ContinuationOptions as ContinuationOptions
from .drawings import DrawingOptions as DrawingOptions
from .errors import OrigamiError as OrigamiError
from .hinges import MeasuredHinge as MeasuredHinge, fit_hinge as fit_hinge
from .inverse_design import Design as Design, design as design
from .kkt import State as State, Stratum as Stratum
from .minima import (
    JudgedState as JudgedState,
    MinimaResult as MinimaResult,
    draw_minima as draw_minima,
)
from .paper import (
    CriticalPoints as CriticalPoints,
    ExactLandscape as ExactLandscape,
    Space as Space,
    find_critical_points as find_critical_points,
    find_landscape as find_landscape,
    find_space as find_space,
)
from .paths import (
    Atlas as Atlas,
    BifurcationSet as BifurcationSet,
    LoadPath as LoadPath,
    find_bifurcation_set as find_bifurcation_set,
    follow as follow,
    load_path as load_path,
)
from .pattern import (
    HingeData as HingeData,
    Load as Load,
    Pattern as Pattern,
    Scene as Scene,
    Vertex as Vertex,
    convert as convert,
    examples as examples,
    format_scene as format_scene,
    from_mesh as from_mesh,
    parse_scene as parse_scene,
    read_fold_scene as read_fold_scene,
    read_pattern as read_pattern,
    read_scene as read_scene,
)
from .pattern_problem import check_admissible as check_admissible, pose as pose
from .pattern_states import (
    Mobility as Mobility,
    Motion as Motion,
    analyze_mobility as analyze_mobility,
    find_motion as find_motion,
)
from .proof import ProofOptions as ProofOptions
from .results import (
    draw as draw,
    read_result as read_result,
    save as save,
    to_frame as to_frame,
    view as view,
)
from .search import IpoptAnswer as IpoptAnswer, SearchOptions as SearchOptions, solve as solve
from .validity import (
    LayerOrders as LayerOrders,
    Validity as Validity,
    check as check,
    layer_orders as layer_orders,
)
from .verbs import (
    classify as classify,
    find_minima as find_minima,
    write_fold as write_fold,
    write_mesh as write_mesh,
)
from .version import __version__ as __version__
