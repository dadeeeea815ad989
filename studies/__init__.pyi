from . import section5_table as section5_table
from .archive import write_archive as write_archive
from .at_most_four import candidates as candidates, draw_boxes as draw_boxes
from .at_most_six import prove_branch as prove_branch
from .audit import audit_candidates as audit_candidates
from .audit_table import (
    as_markdown as as_markdown,
    audit_to_dict as audit_to_dict,
    summary_table as summary_table,
)
from .baseline import STEPS as STEPS, appendix_a as appendix_a
from .chart_states import chart_distance as chart_distance
from .cone_figures import draw_cone_figure as draw_cone_figure
from .cone_limits import limits as limits
from .counts import (
    SheetCount as SheetCount,
    count_all as count_all,
    draw_counts as draw_counts,
)
from .figures import FIGURES as FIGURES, Drawn as Drawn
from .grid_convergence import (
    GridCount as GridCount,
    GridErrors as GridErrors,
    count_grid_minima as count_grid_minima,
    grid_errors as grid_errors,
)
from .grid_convergence_figure import (
    draw_grid_convergence as draw_grid_convergence,
    print_convergence as print_convergence,
)
from .grid_minima import follow_grid_minima as follow_grid_minima, grid_points as grid_points
from .grid_minima_table import grid_minima_table as grid_minima_table
from .published import read_candidates as read_candidates
from .section5 import STATEMENTS as STATEMENTS, check_statements as check_statements
from .section5_plain import findings_to_dict as findings_to_dict, limits_to_dict as limits_to_dict
from .section5_table import LIMIT_HEADS as LIMIT_HEADS, limit_row as limit_row
from .sheets import (
    draw_panels as draw_panels,
    find_panels as find_panels,
    sheet_table as sheet_table,
)
from .two_maxima import draw_two_maxima as draw_two_maxima
