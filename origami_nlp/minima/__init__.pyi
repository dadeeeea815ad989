from .account import (
    ESCAPE_PATHS as ESCAPE_PATHS,
    MEETINGS as MEETINGS,
    SearchReport as SearchReport,
)
from .completeness import (
    Added as Added,
    Completeness as Completeness,
    Open as Open,
    check_prove as check_prove,
)
from .flags import ResultFlags as ResultFlags, StateFlags as StateFlags
from .fold_out import (
    Part as Part,
    check_mesh as check_mesh,
    write_parts as write_parts,
)
from .full_space import (
    FullSpace as FullSpace,
    hessian_spectra as hessian_spectra,
    is_affordable as is_affordable,
    judge_in_full_space as judge_in_full_space,
    permutations as permutations,
    symmetry_blocks as symmetry_blocks,
    with_full_space as with_full_space,
)
from .interactive import view_minima as view_minima
from .marks import (
    Drawn as Drawn,
    drawn_minima as drawn_minima,
    mark_minima as mark_minima,
)
from .minimum import (
    TRIALS as TRIALS,
    JudgedState as JudgedState,
    Survival as Survival,
)
from .noise import (
    NOISE as NOISE,
    check_noise as check_noise,
    displacements as displacements,
    with_survival as with_survival,
)
from .picture import draw_minima as draw_minima, paint_landscape as paint_landscape
from .report_lines import lattice_table as lattice_table
from .result import (
    MinimaResult as MinimaResult,
    check_result as check_result,
)
from .rows import KINDS as KINDS, StateRow as StateRow
from .stability import judged as judged
from .stopping import chao1 as chao1, chao1_error as chao1_error
from .summary import find_images as find_images
from .table import scenes_table as scenes_table
