from . import examples as examples
from .bending import with_bending as with_bending
from .cells import Cell as Cell, make_cell as make_cell
from .coercion import (
    Stated as Stated,
    as_origami as as_origami,
    as_pattern as as_pattern,
    as_scene as as_scene,
    from_mesh as from_mesh,
)
from .converting import (
    convert as convert,
    frame_drawing as frame_drawing,
    frames_of as frames_of,
)
from .crease_pattern import (
    FoldVertex as FoldVertex,
    fold_vertices as fold_vertices,
    make_vertex as make_vertex,
    merged_sectors as merged_sectors,
    misses_of_noise as misses_of_noise,
)
from .examples import degree6 as degree6, degree8 as degree8, panels as panels
from .fold_faces import Oddity as Oddity, drawing_oddities as drawing_oddities
from .fold_file import (
    FIXED_KEY as FIXED_KEY,
    LARGEST as LARGEST,
    LIMITS_KEY as LIMITS_KEY,
    LOADS_KEY as LOADS_KEY,
    PRELOAD_KEY as PRELOAD_KEY,
    REST_KEY as REST_KEY,
    STIFFNESS_KEY as STIFFNESS_KEY,
    Frame as Frame,
    parse_fold as parse_fold,
    read_fold as read_fold,
)
from .fold_limits import (
    LIMIT_KEYS as LIMIT_KEYS,
    Contact as Contact,
    Limits as Limits,
    limit_angles as limit_angles,
    stated_limits as stated_limits,
    tapered_limit as tapered_limit,
    thick_limits as thick_limits,
)
from .fold_notes import listed as listed
from .fold_scene import (
    read_fold_scene as read_fold_scene,
    scene_at as scene_at,
)
from .fold_springs import FoldSprings as FoldSprings
from .hinge_data import HingeData as HingeData, read_hinge_data as read_hinge_data
from .hinge_fit import (
    LawFit as LawFit,
    fit_data as fit_data,
    runs as runs,
)
from .hinge_law import HingeLaw as HingeLaw, moved_cubic as moved_cubic
from .hinge_tables import read_law as read_law
from .hinge_types import (
    detent as detent,
    double_well as double_well,
    linear as linear,
    one_sided as one_sided,
    polynomial as polynomial,
    sum_of as sum_of,
    table as table,
    well as well,
)
from .hinges_stated import (
    Laws as Laws,
    law_probes as law_probes,
    laws_to_fold as laws_to_fold,
    most_torque as most_torque,
    read_torque_bounds as read_torque_bounds,
    same_laws as same_laws,
    seen_laws as seen_laws,
)
from .kept_symmetry import with_symmetry_of as with_symmetry_of
from .lattice_stated import (
    LATTICE_KEY as LATTICE_KEY,
    ROLLED_KEY as ROLLED_KEY,
)
from .loads import (
    DeadLoads as DeadLoads,
    Load as Load,
    dead_loads as dead_loads,
)
from .numbers_read import (
    format_angle as format_angle,
    parse_angle as parse_angle,
    parse_angles as parse_angles,
)
from .one_vertex import shape_of as shape_of
from .origami import Origami as Origami
from .pattern_file import (
    face_oddities as face_oddities,
    frame_pattern as frame_pattern,
    read_pattern as read_pattern,
)
from .places import Example as Example, Numbered as Numbered, with_numbers as with_numbers
from .polygons import (
    Side as Side,
    fold_between as fold_between,
    side as side,
    sides_of as sides_of,
)
from .relations import Relations as Relations
from .scene import Scene as Scene
from .scene_file import (
    decode_scene as decode_scene,
    format_scene as format_scene,
    is_json as is_json,
    parse_scene as parse_scene,
    read_scene as read_scene,
    scene_from_dict as scene_from_dict,
    scene_to_dict as scene_to_dict,
    vertex_from_dict as vertex_from_dict,
)
from .sheet import (
    Loop as Loop,
    Pattern as Pattern,
    in_plane as in_plane,
    laid_flat as laid_flat,
    make_pattern as make_pattern,
)
from .sheet_data import pattern_from_dict as pattern_from_dict, pattern_to_dict as pattern_to_dict
from .symmetry import winding_number as winding_number, windings_of as windings_of
from .vertex import Vertex as Vertex
