from .admissible import (
    Embedding as Embedding,
    check_admissible as check_admissible,
    pose_paper as pose_paper,
)
from .borders import (
    Disjunction as Disjunction,
    choices as choices,
    without_passing as without_passing,
)
from .closure import MOST_DENSE_ROWS as MOST_DENSE_ROWS, Closure as Closure
from .compiled_facets import crossings_among as crossings_among
from .contact_pairs import (
    ContactPair as ContactPair,
    FoldedGeometry as FoldedGeometry,
    Parallel as Parallel,
)
from .crossings import (
    PatternCrossings as PatternCrossings,
    convex_parts as convex_parts,
    cross_each_other as cross_each_other,
)
from .equations import (
    MOST_DENSE as MOST_DENSE,
    PatternEquations as PatternEquations,
)
from .faces import CoplanarContact as CoplanarContact, Faces as Faces
from .features import Features as Features
from .fold_out import (
    MeshFaces as MeshFaces,
    path_frames as path_frames,
    save_fold as save_fold,
    state_frame as state_frame,
    state_mesh as state_mesh,
    state_parts as state_parts,
    states_to_fold as states_to_fold,
)
from .labels import (
    CanonicalLabelling as CanonicalLabelling,
    PaperSymmetry as PaperSymmetry,
    find_labels as find_labels,
    image as image,
)
from .lattice import (
    FoldedLattice as FoldedLattice,
    Lattice as Lattice,
)
from .layers import (
    Layers as Layers,
    check_orders as check_orders,
    conflict as conflict,
    order_layers as order_layers,
    pose_stack as pose_stack,
)
from .orbits import Image as Image, Orbits as Orbits, orbits_of as orbits_of
from .orders import TRANSITIVE as TRANSITIVE, Orders as Orders, Rules as Rules
from .pop_signs import (
    PopSigns as PopSigns,
    angle_sums as angle_sums,
)
from .poses import MOVES as MOVES, Poses as Poses
from .posing import pose as pose
from .problem import PatternProblem as PatternProblem
from .screws import Screws as Screws, find_screws as find_screws
from .stacks import Stack as Stack, Unclear as Unclear
from .symbols import Symbols as Symbols
from .tube import (
    FoldedTube as FoldedTube,
    Tube as Tube,
    measured_cell as measured_cell,
)
from .work import (
    DeadForce as DeadForce,
    Pull as Pull,
    Torque as Torque,
    Work as Work,
    Worked as Worked,
)
