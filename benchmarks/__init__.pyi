from . import (
    budget_page as budget_page,
    judging as judging,
    patterns_page as patterns_page,
    time_budget as time_budget,
    union as union,
)
from .attempt import draw_starts as draw_starts
from .cone_speed import MAP_DEGREES as MAP_DEGREES, measure as measure
from .cone_speed_table import as_markdown as as_markdown
from .coverage import measure_coverage as measure_coverage, scenes_for as scenes_for
from .coverage_table import (
    coverage_markdown as coverage_markdown,
    draw_coverage as draw_coverage,
)
from .design_speed import DesignBench as DesignBench, measure_design as measure_design
from .digest import rows as rows, targets as targets
from .families import FAMILIES as FAMILIES, family_scene as family_scene
from .figure import draw_bench as draw_bench
from .foreign import foreign_methods as foreign_methods, run_foreign as run_foreign
from .hard import run_hard as run_hard
from .judging import Judge as Judge
from .methods_casadi import ipopt_alone as ipopt_alone
from .methods_ours import ours as ours
from .pattern_contacts import PatternContact as PatternContact, measure_contact as measure_contact
from .pattern_problems import (
    PatternTask as PatternTask,
    pattern_problems as pattern_problems,
)
from .pattern_scaling import PatternScale as PatternScale, measure_scale as measure_scale
from .patterns import PatternBench as PatternBench, run_patterns as run_patterns
from .patterns_figure import draw_patterns as draw_patterns
from .problems import random_vertex as random_vertex
from .proved import (
    ProvedCounts as ProvedCounts,
    count_proved as count_proved,
    proved_scene as proved_scene,
)
from .reference import solve_reference as solve_reference
from .report import in_short as in_short, markdown as markdown, show as show
from .run import read_bench as read_bench, run_bench as run_bench, write_bench as write_bench
from .union import build_union as build_union, read_union as read_union
